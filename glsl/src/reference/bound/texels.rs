//! How far a bilinear map is at most from what is linear between three places: exact.
//!
//! Within a cell the difference is bilinear and has no extremum inside. Over a triangle its extremes are among the
//! texels inside, the crossings of its sides with the lattice, and one place on each piece of a side in between, where
//! the difference along it, a parabola, is level. Beyond the border of a clamped map the lattice has no lines.

use super::lattice::Source;
use crate::{
    layout::geometry::Layer,
    reference::map::{bilinear, texel_space},
    tables::Tables,
};

/// A place in texel space and the map's value there.
#[derive(Clone, Copy, Debug)]
pub struct MapPlace {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) value: f64,
}

impl MapPlace {
    /// Of what lies in no map, or in several.
    pub const NONE: Self = Self { x: f64::NAN, y: f64::NAN, value: f64::NAN };

    #[must_use]
    pub fn is_known(&self) -> bool {
        !self.x.is_nan()
    }

    pub(super) fn of(tables: &Tables, layer: &Layer, channel: u64, [u, v]: [f64; 2]) -> Self {
        let [x, y] = texel_space(layer, u, v);
        Self { x, y, value: bilinear(tables, layer, channel, [x, y]) }
    }
}

/// Part of texel space, sides included.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    pub(super) low: [f64; 2],
    pub(super) high: [f64; 2],
}

impl Window {
    pub(super) fn around(corners: &[MapPlace; 3]) -> Self {
        let at = corners.map(|c| [c.x, c.y]);
        Self {
            low: [0, 1].map(|k| at[0][k].min(at[1][k]).min(at[2][k])),
            high: [0, 1].map(|k| at[0][k].max(at[1][k]).max(at[2][k])),
        }
    }

    pub(super) fn clipped(&self, to: &Self) -> Self {
        Self { low: [0, 1].map(|k| self.low[k].max(to.low[k])), high: [0, 1].map(|k| self.high[k].min(to.high[k])) }
    }

    /// Where the side from a to b enters and leaves; none where it stays outside.
    pub(super) fn part(&self, [a, b]: [MapPlace; 2]) -> Option<[f64; 2]> {
        let mut part = [0.0, 1.0];
        for (from, to, low, high) in [(a.x, b.x, self.low[0], self.high[0]), (a.y, b.y, self.low[1], self.high[1])] {
            let d = to - from;
            if d == 0.0 {
                if from < low || from > high {
                    return None;
                }
                continue;
            }
            let (enter, leave) = if d > 0.0 { (low, high) } else { (high, low) };
            part = [f64::max(part[0], (enter - from) / d), f64::min(part[1], (leave - from) / d)];
        }
        (part[0] <= part[1]).then_some(part)
    }
}

/// The greatest of `worst` and the differences along part of a side, cell by cell, until one exceeds `cap`.
pub(super) fn side(
    source: &impl Source,
    ends: [MapPlace; 2],
    [mut start, last]: [f64; 2],
    mut worst: f64,
    cap: f64,
) -> f64 {
    let [a, b] = ends;
    let (from, d) = ([a.x, a.y], [b.x - a.x, b.y - a.y]);
    let mut next = [0, 1].map(|k| source.next_line(k, from[k] + start * d[k], d[k]));
    while worst <= cap {
        let to = [0, 1].map(|k| if d[k] == 0.0 { f64::INFINITY } else { (next[k] - from[k]) / d[k] });
        let end = to[0].min(to[1]).clamp(start, last);
        worst = worst.max(piece(source, a, b, [start, end]));
        if to[0].min(to[1]) >= last {
            break;
        }
        for k in 0..2 {
            if to[k] <= end {
                next[k] = source.next_line(k, next[k], d[k]);
            }
        }
        start = end;
    }
    worst
}

fn piece(source: &impl Source, a: MapPlace, b: MapPlace, t: [f64; 2]) -> f64 {
    let at = |t: f64| [a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)];
    let middle = 0.5 * (t[0] + t[1]);
    let cell = at(middle).map(f64::floor);
    let [[t00, t10], [t01, t11]] = source.cell(cell[0] as i64, cell[1] as i64);
    let difference = |t: f64| {
        let [x, y] = at(t);
        let (fx, fy) = (x - cell[0], y - cell[1]);
        let (top, bottom) = (t00 + fx * (t10 - t00), t01 + fx * (t11 - t01));
        top + fy * (bottom - top) - (a.value + t * (b.value - a.value))
    };
    let [f0, fm, f1] = [t[0], middle, t[1]].map(difference);
    let worst = f0.abs().max(f1.abs());
    let (bend, slope) = (0.5 * (f0 + f1) - fm, 0.5 * (f1 - f0));
    let level = -0.5 * slope / bend;
    if level.abs() < 1.0 { worst.max((fm + level * (slope + level * bend)).abs()) } else { worst }
}
