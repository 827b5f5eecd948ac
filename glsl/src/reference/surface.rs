//! Twin of `surface`: perspective-correct barycentrics and their derivatives (Olano and Greer 1997).

use glam::{DMat3, DVec3};

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Barycentrics {
    pub at: DVec3,
    /// Per pixel.
    pub dx: DVec3,
    pub dy: DVec3,
    /// On the screen.
    pub clockwise: bool,
}

/// `corners` hold homogeneous (x, y, w), moved so that the point asked for is the origin.
#[must_use]
pub fn barycentrics(corners: [DVec3; 3]) -> Barycentrics {
    let adjugate =
        DMat3::from_cols(corners[1].cross(corners[2]), corners[2].cross(corners[0]), corners[0].cross(corners[1]));
    let rows = adjugate.transpose();
    let sum = rows.z_axis.element_sum();
    let at = rows.z_axis / sum;
    let derivative = |row: DVec3| (row - at * row.element_sum()) / sum;
    Barycentrics { at: within(at), dx: derivative(rows.x_axis), dy: derivative(rows.y_axis), clockwise: sum > 0.0 }
}

/// Snapping to fixed point can put a sample just outside: what is seen there is the triangle's rim.
fn within(at: DVec3) -> DVec3 {
    let at = at.max(DVec3::ZERO);
    let total = at.element_sum();
    if total > 0.0 && total < 1e30 { at / total } else { DVec3::splat(1.0 / 3.0) }
}

/// Unit length, or zero where there is no direction.
#[must_use]
pub fn unit_or_zero(v: DVec3) -> DVec3 {
    let squared = v.length_squared();
    if squared > 1e-30 && squared < 1e30 { v / squared.sqrt() } else { DVec3::ZERO }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Homogeneous pixel corners moved to (x, y).
    fn corners_at(x: f64, y: f64) -> [DVec3; 3] {
        let corners = [[10.0, 12.0, 1.0], [90.0, 20.0, 3.0], [30.0, 80.0, 2.0]];
        corners.map(|[px, py, w]| DVec3::new((px - x) * w, (py - y) * w, w))
    }

    #[test]
    fn derivatives_agree_with_finite_differences() {
        let (x, y, step) = (40.0, 35.0, 1e-5);
        let b = barycentrics(corners_at(x, y));
        let dx = (barycentrics(corners_at(x + step, y)).at - barycentrics(corners_at(x - step, y)).at) / (2.0 * step);
        let dy = (barycentrics(corners_at(x, y + step)).at - barycentrics(corners_at(x, y - step)).at) / (2.0 * step);
        assert!((b.dx - dx).abs().max_element() < 1e-9, "{:?} {dx:?}", b.dx);
        assert!((b.dy - dy).abs().max_element() < 1e-9, "{:?} {dy:?}", b.dy);
    }

    #[test]
    fn corners_have_their_own_weight() {
        let b = barycentrics(corners_at(90.0, 20.0));
        assert!((b.at - DVec3::Y).abs().max_element() < 1e-12);
    }
}
