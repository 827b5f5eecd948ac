//! Twin of `backdrop`: what is seen of an environment behind everything.

use glam::DVec3;

use super::environment::Environment;

/// World directions of an image's places, of any length: at the top left corner, and their change by pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Directions {
    pub corner: DVec3,
    pub dx: DVec3,
    pub dy: DVec3,
}

impl Directions {
    /// At a place of the image, pixels.
    #[must_use]
    pub fn at(&self, at_px: [f64; 2]) -> DVec3 {
        self.corner + at_px[0] * self.dx + at_px[1] * self.dy
    }
}

/// Radiance from behind pixel (x, y).
#[must_use]
pub fn backdrop(environment: &Environment, directions: &Directions, x: u32, y: u32) -> DVec3 {
    let d = directions.at([f64::from(x) + 0.5, f64::from(y) + 0.5]);
    let (unit, length) = (d.normalize(), d.length());
    let across = |change: DVec3| (change / length).reject_from_normalized(unit).length();
    environment.mirror(unit, across(directions.dx).max(across(directions.dy)))
}
