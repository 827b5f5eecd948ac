//! How far at most a flat triangle is from the bilinear field it stands for: exact, in texel space.
//!
//! Within one cell of the field the difference h − L of the bilinear h and the affine L is bilinear itself: it has
//! saddles, but no extremum inside. Its extremes over a triangle are therefore among (a) the lattice points inside,
//! (b) the corners and where an edge crosses a lattice line, (c) on each piece of an edge within one cell, the vertex
//! of a parabola. All of them are looked at, so the result is exact up to rounding.
//!
//! Lattice points are walked row by row between the two edges that bound the row, and L is interpolated along edges
//! and rows: nothing is divided by the area, so that needles are as good as any triangle. A triangle without area
//! is its edges: where several of its points fall on one texel place, L is extreme at edges too.
//!
//! Cost: about one texel per texel of area and four per lattice line that an edge crosses, however many periods
//! of the map that is: some 10 ns a texel and 60 ns a line on a slow core. Whoever takes triangles from outside bounds
//! their texels first. No memory.

use std::iter;

use glam::{DVec2, DVec3};

use super::field::Field;

#[cfg(test)]
mod tests;

/// A value of h − L, and where in the triangle it is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremum {
    /// In the units of the channel.
    pub value: f64,
    /// Shares of the three corners: none below 0, of sum 1.
    pub barycentrics: DVec3,
}

/// What h − L goes between over a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    pub lowest: Extremum,
    pub highest: Extremum,
}

impl Deviation {
    /// The greatest |h − L|.
    #[must_use]
    pub fn error(&self) -> f64 {
        self.greatest().value.abs()
    }

    /// Of the two ends the one farther from 0.
    #[must_use]
    pub fn greatest(&self) -> Extremum {
        if -self.lowest.value > self.highest.value { self.lowest } else { self.highest }
    }
}

/// Where h − L is greatest either way: h is one channel of the field, L goes linearly through `heights` at the
/// `corners`. Corners are finite texel-space places within ±2^40, in any order, and may coincide; heights are finite,
/// in the units of the channel. For a displacement of scale · (h − midlevel) with corners displaced by d, pass
/// d / scale + midlevel and multiply the values by the scale.
#[must_use]
pub fn deviation(field: &Field, channel: u32, corners: [DVec2; 3], heights: [f64; 3]) -> Deviation {
    debug_assert!(corners.iter().all(|c| c.abs().max_element() <= LARGEST_TEXEL), "{corners:?} are texel places");
    let nowhere = Extremum { value: f64::INFINITY, barycentrics: DVec3::X };
    let found = Deviation { lowest: nowhere, highest: Extremum { value: f64::NEG_INFINITY, ..nowhere } };
    // From a lattice point nearby, digits do not depend on how far away the map's first texel is.
    let origin = corners[0].floor();
    let mut search = Search { field, channel, origin, corners: corners.map(|c| c - origin), heights, found };
    for (a, b) in [(0, 1), (1, 2), (2, 0)] {
        search.edge(a, b);
    }
    search.rows();
    search.found
}

/// The greatest |h − L|, as [`deviation`].
#[must_use]
pub fn max_error(field: &Field, channel: u32, corners: [DVec2; 3], heights: [f64; 3]) -> f64 {
    deviation(field, channel, corners, heights).error()
}

/// A texel this far from the origin still has 2^12 places along it.
const LARGEST_TEXEL: f64 = (1_u64 << 40) as f64;

struct Search<'f> {
    field: &'f Field,
    channel: u32,
    origin: DVec2,
    /// From the origin.
    corners: [DVec2; 3],
    heights: [f64; 3],
    found: Deviation,
}

/// Where a row of the lattice enters or leaves the triangle.
#[derive(Clone, Copy)]
struct End {
    x: f64,
    plane: f64,
    barycentrics: DVec3,
}

impl Search<'_> {
    fn offer(&mut self, value: f64, barycentrics: impl Fn() -> DVec3) {
        if value < self.found.lowest.value {
            self.found.lowest = Extremum { value, barycentrics: barycentrics() };
        }
        if value > self.found.highest.value {
            self.found.highest = Extremum { value, barycentrics: barycentrics() };
        }
    }

    fn edge(&mut self, a: usize, b: usize) {
        let (p, q) = (self.corners[a], self.corners[b]);
        let mut start = 0.0;
        for end in merged(crossings(p.x, q.x), crossings(p.y, q.y)).chain(iter::once(1.0)) {
            self.piece(a, b, [start, end]);
            start = end;
        }
    }

    /// Candidates (b) and (c) of the part of edge ab between shares `t` of b, which lies in one cell.
    fn piece(&mut self, a: usize, b: usize, t: [f64; 2]) {
        let [p, q] = t.map(|t| self.corners[a].lerp(self.corners[b], t));
        let plane = t.map(|t| mixed(self.heights[a], self.heights[b], t));
        // The middle tells the cell also where rounding puts an end beside its line.
        let cell = (0.5 * (p + q)).floor();
        let [x, y] = (self.origin + cell).to_array();
        let patch = self.field.patch(self.channel, x as i64, y as i64);
        let (start, end) = (patch.value(p - cell) - plane[0], patch.value(q - cell) - plane[1]);
        let bend = patch.twist * (q.x - p.x) * (q.y - p.y);
        let slope = end - start - bend;
        let vertex = -slope / (2.0 * bend);
        let place = |s: f64| DVec3::AXES[a].lerp(DVec3::AXES[b], mixed(t[0], t[1], s));
        self.offer(start, || place(0.0));
        self.offer(end, || place(1.0));
        if vertex > 0.0 && vertex < 1.0 {
            self.offer(start + vertex * (slope + vertex * bend), || place(vertex));
        }
    }

    /// Candidates (a).
    fn rows(&mut self) {
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| self.corners[a].y.total_cmp(&self.corners[b].y));
        let [low, mid, high] = order;
        let y = |corner: usize| self.corners[corner].y;
        let [y_low, y_mid, y_high] = [y(low), y(mid), y(high)];
        if y_low == y_high {
            return;
        }
        for row in y_low.ceil() as i64..=y_high.floor() as i64 {
            let y = row as f64;
            let bent = if y <= y_mid && y_low < y_mid { (low, mid) } else { (mid, high) };
            let (from, to) = (self.end(low, high, y), self.end(bent.0, bent.1, y));
            if from.x <= to.x { self.row(row, from, to) } else { self.row(row, to, from) }
        }
    }

    /// Where edge ab, which is not level, is at height y.
    fn end(&self, a: usize, b: usize, y: f64) -> End {
        let (p, q) = (self.corners[a], self.corners[b]);
        let t = (y - p.y) / (q.y - p.y);
        End {
            x: mixed(p.x, q.x, t),
            plane: mixed(self.heights[a], self.heights[b], t),
            barycentrics: DVec3::AXES[a].lerp(DVec3::AXES[b], t),
        }
    }

    fn row(&mut self, y: i64, from: End, to: End) {
        let [origin_x, origin_y] = self.origin.to_array().map(|o| o as i64);
        let width = to.x - from.x;
        for x in from.x.ceil() as i64..=to.x.floor() as i64 {
            // No width, no inside: the ends are candidates of the edges.
            let s = if width > 0.0 { (x as f64 - from.x) / width } else { 0.0 };
            let value = self.field.texel(self.channel, origin_x + x, origin_y + y) - mixed(from.plane, to.plane, s);
            self.offer(value, || from.barycentrics.lerp(to.barycentrics, s));
        }
    }
}

fn mixed(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

/// The shares of q, in order, at which the way from p to q is at a whole number.
fn crossings(p: f64, q: f64) -> impl Iterator<Item = f64> {
    let (low, high) = (p.min(q).ceil() as i64, p.max(q).floor() as i64);
    let count = if p == q { 0 } else { high - low + 1 };
    (0..count).map(move |k| {
        let line = if p < q { low + k } else { high - k };
        (line as f64 - p) / (q - p)
    })
}

/// Two ascending sequences as one.
fn merged(a: impl Iterator<Item = f64>, b: impl Iterator<Item = f64>) -> impl Iterator<Item = f64> {
    let (mut a, mut b) = (a.peekable(), b.peekable());
    iter::from_fn(move || match (a.peek(), b.peek()) {
        (Some(x), Some(y)) if x <= y => a.next(),
        (Some(_), None) => a.next(),
        _ => b.next(),
    })
}
