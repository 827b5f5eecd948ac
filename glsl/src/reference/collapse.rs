//! Twin of the `collapse_*` passes: vertices that the tolerance does not need are drawn into a neighbour, within their
//! base triangle or along their base edge, many at once. Every new triangle keeps the bound, so texture coordinates,
//! materials and seams stay exact.

use std::cmp::Ordering;

use glam::DVec3;

use super::{
    bound::{Asked, bound},
    place::{Places, share_of},
    refine::{Base, barycentrics},
};
use crate::layout::refine::{RefineBase, RefinedTriangle, RefinedVertex, kind};

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

/// Where a vertex would go, and the largest error of the triangles that come of it, as a share of the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    pub to: u32,
    pub error: f64,
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
pub struct Judge<'j, T> {
    pub places: &'j Places<'j>,
    pub asked: Asked,
    pub mesh: &'j Simplified,
    pub stars: &'j Stars,
    /// What a triangle with these displaced corners may be off by.
    pub tolerance: T,
}

impl<T: Fn([DVec3; 3]) -> f64> Judge<'_, T> {
    /// The neighbour that costs least, of equal ones the first.
    #[must_use]
    pub fn candidate(&self, vertex: u32) -> Option<Candidate> {
        let star = self.stars.of(vertex);
        let moving = &self.mesh.vertices[vertex as usize];
        if moving.kind == kind::CORNER || star.is_empty() || star.len() > MOST_AROUND {
            return None;
        }
        let mut open: Vec<Move> =
            self.neighbours(vertex).into_iter().filter_map(|to| self.planned(star, vertex, to)).collect();
        // What is lost at the vertex itself is quickly known, and never more than what is lost.
        open.sort_by(|a, b| (a.least, a.to).partial_cmp(&(b.least, b.to)).unwrap_or(Ordering::Equal));
        let mut best: Option<Candidate> = None;
        for planned in open {
            let most = best.map_or(1.0, |best| best.error);
            if planned.least > most || best.is_some() && planned.least == most {
                break;
            }
            let found = self.error(&planned, most).filter(|error| best.is_none() || *error < most);
            best = found.map(|error| Candidate { to: planned.to, error }).or(best);
        }
        best
    }

    /// Ascending.
    fn neighbours(&self, vertex: u32) -> Vec<u32> {
        let around = self.stars.of(vertex).iter().flat_map(|t| self.mesh.triangles[*t as usize].gv);
        let mut neighbours: Vec<u32> = around.filter(|gv| *gv != vertex).collect();
        neighbours.sort_unstable();
        neighbours.dedup();
        neighbours
    }

    /// Whether the vertex may go there at all: along its base edge, and with as many triangles vanishing as there are
    /// sheets around.
    fn is_open(&self, star: &[u32], moving: &RefinedVertex, to: u32) -> bool {
        let target = &self.mesh.vertices[to as usize];
        let shared = star.iter().filter(|t| self.mesh.triangles[**t as usize].gv.contains(&to)).count();
        if moving.kind == kind::INTERIOR {
            return shared == 2;
        }
        let along = match target.kind {
            kind::CORNER => self.base().edges[moving.owner as usize].contains(&target.owner),
            kind::EDGE => target.owner == moving.owner,
            _ => false,
        };
        along && shared == sheets(self.mesh, star)
    }

    fn base(&self) -> &Base {
        self.places.base
    }

    /// What becomes of the triangles around with the vertex at `to`; none where it may not go there, where one would turn
    /// over, or where the place it leaves would be too far off.
    fn planned(&self, star: &[u32], vertex: u32, to: u32) -> Option<Move> {
        if !self.is_open(star, &self.mesh.vertices[vertex as usize], to) {
            return None;
        }
        let mut planned = Move { to, facets: Vec::with_capacity(star.len()), least: 0.0 };
        for t in star {
            let facet = &self.mesh.triangles[*t as usize];
            if facet.gv.contains(&to) {
                continue;
            }
            let gv = facet.gv.map(|gv| if gv == vertex { to } else { gv });
            let after = Facet { gv, ..*facet };
            if !self.is_upright(&after) || !self.faces_as(facet, &after) {
                return None;
            }
            planned.least = planned.least.max(self.lost(vertex, &after));
            planned.facets.push(after);
        }
        (planned.least <= 1.0).then_some(planned)
    }

    /// How far the place of the vertex is from a triangle that now lies over it, as a share of the tolerance.
    fn lost(&self, vertex: u32, facet: &Facet) -> f64 {
        let base = &self.base().triangles[facet.base as usize];
        let [a, b, c] = self.units(facet, base);
        let left = barycentrics(&self.mesh.vertices[vertex as usize], base);
        let shares = [twice_area([left, b, c]), twice_area([a, left, c]), twice_area([a, b, left])];
        if shares.iter().any(|share| *share < 0) {
            return 0.0;
        }
        let whole: i64 = shares.iter().sum();
        let corners = self.corners(facet);
        let flat: DVec3 = (0..3).map(|k| corners[k] * (shares[k] as f64 / whole as f64)).sum();
        flat.distance(self.mesh.positions[vertex as usize]) / (self.tolerance)(corners)
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
        let base = &self.base().triangles[facet.base as usize];
        let corners = self.units(facet, base).map(share_of);
        let tolerance = (self.tolerance)(self.corners(facet));
        bound(self.places, self.asked, facet.base, corners, tolerance * most) / tolerance
    }

    fn corners(&self, facet: &Facet) -> [DVec3; 3] {
        facet.gv.map(|gv| self.mesh.positions[gv as usize])
    }

    fn units(&self, facet: &Facet, base: &RefineBase) -> [[u32; 3]; 3] {
        facet.gv.map(|gv| barycentrics(&self.mesh.vertices[gv as usize], base))
    }

    pub(super) fn is_upright(&self, facet: &Facet) -> bool {
        twice_area(self.units(facet, &self.base().triangles[facet.base as usize])) > 0
    }

    /// A new triangle faces as its base does, or nearly as the old one did.
    pub(super) fn faces_as(&self, before: &Facet, after: &Facet) -> bool {
        let facing = DVec3::from_array(self.places.tables.triangle_facing[after.base as usize].map(f64::from));
        let [old, new] = [before, after].map(|facet| {
            let [a, b, c] = self.corners(facet);
            (b - a).cross(c - a)
        });
        new.dot(facing) > 0.0 || new.dot(old) > LEAST_TURN * new.length() * old.length()
    }
}

/// In square units of the base triangle; above 0 where it runs the same way.
fn twice_area(corners: [[u32; 3]; 3]) -> i64 {
    let [a, b, c] = corners.map(|b| [i64::from(b[1]), i64::from(b[2])]);
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Base triangles around: as many as have a triangle in the star.
fn sheets(mesh: &Simplified, star: &[u32]) -> usize {
    let mut bases: Vec<u32> = star.iter().map(|t| mesh.triangles[*t as usize].base).collect();
    bases.sort_unstable();
    bases.dedup();
    bases.len()
}

/// Whether a candidate comes before another: by error, then by mixed numbers, so that along a row not each waits for the
/// next.
#[must_use]
pub fn comes_first(vertex: u32, candidate: &Candidate, other: u32, of_other: &Candidate, round: u32) -> bool {
    let mixed = |v: u32| (v ^ round.wrapping_mul(0x85EB_CA6B)).wrapping_mul(0x9E37_79B1);
    (candidate.error, mixed(vertex)) < (of_other.error, mixed(other))
}

impl Simplified {
    /// The vertices whose candidate comes before those of all neighbours.
    #[must_use]
    pub fn selected(&self, stars: &Stars, candidates: &[Option<Candidate>], round: u32) -> Vec<u32> {
        let first = |vertex: u32, candidate: &Candidate| {
            let around = stars.of(vertex).iter().flat_map(|t| self.triangles[*t as usize].gv);
            around.filter(|other| *other != vertex).all(|other| {
                let of_other = candidates[other as usize].as_ref();
                of_other.is_none_or(|of_other| comes_first(vertex, candidate, other, of_other, round))
            })
        };
        let all = (0..).zip(candidates);
        all.filter_map(|(v, c)| c.as_ref().filter(|c| first(v, c)).map(|_| v)).collect()
    }

    /// Draws the selected vertices into theirs. Returns the vertices around, whose candidates are no longer right.
    pub fn apply(&mut self, stars: &Stars, candidates: &[Option<Candidate>], selected: &[u32]) -> Vec<u32> {
        let mut touched = Vec::new();
        let mut gone = vec![false; self.triangles.len()];
        for &vertex in selected {
            let Some(Candidate { to, .. }) = candidates[vertex as usize] else { continue };
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
