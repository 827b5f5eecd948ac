//! Farther and farther away, along the chart's own view.

use super::{Row, Stand};
use crate::domain::{chart::Sweep, request::RenderRequest};

pub(super) const ROW: Row = Row {
    sweep: Sweep::Distance,
    label: "distance, times that of the chart (log)",
    unit: "x",
    values: &[1.0, 2.0, 4.0, 8.0, 16.0],
    keeps_surface: true,
    vary,
};

fn vary(request: &mut RenderRequest, stand: &Stand, times: f64) {
    request.camera = stand.camera(stand.outward, times * stand.distance);
}
