//! The greatest difference over a triangle of any size: small ones texel by texel, large ones block by block, the block
//! that may be farthest off first.

use std::{cmp::Ordering, collections::BinaryHeap};

use super::{
    lattice::{Lattice, Plain, Source},
    linear::{Linear, Outside},
    pyramid::{BLOCK, Pyramid},
    rows,
    texels::{self, MapPlace, Window},
};

/// Over fewer texels and crossings a search takes longer than looking at them all.
const FEW: f64 = 2500.0;
/// A search ends so near the truth, as a share of the cap; what it finds is never below the truth.
const RESOLUTION: f64 = 1.0 / 32.0;
/// So many blocks a search begins with at most, where its triangle lies within one period.
const FIRST_BLOCKS: i64 = 16;

/// How far the map is at most from what is linear between the corners, or up to `cap` · `RESOLUTION` more; where that
/// exceeds `cap`, some difference that does. `at_texels`: at texels alone, and beyond the border of a clamped map along
/// sides.
pub(super) fn greatest(
    lattice: &Lattice<'_>,
    pyramid: &Pyramid,
    corners: [MapPlace; 3],
    at_texels: bool,
    cap: f64,
) -> f64 {
    let around = Window::around(&corners);
    if cost(&around) > FEW {
        return Search::new(lattice, pyramid, corners, at_texels, cap).run();
    }
    if lattice.holds(&around) {
        return directly(&Plain(lattice), &corners, &around, at_texels, cap);
    }
    let mut worst = 0.0;
    if at_texels {
        worst = beyond(lattice, &corners, worst, cap);
    }
    worst.max(directly(lattice, &corners, &around.clipped(&lattice.domain()), at_texels, cap))
}

/// Whether all texels of a triangle with these corners are looked at.
pub(super) fn is_small(corners: &[MapPlace; 3]) -> bool {
    cost(&Window::around(corners)) <= FEW
}

/// About how many texels and crossings there are: half the box, and its sides.
fn cost(around: &Window) -> f64 {
    let [width, height] = [0, 1].map(|k| around.high[k] - around.low[k]);
    0.5 * width * height + 8.0 * (width + height)
}

fn sides(corners: &[MapPlace; 3]) -> [[MapPlace; 2]; 3] {
    [0, 1, 2].map(|k| [corners[k], corners[(k + 1) % 3]])
}

fn directly(source: &impl Source, corners: &[MapPlace; 3], window: &Window, at_texels: bool, cap: f64) -> f64 {
    let mut worst = 0.0;
    for ends in sides(corners).into_iter().filter(|_| !at_texels) {
        worst = texels::side(source, ends, [0.0, 1.0], worst, cap);
    }
    rows::rows(source, corners, window, worst, cap)
}

/// Along the parts of sides beyond the border of a clamped map. There the map is straight one way or both, so nothing
/// between the sides is farther off.
fn beyond(lattice: &Lattice<'_>, corners: &[MapPlace; 3], mut worst: f64, cap: f64) -> f64 {
    let domain = lattice.domain();
    for ends in sides(corners) {
        let [enter, leave] = domain.part(ends).unwrap_or([1.0, 1.0]);
        for part in [[0.0, enter], [leave, 1.0]].into_iter().filter(|[from, to]| from < to) {
            worst = texels::side(lattice, ends, part, worst, cap);
        }
    }
    worst
}

/// Part of the lattice.
#[derive(Clone, Copy, Debug)]
enum Area {
    /// Whole periods [first, end), across and down.
    Periods { first: [i64; 2], end: [i64; 2] },
    /// A block of one of them.
    Block { period: [i64; 2], level: usize, at: [i64; 2] },
}

/// An area, and how far at most the map is from straight there.
struct Open {
    bound: f64,
    area: Area,
}

/// The smaller of two that may be off as far goes first.
impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound).then(other.area.rank().cmp(&self.area.rank()))
    }
}

impl Area {
    /// Levels above single blocks.
    fn rank(&self) -> usize {
        match *self {
            Self::Periods { .. } => usize::MAX,
            Self::Block { level, .. } => level,
        }
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Open {}

struct Search<'s> {
    lattice: &'s Lattice<'s>,
    pyramid: &'s Pyramid,
    corners: [MapPlace; 3],
    at_texels: bool,
    cap: f64,
    /// What of texel space the triangle can have to do with.
    around: Window,
    linear: Linear,
    outside: [Outside; 3],
    open: BinaryHeap<Open>,
    worst: f64,
}

impl<'s> Search<'s> {
    fn new(lattice: &'s Lattice<'s>, pyramid: &'s Pyramid, corners: [MapPlace; 3], at_texels: bool, cap: f64) -> Self {
        Self {
            lattice,
            pyramid,
            corners,
            at_texels,
            cap,
            around: Window::around(&corners).clipped(&lattice.domain()),
            linear: Linear::through(&corners),
            outside: [0, 1, 2].map(|k| Outside::new(&corners, k)),
            open: BinaryHeap::new(),
            worst: 0.0,
        }
    }

    fn run(mut self) -> f64 {
        self.worst = beyond(self.lattice, &self.corners, 0.0, self.cap);
        self.begin();
        while let Some(Open { bound, area }) = self.open.pop() {
            if bound <= self.enough() || self.worst > self.cap {
                return self.worst.max(bound.min(self.enough()));
            }
            match area {
                Area::Periods { first, end } => self.split(first, end, bound),
                Area::Block { level: 0, .. } => self.look(&self.window(&area)),
                Area::Block { period, level, at } => {
                    let end = [0, 1].map(|k| (2 * at[k] + 2).min(self.pyramid.size(level - 1)[k]));
                    self.push_blocks(period, level - 1, [at.map(|at| 2 * at), end], bound);
                }
            }
        }
        self.worst
    }

    /// What no area needs to be opened for.
    fn enough(&self) -> f64 {
        let near = if self.cap.is_finite() { self.worst + RESOLUTION * self.cap } else { self.worst };
        near.min(self.cap).max(self.worst)
    }

    fn begin(&mut self) {
        if self.around.low[0] > self.around.high[0] || self.around.low[1] > self.around.high[1] {
            return;
        }
        let cells = self.pyramid.cells.map(|cells| cells as f64);
        let domain = self.lattice.domain();
        // Beyond the border of a clamped map there is no period.
        let period = |k: usize, at: f64| if domain.low[k].is_finite() { 0 } else { (at / cells[k]).floor() as i64 };
        let first = [0, 1].map(|k| period(k, self.around.low[k]));
        let end = [0, 1].map(|k| period(k, self.around.high[k]) + 1);
        if (0..2).any(|k| end[k] - first[k] > 1) {
            self.push(Area::Periods { first, end }, f64::INFINITY);
            return;
        }
        for level in 0..=self.pyramid.top() {
            let block = |k: usize, at: f64| {
                ((at - first[k] as f64 * cells[k]) as i64 / (BLOCK << level)).clamp(0, self.pyramid.size(level)[k] - 1)
            };
            let low = [0, 1].map(|k| block(k, self.around.low[k]));
            let high = [0, 1].map(|k| block(k, self.around.high[k]) + 1);
            if (high[0] - low[0]) * (high[1] - low[1]) <= FIRST_BLOCKS {
                self.push_blocks(first, level, [low, high], f64::INFINITY);
                return;
            }
        }
    }

    fn split(&mut self, first: [i64; 2], end: [i64; 2], bound: f64) {
        let count = [0, 1].map(|k| end[k] - first[k]);
        if count == [1, 1] {
            self.push_blocks(first, self.pyramid.top(), [[0, 0], [1, 1]], bound);
            return;
        }
        let k = usize::from(count[1] > count[0]);
        let middle = first[k] + count[k] / 2;
        let mut cut = [end, first];
        cut[0][k] = middle;
        cut[1][k] = middle;
        self.push(Area::Periods { first, end: cut[0] }, bound);
        self.push(Area::Periods { first: cut[1], end }, bound);
    }

    fn push_blocks(&mut self, period: [i64; 2], level: usize, [first, end]: [[i64; 2]; 2], most: f64) {
        for y in first[1]..end[1] {
            for x in first[0]..end[0] {
                self.push(Area::Block { period, level, at: [x, y] }, most);
            }
        }
    }

    /// `most`: what holds for all that it is part of.
    fn push(&mut self, area: Area, most: f64) {
        let whole = self.window(&area);
        let window = whole.clipped(&self.around);
        let is_empty = (0..2).any(|k| window.low[k] > window.high[k]);
        if is_empty || self.outside.iter().any(|outside| outside.holds(&window)) {
            return;
        }
        let bound = self.bound(&area, &whole, &window).min(most);
        // What f32 cannot tell of absurd heights has to be looked at.
        let bound = if bound.is_nan() { f64::INFINITY } else { bound };
        if bound > self.worst {
            self.open.push(Open { bound, area });
        }
    }

    /// In texel space, unwrapped.
    fn window(&self, area: &Area) -> Window {
        let cells = self.pyramid.cells;
        let (low, high) = match *area {
            Area::Periods { first, end } => ([0, 1].map(|k| first[k] * cells[k]), [0, 1].map(|k| end[k] * cells[k])),
            Area::Block { period, level, at } => {
                let width = BLOCK << level;
                let low = [0, 1].map(|k| period[k] * cells[k] + at[k] * width);
                (low, [0, 1].map(|k| (low[k] + width).min((period[k] + 1) * cells[k])))
            }
        };
        Window { low: low.map(|at| at as f64), high: high.map(|at| at as f64) }
    }

    fn bound(&self, area: &Area, whole: &Window, window: &Window) -> f64 {
        let from = |plane: Linear, [low, high]: [f64; 2]| {
            let [least, greatest] = plane.less(&self.linear).range(window);
            (greatest + high).max(-(least + low))
        };
        match *area {
            Area::Periods { .. } => from(Linear::default(), self.pyramid.range()),
            Area::Block { level, at, .. } => {
                let block = self.pyramid.block(level, at);
                let by_plane = from(Linear::of_block(block, whole), block.rest.map(f64::from));
                by_plane.min(from(Linear::default(), block.range.map(f64::from)))
            }
        }
    }

    fn look(&mut self, window: &Window) {
        let window = window.clipped(&self.around);
        if self.lattice.holds(&window) {
            self.look_at(&Plain(self.lattice), &window);
        } else {
            self.look_at(self.lattice, &window);
        }
    }

    fn look_at(&mut self, source: &impl Source, window: &Window) {
        for ends in sides(&self.corners).into_iter().filter(|_| !self.at_texels) {
            if let Some(part) = window.part(ends) {
                self.worst = texels::side(source, ends, part, self.worst, self.cap);
            }
        }
        self.worst = rows::rows(source, &self.corners, window, self.worst, self.cap);
    }
}

#[cfg(test)]
mod tests;
