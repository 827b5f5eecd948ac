//! A map as the function it stands for: bilinear between texels, continued by its wrap rules.

use std::sync::Arc;

use glam::DVec2;

use crate::domain::detail::{Map, Sampling, Wrap};

/// A bilinear function of texel space, in which texel (i, j) lies at (i, j). Cell (i, j) lies between texels
/// i and i + 1, j and j + 1; texels continue beyond the map by its wrap rules.
#[derive(Clone, Debug)]
pub struct Field {
    map: Arc<Map>,
    /// Lowest and highest texel of each channel.
    ranges: Vec<[f64; 2]>,
}

impl Field {
    #[must_use]
    pub fn new(map: &Arc<Map>) -> Self {
        let texels = |c: usize| map.texels.iter().skip(c).step_by(map.channels as usize).map(|&v| f64::from(v));
        let range = |c| texels(c).fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)]);
        Self { map: Arc::clone(map), ranges: (0..map.channels as usize).map(range).collect() }
    }

    #[must_use]
    pub fn channels(&self) -> u32 {
        self.map.channels
    }

    /// Texels across and down.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        [self.map.width, self.map.height]
    }

    /// Per axis (across, down): scale and offset of x = scale · u + offset.
    #[must_use]
    pub fn texel_from_uv(&self) -> [[f64; 2]; 2] {
        self.size().map(|n| match self.map.sampling {
            Sampling::Center => [f64::from(n), -0.5],
            Sampling::Node => [f64::from(n) - 1.0, 0.0],
        })
    }

    /// Per axis (across, down): after how many texels the map repeats; `None` where it is clamped. A repeating
    /// node-sampled map may show another texel at either end of a period in [0, 1] than in the next ones.
    #[must_use]
    pub fn period(&self) -> [Option<u32>; 2] {
        let [n, last] = [self.size(), self.size().map(|n| (n - 1).max(1))];
        [0, 1].map(|axis| match (self.map.wrap[axis], self.map.sampling) {
            (Wrap::Clamp, _) => None,
            (Wrap::Repeat, Sampling::Center) => Some(n[axis]),
            (Wrap::Repeat, Sampling::Node) => Some(last[axis]),
            (Wrap::Mirror, Sampling::Center) => Some(2 * n[axis]),
            (Wrap::Mirror, Sampling::Node) => Some(2 * last[axis]),
        })
    }

    /// Texel (x, y) of one channel.
    #[inline]
    #[must_use]
    pub fn texel(&self, channel: u32, x: i64, y: i64) -> f64 {
        let x = wrapped(x, self.map.width, self.map.wrap[0], self.map.sampling);
        let y = wrapped(y, self.map.height, self.map.wrap[1], self.map.sampling);
        let index = (y * i64::from(self.map.width) + x) * i64::from(self.map.channels) + i64::from(channel);
        f64::from(self.map.texels[index as usize])
    }

    /// The four texels around cell (x, y): `[at (0, 0), (1, 0), (0, 1), (1, 1)]`.
    #[inline]
    #[must_use]
    pub fn cell(&self, channel: u32, x: i64, y: i64) -> [f64; 4] {
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| self.texel(channel, x.saturating_add(i), y.saturating_add(j)))
    }

    /// Lowest and highest texel of one channel.
    #[must_use]
    pub fn range(&self, channel: u32) -> [f64; 2] {
        self.ranges[channel as usize]
    }

    /// The function over cell (x, y).
    #[must_use]
    pub fn patch(&self, channel: u32, x: i64, y: i64) -> Patch {
        let [a, b, c, d] = self.cell(channel, x, y);
        Patch { at_corner: a, slope: DVec2::new(b - a, c - a), twist: (a - b) + (d - c) }
    }

    /// The value at texel-space (x, y).
    #[inline]
    #[must_use]
    pub fn value(&self, channel: u32, x: f64, y: f64) -> f64 {
        let (i, j) = (x.floor(), y.floor());
        let [a, b, c, d] = self.cell(channel, i as i64, j as i64);
        let (s, t) = (x - i, y - j);
        (a * (1.0 - s) + b * s) * (1.0 - t) + (c * (1.0 - s) + d * s) * t
    }
}

/// The bilinear function of one cell: at_corner + slope · p + twist · p.x · p.y, p from the cell's corner (0, 0).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    pub at_corner: f64,
    pub slope: DVec2,
    pub twist: f64,
}

impl Patch {
    #[inline]
    #[must_use]
    pub fn value(&self, p: DVec2) -> f64 {
        self.at_corner + self.slope.dot(p) + self.twist * p.x * p.y
    }

    #[must_use]
    pub fn gradient(&self, p: DVec2) -> DVec2 {
        self.slope + self.twist * DVec2::new(p.y, p.x)
    }
}

/// Which of n texels lattice point i shows.
pub(super) fn wrapped(i: i64, n: u32, wrap: Wrap, sampling: Sampling) -> i64 {
    let n = i64::from(n);
    let last = n - 1;
    // Repeating nodes: the last texel lies on the first of the next period; both are kept, [0, 1] is read as it is.
    if (0..n).contains(&i) {
        return i;
    }
    match (wrap, sampling) {
        (Wrap::Clamp, _) => i.clamp(0, last),
        (Wrap::Repeat, Sampling::Center) => i.rem_euclid(n),
        (Wrap::Repeat, Sampling::Node) => i.rem_euclid(last.max(1)),
        (Wrap::Mirror, Sampling::Center) => {
            let i = i.rem_euclid(2 * n);
            i.min(2 * n - 1 - i)
        }
        (Wrap::Mirror, Sampling::Node) => {
            let period = (2 * last).max(1);
            let i = i.rem_euclid(period);
            i.min(period - i).min(last)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(n: u32, wrap: Wrap, sampling: Sampling, range: std::ops::Range<i64>) -> Vec<f64> {
        let texels: Vec<f32> = (0..n).map(|i| i as f32).collect();
        let map =
            Map { width: n, height: 1, channels: 1, texels: texels.into(), wrap: [wrap; 2], sampling, source_bits: 32 };
        let field = Field::new(&Arc::new(map));
        range.map(|i| field.texel(0, i, 0)).collect()
    }

    #[test]
    fn maps_continue_by_their_wrap_rules() {
        assert_eq!(row(3, Wrap::Repeat, Sampling::Center, -2..5), [1.0, 2.0, 0.0, 1.0, 2.0, 0.0, 1.0]);
        assert_eq!(row(3, Wrap::Mirror, Sampling::Center, -2..5), [1.0, 0.0, 0.0, 1.0, 2.0, 2.0, 1.0]);
        assert_eq!(row(3, Wrap::Clamp, Sampling::Center, -2..5), [0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 2.0]);
        assert_eq!(row(3, Wrap::Repeat, Sampling::Node, -2..5), [0.0, 1.0, 0.0, 1.0, 2.0, 1.0, 0.0]);
        assert_eq!(row(3, Wrap::Mirror, Sampling::Node, -2..5), [2.0, 1.0, 0.0, 1.0, 2.0, 1.0, 0.0]);
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            assert_eq!(row(1, wrap, Sampling::Node, -2..3), [0.0; 5]);
        }
    }

    #[test]
    fn between_texels_the_field_is_bilinear() {
        let texels = vec![0.0, 1.0, 2.0, 7.0];
        let wrap = [Wrap::Clamp; 2];
        let sampling = Sampling::Center;
        let map = Map { width: 2, height: 2, channels: 1, texels: texels.into(), wrap, sampling, source_bits: 32 };
        let field = Field::new(&Arc::new(map));
        assert_eq!(field.value(0, 0.5, 0.5), 2.5);
        assert_eq!(field.value(0, 0.25, 1.0), 3.25);
        let patch = field.patch(0, 0, 0);
        assert_eq!((patch.value(DVec2::splat(0.5)), patch.gradient(DVec2::X)), (2.5, DVec2::new(1.0, 6.0)));
        assert_eq!(field.texel_from_uv(), [[2.0, -0.5]; 2]);
    }
}
