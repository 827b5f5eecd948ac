//! Rays against triangles without leaks: the watertight test of Woop, Benthin and Wald 2013 in f64, its edge
//! functions with exact signs and a rule for ties, so that a line crosses a closed mesh as often in as out.

use glam::{DVec2, DVec3};

use super::bvh::{Bounds, Bvh, Segment};

/// Where a segment meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Along the segment, in lengths of its direction.
    pub t: f64,
    pub triangle: u32,
    /// Of the triangle's corners, from 0 to 1; their sum is 1.
    pub barycentrics: DVec3,
    /// The corners run counter-clockwise as seen from the segment's origin.
    pub front: bool,
}

/// Triangles that rays can meet.
pub struct Tracer {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    bvh: Bvh,
}

/// Boxes are larger than their triangles by this share of the largest coordinate: the shear rounds corners by
/// less, from origins up to 10 000 times as far away.
const BOX_MARGIN: f64 = 1.0 / (1u64 << 36) as f64;
/// A box is left out only beyond this much more than the nearest hit: its own distance is rounded.
const NEAREST_SLACK: f64 = 16.0 * f64::EPSILON;

impl Tracer {
    /// Finite positions, and triangles that name them.
    #[must_use]
    pub fn new(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Self {
        let largest = positions.iter().fold(0.0, |largest: f64, p| largest.max(p.abs().max_element()));
        let corners = |t: &[u32; 3]| t.map(|v| positions[v as usize]);
        let boxes: Vec<Bounds> =
            triangles.iter().map(|t| Bounds::of(&corners(t)).inflated(BOX_MARGIN * largest)).collect();
        let bvh = Bvh::build(&boxes);
        Self { positions, triangles, bvh }
    }

    /// Corners of a triangle.
    #[must_use]
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|v| self.positions[v as usize])
    }

    /// The nearest hit; of equally near ones that of the lowest triangle.
    #[must_use]
    pub fn first_hit(&self, segment: &Segment) -> Option<Hit> {
        self.first_hit_where(segment, |_| true)
    }

    /// The nearest of the hits that `counts` lets count.
    #[must_use]
    pub fn first_hit_where(&self, segment: &Segment, counts: impl Fn(&Hit) -> bool) -> Option<Hit> {
        let ray = Sheared::new(segment);
        let mut best: Option<Hit> = None;
        self.bvh.along(segment, |triangle, _| {
            let nearer = |hit: &Hit| best.is_none_or(|best| (hit.t, hit.triangle) < (best.t, best.triangle));
            if let Some(hit) = self.hit(&ray, triangle).filter(nearer).filter(|hit| counts(hit)) {
                best = Some(hit);
            }
            best.map_or(f64::INFINITY, |best| best.t + NEAREST_SLACK * best.t.abs())
        });
        best
    }

    #[must_use]
    pub fn any_hit(&self, segment: &Segment) -> bool {
        self.any_hit_where(segment, |_| true)
    }

    /// Whether there is a hit that `counts` lets count.
    #[must_use]
    pub fn any_hit_where(&self, segment: &Segment, counts: impl Fn(&Hit) -> bool) -> bool {
        let ray = Sheared::new(segment);
        let mut found = false;
        self.bvh.along(segment, |triangle, _| {
            found = found || self.hit(&ray, triangle).is_some_and(|hit| counts(&hit));
            if found { f64::NEG_INFINITY } else { f64::INFINITY }
        });
        found
    }

    /// Every hit, in no order.
    #[must_use]
    pub fn hits(&self, segment: &Segment) -> Vec<Hit> {
        let ray = Sheared::new(segment);
        let mut hits = Vec::new();
        self.bvh.along(segment, |triangle, _| {
            hits.extend(self.hit(&ray, triangle));
            f64::INFINITY
        });
        hits
    }

    fn hit(&self, ray: &Sheared, triangle: u32) -> Option<Hit> {
        ray.hit(self.corners(triangle)).map(|(t, barycentrics, front)| Hit { t, triangle, barycentrics, front })
    }
}

/// The segment's own axes: the direction is (0, 0, 1) and the origin 0. A corner goes there the same way for
/// every triangle that has it, so what is decided there is decided for a mesh without gaps.
struct Sheared {
    origin: DVec3,
    axes: [usize; 3],
    shear: DVec2,
    t_from_z: f64,
    from: f64,
    to: f64,
}

impl Sheared {
    fn new(segment: &Segment) -> Self {
        let d = segment.direction;
        let z = (0..3).fold(0, |most, k| if d[k].abs() > d[most].abs() { k } else { most });
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        // Looking along z from below mirrors: swapping keeps the sense of rotation.
        let [x, y] = if d[z] < 0.0 { [y, x] } else { [x, y] };
        Self {
            origin: segment.origin,
            axes: [x, y, z],
            shear: DVec2::new(d[x] / d[z], d[y] / d[z]),
            t_from_z: 1.0 / d[z],
            from: segment.from,
            to: segment.to,
        }
    }

    fn place(&self, p: DVec3) -> (DVec2, f64) {
        let p = p - self.origin;
        let [x, y, z] = self.axes.map(|k| p[k]);
        (DVec2::new(x - self.shear.x * z, y - self.shear.y * z), z)
    }

    /// t, barycentrics, and whether the front is seen.
    fn hit(&self, corners: [DVec3; 3]) -> Option<(f64, DVec3, bool)> {
        let [(a, az), (b, bz), (c, cz)] = corners.map(|p| self.place(p));
        let (weight_a, left) = side(b, c);
        let (weight_b, _) = Some(side(c, a)).filter(|side| side.1 == left)?;
        let (weight_c, _) = Some(side(a, b)).filter(|side| side.1 == left)?;
        let weights = DVec3::new(weight_a, weight_b, weight_c);
        let sum = weights.element_sum();
        let t = weights.dot(DVec3::new(az, bz, cz)) / sum * self.t_from_z;
        // Not a number where the triangle is too small for its area to be one.
        (t >= self.from && t <= self.to).then(|| (t, weights / sum, !left))
    }
}

/// Twice the area of (0, a, b), and whether 0 lies to the left of a → b. On the line itself (ε, ε²) decides for
/// an endless small ε (Edelsbrunner and Mücke 1990), the same for all triangles; b → a gets the opposite answer.
fn side(a: DVec2, b: DVec2) -> (f64, bool) {
    let area = exact_cross(a, b);
    let decides = [area, a.y - b.y, b.x - a.x].into_iter().find(|x| *x != 0.0).unwrap_or(0.0);
    (area, decides > 0.0)
}

/// a.x b.y − a.y b.x, its sign exact (products of more than about 1e-290).
fn exact_cross(a: DVec2, b: DVec2) -> f64 {
    let (p, q) = (a.x * b.y, a.y * b.x);
    let difference = p - q;
    // Both products and the difference are off by half an ulp each.
    if difference.abs() > 2.0 * f64::EPSILON * (p.abs() + q.abs()) {
        return difference;
    }
    // As close as this the difference is exact (Sterbenz 1974), and so are the errors of the products.
    let (p_error, q_error) = (a.x.mul_add(b.y, -p), a.y.mul_add(b.x, -q));
    let (high, low) = exact_difference(p_error, q_error);
    let sum = difference + high;
    if sum == 0.0 { low } else { sum }
}

/// a − b as a rounded difference and what is missing of it (Knuth 1969).
fn exact_difference(a: f64, b: f64) -> (f64, f64) {
    let difference = a - b;
    let back = difference - a;
    (difference, (a - (difference - back)) - (b + back))
}

#[cfg(test)]
mod tests;
