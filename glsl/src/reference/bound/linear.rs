//! What is linear over texel space, and what lies to one side of a line.

use super::{
    pyramid::Block,
    texels::{MapPlace, Window},
};

/// value + x · slope[0] + y · slope[1], and how far at most from it what it stands for is.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Linear {
    value: f64,
    slope: [f64; 2],
    apart: f64,
}

/// Corners whose triangle is narrower than this share of its sides count as on a line.
const NARROW: f64 = 1e-6;

impl Linear {
    /// Between three corners.
    pub(super) fn through(corners: &[MapPlace; 3]) -> Self {
        let [a, b, c] = corners;
        let (p, q) = ([b.x - a.x, b.y - a.y], [c.x - a.x, c.y - a.y]);
        let (up, uq) = (b.value - a.value, c.value - a.value);
        let cross = p[0] * q[1] - p[1] * q[0];
        let slope = if cross.abs() > NARROW * length(p) * length(q) {
            [(up * q[1] - uq * p[1]) / cross, (uq * p[0] - up * q[0]) / cross]
        } else {
            along_longest(corners)
        };
        let flat = Self { value: a.value - slope[0] * a.x - slope[1] * a.y, slope, apart: 0.0 };
        let apart = corners.iter().fold(0.0, |most: f64, c| most.max((c.value - flat.at(c.x, c.y)).abs()));
        Self { apart, ..flat }
    }

    /// The plane of a block that lies there.
    pub(super) fn of_block(block: &Block, at: &Window) -> Self {
        let slope = block.slope.map(f64::from);
        let value = f64::from(block.value) - slope[0] * at.low[0] - slope[1] * at.low[1];
        Self { value, slope, apart: 0.0 }
    }

    fn at(&self, x: f64, y: f64) -> f64 {
        self.value + self.slope[0] * x + self.slope[1] * y
    }

    pub(super) fn less(&self, other: &Self) -> Self {
        Self {
            value: self.value - other.value,
            slope: [0, 1].map(|k| self.slope[k] - other.slope[k]),
            apart: self.apart + other.apart,
        }
    }

    /// Least and greatest over the window.
    pub(super) fn range(&self, window: &Window) -> [f64; 2] {
        let middle = self.at(0.5 * (window.low[0] + window.high[0]), 0.5 * (window.low[1] + window.high[1]));
        let half = |k: usize| 0.5 * self.slope[k].abs() * (window.high[k] - window.low[k]);
        let around = half(0) + half(1) + self.apart;
        [middle - around, middle + around]
    }
}

/// Of two numbers, the first where the second is NaN: one instruction, where `f64::min` takes several.
pub(super) fn least(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}

/// As [`least`].
pub(super) fn greatest(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

fn length(of: [f64; 2]) -> f64 {
    of[0].hypot(of[1])
}

fn along_longest(corners: &[MapPlace; 3]) -> [f64; 2] {
    let sides = [0, 1, 2].map(|k| (corners[k], corners[(k + 1) % 3]));
    let step = |(a, b): &(MapPlace, MapPlace)| [b.x - a.x, b.y - a.y];
    let longest = sides.into_iter().max_by(|a, b| length(step(a)).total_cmp(&length(step(b))));
    let Some((a, b)) = longest.filter(|side| length(step(side)) > 0.0) else { return [0.0; 2] };
    let d = step(&(a, b));
    d.map(|d_k| (b.value - a.value) * d_k / (d[0] * d[0] + d[1] * d[1]))
}

/// The two half planes that no place of a triangle lies in, along one of its sides.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outside {
    from: [f64; 2],
    d: [f64; 2],
    /// Of the cross products of places inside.
    inside: [f64; 2],
}

/// Of the side's length squared and more: what is as near counts as inside.
const RIM: f64 = 1e-9;

impl Outside {
    pub(super) fn new(corners: &[MapPlace; 3], k: usize) -> Self {
        let [a, b, c] = [0, 1, 2].map(|j| corners[(k + j) % 3]);
        let side = Self { from: [a.x, a.y], d: [b.x - a.x, b.y - a.y], inside: [0.0; 2] };
        let third = side.cross([c.x, c.y]);
        let rim = RIM * (1.0 + side.d[0].abs() + side.d[1].abs()) * (1.0 + third.abs().sqrt());
        Self { inside: [third.min(0.0) - rim, third.max(0.0) + rim], ..side }
    }

    fn cross(&self, p: [f64; 2]) -> f64 {
        self.d[0] * (p[1] - self.from[1]) - self.d[1] * (p[0] - self.from[0])
    }

    /// Whether all of the window lies there.
    pub(super) fn holds(&self, window: &Window) -> bool {
        let middle = self.cross([0, 1].map(|k| 0.5 * (window.low[k] + window.high[k])));
        let half = |k: usize| 0.5 * self.d[1 - k].abs() * (window.high[k] - window.low[k]);
        let around = half(0) + half(1);
        middle + around < self.inside[0] || middle - around > self.inside[1]
    }
}
