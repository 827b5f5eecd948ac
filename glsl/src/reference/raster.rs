//! Twin of `setup` and of the `raster_*` passes: coverage in integers wide enough for anything, depth in f64.

use super::transform::Snapped;

/// Where the samples of a pixel lie, fixed point: the standard rotated grid.
pub const SAMPLES: [[i64; 2]; 4] = [[96, 32], [224, 96], [32, 160], [160, 224]];

/// A triangle on the screen that runs clockwise (y down).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScreenTriangle {
    pub corner: [Snapped; 3],
    /// It ran counter-clockwise before.
    pub turned: bool,
}

impl ScreenTriangle {
    /// `None` without area.
    #[must_use]
    pub fn new(a: Snapped, b: Snapped, c: Snapped) -> Option<Self> {
        let area = edge(a, b, [c.x, c.y]);
        match area.signum() {
            1 => Some(Self { corner: [a, b, c], turned: false }),
            -1 => Some(Self { corner: [a, c, b], turned: true }),
            _ => None,
        }
    }

    /// Whether the triangle owns the point: inside, or on a top or left edge.
    #[must_use]
    pub fn covers(&self, p: [i64; 2]) -> bool {
        (0..3).all(|k| {
            let (from, to) = (self.corner[(k + 1) % 3], self.corner[(k + 2) % 3]);
            edge(from, to, p) + bias(from, to) >= 0
        })
    }

    /// Reversed depth by the plane through the corners, kept within theirs.
    #[must_use]
    pub fn depth_at(&self, p: [i64; 2]) -> f64 {
        let [a, b, c] = self.corner;
        let area = edge(a, b, [c.x, c.y]) as f64;
        let (weight_b, weight_c) = (edge(c, a, p) as f64 / area, edge(a, b, p) as f64 / area);
        let depth = a.depth + weight_b * (b.depth - a.depth) + weight_c * (c.depth - a.depth);
        depth.clamp(a.depth.min(b.depth).min(c.depth), a.depth.max(b.depth).max(c.depth))
    }

    /// Low and high corner of the box, fixed point.
    #[must_use]
    pub fn bounds(&self) -> [[i64; 2]; 2] {
        let [a, b, c] = self.corner;
        [[a.x.min(b.x).min(c.x), a.y.min(b.y).min(c.y)], [a.x.max(b.x).max(c.x), a.y.max(b.y).max(c.y)]]
    }
}

fn edge(from: Snapped, to: Snapped, p: [i64; 2]) -> i128 {
    i128::from(to.x - from.x) * i128::from(p[1] - from.y) - i128::from(to.y - from.y) * i128::from(p[0] - from.x)
}

fn bias(from: Snapped, to: Snapped) -> i128 {
    let (dx, dy) = (to.x - from.x, to.y - from.y);
    if dy < 0 || (dy == 0 && dx > 0) { 0 } else { -1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: i64, y: i64) -> Snapped {
        Snapped { x, y, depth: 0.5 }
    }

    #[test]
    fn the_two_halves_of_a_square_share_no_point_and_miss_none() {
        let upper = ScreenTriangle::new(at(0, 0), at(8, 0), at(8, 8)).unwrap();
        let lower = ScreenTriangle::new(at(0, 0), at(8, 8), at(0, 8)).unwrap();
        for y in -1..=8 {
            for x in -1..=8 {
                let inside = (0..8).contains(&x) && (0..8).contains(&y);
                let owners = u32::from(upper.covers([x, y])) + u32::from(lower.covers([x, y]));
                assert_eq!(owners, u32::from(inside), "({x}, {y})");
            }
        }
    }
}
