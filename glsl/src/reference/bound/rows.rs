//! The texels inside a triangle, row by row.

use super::{
    lattice::Source,
    linear::{greatest, least},
    texels::{MapPlace, Window},
};

/// What is linear along a row of texels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    pub(super) x: f64,
    pub(super) value: f64,
    pub(super) slope: f64,
}

/// A texel a rounding error outside counts as inside.
const RIM: f64 = 1e-9;
/// Over a triangle narrower than this share of its sides slopes are those between its sides, row by row.
const NARROW: f64 = 1e-6;

/// The greatest of `worst` and the differences at the texels of the window inside the triangle, until one exceeds `cap`.
pub(super) fn rows(source: &impl Source, corners: &[MapPlace; 3], window: &Window, mut worst: f64, cap: f64) -> f64 {
    let rows = Rows::new(corners);
    let [first, last] = rows.numbers(window);
    // What is off is off most in the middle.
    let mut y = first + (last - first) / 2;
    for _ in first..=last {
        if worst > cap {
            break;
        }
        let (x, line) = rows.row(y as f64);
        let x = [whole_above(greatest(x[0], window.low[0]) - RIM), whole_below(least(x[1], window.high[0]) + RIM)];
        if x[0] <= x[1] {
            worst = source.row(y, x, line, worst);
        }
        y = if y < last { y + 1 } else { first };
    }
    worst
}

/// A triangle to be met by rows of texels.
struct Rows {
    /// By y.
    corners: [MapPlace; 3],
    /// From the first corner to the last, to the second, and from there to the last: x and value for each row; 0 of
    /// those along a row.
    sides: [[f64; 2]; 3],
    /// Of the value by x and y; none of a narrow triangle.
    slopes: Option<[f64; 2]>,
}

impl Rows {
    fn new(corners: &[MapPlace; 3]) -> Self {
        let mut corners = *corners;
        for (i, j) in [(0, 1), (1, 2), (0, 1)] {
            if corners[j].y < corners[i].y {
                corners.swap(i, j);
            }
        }
        let [top, middle, bottom] = corners;
        let sides = [per_row(top, bottom), per_row(top, middle), per_row(middle, bottom)];
        Self { corners, sides, slopes: slopes(&corners) }
    }

    /// The first and the last whose texels may lie in the triangle and in the window.
    fn numbers(&self, window: &Window) -> [i64; 2] {
        let [top, _, bottom] = self.corners;
        [whole_above(top.y.max(window.low[1]) - RIM), whole_below(bottom.y.min(window.high[1]) + RIM)]
    }

    /// Where it enters and leaves the triangle, and the values there.
    fn row(&self, row: f64) -> ([f64; 2], Line) {
        let [top, middle, bottom] = self.corners;
        let y = least(greatest(row, top.y), bottom.y);
        let (from, side) = if y < middle.y { (top, self.sides[1]) } else { (middle, self.sides[2]) };
        let [long, short] = [top.x + (y - top.y) * self.sides[0][0], from.x + (y - from.y) * side[0]];
        let x = [least(long, short), greatest(long, short)];
        if let Some([slope, down]) = self.slopes {
            return (x, Line { x: top.x, value: top.value + (row - top.y) * down, slope });
        }
        let values = [top.value + (y - top.y) * self.sides[0][1], from.value + (y - from.y) * side[1]];
        let [start, end] = if long <= short { values } else { [values[1], values[0]] };
        let width = x[1] - x[0];
        (x, Line { x: x[0], value: start, slope: if width > 0.0 { (end - start) / width } else { 0.0 } })
    }
}

fn per_row(from: MapPlace, to: MapPlace) -> [f64; 2] {
    let rows = to.y - from.y;
    if rows > 0.0 { [(to.x - from.x) / rows, (to.value - from.value) / rows] } else { [0.0; 2] }
}

fn slopes([a, b, c]: &[MapPlace; 3]) -> Option<[f64; 2]> {
    let (p, q) = ([b.x - a.x, b.y - a.y], [c.x - a.x, c.y - a.y]);
    let (up, uq) = (b.value - a.value, c.value - a.value);
    let cross = p[0] * q[1] - p[1] * q[0];
    let sides = (p[0] * p[0] + p[1] * p[1]) * (q[0] * q[0] + q[1] * q[1]);
    let is_wide = cross * cross > NARROW * NARROW * sides;
    is_wide.then(|| [(up * q[1] - uq * p[1]) / cross, (uq * p[0] - up * q[0]) / cross])
}

/// The least whole number that is no less.
fn whole_above(x: f64) -> i64 {
    let whole = x as i64;
    whole + i64::from((whole as f64) < x)
}

/// The greatest that is no more.
fn whole_below(x: f64) -> i64 {
    let whole = x as i64;
    whole - i64::from(whole as f64 > x)
}
