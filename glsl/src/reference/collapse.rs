//! Twin of the `collapse_*` passes: vertices that the tolerance does not need are drawn into a neighbour, within their
//! base triangle or along their base edge, many at once. Every new triangle keeps the bound, so texture coordinates,
//! materials and seams stay exact.

mod found;
mod judge;
mod nearby;
mod star;

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use super::{bound::MapPlace, keys, place::Places};
use crate::layout::refine::{RefinedTriangle, RefinedVertex};
pub use found::Found;
pub use judge::Judge;

/// A refined mesh being simplified.
#[derive(Clone, Debug, Default)]
pub struct Simplified {
    pub vertices: Vec<RefinedVertex>,
    /// Displaced, by vertex.
    pub positions: Vec<DVec3>,
    pub triangles: Vec<Facet>,
    /// Of vertices; see [`keys`].
    pub keys: Vec<u32>,
    /// Of vertices within base triangles that have one map alone; nothing of others.
    pub in_map: Vec<MapPlace>,
    /// Errors of its triangles; copies of the mesh share them.
    pub found: Arc<Found>,
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
    /// It may go, and is guessed to cost this.
    Guess { error: f64 },
    /// The largest error of the triangles that come of drawing it there, the way that costs least.
    To { vertex: u32, error: f64 },
}

impl Candidate {
    /// What is known, or guessed.
    #[must_use]
    pub fn error(&self) -> Option<f64> {
        match self {
            Self::None => None,
            Self::Guess { error } | Self::To { error, .. } => Some(*error),
        }
    }
}

/// Triangles around each vertex, ascending.
#[derive(Clone, Debug, Default)]
pub struct Stars {
    pub first: Vec<u32>,
    pub items: Vec<u32>,
}

/// More triangles than this around a vertex, and it stays.
pub const MOST_AROUND: usize = 64;
/// Errors nearer than this share of the tolerance count as equal: rounding must not decide which vertex goes first.
const NEAR: f64 = 1.0 / (1 << 24) as f64;

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

/// The turn of a vertex that stays.
pub const NEVER: u64 = u64::MAX;

/// An error as whole numbers of [`NEAR`].
#[must_use]
pub fn rank(error: f64) -> u64 {
    (error / NEAR).round() as u64
}

impl Simplified {
    /// With what rounds of collapses read again and again of its vertices: their keys, and where they lie in the map.
    /// What lies side by side gets numbers side by side, and so lies in memory.
    #[must_use]
    pub fn prepared(mut self, places: &Places<'_>) -> Self {
        nearby::sort(&mut self);
        let keys = self.vertices.par_iter().map(|vertex| keys::of(vertex, places.base)).collect();
        let in_map = self.vertices.par_iter().map(|vertex| places.vertex_in_map(vertex)).collect();
        Self { keys, in_map, found: Arc::default(), ..self }
    }

    /// What a vertex comes before its neighbours by: the error, then its mixed key, so that along a row not each waits for
    /// the next. Those that may not go come last.
    #[must_use]
    pub fn turn(&self, vertex: u32, candidate: &Candidate, round: u32) -> u64 {
        let mixed = || u64::from(keys::mixed(self.keys[vertex as usize] ^ round));
        candidate.error().map_or(NEVER, |error| rank(error) << 32 | mixed())
    }

    /// Whether the vertex comes before all its neighbours.
    #[must_use]
    pub fn comes_first(&self, stars: &Stars, turns: &[u64], vertex: u32) -> bool {
        let own = (turns[vertex as usize], vertex);
        let is_later = |other: &u32| own < (turns[*other as usize], *other) || *other == vertex;
        own.0 != NEVER && stars.of(vertex).iter().all(|t| self.triangles[*t as usize].gv.iter().all(is_later))
    }

    /// These vertices and their neighbours, each once; `seen` is false of all vertices, before and after.
    #[must_use]
    pub fn around(&self, stars: &Stars, vertices: &[u32], seen: &mut [bool]) -> Vec<u32> {
        let mut around = Vec::with_capacity(7 * vertices.len());
        for t in vertices.iter().flat_map(|vertex| stars.of(*vertex)) {
            for gv in self.triangles[*t as usize].gv {
                if !std::mem::replace(&mut seen[gv as usize], true) {
                    around.push(gv);
                }
            }
        }
        around.iter().for_each(|gv| seen[*gv as usize] = false);
        around
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
