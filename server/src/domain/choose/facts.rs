//! What is known of a height map, over any box of it: heights, slopes, how far it is from affine, and what its coarser
//! levels leave out.

mod framed;
mod levels;
mod residual;

use displace_glsl::reference::relief::HeightLevel;
use glam::{DVec2, IVec2};

use super::greatest::{Greatest, runs};
use crate::domain::image::HeightMap;
use framed::Framed;
use levels::LevelErrors;
use residual::Residuals;

/// A box of the map, texels: texel (i, j) is at x = i, y = j of an endless map.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Window {
    pub low: DVec2,
    pub high: DVec2,
}

/// All heights are mesh-local units, all slopes heights for each texel. Made once for a map; about 50 bytes a texel.
#[derive(Clone, Debug)]
pub struct HeightFacts {
    size: [usize; 2],
    repeats: [bool; 2],
    /// Least and greatest height of all.
    pub range: [f64; 2],
    /// Width of the thinnest feature, texels; see [`HeightMap::thinnest_texels`].
    pub thinnest_texels: f64,
    /// Of texels; the least are kept with the other sign.
    greatest: Greatest,
    least: Greatest,
    /// |h(x + 1, y) - h(x, y)| and |h(x, y + 1) - h(x, y)| at texel (x, y).
    slopes: [Greatest; 2],
    residuals: Residuals,
    level_errors: LevelErrors,
    /// Means, the finest first.
    levels: Vec<HeightLevel>,
}

impl Window {
    #[must_use]
    pub fn around(points: impl IntoIterator<Item = DVec2>) -> Self {
        let nothing = Self { low: DVec2::INFINITY, high: DVec2::NEG_INFINITY };
        points.into_iter().fold(nothing, |w, p| Self { low: w.low.min(p), high: w.high.max(p) })
    }

    #[must_use]
    pub fn grown(&self, by: DVec2) -> Self {
        Self { low: self.low - by, high: self.high + by }
    }

    /// Around it and itself shifted by anything from `low` to `high`.
    #[must_use]
    pub fn swept(&self, low: DVec2, high: DVec2) -> Self {
        Self { low: self.low + low.min(DVec2::ZERO), high: self.high + high.max(DVec2::ZERO) }
    }

    #[must_use]
    pub fn size(&self) -> DVec2 {
        self.high - self.low
    }

    /// What of it is in another that it meets.
    #[must_use]
    pub fn within(&self, other: &Self) -> Self {
        Self { low: self.low.max(other.low), high: self.high.min(other.high) }
    }

    /// First and last texel that what lies inside is interpolated from.
    fn texels(&self) -> [IVec2; 2] {
        [self.low.floor().as_ivec2(), self.high.ceil().as_ivec2()]
    }
}

impl HeightFacts {
    #[must_use]
    pub fn new(map: &HeightMap) -> Self {
        let finest = HeightLevel { size: [map.width, map.height], heights: map.heights.clone(), repeats: map.repeats };
        let size = finest.size.map(|n| n as usize);
        let framed = Framed::new(&finest);
        let steps = |way: IVec2| Greatest::of(size, |at| (framed.texel(at + way) - framed.texel(at)).abs());
        let levels = finest.chain();
        Self {
            size,
            repeats: map.repeats,
            range: map.range().map(f64::from),
            thinnest_texels: f64::from(map.thinnest_texels),
            greatest: Greatest::new(size, map.heights.clone()),
            least: Greatest::new(size, map.heights.iter().map(|h| -h).collect()),
            slopes: [steps(IVec2::X), steps(IVec2::Y)],
            residuals: Residuals::new(&framed, map.repeats),
            level_errors: LevelErrors::new(&levels),
            levels,
        }
    }

    /// Texels along u and v.
    #[must_use]
    pub fn size(&self) -> DVec2 {
        DVec2::new(self.size[0] as f64, self.size[1] as f64)
    }

    /// Levels that a march may choose from.
    #[must_use]
    pub fn level_count(&self) -> usize {
        self.levels.len()
    }

    /// Least and greatest height inside: of up to 32 texels exact where its sides are lattice lines.
    #[must_use]
    pub fn heights(&self, window: &Window) -> [f64; 2] {
        let [first, last] = window.texels();
        [-self.over(&self.least, first, last), self.over(&self.greatest, first, last)]
    }

    /// Greatest slopes inside, along u and along v.
    #[must_use]
    pub fn slopes(&self, window: &Window) -> DVec2 {
        let [first, last] = window.texels();
        let across = |way: IVec2| (last - way).max(first);
        DVec2::new(
            self.over(&self.slopes[0], first, across(IVec2::X)),
            self.over(&self.slopes[1], first, across(IVec2::Y)),
        )
    }

    /// How much heights change at most over a way inside that is so long along either axis.
    #[must_use]
    pub fn change(&self, window: &Window, way: DVec2) -> f64 {
        let [low, high] = self.heights(window);
        self.slopes(window).dot(way.abs()).min(high - low)
    }

    /// How far the heights are at most from what is linear between the corners of any triangle, or the ends of any line,
    /// that lies inside and fits a box of this size.
    #[must_use]
    pub fn residual(&self, window: &Window, size: DVec2) -> f64 {
        let [low, high] = self.heights(window);
        // Weights that sum to a place are off it by half the size at most, on average.
        let by_slopes = 0.5 * self.slopes(window).dot(size);
        self.residuals.over(self, window, size).min(high - low).min(by_slopes)
    }

    /// How far the heights are at most from a plane, `value` at `from` with this slope, over a box: by the corners of its cells.
    #[must_use]
    pub fn apart(&self, window: &Window, (from, value): (DVec2, f64), slope: DVec2) -> f64 {
        let [first, last] = window.texels();
        let places = (first.y..=last.y).flat_map(|y| (first.x..=last.x).map(move |x| IVec2::new(x, y)));
        let apart = |at: IVec2| (self.levels[0].texel(at) - value - slope.dot(at.as_dvec2() - from)).abs();
        places.map(apart).fold(0.0, f64::max)
    }

    /// The second differences' part of [`Self::residual`].
    #[must_use]
    pub fn bent(&self, window: &Window, size: DVec2) -> f64 {
        self.residuals.of_seconds(self, window, size)
    }

    /// About how far they are from the best that is linear, over a square around a place.
    #[must_use]
    pub fn about(&self, place: DVec2, side: f64) -> f64 {
        self.residuals.about(self, place, side)
    }

    /// Bilinear at full resolution.
    #[must_use]
    pub fn height(&self, place: DVec2) -> f64 {
        self.levels[0].height(place)
    }

    /// How far the heights of a level, or of any finer one, are at most from those of the finest inside.
    #[must_use]
    pub fn level_error(&self, window: &Window, level: usize) -> f64 {
        if level == 0 {
            return 0.0;
        }
        let [low, high] = self.heights(&self.read_by(window, level));
        self.level_errors.over(window, level).min(high - low)
    }

    /// What a level's heights inside are means of.
    #[must_use]
    pub fn read_by(&self, window: &Window, level: usize) -> Window {
        if level == 0 {
            return *window;
        }
        // Beyond the border of what is clamped the last texels of a level go on, which are means of what lies inside.
        let mut reached = *window;
        for axis in (0..2).filter(|axis| !self.repeats[*axis]) {
            reached.low[axis] = reached.low[axis].min(self.size[axis] as f64 - 1.0);
            reached.high[axis] = reached.high[axis].max(0.0);
        }
        reached.grown(DVec2::splat(1.5 * 2f64.powi(level as i32)))
    }

    /// About the mean height inside.
    #[must_use]
    pub fn mean(&self, window: &Window) -> f64 {
        let texels = window.size().max_element().max(1.0);
        let level = (texels.log2().round() as usize).min(self.levels.len() - 1);
        let level = &self.levels[level];
        let scale = DVec2::new(f64::from(level.size[0]), f64::from(level.size[1])) / self.size();
        level.height((0.5 * (window.low + window.high) + 0.5) * scale - 0.5)
    }

    fn over(&self, grid: &Greatest, first: IVec2, last: IVec2) -> f64 {
        over(grid, self.size, self.repeats, first, last)
    }
}

/// The greatest of an endless grid between two places, both included.
fn over(grid: &Greatest, size: [usize; 2], repeats: [bool; 2], first: IVec2, last: IVec2) -> f64 {
    let [x, y] = [0, 1].map(|k| runs(first[k].into(), last[k].into(), size[k], repeats[k]));
    let boxes = y.clone().flat_map(|y| x.clone().map(move |x| grid.over(x, y)));
    boxes.fold(f64::NEG_INFINITY, f64::max)
}

#[cfg(test)]
mod tests;
