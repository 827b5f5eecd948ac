//! The way of a straight piece of a course over the nodes and cells of a map.

use glam::{DVec2, DVec4, IVec2};

use super::{
    super::{March, ReliefMap},
    MOST_READS,
    leaf::Gap,
};

/// Half an ulp of 1 in f32: what is passed by is what the device passes by.
const ROUNDING: f64 = 1.0 / (1u32 << 24) as f64;
/// The inverse of a direction that is none; as far as f32 goes.
const NEVER: f64 = 1e30;
/// Where a march begins, nodes are so much smaller than the way, as a power of two.
const START_BELOW: i32 = 3;

/// A piece from t = 0 to 1.
pub(super) struct Piece {
    origin: DVec2,
    direction: DVec2,
    inverse: DVec2,
    z: f64,
    fall: f64,
    fall_inverse: f64,
    /// What rounding may do to a gap.
    slack: f64,
    /// Nothing comes before it, and nothing after it.
    is_first: bool,
    is_last: bool,
}

impl Piece {
    pub(super) fn new(map: &ReliefMap, from: DVec4, to: DVec4, [is_first, is_last]: [bool; 2]) -> Self {
        let way = to - from;
        let (origin, direction) = (from.truncate().truncate(), way.truncate().truncate());
        let [low, high] = [map.bounds.len() - 1, map.bounds.len() - 2].map(|k| f64::from(map.bounds[k]));
        let reach = origin.abs().max_element() + direction.abs().max_element();
        let heights = from.z.abs() + to.z.abs() + low.abs().max(high.abs());
        let slack = ROUNDING * (16.0 * heights + 32.0 * (high - low) * (1.0 + reach));
        let inverse = DVec2::new(inverse(direction.x), inverse(direction.y));
        Self {
            origin,
            direction,
            inverse,
            z: from.z,
            fall: way.z,
            fall_inverse: inverse_of_fall(way.z),
            slack,
            is_first,
            is_last,
        }
    }

    pub(super) fn place(&self, t: f64) -> DVec2 {
        self.origin + self.direction * t
    }

    /// The t at which lattice lines are crossed: from their numbers alone.
    fn crossing(&self, lines: IVec2) -> DVec2 {
        (lines.as_dvec2() - self.origin) * self.inverse
    }

    /// 1 along axes on which cells count up.
    fn forward(&self) -> IVec2 {
        IVec2::new(i32::from(self.inverse.x > 0.0), i32::from(self.inverse.y > 0.0))
    }

    /// The cell that the piece is in at t.
    fn cell(&self, t: f64) -> IVec2 {
        let (forward, guess) = (self.forward(), self.place(t).floor().as_ivec2());
        let step = 2 * forward - 1;
        let (leaves, enters) = (self.crossing(guess + forward), self.crossing(guess + 1 - forward));
        let by = |axis: usize| i32::from(leaves[axis] <= t) - i32::from(enters[axis] > t);
        guess + step * IVec2::new(by(0), by(1))
    }

    /// Up to which t it is above a height, and not within rounding of it.
    fn clear_until(&self, height: f64, t: f64) -> f64 {
        let height = height + 2.0 * self.slack;
        if self.fall < 0.0 {
            (height - self.z) * self.fall_inverse
        } else if self.z + self.fall * t > height {
            NEVER
        } else {
            -1.0
        }
    }
}

fn inverse(direction: f64) -> f64 {
    if direction.abs() < 1.0 / NEVER { NEVER } else { 1.0 / direction }
}

fn inverse_of_fall(fall: f64) -> f64 {
    if fall.abs() < 1.0 / NEVER { -NEVER } else { 1.0 / fall }
}

/// Where a march is.
pub(super) struct Walk<'m> {
    map: &'m ReliefMap,
    piece: &'m Piece,
    t: f64,
    cell: IVec2,
    level: i32,
    most: i32,
    pub(super) above: bool,
}

impl<'m> Walk<'m> {
    pub(super) fn new(map: &'m ReliefMap, piece: &'m Piece, above: bool, setting: f64) -> Self {
        let travel = piece.direction.abs().element_sum();
        let top =
            i32::try_from(map.level.size[0].max(map.level.size[1]).next_power_of_two().trailing_zeros()).unwrap_or(0);
        let most = if travel < setting { 0 } else { top };
        let level = (travel.max(1.0).log2().floor() as i32 - START_BELOW).clamp(0, most);
        Self { map, piece, t: 0.0, cell: piece.cell(0.0), level, most, above }
    }

    /// The t at which the surface is met.
    pub(super) fn run(&mut self, march: &mut March) -> Option<f64> {
        while self.t < 1.0 {
            if march.fetches >= MOST_READS {
                march.capped = true;
                return Some(self.t);
            }
            march.fetches += 1;
            march.steps += 1;
            if self.level > 0 {
                self.node();
            } else if let Some(t) = self.leaf() {
                return Some(t);
            }
        }
        None
    }

    /// Passes a node by, or goes below it as far along as its height allows.
    fn node(&mut self) {
        let (lines, bound) = self.bound();
        let leaves = self.piece.crossing(lines).min_element();
        let clear = self.piece.clear_until(bound, self.t);
        self.above |= clear > self.t;
        if clear >= leaves {
            self.pass(leaves);
        } else {
            self.t = self.t.max(clear);
            self.cell = self.piece.cell(self.t);
            self.level -= 1;
        }
    }

    /// Goes on to what is next; a level up where that belongs to another node there.
    fn pass(&mut self, leaves: f64) {
        let before = self.ancestor();
        self.t = leaves;
        self.cell = self.piece.cell(leaves);
        if self.ancestor() != before && self.level < self.most {
            self.level += 1;
        }
    }

    /// Tile and number of the node above.
    fn ancestor(&self) -> (IVec2, IVec2) {
        let (tile, cell) = self.in_tile();
        (tile, cell >> (self.level + 1))
    }

    /// First cell of the tile, and number in it; what is clamped is one endless tile.
    fn in_tile(&self) -> (IVec2, IVec2) {
        let first = |axis: usize| {
            let size = self.map.level.size[axis] as i32;
            if self.map.level.repeats[axis] { self.cell[axis].div_euclid(size) * size } else { 0 }
        };
        let tile = IVec2::new(first(0), first(1));
        (tile, self.cell - tile)
    }

    /// The lines at which the node is left, and its greatest height.
    fn bound(&self) -> (IVec2, f64) {
        let (tile, cell) = self.in_tile();
        let level = &self.map.level;
        let forward = self.piece.forward();
        let node = cell >> self.level;
        let line = |axis: usize| {
            let line = (node[axis] + forward[axis]) << self.level;
            tile[axis] + if level.repeats[axis] { line.min(level.size[axis] as i32) } else { line }
        };
        let size_at = |l: i32| level.size.map(|n| (n as i32 + (1 << l) - 1) >> l);
        let first: i32 = (0..self.level).map(|l| size_at(l)[0] * size_at(l)[1]).sum();
        let size = size_at(self.level);
        let at = [0, 1].map(|axis| node[axis].clamp(0, size[axis] - 1));
        let bound = self.map.bounds[(first + at[1] * size[0] + at[0]) as usize];
        (IVec2::new(line(0), line(1)), f64::from(bound))
    }

    fn leaf(&mut self) -> Option<f64> {
        let piece = self.piece;
        let forward = piece.forward();
        let enters = piece.crossing(self.cell + 1 - forward).max_element().max(0.0);
        let leaves = piece.crossing(self.cell + forward).min_element().min(1.0);
        let gap = self.gap(enters, leaves - enters);
        let starts_on_it = piece.is_first && piece.fall < 0.0 && enters <= 0.0 && gap.c >= -piece.slack;
        let (met, above) = gap.met(self.above || starts_on_it);
        self.above = above;
        let ends_on_it = above && piece.is_last && piece.fall < 0.0 && leaves >= 1.0 && gap.at_end() <= piece.slack;
        if met.is_some() || ends_on_it {
            return Some(met.map_or(1.0, |after| (enters + after).min(leaves)));
        }
        self.pass(leaves);
        None
    }

    /// Over the cell, from where it is entered.
    fn gap(&self, enters: f64, length: f64) -> Gap {
        let (piece, d) = (self.piece, self.piece.direction);
        let p = (piece.origin - self.cell.as_dvec2()) + d * enters;
        let [h, right, up, both] = self.map.level.corners(self.cell);
        let (slope, twist) = (DVec2::new(right - h, up - h), (h - right) + (both - up));
        let c = (piece.z + piece.fall * enters) - (h + (slope.x + twist * p.y) * p.x + slope.y * p.y);
        let b = piece.fall - ((slope.x + twist * p.y) * d.x + (slope.y + twist * p.x) * d.y);
        Gap { a: -twist * d.x * d.y, b, c, length }
    }
}
