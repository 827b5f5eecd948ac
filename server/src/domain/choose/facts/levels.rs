//! What the coarser levels of a map leave out of it.

use displace_glsl::reference::relief::HeightLevel;
use glam::{DVec2, IVec2};

use super::{Window, above, over};
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
            let at = |k: usize| IVec2::new((k % cells[0]) as i32, (k / cells[0]) as i32);
            let errors = (0..cells[0] * cells[1]).map(|k| above(in_cell(&pair[0], &pair[1], at(k)))).collect();
            (size(&pair[1]), cells, Greatest::new(cells, errors))
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

/// The greatest difference over a cell of the coarser level: both are bilinear between lattice lines of either, so at their
/// crossings.
fn in_cell(fine: &HeightLevel, coarse: &HeightLevel, cell: IVec2) -> f64 {
    let lines = [0, 1].map(|k| lines(fine, coarse, cell[k], k));
    let ratio = ratio(fine, coarse);
    let apart = |x: f64, y: f64| {
        let at = DVec2::new(x, y);
        (coarse.height(at) - fine.height((at + 0.5) * ratio - 0.5)).abs()
    };
    lines[1].iter().flat_map(|y| lines[0].iter().map(|x| apart(*x, *y))).fold(0.0, f64::max)
}

/// Of both levels across a cell, in coarse texels; before the first texel of what is clamped too.
fn lines(fine: &HeightLevel, coarse: &HeightLevel, cell: i32, axis: usize) -> Vec<f64> {
    let ratio = ratio(fine, coarse)[axis];
    let is_first = cell == 0 && !coarse.repeats[axis];
    let (low, high) = (f64::from(cell) - if is_first { 1.0 } else { 0.0 }, f64::from(cell) + 1.0);
    let fine_of = |x: f64| (x + 0.5) * ratio - 0.5;
    let (first, last) = (fine_of(low).ceil() as i64, fine_of(high).floor() as i64);
    let between = (first..=last).map(|i| (i as f64 + 0.5) / ratio - 0.5);
    [low, f64::from(cell), high].into_iter().chain(between).collect()
}

fn ratio(fine: &HeightLevel, coarse: &HeightLevel) -> DVec2 {
    DVec2::from_array([0, 1].map(|k| f64::from(fine.size[k]) / f64::from(coarse.size[k])))
}
