//! What of a ray lies in a prism, and the course over a height map that this gives.

use std::ops::Range;

use glam::{DVec2, DVec3, DVec4};

use super::{INFLATION, Prism, Under, blend, inflated};
use crate::layout::relief::COURSE_NODES;

impl Prism {
    /// Where a ray, mesh-local, leads over a height map, whose texels the corners are at: (x, y, height, t) at even times from
    /// where it comes between the sides to where it leaves them, but from `least` on. Empty where it does neither.
    ///
    /// Between nodes a course is straight, and the way of the ray bends by what the prism's directions turn, β, over one of
    /// its eight parts: it is off by no more than about β/512 of the prism's longest side, and at nodes by nothing.
    #[must_use]
    pub fn course(&self, origin: DVec3, direction: DVec3, texels: &[DVec2; 3], least: f64) -> Vec<DVec4> {
        let (origin, direction) = (self.local(origin), direction / self.side);
        let Some(range) = self.range(origin, direction).filter(|range| range.end > least) else { return Vec::new() };
        let start = range.start.max(least);
        let mut near = self.guess(origin + direction * start);
        let node = |n: usize| {
            let t = start + (range.end - start) * (n as f64 / (COURSE_NODES - 1) as f64);
            near = self.under(origin + direction * t, near)?;
            let at = texels[0] * near.weights.x + texels[1] * near.weights.y + texels[2] * near.weights.z;
            Some(DVec4::new(at.x, at.y, self.height(&near), t))
        };
        (0..COURSE_NODES).map(node).collect::<Option<_>>().unwrap_or_default()
    }

    /// From where to where a ray, in units of the prism, is between its sides; what lies between, if it goes out and comes
    /// back in, counts as inside. It may begin above the greatest height or end below the least.
    #[must_use]
    pub fn range(&self, origin: DVec3, direction: DVec3) -> Option<Range<f64>> {
        let around = self.around(origin, direction)?;
        let mut cuts = vec![around.start, around.end];
        for side in 0..3 {
            cuts.extend(self.cuts(side, origin, direction).into_iter().filter(|t| around.contains(t)));
        }
        cuts.sort_by(f64::total_cmp);
        let inside: Vec<_> =
            cuts.windows(2).filter(|pair| self.holds(origin + direction * (0.5 * (pair[0] + pair[1])))).collect();
        Some(inside.first()?[0]..inside.last()?[1])
    }

    pub(super) fn holds(&self, point: DVec3) -> bool {
        let slack = self.reach.end - self.reach.start;
        let is_near = |under: &Under| under.k >= self.reach.start - slack && under.k <= self.reach.end + slack;
        self.under(point, self.guess(point)).is_some_and(|under| under.is_inside() && is_near(&under))
    }

    /// What of a ray is in a sphere around the prism, and between two planes along the triangle.
    fn around(&self, origin: DVec3, direction: DVec3) -> Option<Range<f64>> {
        let hull = self.local_hull(INFLATION);
        let middle = hull.iter().sum::<DVec3>() / 6.0;
        let radius_squared = hull.iter().fold(0.0, |most: f64, p| most.max(p.distance_squared(middle)));
        let (squared, towards) = (direction.length_squared(), (middle - origin).dot(direction));
        let nearest = towards / squared;
        let half_squared = (radius_squared - (origin + direction * nearest).distance_squared(middle)) / squared;
        let half = half_squared.max(0.0).sqrt();
        let levels = hull.map(|point| point.dot(self.upright));
        let low = levels.iter().fold(f64::INFINITY, |least, level| least.min(*level));
        let high = levels.iter().fold(f64::NEG_INFINITY, |most, level| most.max(*level));
        let (from, rate) = (origin.dot(self.upright), direction.dot(self.upright));
        let [a, b] = [(low - from) / rate, (high - from) / rate];
        let along = if rate == 0.0 && (from < low || from > high) {
            return None;
        } else if rate == 0.0 {
            f64::NEG_INFINITY..f64::INFINITY
        } else {
            a.min(b)..a.max(b)
        };
        let range = (nearest - half).max(along.start)..(nearest + half).min(along.end);
        (range.start < range.end).then_some(range)
    }

    /// Where a ray meets the surface that an inflated side lies in.
    fn cuts(&self, side: usize, origin: DVec3, direction: DVec3) -> Vec<f64> {
        let [from, to] = [inflated(side, INFLATION), inflated((side + 1) % 3, INFLATION)];
        let (a, da) = (blend(&self.corners, from), blend(&self.corners, to - from));
        let (m, dm) = (blend(&self.directions, from), blend(&self.directions, to - from));
        let (across, turn, from) = (m.cross(direction), dm.cross(direction), a - origin);
        let coefficients = [from.dot(across), da.dot(across) + from.dot(turn), da.dot(turn)];
        let met = |s: f64| {
            let (a, m) = (a + da * s, m + dm * s);
            let normal = direction.cross(m);
            (a - origin).cross(m).dot(normal) / normal.length_squared()
        };
        let is_on_side = |s: &f64| *s > -0.125 && *s < 1.125;
        roots(coefficients).into_iter().filter(is_on_side).map(met).filter(|t| t.is_finite()).collect()
    }
}

/// Of c0 + c1 s + c2 s²; those that are no numbers are for the caller to leave out.
fn roots([c0, c1, c2]: [f64; 3]) -> Vec<f64> {
    let discriminant = c1 * c1 - 4.0 * c0 * c2;
    if discriminant < 0.0 {
        return Vec::new();
    }
    let q = -0.5 * (c1 + discriminant.sqrt().copysign(c1));
    vec![q / c2, c0 / q]
}
