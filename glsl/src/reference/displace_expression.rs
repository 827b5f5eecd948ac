//! The displacement of an expression layer. The twin of `displace_expression.comp`.

use glam::DVec3;

use super::{map, subdivide::Base};
use crate::{
    expression::{Instruction, evaluate},
    layout::geometry::Layer,
    tables::Tables,
};

/// The instructions of an expression layer.
#[must_use]
pub fn code<'a>(tables: &'a Tables, layer: &Layer) -> &'a [Instruction] {
    &tables.instructions[layer.first as usize..(layer.first + layer.row) as usize]
}

#[must_use]
pub fn displacement(tables: &Tables, layer: &Layer, base: &Base) -> DVec3 {
    let [u, v] = map::texel_space(layer, base.uv[0], base.uv[1]);
    let (p, n) = (base.position, base.normal);
    let value: f64 = evaluate(code(tables, layer), &[u, v, p.x, p.y, p.z, n.x, n.y, n.z]);
    base.direction * ((value - f64::from(layer.midlevel)) * f64::from(layer.scale))
}
