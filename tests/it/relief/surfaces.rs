//! Surfaces that tell methods apart, and rays over them. Heights are in texels.

use displace_glsl::reference::relief::{Course, HeightLevel, March, ReliefMap, exact};
use displace_tests::march;
use glam::DVec2;
use rand::{RngExt as _, SeedableRng, rngs::StdRng};

/// Heights of 64 x 64 texels, in texels.
pub(super) fn tiling(height: impl Fn(u32, u32) -> f64) -> ReliefMap {
    let texels = (0..64 * 64).map(|i| height(i % 64, i / 64) as f32).collect();
    let level = HeightLevel { size: [64, 64], heights: texels, repeats: [true; 2] };
    ReliefMap { bounds: exact::bounds(&level), ..march::map(level) }
}

/// 0 or 4, bricks of 13 by 29 texels with joints of 3.
pub(super) fn bricks() -> ReliefMap {
    tiling(|x, y| {
        let across = (x + y / 16 % 2 * 16) % 32;
        if across < 3 || y % 16 < 3 { 0.0 } else { 4.0 }
    })
}

/// 4 high, a texel wide, 16 apart.
pub(super) fn posts() -> ReliefMap {
    tiling(|x, y| if x % 16 == 5 && y % 16 == 9 { 4.0 } else { 0.0 })
}

/// From 0 to 4, smooth.
pub(super) fn hills() -> ReliefMap {
    let wave = |x: u32| (f64::from(x) * std::f64::consts::TAU / 32.0).sin();
    tiling(|x, y| 2.0 + wave(x) + wave(y))
}

/// Sums of noise, twice as fine and half as high each.
pub(super) fn fractal() -> ReliefMap {
    let mut random = Random::new(1);
    let mut grid = |k: u32| -> HeightLevel {
        let heights = (0..k * k).map(|_| random.within(0.0, 64.0 / f64::from(k) / 4.0) as f32).collect();
        HeightLevel { size: [k, k], heights, repeats: [true; 2] }
    };
    let octaves = [8, 16, 32, 64].map(&mut grid);
    tiling(|x, y| {
        let at = |level: &HeightLevel| level.height(DVec2::new(x.into(), y.into()) * f64::from(level.size[0]) / 64.0);
        octaves.iter().map(at).sum()
    })
}

/// Numbers that look random, the same in every run.
pub(super) struct Random(StdRng);

impl Random {
    pub(super) fn new(seed: u64) -> Self {
        Self(StdRng::seed_from_u64(seed))
    }

    pub(super) fn within(&mut self, low: f64, high: f64) -> f64 {
        self.0.random_range(low..high)
    }

    pub(super) fn way(&mut self) -> DVec2 {
        DVec2::from_angle(self.within(0.0, std::f64::consts::TAU))
    }

    /// Down through heights at an angle, over the tile from a place in it; rounded to f32.
    pub(super) fn course(&mut self, degrees: f64, [high, low]: [f64; 2]) -> Course {
        let from = DVec2::new(self.within(0.0, 64.0), self.within(0.0, 64.0));
        let to = from + self.way() * degrees.to_radians().tan() * (high - low);
        march::straight([from.x, from.y, high], [to.x, to.y, low])
    }
}

/// Least and greatest height.
pub(super) fn range(map: &ReliefMap) -> [f64; 2] {
    let heights = map.level.heights.iter();
    heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], h| [low.min((*h).into()), high.max((*h).into())])
}

/// What a ray meets first.
pub(super) fn met(map: &ReliefMap, course: &Course) -> March {
    let met = exact::marched(map, course, 0.0);
    assert!(met.is_hit(), "a course ends below");
    met
}
