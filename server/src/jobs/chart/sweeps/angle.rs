//! From grazing to face-on, around what is looked at.

use super::{Row, Stand};
use crate::domain::{chart::Sweep, request::RenderRequest};

pub(super) const ROW: Row = Row {
    sweep: Sweep::Angle,
    label: "angle between the view's axis and the surface, degrees (log)",
    unit: "°",
    values: &[5.0, 10.0, 15.0, 20.0, 30.0, 45.0, 60.0, 85.0],
    keeps_surface: true,
    vary,
};

fn vary(request: &mut RenderRequest, stand: &Stand, degrees: f64) {
    let (sin, cos) = degrees.to_radians().sin_cos();
    request.camera = stand.camera(cos * stand.along() + sin * stand.normal, stand.distance);
}
