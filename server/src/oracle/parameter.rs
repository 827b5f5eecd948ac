//! What the surface is evaluated with: numbers, numbers with derivatives, and bounds over a region.

use displace_glsl::expression::{Dual, Interval, Number};
use glam::DVec3;

use super::{
    field::Field,
    interval_jet::{IntervalJet, hull},
    smooth::{Polynomial, Spot},
};

/// A number that knows how affine functions of the barycentrics and maps look where it is taken.
pub trait Parameter: Number {
    /// Where: one point of a base triangle, or a convex region of it.
    type Place: ?Sized;

    /// The function that is `values[k]` at corner k of the base triangle.
    fn affine(place: &Self::Place, values: [f64; 3]) -> Self;

    /// How far along an edge: b[to] / (b[to] + b[from]), 0 to 1.
    fn along(place: &Self::Place, to: usize, from: usize) -> Self;

    /// One channel of a map at texel-space (x, y).
    fn field(field: &Field, channel: u32, x: Self, y: Self) -> Self;

    /// The least and the largest it may be.
    fn extremes(self) -> [f64; 2];

    /// The one point, or the corners of the region.
    fn corners(place: &Self::Place) -> &[DVec3];

    /// The other way round; never of nothing.
    fn place(corners: &[DVec3]) -> &Self::Place;

    /// A vector polynomial at the point, or over the box, that `spot` is.
    fn polynomial(spot: &Spot, polynomial: &Polynomial) -> [Self; 3];

    /// What either of two is; of a point they are the same.
    fn either(self, other: Self) -> Self;

    /// With derivatives through `along`, where self was taken on the edge from corner `from` to corner `to`.
    fn chained(self, along: Self, from: usize, to: usize) -> Self;

    /// Anything from `lo` to `hi`, with any slopes; asked for only where `extremes` differ.
    fn between(lo: f64, hi: f64) -> Self;
}

impl Parameter for f64 {
    type Place = DVec3;

    #[inline]
    fn affine(b: &DVec3, [v0, v1, v2]: [f64; 3]) -> Self {
        // Rounding must not carry it beyond its ends, where a step may wait.
        let (low, high) = (v0.min(v1).min(v2), v0.max(v1).max(v2));
        (v0 + b.y * (v1 - v0) + b.z * (v2 - v0)).max(low).min(high)
    }
    fn along(b: &DVec3, to: usize, from: usize) -> Self {
        let both = b[to] + b[from];
        if both > 0.0 { (b[to] / both).clamp(0.0, 1.0) } else { 0.5 }
    }
    #[inline]
    fn field(field: &Field, channel: u32, x: Self, y: Self) -> Self {
        field.value(channel, x, y)
    }
    fn corners(place: &DVec3) -> &[DVec3] {
        std::slice::from_ref(place)
    }
    fn place(corners: &[DVec3]) -> &DVec3 {
        &corners[0]
    }
    fn polynomial(spot: &Spot, polynomial: &Polynomial) -> [Self; 3] {
        polynomial.first_order(spot.low)[0].to_array()
    }
    fn either(self, _: Self) -> Self {
        self
    }
    fn chained(self, _: Self, _: usize, _: usize) -> Self {
        self
    }
    fn extremes(self) -> [f64; 2] {
        [self; 2]
    }
    fn between(lo: f64, hi: f64) -> Self {
        0.5 * (lo + hi)
    }
}

/// Derivatives by (b1, b2). Those of a map are central differences over one texel: the slopes that shading
/// is defined by.
impl Parameter for Dual<2> {
    type Place = DVec3;

    #[inline]
    fn affine(b: &DVec3, values: [f64; 3]) -> Self {
        Self::new(f64::affine(b, values), [values[1] - values[0], values[2] - values[0]])
    }
    fn along(b: &DVec3, to: usize, from: usize) -> Self {
        let unit = |k: usize| [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]][k];
        let both = (b[to] + b[from]).max(1e-300);
        let slope = |axis: usize| (b[from] * unit(to)[axis] - b[to] * unit(from)[axis]) / (both * both);
        Self::new(f64::along(b, to, from), [slope(0), slope(1)])
    }
    #[inline]
    fn field(field: &Field, channel: u32, x: Self, y: Self) -> Self {
        let at = |dx: f64, dy: f64| field.value(channel, x.value + dx, y.value + dy);
        let (by_x, by_y) = (at(0.5, 0.0) - at(-0.5, 0.0), at(0.0, 0.5) - at(0.0, -0.5));
        let slope = |axis: usize| by_x * x.derivative[axis] + by_y * y.derivative[axis];
        Self::new(at(0.0, 0.0), [slope(0), slope(1)])
    }
    fn corners(place: &DVec3) -> &[DVec3] {
        std::slice::from_ref(place)
    }
    fn place(corners: &[DVec3]) -> &DVec3 {
        &corners[0]
    }
    fn polynomial(spot: &Spot, polynomial: &Polynomial) -> [Self; 3] {
        let [value, by_x, by_y] = polynomial.first_order(spot.low);
        std::array::from_fn(|k| Self::new(value[k], [spot.scale * by_x[k], spot.scale * by_y[k]]))
    }
    fn either(self, _: Self) -> Self {
        self
    }
    fn chained(self, along: Self, from: usize, to: usize) -> Self {
        let by = |corner: usize| if corner == 0 { 0.0 } else { self.derivative[corner - 1] };
        Self::new(self.value, along.derivative.map(|d| d * (by(to) - by(from))))
    }
    fn extremes(self) -> [f64; 2] {
        [self.value; 2]
    }
    fn between(lo: f64, hi: f64) -> Self {
        Self::constant(0.5 * (lo + hi))
    }
}

/// The corners of a convex region, in barycentrics.
impl Parameter for IntervalJet {
    type Place = [DVec3];

    #[inline]
    fn affine(corners: &[DVec3], values: [f64; 3]) -> Self {
        let slope = [values[1] - values[0], values[2] - values[0]].map(Interval::constant);
        let ends = range(values.into_iter());
        let value = range(corners.iter().map(|b| f64::affine(b, values))).widened();
        // What never changes is known exactly.
        Self::new(Interval::new(value.lo.max(ends.lo), value.hi.min(ends.hi)), slope)
    }
    fn along(corners: &[DVec3], to: usize, from: usize) -> Self {
        // Constant on lines through the opposite corner, so its extremes lie at corners of the region.
        let tip = corners.iter().any(|b| b[to] + b[from] <= 0.0);
        let value = range(corners.iter().map(|b| f64::along(b, to, from)));
        let value = if tip { Interval::new(0.0, 1.0) } else { value };
        let unit = |k: usize| [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]][k];
        let coordinate = |k: usize| range(corners.iter().map(|b| b[k].max(0.0)));
        let (t, f) = (coordinate(to), coordinate(from));
        let both = range(corners.iter().map(|b| b[to] + b[from]));
        let slope = |axis: usize| {
            let top = f.mul(Interval::constant(unit(to)[axis])).sub(t.mul(Interval::constant(unit(from)[axis])));
            if both.lo <= 0.0 { Interval::WHOLE } else { top.div(both.mul(both)) }
        };
        Self::new(value, [slope(0), slope(1)])
    }
    #[inline]
    fn field(field: &Field, channel: u32, x: Self, y: Self) -> Self {
        let (value, by_x, by_y) = bounds(field, channel, x.value, y.value);
        let by = |d: Interval, slope: Interval| if is_zero(slope) { slope } else { d.mul(slope) };
        let slope = |axis: usize| by(by_x, x.slope[axis]).add(by(by_y, y.slope[axis]));
        Self::new(value, [slope(0), slope(1)])
    }
    fn corners(place: &[DVec3]) -> &[DVec3] {
        place
    }
    fn place(corners: &[DVec3]) -> &[DVec3] {
        corners
    }
    fn polynomial(spot: &Spot, polynomial: &Polynomial) -> [Self; 3] {
        let middle = [0, 1].map(|k| 0.5 * (spot.low[k] + spot.high[k]));
        let radius = [0, 1].map(|k| (0.5 * (spot.high[k] - spot.low[k])).next_up());
        let about = polynomial.about(middle);
        let (at, spread) = (about.first_order([0.0; 2]), about.spread(radius));
        let interval = |order: usize, k: usize| {
            Interval::new(at[order][k] - spread[order][k], at[order][k] + spread[order][k]).widened()
        };
        let slope = |order: usize, k: usize| interval(order, k).mul(Interval::constant(spot.scale));
        std::array::from_fn(|k| Self::new(interval(0, k), [slope(1, k), slope(2, k)]))
    }
    fn either(self, other: Self) -> Self {
        let slope = [0, 1].map(|k| hull(self.slope[k], other.slope[k]));
        Self::new(hull(self.value, other.value), slope)
    }
    fn chained(self, along: Self, from: usize, to: usize) -> Self {
        let by = |corner: usize| if corner == 0 { Interval::constant(0.0) } else { self.slope[corner - 1] };
        let slope = by(to).sub(by(from));
        Self::new(self.value, along.slope.map(|d| if is_zero(d) { d } else { d.mul(slope) }))
    }
    fn extremes(self) -> [f64; 2] {
        [self.value.lo, self.value.hi]
    }
    fn between(lo: f64, hi: f64) -> Self {
        Self::new(Interval::new(lo, hi), [Interval::WHOLE; 2])
    }
}

fn is_zero(i: Interval) -> bool {
    i.lo == 0.0 && i.hi == 0.0
}

#[inline]
fn range(values: impl Iterator<Item = f64>) -> Interval {
    let (lo, hi) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
    Interval::new(lo, hi)
}

/// A region reaches so far into the next cell without touching it, texels: what cutting along grid lines leaves.
pub(super) const CELL_SLACK: f64 = 1e-9;
/// A region over more cells is bounded by the whole map.
const MOST_CELLS: i64 = 1024;

/// Value and slopes of a bilinear map anywhere in a box of texel space.
fn bounds(field: &Field, channel: u32, x: Interval, y: Interval) -> (Interval, Interval, Interval) {
    let Some((columns, rows)) = cells(x).zip(cells(y)) else { return whole(field, channel) };
    let count = (columns[1] - columns[0] + 1).saturating_mul(rows[1] - rows[0] + 1);
    if count > MOST_CELLS {
        return whole(field, channel);
    }
    let empty = Interval::new(f64::INFINITY, f64::NEG_INFINITY);
    let mut all = (empty, empty, empty);
    for j in rows[0]..=rows[1] {
        for i in columns[0]..=columns[1] {
            let (value, by_x, by_y) = cell_bounds(field.cell(channel, i, j), within(x, i), within(y, j));
            all = (hull(all.0, value), hull(all.1, by_x), hull(all.2, by_y));
        }
    }
    all
}

fn whole(field: &Field, channel: u32) -> (Interval, Interval, Interval) {
    let [low, high] = field.range(channel);
    let slope = Interval::new(low - high, high - low);
    (Interval::new(low, high), slope, slope)
}

/// First and last cell under an interval.
fn cells(x: Interval) -> Option<[i64; 2]> {
    let far = 1e15;
    if !(x.lo > -far && x.hi < far) {
        return None;
    }
    let first = (x.lo + CELL_SLACK).floor() as i64;
    Some([first, ((x.hi - CELL_SLACK).ceil() as i64 - 1).max(first)])
}

/// The part of an interval in cell `i`, from 0 to 1 but for the slack.
fn within(x: Interval, i: i64) -> Interval {
    let from = i as f64;
    Interval::new((x.lo - from).max(-CELL_SLACK), (x.hi - from).min(1.0 + CELL_SLACK))
}

/// A bilinear function takes its extremes, and so do its slopes, at corners of a box.
fn cell_bounds([a, b, c, d]: [f64; 4], s: Interval, t: Interval) -> (Interval, Interval, Interval) {
    let by_x = |t: f64| (b - a) * (1.0 - t) + (d - c) * t;
    let by_y = |s: f64| (c - a) * (1.0 - s) + (d - b) * s;
    let value = |s: f64, t: f64| a + (b - a) * s + by_y(s) * t;
    let corners = [value(s.lo, t.lo), value(s.hi, t.lo), value(s.lo, t.hi), value(s.hi, t.hi)];
    let pair = |p: f64, q: f64| Interval::new(p.min(q), p.max(q));
    (range(corners.into_iter()), pair(by_x(t.lo), by_x(t.hi)), pair(by_y(s.lo), by_y(s.hi)))
}
