//! A height layer with derivatives. The twin of `jets_height.comp`.

use glam::DVec3;

use super::{
    frame::{self, Jet, frame_at, product},
    map,
    samples::Sample,
};
use crate::{layout::geometry::Layer, tables::Tables};

#[must_use]
pub fn jet(tables: &Tables, layer: &Layer, sample: &Sample) -> Jet {
    let frame = frame_at(tables, &sample.site);
    let x = frame::affine(layer.texel_from_u, frame.u, frame.v);
    let y = frame::affine(layer.texel_from_v, frame.u, frame.v);
    let [value, by_x, by_y] = map::with_slopes(tables, layer, 0, [x.x, y.x]);
    let height = DVec3::new(value - f64::from(layer.midlevel), by_x * x.y + by_y * y.y, by_x * x.z + by_y * y.z);
    sample.counted(product(f64::from(layer.scale) * height, frame.direction))
}
