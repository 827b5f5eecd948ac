//! Twin of the `collapse_*` passes: vertices that the tolerance does not need are drawn into a neighbour, within their
//! base triangle or along their base edge, many at once. Every new triangle keeps the bound, so texture coordinates,
//! materials and seams stay exact.

use std::cmp::Ordering;

use glam::DVec3;

use super::{
    bound::{Asked, bound},
    place::{Places, share_of},
    refine::barycentrics,
};
use crate::layout::refine::{RefinedTriangle, RefinedVertex, kind};

/// A refined mesh being simplified.
#[derive(Clone, Debug, Default)]
pub struct Simplified {
    pub vertices: Vec<RefinedVertex>,
    /// Displaced, by vertex.
    pub positions: Vec<DVec3>,
    pub triangles: Vec<Facet>,
}

/// A triangle of the result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Facet {
    pub gv: [u32; 3],
    pub base: u32,
}

impl From<&RefinedTriangle> for Facet {
    fn from(triangle: &RefinedTriangle) -> Self {
        Self { gv: triangle.gv, base: triangle.base }
    }
}

/// What is known of drawing a vertex into a neighbour; errors are shares of the tolerance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Candidate {
    /// It may not go anywhere.
    #[default]
    None,
    /// Any way costs at least this.
    AtLeast { error: f64 },
    /// The largest error of the triangles that come of drawing it there, the way that costs least.
    To { vertex: u32, error: f64 },
}

impl Candidate {
    /// No less than what is known.
    #[must_use]
    pub fn error(&self) -> Option<f64> {
        match self {
            Self::None => None,
            Self::AtLeast { error } | Self::To { error, .. } => Some(*error),
        }
    }
}

/// A triangle at a vertex, which is its first corner.
struct Around {
    facet: Facet,
    /// Barycentrics in its base triangle.
    units: [[u32; 3]; 3],
    /// Displaced.
    corners: [DVec3; 3],
}

/// A vertex drawn into another.
struct Move {
    to: u32,
    /// Of the triangles around, those that stay.
    facets: Vec<Facet>,
    /// The error is no less.
    least: f64,
}

/// Triangles around each vertex, ascending.
#[derive(Clone, Debug, Default)]
pub struct Stars {
    pub first: Vec<u32>,
    pub items: Vec<u32>,
}

/// More triangles than this around a vertex, and it stays.
pub const MOST_AROUND: usize = 64;
/// A triangle that faces away from its base may turn so far: half its old direction.
const LEAST_TURN: f64 = 0.5;

impl Stars {
    #[must_use]
    pub fn new(vertices: usize, facets: &[Facet]) -> Self {
        let mut first = vec![0u32; vertices + 1];
        facets.iter().flat_map(|f| f.gv).for_each(|gv| first[gv as usize + 1] += 1);
        for v in 0..vertices {
            first[v + 1] += first[v];
        }
        let mut next = first.clone();
        let mut items = vec![0; 3 * facets.len()];
        for (t, facet) in (0..).zip(facets) {
            for gv in facet.gv {
                items[next[gv as usize] as usize] = t;
                next[gv as usize] += 1;
            }
        }
        Self { first, items }
    }

    #[must_use]
    pub fn of(&self, vertex: u32) -> &[u32] {
        &self.items[self.first[vertex as usize] as usize..self.first[vertex as usize + 1] as usize]
    }
}

/// Everything a candidate is judged by.
pub struct Judge<'j> {
    pub places: &'j Places<'j>,
    pub asked: Asked,
    pub mesh: &'j Simplified,
    pub stars: &'j Stars,
    /// What a triangle with these displaced corners may be off by.
    pub tolerance: &'j (dyn Fn([DVec3; 3]) -> f64 + Sync),
}

impl Judge<'_> {
    /// What is quickly known: what is lost at the vertex itself.
    #[must_use]
    pub fn estimate(&self, vertex: u32) -> Candidate {
        self.moves(vertex).first().map_or(Candidate::None, |first| Candidate::AtLeast { error: first.least })
    }

    /// The neighbour that costs least, of equal ones the first.
    #[must_use]
    pub fn candidate(&self, vertex: u32) -> Candidate {
        let mut best: Option<(u32, f64)> = None;
        for planned in self.moves(vertex) {
            let most = best.map_or(1.0, |(_, error)| error);
            if planned.least > most || best.is_some() && planned.least == most {
                break;
            }
            let found = self.error(&planned, most).filter(|error| best.is_none() || *error < most);
            best = found.map(|error| (planned.to, error)).or(best);
        }
        best.map_or(Candidate::None, |(vertex, error)| Candidate::To { vertex, error })
    }

    /// The ways it may go, the one that loses least at the vertex itself first.
    fn moves(&self, vertex: u32) -> Vec<Move> {
        let star = self.stars.of(vertex);
        if self.mesh.vertices[vertex as usize].kind == kind::CORNER || star.is_empty() || star.len() > MOST_AROUND {
            return Vec::new();
        }
        let star: Vec<Around> = star.iter().map(|t| self.around_vertex(*t, vertex)).collect();
        let mut moves: Vec<Move> =
            neighbours(&star).into_iter().filter_map(|to| self.planned(&star, vertex, to)).collect();
        moves.sort_by(|a, b| (a.least, a.to).partial_cmp(&(b.least, b.to)).unwrap_or(Ordering::Equal));
        moves
    }

    fn around_vertex(&self, t: u32, vertex: u32) -> Around {
        let facet = self.mesh.triangles[t as usize];
        let k = facet.gv.iter().position(|gv| *gv == vertex).unwrap_or(0);
        self.around(Facet { gv: [facet.gv[k], facet.gv[(k + 1) % 3], facet.gv[(k + 2) % 3]], ..facet })
    }

    fn around(&self, facet: Facet) -> Around {
        Around { facet, units: self.units(&facet), corners: self.corners(&facet) }
    }

    /// Whether the vertex may go there at all: along its base edge, and with as many triangles vanishing as there are
    /// sheets around.
    fn is_open(&self, star: &[Around], moving: &RefinedVertex, to: u32) -> bool {
        let target = &self.mesh.vertices[to as usize];
        let shared = star.iter().filter(|around| around.facet.gv.contains(&to)).count();
        if moving.kind == kind::INTERIOR {
            return shared == 2;
        }
        let along = match target.kind {
            kind::CORNER => self.places.base.edges[moving.owner as usize].contains(&target.owner),
            kind::EDGE => target.owner == moving.owner,
            _ => false,
        };
        along && shared == sheets(star)
    }

    /// What becomes of the triangles around with the vertex at `to`; none where it may not go there, where one would turn
    /// over, or where the place it leaves would be too far off.
    fn planned(&self, star: &[Around], vertex: u32, to: u32) -> Option<Move> {
        if !self.is_open(star, &self.mesh.vertices[vertex as usize], to) {
            return None;
        }
        let mut planned = Move { to, facets: Vec::with_capacity(star.len()), least: 0.0 };
        for around in star.iter().filter(|around| !around.facet.gv.contains(&to)) {
            let [_, b, c] = around.facet.gv;
            let after = self.around(Facet { gv: [to, b, c], ..around.facet });
            if twice_area(after.units) <= 0 || !self.faces_as(around, &after) {
                return None;
            }
            planned.least = planned.least.max(self.lost(around, &after));
            planned.facets.push(after.facet);
        }
        (planned.least <= 1.0).then_some(planned)
    }

    /// How far the place of the vertex is from a triangle that now lies over it, as a share of the tolerance.
    fn lost(&self, before: &Around, after: &Around) -> f64 {
        let [a, b, c] = after.units;
        let left = before.units[0];
        let (beyond_b, beyond_c) = (twice_area([a, left, c]), twice_area([a, b, left]));
        if beyond_b < 0 || beyond_c < 0 {
            return 0.0;
        }
        let at_a = twice_area([left, b, c]);
        let whole = (at_a + beyond_b + beyond_c) as f64;
        let shares = [at_a, beyond_b, beyond_c].map(|share| share as f64 / whole);
        let flat: DVec3 = (0..3).map(|k| after.corners[k] * shares[k]).sum();
        flat.distance(before.corners[0]) / (self.tolerance)(after.corners)
    }

    /// The largest error of the triangles that come of it; none above `most`.
    fn error(&self, planned: &Move, most: f64) -> Option<f64> {
        let mut worst = 0.0;
        for facet in &planned.facets {
            let error = self.error_of(facet, most);
            if error > most {
                return None;
            }
            worst = error.max(worst);
        }
        Some(worst)
    }

    /// As a share of the tolerance; anything above `most` where it is above.
    #[must_use]
    pub fn error_of(&self, facet: &Facet, most: f64) -> f64 {
        let corners = self.units(facet).map(share_of);
        let tolerance = (self.tolerance)(self.corners(facet));
        bound(self.places, self.asked, facet.base, corners, tolerance, most)
    }

    fn corners(&self, facet: &Facet) -> [DVec3; 3] {
        facet.gv.map(|gv| self.mesh.positions[gv as usize])
    }

    fn units(&self, facet: &Facet) -> [[u32; 3]; 3] {
        let base = &self.places.base.triangles[facet.base as usize];
        facet.gv.map(|gv| barycentrics(&self.mesh.vertices[gv as usize], base))
    }

    /// Whether a triangle may take the place of another: it runs the same way in its base triangle, and faces as that
    /// does or nearly as the old one did.
    pub(super) fn may_follow(&self, before: &Facet, after: &Facet) -> bool {
        let [before, after] = [before, after].map(|facet| self.around(*facet));
        twice_area(after.units) > 0 && self.faces_as(&before, &after)
    }

    fn faces_as(&self, before: &Around, after: &Around) -> bool {
        let facing = self.places.tables.triangle_facing[after.facet.base as usize];
        let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
        let new = normal(after.corners);
        if new.dot(DVec3::from_array(facing.map(f64::from))) > 0.0 {
            return true;
        }
        let old = normal(before.corners);
        new.dot(old) > LEAST_TURN * new.length() * old.length()
    }
}

/// All vertices of a star but the one in its middle, ascending.
fn neighbours(star: &[Around]) -> Vec<u32> {
    let mut neighbours: Vec<u32> = star.iter().flat_map(|around| [around.facet.gv[1], around.facet.gv[2]]).collect();
    neighbours.sort_unstable();
    neighbours.dedup();
    neighbours
}

/// Base triangles around: as many as have a triangle in the star.
fn sheets(star: &[Around]) -> usize {
    let mut bases: Vec<u32> = star.iter().map(|around| around.facet.base).collect();
    bases.sort_unstable();
    bases.dedup();
    bases.len()
}

/// In square units of the base triangle; above 0 where it runs the same way.
fn twice_area(corners: [[u32; 3]; 3]) -> i64 {
    let [a, b, c] = corners.map(|b| [i64::from(b[1]), i64::from(b[2])]);
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

impl Simplified {
    /// Whether a vertex comes before all its neighbours: by error, then by mixed numbers, so that along a row not each
    /// waits for the next.
    #[must_use]
    pub fn comes_first(&self, stars: &Stars, candidates: &[Candidate], vertex: u32, round: u32) -> bool {
        let mixed = |v: u32| (v ^ round.wrapping_mul(0x85EB_CA6B)).wrapping_mul(0x9E37_79B1);
        let Some(error) = candidates[vertex as usize].error() else { return false };
        let mut around = stars.of(vertex).iter().flat_map(|t| self.triangles[*t as usize].gv);
        around.all(|other| {
            let of_other = candidates[other as usize].error();
            other == vertex || of_other.is_none_or(|of_other| (error, mixed(vertex)) < (of_other, mixed(other)))
        })
    }

    /// Draws the selected vertices into theirs. Returns the vertices around, whose candidates are no longer right.
    pub fn apply(&mut self, stars: &Stars, candidates: &[Candidate], selected: &[u32]) -> Vec<u32> {
        let mut touched = Vec::new();
        let mut gone = vec![false; self.triangles.len()];
        for &vertex in selected {
            let Candidate::To { vertex: to, .. } = candidates[vertex as usize] else { continue };
            for t in stars.of(vertex) {
                let facet = &mut self.triangles[*t as usize];
                touched.extend(facet.gv);
                gone[*t as usize] |= facet.gv.contains(&to);
                facet.gv = facet.gv.map(|gv| if gv == vertex { to } else { gv });
            }
        }
        let mut t = 0;
        self.triangles.retain(|_| {
            t += 1;
            !gone[t - 1]
        });
        touched.sort_unstable();
        touched.dedup();
        touched
    }
}
