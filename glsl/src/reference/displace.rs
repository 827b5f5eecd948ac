//! The displacement of a height layer. The twin of `displace.comp`.

use glam::DVec3;

use super::{map, subdivide::Base};
use crate::{layout::geometry::Layer, tables::Tables};

#[must_use]
pub fn displacement(tables: &Tables, layer: &Layer, base: &Base) -> DVec3 {
    let p = map::texel_space(layer, base.uv[0], base.uv[1]);
    let value = map::bilinear(tables, layer, 0, p);
    base.direction * ((value - f64::from(layer.midlevel)) * f64::from(layer.scale))
}
