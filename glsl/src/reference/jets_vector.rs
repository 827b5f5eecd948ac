//! A vector layer with derivatives. The twin of `jets_vector.comp`.

use glam::{DMat3, DVec3};

use super::{
    frame::{self, Jet, frame_at, product, tangents_at},
    map,
    samples::Sample,
};
use crate::{
    layout::geometry::{Layer, kind},
    tables::Tables,
};

#[must_use]
pub fn jet(tables: &Tables, layer: &Layer, sample: &Sample) -> Jet {
    let frame = frame_at(tables, &sample.site);
    let x = frame::affine(layer.texel_from_u, frame.u, frame.v);
    let y = frame::affine(layer.texel_from_v, frame.u, frame.v);
    let component = |k: u64| {
        let [value, by_x, by_y] = map::with_slopes(tables, layer, k, [x.x, y.x]);
        let jet = DVec3::new(value - f64::from(layer.midlevel), by_x * x.y + by_y * y.y, by_x * x.z + by_y * y.z);
        f64::from(layer.scale) * jet
    };
    let [a, b, c] = [0, 1, 2].map(component);
    if layer.kind == kind::VECTOR_OBJECT {
        return sample.counted(DMat3::from_cols(a, b, c).transpose());
    }
    let (tangent, bitangent) = tangents_at(tables, &sample.site, frame.normal);
    sample.counted(product(a, tangent) + product(b, bitangent) + product(c, frame.direction))
}
