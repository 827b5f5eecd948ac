//! How far a bilinear map is at most from what is linear between three places: exact.
//!
//! Within a cell the difference is bilinear and has no extremum inside. Over a triangle its extremes are among the
//! texels inside, the crossings of its sides with the lattice, and one place on each piece of a side in between, where
//! the difference along it, a parabola, is level. Beyond the border of a clamped map the lattice has no lines.

use super::lattice::Source;

/// A corner in texel space and the map's value there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) value: f64,
}

/// Part of texel space, sides included.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    pub(super) low: [f64; 2],
    pub(super) high: [f64; 2],
}

/// What is linear along a row of texels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    pub(super) x: f64,
    pub(super) value: f64,
    pub(super) slope: f64,
}

/// A texel a rounding error outside counts as inside.
const RIM: f64 = 1e-9;

impl Window {
    pub(super) fn around(corners: &[Corner; 3]) -> Self {
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
    pub(super) fn part(&self, [a, b]: [Corner; 2]) -> Option<[f64; 2]> {
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

/// The greatest of `worst` and the differences at the texels of the window inside the triangle.
pub(super) fn rows(source: &impl Source, corners: &[Corner; 3], window: &Window, mut worst: f64, cap: f64) -> f64 {
    let triangle = Window::around(corners);
    let [low, high] = [triangle.low[1].max(window.low[1]), triangle.high[1].min(window.high[1])];
    let mut y = (low - RIM).ceil();
    while y <= high + RIM && worst <= cap {
        worst = row(source, corners, y, window, worst);
        y += 1.0;
    }
    worst
}

/// Where a row of texels enters and leaves the triangle.
fn row(source: &impl Source, corners: &[Corner; 3], y: f64, window: &Window, worst: f64) -> f64 {
    let mut start = Corner { x: f64::INFINITY, y, value: 0.0 };
    let mut end = Corner { x: f64::NEG_INFINITY, y, value: 0.0 };
    for k in 0..3 {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        let (low, high) = (a.y.min(b.y), a.y.max(b.y));
        if y < low - RIM || y > high + RIM {
            continue;
        }
        let shares = if b.y == a.y { [0.0, 1.0] } else { [((y - a.y) / (b.y - a.y)).clamp(0.0, 1.0); 2] };
        for t in shares {
            let met = Corner { x: a.x + t * (b.x - a.x), y, value: a.value + t * (b.value - a.value) };
            start = if met.x < start.x { met } else { start };
            end = if met.x > end.x { met } else { end };
        }
    }
    let width = end.x - start.x;
    let slope = if width > 0.0 { (end.value - start.value) / width } else { 0.0 };
    let (first, last) = ((start.x.max(window.low[0]) - RIM).ceil(), (end.x.min(window.high[0]) + RIM).floor());
    if first > last {
        return worst;
    }
    source.row(y as i64, [first as i64, last as i64], Line { x: start.x, value: start.value, slope }, worst)
}

/// The greatest of `worst` and the differences along part of a side, cell by cell, until one exceeds `cap`.
pub(super) fn side(
    source: &impl Source,
    ends: [Corner; 2],
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

fn piece(source: &impl Source, a: Corner, b: Corner, t: [f64; 2]) -> f64 {
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
