//! A part of a triangle whose distance is to be bounded, and what its corners alone say of that.

use std::cmp::Ordering;

use glam::DVec3;

use crate::oracle::sheet::Near;

/// More than a few operations round off.
const ROUNDED_UP: f64 = 1.0 + 1e-14;
/// Cuts at the borders of nearest triangles come no nearer to an end than this.
const MARGIN: f64 = 0.03;

/// A part of a triangle of A.
pub(super) struct Piece {
    pub(super) triangle: u32,
    pub(super) depth: u16,
    /// Barycentrics of its corners, their exact places, and what of B is nearest to them.
    pub(super) corners: [DVec3; 3],
    pub(super) places: [DVec3; 3],
    pub(super) near: [Near; 3],
    /// No place of the piece is farther from B.
    pub(super) upper: f64,
}

impl Piece {
    /// No corner is farther from B.
    pub(super) fn farthest(&self) -> f64 {
        self.near.iter().map(|near| near.upper).fold(0.0, f64::max)
    }
}

impl PartialEq for Piece {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Piece {}

impl PartialOrd for Piece {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Largest bound first; then by place, so that equal bounds are taken in one order.
impl Ord for Piece {
    fn cmp(&self, other: &Self) -> Ordering {
        let corner = |p: &Self| p.corners[0].to_array().map(f64::to_bits);
        let upper = self.upper.total_cmp(&other.upper);
        upper.then(other.triangle.cmp(&self.triangle)).then_with(|| corner(self).cmp(&corner(other)))
    }
}

/// The distance to a point is convex too.
pub(super) fn farthest_from(target: DVec3, places: &[DVec3; 3]) -> f64 {
    places.iter().map(|p| p.distance(target)).fold(0.0, f64::max)
}

/// How far along a segment its foot on a triangle's plane leaves the triangle.
pub(super) fn leaves(from: DVec3, to: DVec3, triangle: [DVec3; 3]) -> Option<f64> {
    let normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
    let mut first: Option<f64> = None;
    for k in 0..3 {
        let (p, q) = (triangle[k], triangle[(k + 1) % 3]);
        let inward = normal.cross(q - p);
        let (d, e) = (inward.dot(from - p), inward.dot(to - p));
        let share = d / (d - e);
        if d > 0.0 && e < 0.0 && (MARGIN..=1.0 - MARGIN).contains(&share) && first.is_none_or(|s| share < s) {
            first = Some(share);
        }
    }
    first
}

pub(super) fn longest(places: &[DVec3; 3]) -> usize {
    let length = |k: usize| places[k].distance_squared(places[(k + 1) % 3]);
    (0..3).max_by(|&i, &j| length(i).total_cmp(&length(j))).unwrap_or(0)
}

/// No point of a triangle is farther from its nearest corner: the circumradius, or half the longest side of an
/// obtuse one, whose circumcentre lies outside.
pub(super) fn covering_radius(places: &[DVec3; 3]) -> f64 {
    let k = longest(places);
    let (a, b, c) = (places[k], places[(k + 1) % 3], places[(k + 2) % 3]);
    let (side, p, q) = (b - a, a - c, b - c);
    let half = 0.5 * side.length();
    if p.dot(q) <= 0.0 {
        return half * ROUNDED_UP;
    }
    // At most 1/√3 of the longest side, whatever rounding makes of the area.
    let circumradius = half * (p.length() * q.length() / p.cross(q).length());
    circumradius.min(2.0 * half / 3f64.sqrt()) * ROUNDED_UP
}
