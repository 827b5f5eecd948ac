//! The same detail, lower and higher.

use super::{Row, Stand};
use crate::domain::{chart::Sweep, request::RenderRequest};

pub(super) const ROW: Row = Row {
    sweep: Sweep::Amplitude,
    label: "scale of the detail, times that of the chart (log)",
    unit: "x",
    values: &[0.25, 0.5, 1.0, 2.0, 4.0],
    keeps_surface: false,
    vary,
};

/// Normal maps bend as they do: their scale is not a height.
fn vary(request: &mut RenderRequest, stand: &Stand, times: f64) {
    request.camera = stand.camera(stand.outward, stand.distance);
    let layers = request.surface.details.iter_mut().flat_map(|detail| &mut detail.layers);
    for layer in layers.filter(|layer| !layer.source.is_normal()) {
        layer.scale *= times as f32;
    }
}
