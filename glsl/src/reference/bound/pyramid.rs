//! What parts of a map are at most from planes that lie near them, over ever larger blocks: a triangle that is near a
//! block's plane need not look at its texels, however steep both are.

use rayon::prelude::*;

use super::{
    lattice::{Lattice, is_clamped},
    linear::{greatest, least},
};
pub(super) use crate::layout::bound::MapBlock as Block;

/// Cells along the side of a block of level 0.
pub(super) const BLOCK: i64 = 8;

/// Blocks that are `BLOCK << level` cells wide.
#[derive(Clone, Debug)]
struct Level {
    /// Blocks across and down.
    size: [i64; 2],
    blocks: Vec<Block>,
}

/// All blocks of a map's period.
#[derive(Clone, Debug)]
pub struct Pyramid {
    /// Cells of the period, across and down.
    pub(super) cells: [i64; 2],
    levels: Vec<Level>,
}

impl Pyramid {
    #[must_use]
    pub fn new(lattice: &Lattice<'_>) -> Self {
        let cells = lattice.axes().map(|axis| i64::from(if is_clamped(axis) { axis.top } else { axis.period }).max(1));
        let mut levels = vec![Level::finest(lattice, cells)];
        while let Some(last) = levels.last().filter(|level| level.blocks.len() > 1) {
            let next = last.coarser(cells, levels.len() - 1);
            levels.push(next);
        }
        Self { cells, levels }
    }

    /// Least and greatest value of the map.
    pub(super) fn range(&self) -> [f64; 2] {
        self.block(self.top(), [0, 0]).range.map(f64::from)
    }

    /// Of the map's period, across and down.
    #[must_use]
    pub fn cells(&self) -> [i64; 2] {
        self.cells
    }

    /// How many blocks each level has, across and down, the finest level first; the last has one.
    pub fn sizes(&self) -> impl Iterator<Item = [i64; 2]> {
        self.levels.iter().map(|level| level.size)
    }

    /// Level by level, the finest first, row by row.
    pub fn blocks(&self) -> impl Iterator<Item = &Block> {
        self.levels.iter().flat_map(|level| &level.blocks)
    }

    pub(super) fn top(&self) -> usize {
        self.levels.len() - 1
    }

    /// Blocks of a level, across and down.
    pub(super) fn size(&self, level: usize) -> [i64; 2] {
        self.levels[level].size
    }

    pub(super) fn block(&self, level: usize, [x, y]: [i64; 2]) -> &Block {
        let level = &self.levels[level];
        &level.blocks[(y * level.size[0] + x) as usize]
    }
}

const NOTHING: [f32; 2] = [f32::INFINITY, f32::NEG_INFINITY];

/// Cells [first, end) of block k.
fn cells_of(k: i64, width: i64, cells: i64) -> [i64; 2] {
    [k * width, ((k + 1) * width).min(cells)]
}

impl Level {
    fn finest(lattice: &Lattice<'_>, cells: [i64; 2]) -> Self {
        let size = cells.map(|cells| (cells + BLOCK - 1) / BLOCK);
        let block = |k: i64| {
            let at = [k % size[0], k / size[0]];
            let [x, y] = [0, 1].map(|axis| cells_of(at[axis], BLOCK, cells[axis]));
            Block::over(lattice, cells, x, y)
        };
        Self { size, blocks: (0..size[0] * size[1]).into_par_iter().map(block).collect() }
    }

    /// Of blocks twice as wide as those of this level.
    fn coarser(&self, cells: [i64; 2], level: usize) -> Self {
        let size = self.size.map(|size| (size + 1) / 2);
        let width = BLOCK << level;
        let block = |k: i64| {
            let first = [k % size[0], k / size[0]].map(|k| 2 * k);
            let end = [0, 1].map(|axis| (first[axis] + 2).min(self.size[axis]));
            let children = (first[1]..end[1]).flat_map(|y| (first[0]..end[0]).map(move |x| [x, y]));
            let parts = children.map(|[x, y]| {
                let child = self.blocks[(y * self.size[0] + x) as usize];
                let window = [0, 1].map(|axis| cells_of([x, y][axis], width, cells[axis]));
                (child, window)
            });
            Block::around(&parts.collect::<Vec<_>>())
        };
        Self { size, blocks: (0..size[0] * size[1]).into_par_iter().map(block).collect() }
    }
}

fn merged(a: [f32; 2], b: [f32; 2]) -> [f32; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

impl Block {
    /// With the plane through the middle of what its corners span.
    fn with_plane(corners: [[f64; 2]; 2], [width, height]: [f64; 2]) -> Self {
        let [[a, b], [c, d]] = corners;
        let slope = [0.5 * (b - a + d - c) / width, 0.5 * (c - a + d - b) / height];
        let finite = |slope: f64| Some(slope as f32).filter(|slope| slope.is_finite()).unwrap_or(0.0);
        Self { value: a as f32, slope: slope.map(finite), rest: NOTHING, range: NOTHING }
    }

    pub(super) fn plane(&self, x: f64, y: f64) -> f64 {
        f64::from(self.value) + x * f64::from(self.slope[0]) + y * f64::from(self.slope[1])
    }

    fn widen(&mut self, low: f64, high: f64) {
        self.rest = [self.rest[0].min((low as f32).next_down()), self.rest[1].max((high as f32).next_up())];
    }

    /// Around the texels of cells [x0, x1) and [y0, y1). At the ends of the period a map that repeats from node to
    /// node may hold another texel the first time; one that is clamped holds no other.
    fn over(lattice: &Lattice<'_>, cells: [i64; 2], x: [i64; 2], y: [i64; 2]) -> Self {
        let corners = y.map(|y| x.map(|x| lattice.at(x, y)));
        let mut block = Self::with_plane(corners, [(x[1] - x[0]) as f64, (y[1] - y[0]) as f64]);
        let mut seen = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
        let mut see = |x: i64, y: i64, value: f64| {
            let rest = value - block.plane(x as f64, y as f64);
            seen = [least(seen[0], rest), greatest(seen[1], rest), least(seen[2], value), greatest(seen[3], value)];
        };
        let goes_on = lattice.axes().map(|axis| !is_clamped(axis));
        let has_end = (0..2).any(|k| goes_on[k] && [x, y][k].iter().any(|at| *at == 0 || *at == cells[k]));
        if !has_end && lattice.is_direct(x[1], y[1]) {
            for row in y[0]..=y[1] {
                (x[0]..=x[1]).for_each(|column| see(column - x[0], row - y[0], lattice.direct(column, row)));
            }
        } else {
            let again = |at: i64, k: usize| {
                let is_end = at == 0 || at == cells[k];
                if goes_on[k] && is_end { [at, at + cells[k]] } else { [at; 2] }
            };
            for (row, column) in (y[0]..=y[1]).flat_map(|row| (x[0]..=x[1]).map(move |column| (row, column))) {
                let all = again(row, 1).into_iter().flat_map(|v| again(column, 0).map(|u| lattice.at(u, v)));
                all.for_each(|value| see(column - x[0], row - y[0], value));
            }
        }
        let [low, high, least, greatest] = seen;
        block.widen(low, high);
        block.range = [least as f32, greatest as f32];
        block
    }

    /// Around blocks, each with its cells; the first and the last are at opposite corners.
    fn around(parts: &[(Self, [[i64; 2]; 2])]) -> Self {
        let (Some((_, [[x0, _], [y0, _]])), Some((_, [[_, x1], [_, y1]]))) = (parts.first(), parts.last()) else {
            return Self::default();
        };
        let size = [(x1 - x0) as f64, (y1 - y0) as f64];
        let value = |x: i64, y: i64| {
            let holds =
                |(_, [xs, ys]): &&(Self, [[i64; 2]; 2])| (xs[0]..=xs[1]).contains(&x) && (ys[0]..=ys[1]).contains(&y);
            let part = parts.iter().rev().find(holds);
            part.map_or(0.0, |(part, [xs, ys])| part.plane((x - xs[0]) as f64, (y - ys[0]) as f64))
        };
        let mut block = Self::with_plane([*y0, *y1].map(|y| [*x0, *x1].map(|x| value(x, y))), size);
        for (part, [xs, ys]) in parts {
            block.range = merged(block.range, part.range);
            for (x, y) in [(xs[0], ys[0]), (xs[1], ys[0]), (xs[0], ys[1]), (xs[1], ys[1])] {
                let own = part.plane((x - xs[0]) as f64, (y - ys[0]) as f64);
                let apart = own - block.plane((x - x0) as f64, (y - y0) as f64);
                block.widen(apart + f64::from(part.rest[0]), apart + f64::from(part.rest[1]));
            }
        }
        block
    }
}
