//! One channel of a map as a lattice of texels without end.

use super::{rows::Line, texels::Window};
use crate::{
    layout::geometry::{Layer, MapAxis, kind},
    reference::map::wrapped,
    tables::Tables,
};

/// Where texels come from.
pub(super) trait Source {
    /// The texels at the corners of a cell, row by row.
    fn cell(&self, x: i64, y: i64) -> [[f64; 2]; 2];

    /// The greatest of `worst` and the differences from `line` at these texels of a row, the last included.
    fn row(&self, y: i64, x: [i64; 2], line: Line, worst: f64) -> f64;

    /// The next line of the lattice across an axis (0: x, 1: y) beyond `from`, in the direction of `d`.
    fn next_line(&self, axis: usize, from: f64, d: f64) -> f64;
}

/// A channel of a layer's map, with its wrapping.
#[derive(Clone, Copy, Debug)]
pub struct Lattice<'t> {
    texels: &'t [f32],
    across: MapAxis,
    down: MapAxis,
    row: usize,
    channels: usize,
}

impl<'t> Lattice<'t> {
    #[must_use]
    pub fn new(tables: &'t Tables, layer: &Layer, channel: u64) -> Self {
        Self {
            texels: &tables.texels[(u64::from(layer.first) + channel) as usize..],
            across: layer.across,
            down: layer.down,
            row: layer.row as usize,
            channels: if layer.kind == kind::HEIGHT { 1 } else { 3 },
        }
    }

    pub(super) fn axes(&self) -> [&MapAxis; 2] {
        [&self.across, &self.down]
    }

    pub(super) fn at(&self, x: i64, y: i64) -> f64 {
        self.texel(wrapped(&self.across, x) as usize, wrapped(&self.down, y) as usize)
    }

    /// Whether texels up to this one, from 0 on, are those of the map, without wrapping.
    pub(super) fn is_direct(&self, x: i64, y: i64) -> bool {
        let is_own = |axis: &MapAxis, at: i64| at <= i64::from(axis.top.min(axis.fold / 2));
        is_own(&self.across, x) && is_own(&self.down, y)
    }

    /// A texel that is.
    pub(super) fn direct(&self, x: i64, y: i64) -> f64 {
        self.texel(x as usize, y as usize)
    }

    fn texel(&self, x: usize, y: usize) -> f64 {
        f64::from(self.texels[self.channels * (y * self.row + x)])
    }

    /// Where the map does not repeat what lies at its border.
    pub(super) fn domain(&self) -> Window {
        let ends = self.axes().map(|axis| if is_clamped(axis) { [0.0, f64::from(axis.top)] } else { NO_END });
        Window { low: ends.map(|e| e[0]), high: ends.map(|e| e[1]) }
    }

    /// Whether the window, and a cell around it, needs no wrapping.
    pub(super) fn holds(&self, window: &Window) -> bool {
        self.axes()
            .into_iter()
            .enumerate()
            .all(|(k, axis)| window.low[k] >= 1.0 && window.high[k] <= f64::from(axis.top.min(axis.fold / 2) - 1))
    }
}

const NO_END: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

pub(super) fn is_clamped(axis: &MapAxis) -> bool {
    axis.high == axis.top
}

impl Source for Lattice<'_> {
    fn cell(&self, x: i64, y: i64) -> [[f64; 2]; 2] {
        [y, y + 1].map(|y| [self.at(x, y), self.at(x + 1, y)])
    }

    fn row(&self, y: i64, [first, last]: [i64; 2], line: Line, mut worst: f64) -> f64 {
        for x in first..=last {
            worst = f64::max(worst, (self.at(x, y) - line.at(x as f64)).abs());
        }
        worst
    }

    fn next_line(&self, axis: usize, from: f64, d: f64) -> f64 {
        let next = next_whole(from, d);
        let axis = self.axes()[axis];
        if !is_clamped(axis) {
            return next;
        }
        let top = f64::from(axis.top);
        match d > 0.0 {
            true if next > top => f64::INFINITY,
            false if next < 0.0 => f64::NEG_INFINITY,
            _ => next.clamp(0.0, top),
        }
    }
}

fn next_whole(from: f64, d: f64) -> f64 {
    if d > 0.0 { from.floor() + 1.0 } else { from.ceil() - 1.0 }
}

/// Where nothing wraps and texels lie side by side.
pub(super) struct Plain<'l>(pub(super) &'l Lattice<'l>);

impl Source for Plain<'_> {
    fn cell(&self, x: i64, y: i64) -> [[f64; 2]; 2] {
        let (x, y) = (x as usize, y as usize);
        [y, y + 1].map(|y| [self.0.texel(x, y), self.0.texel(x + 1, y)])
    }

    fn row(&self, y: i64, [first, last]: [i64; 2], line: Line, worst: f64) -> f64 {
        let start = y as usize * self.0.row;
        if self.0.channels == 1 {
            return line.greatest(&self.0.texels[start + first as usize..=start + last as usize], first, worst);
        }
        let at = |x: i64| (self.0.texel(x as usize, y as usize) - line.at(x as f64)).abs();
        (first..=last).fold(worst, |worst, x| worst.max(at(x)))
    }

    fn next_line(&self, _axis: usize, from: f64, d: f64) -> f64 {
        next_whole(from, d)
    }
}

/// Texels looked at side by side.
const LANES: usize = 4;

impl Line {
    fn at(&self, x: f64) -> f64 {
        self.value + (x - self.x) * self.slope
    }

    /// Over texels from `first` on.
    fn greatest(&self, texels: &[f32], first: i64, worst: f64) -> f64 {
        let mut most = [worst; LANES];
        let mut x = first as f64;
        let (chunks, rest) = texels.as_chunks::<LANES>();
        for chunk in chunks {
            for lane in 0..LANES {
                let difference = (f64::from(chunk[lane]) - self.at(x + lane as f64)).abs();
                most[lane] = if difference > most[lane] { difference } else { most[lane] };
            }
            x += LANES as f64;
        }
        let mut worst = most.into_iter().fold(worst, f64::max);
        for texel in rest {
            let difference = (f64::from(*texel) - self.at(x)).abs();
            worst = if difference > worst { difference } else { worst };
            x += 1.0;
        }
        worst
    }
}
