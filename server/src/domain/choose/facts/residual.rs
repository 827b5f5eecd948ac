//! How far a map is from affine (`methods.md` D.2): for blocks of growing size that overlap by half, a plane and the range
//! of what is left; and second differences.
//!
//! Theorem: where h = a + e, a affine and e in [r-, r+], anything linear between places of h is within r+ - r- of h, since
//! interpolation reproduces a and averages e. A bilinear map has its extremes of e at texels.

use glam::{DVec2, IVec2};
use rayon::prelude::*;

use super::{Framed, HeightFacts, Window, over};
use crate::domain::choose::greatest::Greatest;

#[derive(Clone, Debug)]
pub(super) struct Residuals {
    /// Of blocks 2^(k + 1) cells wide, each 2^k from the one before: r+ - r-.
    levels: Vec<([usize; 2], Greatest)>,
    /// Of texels: how much the slope changes there along u, and along v; of cells: their twist.
    seconds: [Greatest; 3],
}

/// A plane around the middle of a block, and what is left of the heights.
#[derive(Clone, Copy, Debug)]
struct Block {
    middle: f64,
    slope: DVec2,
    rest: [f64; 2],
    range: [f64; 2],
}

impl Residuals {
    pub(super) fn new(map: &Framed, repeats: [bool; 2]) -> Self {
        let size = map.size;
        let mut blocks = every(size, |at| Block::over(map, at));
        let mut of_blocks = size;
        let mut levels = vec![(size, grid(size, &blocks))];
        while of_blocks.iter().any(|n| *n > 2) {
            let level = levels.len() - 1;
            let repeats = [0, 1].map(|k| repeats[k] && is_whole(size[k], level));
            let below = Row { size: of_blocks, blocks: &blocks, repeats };
            let half = 2f64.powi(level as i32);
            let next = of_blocks.map(|n| n.div_ceil(2));
            let above = every(next, |at| Block::around(&below, at, half));
            (of_blocks, blocks) = (next, above);
            levels.push((next, grid(next, &blocks)));
        }
        Self { levels, seconds: [0, 1, 2].map(|kind| Greatest::of(size, |at| second(map, at, kind))) }
    }

    /// See [`HeightFacts::residual`].
    pub(super) fn over(&self, facts: &HeightFacts, window: &Window, size: DVec2) -> f64 {
        self.of_blocks(facts, window, size.max_element()).min(self.of_seconds(facts, window, size))
    }

    /// About how far the heights around a place are from the plane that fits them best, over a square of this side.
    pub(super) fn about(&self, facts: &HeightFacts, place: DVec2, side: f64) -> f64 {
        // Of blocks twice as wide as they are apart.
        let level = ((0.5 * side).max(1.0).log2().round() as usize).min(self.levels.len() - 1);
        let (size, grid) = &self.levels[level];
        let width = 2f64.powi(level as i32);
        let on_map = |k: usize| if facts.repeats[k] { place[k].rem_euclid(facts.size()[k]) } else { place[k] };
        let at = (DVec2::new(on_map(0), on_map(1)) / width - 0.5).floor().as_ivec2();
        let shrink = (side / (2.0 * width)).min(1.0);
        0.5 * over(grid, *size, facts.repeats, at, at) * shrink * shrink
    }

    fn of_blocks(&self, facts: &HeightFacts, window: &Window, side: f64) -> f64 {
        let level = side.max(1.0).log2().ceil() as usize;
        let Some((size, grid)) = self.levels.get(level) else { return f64::INFINITY };
        let Some(window) = inside_of_blocks(facts, window, level) else { return f64::INFINITY };
        let width = 2f64.powi(level as i32);
        let [first, last] = [window.low, (window.high - side).max(window.low)].map(|p| (p / width).floor().as_ivec2());
        over(grid, *size, facts.repeats, first, last)
    }

    /// Of the difference to what is linear, h(x) - sum l_i h(x_i) with x = sum l_i x_i, a change of slope along u at a line
    /// makes up at most a quarter of the size along u, all lines together an eighth of its square and that of one more; a
    /// twist t at most t times the mean of |dx dy|, a quarter of the box.
    pub(super) fn of_seconds(&self, facts: &HeightFacts, window: &Window, size: DVec2) -> f64 {
        let lines = |s: f64| (s.ceil() * s / 4.0).min(s * s / 8.0 + s / 4.0);
        let shares = [lines(size.x), lines(size.y), size.x * size.y / 4.0];
        let (low, high) = (window.low.floor().as_ivec2(), window.high.ceil().as_ivec2());
        // Lines on which slopes change lie inside; cells begin inside or before.
        let (first, last) = (low + 1, high - 1);
        let windows = [
            [IVec2::new(first.x, low.y), IVec2::new(last.x, high.y)],
            [IVec2::new(low.x, first.y), IVec2::new(high.x, last.y)],
            [low, last.max(low)],
        ];
        let most = |grid: &Greatest, [first, last]: [IVec2; 2]| {
            if first.cmpgt(last).any() { 0.0 } else { over(grid, facts.size, facts.repeats, first, last) }
        };
        let of = |k: usize| if shares[k] > 0.0 { most(&self.seconds[k], windows[k]) * shares[k] } else { 0.0 };
        (0..3).map(of).sum()
    }
}

/// Whether blocks of a level end with the map.
fn is_whole(texels: usize, level: usize) -> bool {
    texels.is_multiple_of(1 << level)
}

/// Blocks of what is clamped end with it, and so they do where no whole number of them repeats.
fn inside_of_blocks(facts: &HeightFacts, window: &Window, level: usize) -> Option<Window> {
    let mut window = *window;
    for k in (0..2).filter(|k| !facts.repeats[*k] || !is_whole(facts.size[*k], level)) {
        let size = facts.size()[k];
        let turns = if facts.repeats[k] { (window.low[k] / size).floor() * size } else { 0.0 };
        (window.low[k], window.high[k]) = (window.low[k] - turns, window.high[k] - turns);
        if window.low[k] < 0.0 || window.high[k] > size - 1.0 {
            return None;
        }
    }
    Some(window)
}

/// Row by row.
fn every<T: Send>(size: [usize; 2], of: impl Fn(IVec2) -> T + Sync) -> Vec<T> {
    let at = |k: usize| IVec2::new((k % size[0]) as i32, (k / size[0]) as i32);
    (0..size[0] * size[1]).into_par_iter().map(|k| of(at(k))).collect()
}

fn grid(size: [usize; 2], blocks: &[Block]) -> Greatest {
    let residual = |b: &Block| (b.rest[1] - b.rest[0]).min(b.range[1] - b.range[0]);
    Greatest::of(size, |at| residual(&blocks[at.y as usize * size[0] + at.x as usize]))
}

/// |h(x - 1, y) - 2 h(x, y) + h(x + 1, y)|, the same along v, and |h(x, y) - h(x + 1, y) - h(x, y + 1) + h(x + 1, y + 1)|.
fn second(map: &Framed, at: IVec2, kind: usize) -> f64 {
    let texel = |x: i32, y: i32| map.texel(at + IVec2::new(x, y));
    match kind {
        0 => (texel(-1, 0) - 2.0 * texel(0, 0) + texel(1, 0)).abs(),
        1 => (texel(0, -1) - 2.0 * texel(0, 0) + texel(0, 1)).abs(),
        _ => (texel(0, 0) - texel(1, 0) - texel(0, 1) + texel(1, 1)).abs(),
    }
}

/// Blocks of one size.
struct Row<'b> {
    size: [usize; 2],
    blocks: &'b [Block],
    repeats: [bool; 2],
}

impl Row<'_> {
    fn at(&self, at: IVec2) -> Block {
        let k = |axis: usize| {
            let n = self.size[axis] as i32;
            if self.repeats[axis] { at[axis].rem_euclid(n) } else { at[axis].min(n - 1) }
        };
        self.blocks[k(1) as usize * self.size[0] + k(0) as usize]
    }
}

/// The least and the greatest.
fn ends(values: &[f64]) -> [f64; 2] {
    values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(*x), high.max(*x)])
}

const CORNERS: [DVec2; 4] =
    [DVec2::new(-1.0, -1.0), DVec2::new(1.0, -1.0), DVec2::new(-1.0, 1.0), DVec2::new(1.0, 1.0)];

impl Block {
    /// The least squares plane of the 3 x 3 texels from `first` on.
    fn over(map: &Framed, first: IVec2) -> Self {
        let nine @ [a, b, c, d, e, f, g, h, i] = map.nine(first);
        let middle = (a + b + c + d + e + f + g + h + i) / 9.0;
        let slope = DVec2::new(c + f + i - a - d - g, g + h + i - a - b - c) / 6.0;
        let plane = [-1.0, 0.0, 1.0].map(|y| [-1.0, 0.0, 1.0].map(|x| middle + slope.x * x + slope.y * y));
        let rest: [f64; 9] = std::array::from_fn(|k| nine[k] - plane[k / 3][k % 3]);
        Self { middle, slope, rest: ends(&rest), range: ends(&nine) }
    }

    /// Of four blocks `2 half` wide that lie side by side, with the plane of their middles.
    fn around(below: &Row<'_>, at: IVec2, half: f64) -> Self {
        let parts = CORNERS.map(|c| (c * half, below.at(2 * at + (c + 1.0).as_ivec2())));
        let middle = parts.iter().map(|(_, b)| b.middle).sum::<f64>() / 4.0;
        let slope = parts.iter().map(|(c, b)| *c * b.middle).sum::<DVec2>() / (4.0 * half * half);
        let plane = |at: DVec2| middle + slope.dot(at);
        let mut block = Self { middle, slope, rest: [f64::INFINITY, f64::NEG_INFINITY], range: parts[0].1.range };
        for (centre, part) in &parts {
            let apart = CORNERS.map(|c| part.middle + part.slope.dot(c * half) - plane(*centre + c * half));
            let [low, high] = ends(&apart);
            block.rest = [block.rest[0].min(low + part.rest[0]), block.rest[1].max(high + part.rest[1])];
            block.range = [block.range[0].min(part.range[0]), block.range[1].max(part.range[1])];
        }
        block
    }
}
