//! Triangles of a convex polygon, some of whose corners lie on its straight sides.

use std::collections::BinaryHeap;

use glam::DVec3;

/// A corner less high over its neighbours, as a share of their distance, lies straight between them.
const STRAIGHT: f64 = 1e-9;

/// Corners of n − 2 triangles, as indices into `outline`; all have area where the polygon has. The corner that is
/// highest over its neighbours is cut off first.
pub(super) fn triangles(outline: &[DVec3]) -> Vec<[usize; 3]> {
    let count = outline.len();
    let mut ring = Ring::new(outline);
    let mut open: BinaryHeap<(u64, usize, u32)> = (0..count).map(|k| ring.key(k)).collect();
    let mut held = Vec::new();
    let mut made = Vec::with_capacity(count.saturating_sub(2));
    while made.len() + 3 < count {
        let Some((_, k, version)) = open.pop() else { break };
        if version != ring.version[k] {
            continue;
        }
        // The last corner beside a straight side stays, or that side alone would be left.
        if ring.would_leave_a_side(k) {
            if !held.contains(&k) {
                held.push(k);
            }
            continue;
        }
        let [before, after] = [ring.before[k], ring.after[k]];
        made.push([before, k, after]);
        ring.remove(k);
        held.retain(|k| *k != before && *k != after);
        open.extend([before, after].into_iter().chain(held.drain(..)).map(|k| ring.key(k)));
    }
    let last = (0..count).find(|&k| !ring.is_cut(k)).unwrap_or(0);
    made.push([ring.before[last], last, ring.after[last]]);
    made
}

/// What is left of the outline.
struct Ring<'o> {
    outline: &'o [DVec3],
    before: Vec<usize>,
    after: Vec<usize>,
    /// How high each corner is over its neighbours.
    height: Vec<f64>,
    /// Counts what changed of a corner; the largest number once it is cut off.
    version: Vec<u32>,
    /// Corners that are not straight.
    convex: usize,
}

impl<'o> Ring<'o> {
    fn new(outline: &'o [DVec3]) -> Self {
        let count = outline.len();
        let before = (0..count).map(|k| (k + count - 1) % count).collect();
        let after = (0..count).map(|k| (k + 1) % count).collect();
        let mut ring = Self { outline, before, after, height: vec![0.0; count], version: vec![0; count], convex: 0 };
        (0..count).for_each(|k| ring.height[k] = ring.height_of(k));
        ring.convex = ring.height.iter().filter(|height| **height > STRAIGHT).count();
        ring
    }

    fn height_of(&self, k: usize) -> f64 {
        let [a, b, c] = [self.before[k], k, self.after[k]].map(|k| self.outline[k]);
        (b - a).cross(c - a).length() / a.distance_squared(c).max(1e-300)
    }

    /// Numbers that are not negative are ordered as their bits are.
    fn key(&self, k: usize) -> (u64, usize, u32) {
        (self.height[k].to_bits(), k, self.version[k])
    }

    fn is_convex(&self, k: usize) -> bool {
        self.height[k] > STRAIGHT
    }

    fn is_cut(&self, k: usize) -> bool {
        self.version[k] == u32::MAX
    }

    fn would_leave_a_side(&self, k: usize) -> bool {
        self.convex == 3 && self.is_convex(k) && self.is_convex(self.before[k]) && self.is_convex(self.after[k])
    }

    fn remove(&mut self, k: usize) {
        let [before, after] = [self.before[k], self.after[k]];
        self.convex -= usize::from(self.is_convex(k));
        self.version[k] = u32::MAX;
        (self.after[before], self.before[after]) = (after, before);
        for k in [before, after] {
            self.convex -= usize::from(self.is_convex(k));
            self.height[k] = self.height_of(k);
            self.convex += usize::from(self.is_convex(k));
            self.version[k] += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A convex polygon on a circle, each side divided.
    fn outline(corners: usize, on_sides: impl Fn(usize) -> usize) -> Vec<DVec3> {
        let corner = |k: usize| {
            let angle = std::f64::consts::TAU * (k % corners) as f64 / corners as f64;
            DVec3::new(angle.cos(), 3.0 * angle.sin(), 0.0)
        };
        let side = |k: usize| {
            let parts = on_sides(k) + 1;
            (0..parts).map(move |i| corner(k).lerp(corner(k + 1), i as f64 / parts as f64))
        };
        (0..corners).flat_map(side).collect()
    }

    fn area(outline: &[DVec3], [a, b, c]: [usize; 3]) -> f64 {
        0.5 * (outline[b] - outline[a]).cross(outline[c] - outline[a]).z
    }

    #[test]
    fn every_triangle_has_area_and_all_have_the_polygon_s() {
        let divisions: [fn(usize) -> usize; 5] =
            [|_| 0, |k| 3 * usize::from(k == 0), |_| 1, |k| k, |k| 7 - 3 * (k % 3)];
        for corners in 3..9 {
            for (d, on_sides) in divisions.iter().enumerate() {
                let outline = outline(corners, on_sides);
                let made = triangles(&outline);
                assert_eq!(made.len(), outline.len() - 2, "{corners} corners, division {d}");
                let areas: Vec<f64> = made.iter().map(|&t| area(&outline, t)).collect();
                assert!(areas.iter().all(|area| *area > 1e-6), "{corners} corners, division {d}: {areas:?}");
                let whole: f64 = (2..outline.len()).map(|k| area(&outline, [0, k - 1, k])).sum();
                assert!((areas.iter().sum::<f64>() - whole).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_side_with_very_many_corners_is_no_square_work() {
        let outline = outline(3, |k| if k == 1 { 200_000 } else { 0 });
        assert_eq!(triangles(&outline).len(), outline.len() - 2);
    }
}
