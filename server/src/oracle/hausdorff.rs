//! Certified distances: the Hausdorff distance of two sheets as an interval that holds it.
//!
//! From A to B it is the largest distance any place of A has to B. A place known exactly gives a lower bound;
//! a piece of A gives an upper bound, and the pieces with the largest are cut until the bounds meet (branch
//! and bound; Tang, Lee and Kim 2009). For a piece with corners cᵢ and distances dᵢ:
//! * distance to a convex set is convex, so to one triangle of B it is largest at a corner;
//! * distance is 1-Lipschitz, so it is at most max dᵢ + how far any place is from the nearest corner;
//! * to a surface, the piece pairs with the surface's places between those nearest to its corners, or with those over
//!   its feet on one triangle for the surface.

mod open;
mod piece;

use glam::DVec3;
use rayon::prelude::*;

use self::{
    open::Open,
    piece::{Piece, covering_radius, farthest_from, leaves, longest},
};
use super::{
    overlay::{Few, Overlay, Seen},
    sheet::{Near, Sheet, closest_on_triangle, distance_to_triangle},
};
use crate::domain::{
    Error, Result,
    cancel::{Cancel, Progress},
};

/// How exact, and at most how much work.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Width of the interval asked for, world units; above 0.
    pub precision: f64,
    /// Pieces that are cut before the interval is returned as it stands.
    pub max_cuts: u64,
}

/// The distance from one sheet to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Directed {
    /// At least, at most; world units.
    pub lo: f64,
    pub hi: f64,
    /// A place of the first sheet that is at least `lo` away, and the place of the second nearest to it.
    pub at: [DVec3; 2],
    /// Pieces that were cut.
    pub cuts: u64,
}

/// Pieces cut at a time, in parallel.
const BATCH: usize = 8192;
/// How far the bounds of one distance may be apart where only a limit is asked about, as a share of it.
const WIDTH_WITHIN: f64 = 0.25;
/// Triangles that one thread asks about one after the other.
const LOT: usize = 256;
/// Rounding of one distance, as a share of the largest number in it.
const ROUNDING: f64 = 1e-14;
/// Pieces deeper than this are cut in halves, so that they shrink surely.
const MOST_ALIGNED_CUTS: u16 = 12;

/// The largest distance from A to B. `None` where either is empty.
pub fn directed(
    a: &Sheet<'_>,
    b: &Sheet<'_>,
    settings: &Settings,
    cancel: &Cancel,
    progress: &dyn Progress,
) -> Result<Option<Directed>> {
    if a.triangles.is_empty() || b.triangles.is_empty() {
        return Ok(None);
    }
    let search = Search { a, b, width: settings.precision / 8.0, cancel };
    let vertices = search.vertices()?;
    let mut best = search.farthest_vertex(&vertices)?;
    let wanted = settings.precision * 0.875;
    let mut open = Open::default();
    for chunk in (0..a.triangles.len() as u32).collect::<Vec<_>>().chunks(1 << 18) {
        let whole = |&t: &u32| search.whole(t, &vertices, best.lower + wanted);
        let pieces: Vec<Piece> = chunk.par_iter().map(whole).collect::<Result<_>>()?;
        pieces.into_iter().for_each(|piece| open.add(piece, best.lower + wanted));
    }
    let mut cuts = 0;
    while cuts < settings.max_cuts {
        let (lower, enough) = (best.lower, best.lower + wanted);
        let batch = open.take(BATCH, enough);
        if batch.is_empty() {
            break;
        }
        cuts += batch.len() as u64;
        let cut = |piece: &Piece| search.cut(piece, lower, wanted);
        let parts: Vec<[Piece; 2]> = batch.par_iter().map(cut).collect::<Result<_>>()?;
        for part in parts.iter().flatten() {
            part.near.iter().zip(&part.places).for_each(|(near, place)| best.offer(*place, near));
        }
        parts.into_iter().flatten().for_each(|part| open.add(part, best.lower + wanted));
        progress.pass("measure", cuts, 0);
    }
    let rounding = ROUNDING * a.magnitude().max(b.magnitude());
    let hi = best.lower.max(open.most()) + rounding;
    let lo = (best.lower - rounding - a.moved() - b.sliver_rounding()).max(0.0);
    Ok(Some(Directed { lo, hi, at: best.at, cuts }))
}

/// What is found of one triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// No place of it is farther; infinite where that is not shown to be at most the limit.
    pub bound: f64,
    /// The triangles of the other mesh that alone show it, where they are few.
    pub by: Option<Few>,
}

/// For each triangle of A, whether it is at most `limit` from B. Both are meshes. Much sooner found than [`directed`]'s
/// interval: what B covers is not cut, nor what is near enough. `max_cuts` are for each triangle that is cut; those of
/// which `known` tells are not asked about.
pub fn within(
    a: &Sheet<'_>,
    b: &Overlay<'_>,
    limit: f64,
    max_cuts: u64,
    known: impl Fn(u32) -> Option<Shown> + Sync,
    cancel: &Cancel,
) -> Result<Vec<Shown>> {
    let all: Vec<u32> = (0..a.triangles.len() as u32).collect();
    if b.sheet().triangles.is_empty() {
        return Ok(vec![Shown { bound: f64::INFINITY, by: None }; all.len()]);
    }
    let rounding = ROUNDING * a.magnitude().max(b.sheet().magnitude());
    let search = Search { a, b: b.sheet(), width: limit * WIDTH_WITHIN, cancel };
    let of_lot = |lot: &[u32]| search.lot_within(lot, b, limit, rounding, max_cuts, &known);
    let lots: Vec<Vec<Shown>> = all.par_chunks(LOT).map(of_lot).collect::<Result<_>>()?;
    Ok(lots.concat())
}

fn not_finite() -> Error {
    let message =
        "the surface is not finite everywhere: lower the scale, or keep the expression away from division by 0";
    Error::invalid("details", message)
}

/// The farthest place found.
#[derive(Default)]
struct Best {
    lower: f64,
    at: [DVec3; 2],
}

impl Best {
    fn offer(&mut self, place: DVec3, near: &Near) {
        if near.lower > self.lower {
            *self = Self { lower: near.lower, at: [place, near.place] };
        }
    }
}

struct Search<'s> {
    a: &'s Sheet<'s>,
    b: &'s Sheet<'s>,
    /// Of the bounds of one distance.
    width: f64,
    cancel: &'s Cancel,
}

impl Search<'_> {
    /// As [`within`], of listed triangles of A.
    fn lot_within(
        &self,
        lot: &[u32],
        b: &Overlay<'_>,
        limit: f64,
        rounding: f64,
        max_cuts: u64,
        known: &impl Fn(u32) -> Option<Shown>,
    ) -> Result<Vec<Shown>> {
        let (enough, mut hint, mut seen) = (limit - rounding, None, Seen::default());
        let mut one = |&triangle: &u32| {
            self.cancel.check()?;
            if let Some(shown) = known(triangle) {
                return Ok(shown);
            }
            let corners = self.a.corners(triangle);
            let near = self.near(corners.into_iter().sum::<DVec3>() / 3.0, hint, enough - self.width)?;
            hint = Some(near.triangle);
            if let Some(bound) = b.height(corners, near.triangle, &mut seen).filter(|height| *height <= enough) {
                return Ok(Shown { bound: bound + rounding, by: seen.few() });
            }
            let bound = if near.lower <= enough { self.cut_within(triangle, enough, max_cuts)? } else { None };
            Ok(Shown { bound: bound.map_or(f64::INFINITY, |bound| bound + rounding), by: None })
        };
        lot.iter().map(&mut one).collect()
    }

    /// A bound of one triangle of A, at most `enough`, by cutting it.
    fn cut_within(&self, triangle: u32, enough: f64, max_cuts: u64) -> Result<Option<f64>> {
        let is_far = |near: &Near| near.lower > enough;
        let [p, q, r] = self.a.corners(triangle).map(|corner| self.near(corner, None, enough - self.width));
        let near = [p?, q?, r?];
        if near.iter().any(is_far) {
            return Ok(None);
        }
        let mut open = Open::default();
        open.add(self.whole_of(triangle, near, enough), enough);
        for _ in 0..max_cuts {
            let Some(piece) = open.take(1, enough).pop() else { return Ok(Some(open.most())) };
            let parts = self.cut(&piece, enough - self.width, self.width)?;
            if parts.iter().flat_map(|part| &part.near).any(is_far) {
                return Ok(None);
            }
            parts.into_iter().for_each(|part| open.add(part, enough));
        }
        Ok(None)
    }

    fn vertices(&self) -> Result<Vec<Near>> {
        let of_chunk = |places: &[DVec3]| -> Result<Vec<Near>> {
            let mut hint = None;
            let near = |&place: &DVec3| {
                self.cancel.check()?;
                let near = self.near(place, hint, f64::INFINITY)?;
                hint = Some(near.triangle);
                Ok(near)
            };
            places.iter().map(near).collect()
        };
        let chunks: Vec<Vec<Near>> = self.a.positions.par_chunks(1 << 14).map(of_chunk).collect::<Result<_>>()?;
        Ok(chunks.into_iter().flatten().collect())
    }

    /// A place that B is near to needs no sharp bounds: only the farthest one decides.
    fn near(&self, place: DVec3, hint: Option<u32>, lower: f64) -> Result<Near> {
        let near = self.b.near_enough(place, hint, 0.5 * self.width).expect("B has triangles");
        if !(near.upper.is_finite() && near.place.is_finite()) {
            return Err(not_finite());
        }
        if near.upper <= lower + self.width || near.upper - near.lower <= self.width {
            return Ok(near);
        }
        Ok(self.b.nearest(place, Some(near.triangle), self.width).expect("B has triangles"))
    }

    /// The vertex with the largest lower bound, once no other can have a much larger one.
    fn farthest_vertex(&self, vertices: &[Near]) -> Result<Best> {
        let mut best = Best::default();
        vertices.iter().zip(&self.a.positions).for_each(|(near, place)| best.offer(*place, near));
        let mut by_upper: Vec<usize> = (0..vertices.len()).collect();
        by_upper.sort_unstable_by(|&i, &j| vertices[j].upper.total_cmp(&vertices[i].upper).then(i.cmp(&j)));
        for chunk in by_upper.chunks(256) {
            let lower = best.lower;
            let may_be_farther = |&&v: &&usize| vertices[v].upper > lower + self.width;
            let narrowed = |&v: &usize| -> Result<(DVec3, Near)> {
                self.cancel.check()?;
                let place = self.a.positions[v];
                Ok((place, self.near(place, Some(vertices[v].triangle), lower)?))
            };
            let found: Vec<_> = chunk.par_iter().filter(may_be_farther).map(narrowed).collect::<Result<_>>()?;
            if found.is_empty() {
                break;
            }
            found.iter().for_each(|(place, near)| best.offer(*place, near));
        }
        Ok(best)
    }

    fn whole(&self, triangle: u32, vertices: &[Near], enough: f64) -> Result<Piece> {
        self.cancel.check()?;
        let near = self.a.triangles[triangle as usize].map(|v| vertices[v as usize]);
        Ok(self.whole_of(triangle, near, enough))
    }

    fn whole_of(&self, triangle: u32, near: [Near; 3], enough: f64) -> Piece {
        let corners = [DVec3::X, DVec3::Y, DVec3::Z];
        let places = self.a.corners(triangle);
        self.bounded(Piece { triangle, depth: 0, corners, places, near, upper: 0.0 }, enough)
    }

    /// The cheap bounds first; what they show to be near enough needs no better one.
    fn bounded(&self, mut piece: Piece, enough: f64) -> Piece {
        let own = if piece.depth == 0 {
            self.a.residual(piece.triangle)
        } else {
            self.a.deviation(piece.triangle, piece.corners) + self.a.moved()
        };
        let lipschitz = piece.farthest() + covering_radius(&piece.places);
        let to_places = piece.near.iter().map(|near| farthest_from(near.place, &piece.places));
        let mut upper = to_places.fold(lipschitz, f64::min);
        let [a, b, c] = piece.near.map(|near| near.triangle);
        let targets = [Some(a), (b != a).then_some(b), (c != a && c != b).then_some(c)];
        for target in targets.into_iter().flatten() {
            if own + upper > enough {
                upper = upper.min(self.to_one(&piece.places, target, enough - own));
            }
        }
        if own + upper > enough && self.b.largest_residual() > 0.0 {
            upper = upper.min(self.paired(&piece, enough - own).unwrap_or(f64::INFINITY));
        }
        piece.upper = own + upper;
        // What is not a number is not known.
        piece.upper = if piece.upper.is_nan() { f64::INFINITY } else { piece.upper };
        piece
    }

    /// To one triangle of B; where its residual decides, to the surface it stands for.
    fn to_one(&self, places: &[DVec3; 3], triangle: u32, enough: f64) -> f64 {
        let (other, residual) = (self.b.corners(triangle), self.b.residual(triangle));
        let distance = places.iter().map(|&p| distance_to_triangle(p, other)).fold(0.0, f64::max);
        let upper = distance + residual;
        let residual_decides = upper > enough && distance - residual <= enough && residual > 0.0;
        if residual_decides { upper.min(self.to_one_patch(places, triangle)) } else { upper }
    }

    /// To the part of the surface that lies over the feet of the piece on one triangle for it.
    fn to_one_patch(&self, places: &[DVec3; 3], triangle: u32) -> f64 {
        let other = self.b.corners(triangle);
        let feet = places.map(|p| closest_on_triangle(p, other).1);
        let distances = feet.iter().zip(places).map(|(foot, p)| self.b.point(triangle, *foot).distance(*p));
        distances.fold(0.0, f64::max) + self.b.deviation(triangle, feet)
    }

    /// To the part of the surface between the places nearest to the corners; `None` where that is not near enough.
    fn paired(&self, piece: &Piece, enough: f64) -> Option<f64> {
        let farthest = piece.farthest();
        Some(farthest + self.b.deviation_between(&piece.near, enough - farthest)?)
    }

    fn cut(&self, piece: &Piece, lower: f64, wanted: f64) -> Result<[Piece; 2]> {
        self.cancel.check()?;
        let (side, share) = self.where_to_cut(piece);
        let next = (side + 1) % 3;
        let middle = piece.corners[side].lerp(piece.corners[next], share);
        let place = self.a.point(piece.triangle, middle);
        if !place.is_finite() {
            return Err(not_finite());
        }
        let near = self.near(place, Some(piece.near[side].triangle), lower)?;
        Ok([side, next].map(|replaced| {
            let mut part = Piece { depth: piece.depth + 1, upper: 0.0, ..*piece };
            part.corners[replaced] = middle;
            part.places[replaced] = place;
            part.near[replaced] = near;
            self.bounded(part, lower + wanted)
        }))
    }

    /// The side to cut and where along it: at the border of the triangle of B nearest to its start, where
    /// pieces then lie over one triangle each; else the longest in the middle.
    fn where_to_cut(&self, piece: &Piece) -> (usize, f64) {
        let longest = longest(&piece.places);
        if piece.depth > MOST_ALIGNED_CUTS {
            return (longest, 0.5);
        }
        let differs = |k: usize| piece.near[k].triangle != piece.near[(k + 1) % 3].triangle;
        let border = |k: usize| {
            let (from, to) = (piece.places[k], piece.places[(k + 1) % 3]);
            let forward = leaves(from, to, self.b.corners(piece.near[k].triangle));
            let back = || leaves(to, from, self.b.corners(piece.near[(k + 1) % 3].triangle)).map(|s| 1.0 - s);
            forward.or_else(back).map(|share| (k, share))
        };
        let sides = [longest, (longest + 1) % 3, (longest + 2) % 3];
        sides.into_iter().filter(|&k| differs(k)).find_map(border).unwrap_or((longest, 0.5))
    }
}
