//! An expression layer with derivatives, by dual numbers. The twin of `jets_expression.comp`.

use glam::DVec3;

use super::{
    displace_expression::code,
    frame::{self, Jet, frame_at, product, slopes},
    samples::Sample,
};
use crate::{
    expression::{Dual, evaluate},
    layout::geometry::Layer,
    tables::Tables,
};

#[must_use]
pub fn jet(tables: &Tables, layer: &Layer, sample: &Sample) -> Jet {
    let frame = frame_at(tables, &sample.site);
    let scalar = |s: DVec3| Dual::new(s.x, slopes(s));
    let component = |m: Jet, k: usize| Dual::new(m.x_axis[k], [m.y_axis[k], m.z_axis[k]]);
    let (p, n) = (frame.position, frame.normal);
    let variables = [
        scalar(frame::affine(layer.texel_from_u, frame.u, frame.v)),
        scalar(frame::affine(layer.texel_from_v, frame.u, frame.v)),
        component(p, 0),
        component(p, 1),
        component(p, 2),
        component(n, 0),
        component(n, 1),
        component(n, 2),
    ];
    let h = evaluate(code(tables, layer), &variables);
    let height = DVec3::new(h.value - f64::from(layer.midlevel), h.derivative[0], h.derivative[1]);
    sample.counted(product(height * f64::from(layer.scale), frame.direction))
}
