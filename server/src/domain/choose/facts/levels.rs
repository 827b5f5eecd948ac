//! What the coarser levels of a map leave out of it.

use displace_glsl::reference::relief::HeightLevel;
use glam::{DVec2, IVec2};

use super::{Window, over};
use crate::domain::choose::greatest::Greatest;

/// Of each level but the finest, by its cells: how far it is from the one before.
#[derive(Clone, Debug)]
pub(super) struct LevelErrors {
    finest: DVec2,
    repeats: [bool; 2],
    levels: Vec<(DVec2, [usize; 2], Greatest)>,
}

impl LevelErrors {
    pub(super) fn new(levels: &[HeightLevel]) -> Self {
        let size = |level: &HeightLevel| DVec2::new(f64::from(level.size[0]), f64::from(level.size[1]));
        let error = |pair: &[HeightLevel]| {
            let cells = pair[1].size.map(|n| n as usize);
            let [x, y] = [0, 1].map(|axis| lines(&pair[0], &pair[1], axis));
            let in_row = |row: usize| row_of_cells(&pair[0], &pair[1], &x, &y[row]);
            (size(&pair[1]), cells, Greatest::of_rows(cells, in_row))
        };
        Self { finest: size(&levels[0]), repeats: levels[0].repeats, levels: levels.windows(2).map(error).collect() }
    }

    /// Sums of what levels up to this one leave out of those before.
    pub(super) fn over(&self, window: &Window, level: usize) -> f64 {
        let of = |(size, cells, grid): &(DVec2, [usize; 2], Greatest)| {
            let [low, high] = [window.low, window.high].map(|p| (p + 0.5) * (*size / self.finest) - 0.5);
            let [first, last] = [low, high].map(|p| p.floor().as_ivec2());
            // Before the first texel of what is clamped a cell of its own begins, which is kept with the first.
            over(grid, *cells, self.repeats, first, last)
        };
        self.levels.iter().take(level).map(of).sum()
    }
}

/// A line across a cell of the coarser level: between which texels of the finer and of the coarser one it lies, along one axis.
struct Line([Between; 2]);

/// Two texels, and the share of the second.
struct Between([usize; 2], f64);

/// Of both levels across each cell of the coarser; before the first texel of what is clamped too.
fn lines(fine: &HeightLevel, coarse: &HeightLevel, axis: usize) -> Vec<Vec<Line>> {
    let ratio = f64::from(fine.size[axis]) / f64::from(coarse.size[axis]);
    let fine_of = |x: f64| (x + 0.5) * ratio - 0.5;
    let of_cell = |cell: u32| {
        let is_first = cell == 0 && !coarse.repeats[axis];
        let (low, high) = (f64::from(cell) - if is_first { 1.0 } else { 0.0 }, f64::from(cell) + 1.0);
        let (first, last) = (fine_of(low).ceil() as i64, fine_of(high).floor() as i64);
        let between = (first..=last).map(|i| (i as f64 + 0.5) / ratio - 0.5);
        let mut all: Vec<f64> = [low, f64::from(cell), high].into_iter().chain(between).collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        all.iter().map(|x| Line([between_texels(fine, axis, fine_of(*x)), between_texels(coarse, axis, *x)])).collect()
    };
    (0..coarse.size[axis]).map(of_cell).collect()
}

fn between_texels(level: &HeightLevel, axis: usize, place: f64) -> Between {
    let below = place.floor();
    let at = |i: i32| {
        let mut at = IVec2::ZERO;
        at[axis] = i;
        level.index(at) / if axis == 0 { 1 } else { level.size[0] as usize }
    };
    Between([at(below as i32), at(below as i32 + 1)], place - below)
}

/// The greatest difference over each cell of a row: both levels are bilinear between lattice lines of either, so at their
/// crossings.
fn row_of_cells(fine: &HeightLevel, coarse: &HeightLevel, x: &[Vec<Line>], y: &[Line]) -> Vec<f64> {
    let mut greatest = vec![0f64; x.len()];
    for Line([yf, yc]) in y {
        let (fine, coarse) = (along(fine, yf), along(coarse, yc));
        for (greatest, lines) in greatest.iter_mut().zip(x) {
            let apart = |Line([xf, xc]): &Line| (xf.of(&fine) - xc.of(&coarse)).abs();
            *greatest = lines.iter().map(apart).fold(*greatest, f64::max);
        }
    }
    greatest
}

/// The heights of a level along a line.
fn along(level: &HeightLevel, y: &Between) -> Vec<f64> {
    let width = level.size[0] as usize;
    let [first, second] = y.0.map(|row| &level.heights[row * width..][..width]);
    first.iter().zip(second).map(|(a, b)| f64::from(*a) + (f64::from(*b) - f64::from(*a)) * y.1).collect()
}

impl Between {
    fn of(&self, row: &[f64]) -> f64 {
        let [a, b] = self.0.map(|i| row[i]);
        a + (b - a) * self.1
    }
}
