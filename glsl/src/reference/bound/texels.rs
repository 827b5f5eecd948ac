//! How far a bilinear map is at most from what is linear between three places: exact.
//!
//! Within a cell the difference is bilinear and has no extremum inside. Over a triangle its extremes are among the
//! texels inside, the crossings of its sides with the lattice, and one place on each piece of a side in between, where
//! the difference along it, a parabola, is level.

/// A corner in texel space and the map's value there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) value: f64,
}

/// A texel a rounding error outside counts as inside.
const RIM: f64 = 1e-9;

/// How many texels and crossings are looked at, about: half the box, and its sides.
pub(super) fn cost(corners: &[Corner; 3]) -> f64 {
    let extent = |of: fn(&Corner) -> f64| {
        let at = corners.each_ref().map(of);
        at[0].max(at[1]).max(at[2]) - at[0].min(at[1]).min(at[2])
    };
    let (width, height) = (extent(|c| c.x), extent(|c| c.y));
    0.5 * width * height + 8.0 * (width + height)
}

/// The greatest difference; where it exceeds `cap`, some difference that does. `at_texels`: at texels alone.
pub(super) fn greatest(texel: impl Fn(i64, i64) -> f64, corners: [Corner; 3], at_texels: bool, cap: f64) -> f64 {
    let mut worst = 0.0;
    if !at_texels {
        for k in 0..3 {
            worst = side(&texel, [corners[k], corners[(k + 1) % 3]], worst, cap);
            if worst > cap {
                return worst;
            }
        }
    }
    let low = corners.iter().fold(f64::INFINITY, |low, c| low.min(c.y));
    let high = corners.iter().fold(f64::NEG_INFINITY, |high, c| high.max(c.y));
    let mut y = (low - RIM).ceil();
    while y <= high + RIM && worst <= cap {
        worst = row(&texel, &corners, y, worst);
        y += 1.0;
    }
    worst
}

/// Where a row of texels enters and leaves the triangle.
fn row(texel: &impl Fn(i64, i64) -> f64, corners: &[Corner; 3], y: f64, mut worst: f64) -> f64 {
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
    let mut x = (start.x - RIM).ceil();
    while x <= end.x + RIM {
        let linear = start.value + (x - start.x) * slope;
        worst = f64::max(worst, (texel(x as i64, y as i64) - linear).abs());
        x += 1.0;
    }
    worst
}

/// Along side ab, cell by cell, until the difference exceeds `cap`.
fn side(texel: &impl Fn(i64, i64) -> f64, [a, b]: [Corner; 2], mut worst: f64, cap: f64) -> f64 {
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    let mut next = [first_line(a.x, dx), first_line(a.y, dy)];
    let mut start = 0.0;
    while start < 1.0 && worst <= cap {
        let reach = |line: f64, from: f64, d: f64| if d == 0.0 { 1.0 } else { (line - from) / d };
        let to = [reach(next[0], a.x, dx), reach(next[1], a.y, dy)];
        let end = to[0].min(to[1]).clamp(start, 1.0);
        worst = worst.max(piece(texel, a, b, [start, end]));
        for k in 0..2 {
            if to[k] <= end {
                next[k] += if [dx, dy][k] > 0.0 { 1.0 } else { -1.0 };
            }
        }
        start = if to[0].min(to[1]) >= 1.0 { 1.0 } else { end };
    }
    worst
}

/// The first lattice line that is met after `from`.
fn first_line(from: f64, d: f64) -> f64 {
    if d > 0.0 { from.floor() + 1.0 } else { from.ceil() - 1.0 }
}

fn piece(texel: &impl Fn(i64, i64) -> f64, a: Corner, b: Corner, t: [f64; 2]) -> f64 {
    let at = |t: f64| [a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)];
    let middle = 0.5 * (t[0] + t[1]);
    let cell = at(middle).map(f64::floor);
    let (i, j) = (cell[0] as i64, cell[1] as i64);
    let (t00, t10, t01, t11) = (texel(i, j), texel(i + 1, j), texel(i, j + 1), texel(i + 1, j + 1));
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
