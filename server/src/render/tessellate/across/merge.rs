//! Regions, first each by itself and then joined level by level: the strips along their borders, which must stay while
//! the regions are apart, go when they are one. Every region is measured against the whole mesh that it stands for, so
//! errors of levels do not add.

use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::*;

use super::{
    patch::{Held, Patch, place},
    regions::Regions,
    verdict::{Reference, special_edges},
};
use crate::{
    domain::{Result, mesh::Mesh, surface::Surface},
    oracle::topology,
    render::JobContext,
};

/// Triangles of a region by itself: more adapt less to what is where, fewer have more border.
const SMALL: usize = 4096;
/// Regions are joined up to this size. What of a larger mesh lies along its borders stays.
const LARGE: usize = 1 << 21;
/// Regions are joined eight at a time.
const JOINED: u32 = 3;
/// Errors that are proposed: the tolerance times 2 to half of each of these.
const STEPS: std::ops::Range<i32> = -8..8;

/// What stands for a part of the mesh.
pub(super) struct Simpler {
    /// Of fine vertices of the surface.
    pub(super) triangles: Vec<[u32; 3]>,
    /// The distance to what it stands for is proven to be at most this, mesh-local units.
    pub(super) error: f64,
}

pub(super) struct Merging<'a> {
    job: &'a JobContext<'a>,
    surface: &'a Surface,
    held: Held<'a>,
    tolerance_local: f64,
    /// Of every fine vertex.
    places: Vec<u32>,
    /// Places where sheets meet in a way that a simplifier might not keep.
    fixed: Vec<bool>,
    regions: Regions,
    depth: u32,
}

impl<'a> Merging<'a> {
    pub(super) fn new(job: &'a JobContext<'a>, mesh: &'a Mesh, surface: &'a Surface, tolerance_local: f64) -> Self {
        let (places, of_places) = topology::places(&surface.positions);
        let mut fixed = vec![false; of_places.len()];
        for (ends, ..) in special_edges(&places, &surface.triangles) {
            ends.into_iter().for_each(|place| fixed[place as usize] = true);
        }
        let third = |t: &[u32; 3]| t.iter().map(|v| place(surface, *v)).sum::<DVec3>() / 3.0;
        let centres: Vec<DVec3> = surface.triangles.par_iter().map(third).collect();
        let depth = Regions::depth(centres.len(), SMALL);
        let names: Vec<(&str, usize)> = mesh.attributes.iter().map(|a| (&*a.semantic, a.components)).collect();
        Self {
            job,
            surface,
            held: Held::new(surface, &names, tolerance_local),
            tolerance_local,
            places,
            fixed,
            regions: Regions::new(&centres, depth),
            depth,
        }
    }

    pub(super) fn run(&self) -> Result<Simpler> {
        let least_depth = Regions::depth(self.surface.triangles.len(), LARGE);
        let mut depth = self.depth;
        let mut states: Vec<Simpler> = self.parts(depth).into_iter().map(as_it_is).collect();
        loop {
            states = self.level(depth, states)?;
            if depth == least_depth {
                return Ok(joined(states));
            }
            let next = depth.saturating_sub(JOINED).max(least_depth);
            states = in_lots(states, 1 << (depth - next));
            depth = next;
        }
    }

    /// The triangles of the surface in each region.
    fn parts(&self, depth: u32) -> Vec<Vec<[u32; 3]>> {
        let of = |region: &[u32]| region.iter().map(|t| self.surface.triangles[*t as usize]).collect();
        self.regions.at(depth).into_iter().map(of).collect()
    }

    /// Simplifies each region by itself.
    fn level(&self, depth: u32, states: Vec<Simpler>) -> Result<Vec<Simpler>> {
        let parts = self.parts(depth);
        let border = self.border(&parts);
        let work = |(part, state): (&Vec<[u32; 3]>, &Simpler)| self.simplified(part, state, &border);
        let simpler: Vec<Simpler> = parts.par_iter().zip(&states).map(work).collect::<Result<_>>()?;
        Ok(self.agreed(&border, &parts, states, simpler))
    }

    /// Whether a place is of more than one part.
    fn border(&self, parts: &[Vec<[u32; 3]>]) -> Vec<bool> {
        const NONE: u32 = u32::MAX;
        let mut owner = vec![NONE; self.fixed.len()];
        let mut border = vec![false; self.fixed.len()];
        for (number, part) in (0..).zip(parts) {
            for place in part.as_flattened().iter().map(|v| self.places[*v as usize] as usize) {
                border[place] |= owner[place] != NONE && owner[place] != number;
                owner[place] = number;
            }
        }
        border
    }

    /// The proposal of the largest error that is not refused, or the state as it is.
    fn simplified(&self, part: &[[u32; 3]], state: &Simpler, border: &[bool]) -> Result<Simpler> {
        self.job.cancel.check()?;
        let is_locked = |v: u32| {
            let place = self.places[v as usize] as usize;
            border[place] || self.fixed[place]
        };
        let patch = Patch::new(&self.held, &state.triangles, is_locked);
        let reference = Reference::new(self.surface, &self.places, part, self.tolerance_local);
        let mut best = Simpler { triangles: state.triangles.clone(), error: state.error };
        let (mut good, mut refused) = (STEPS.start - 1, STEPS.end);
        while refused - good > 1 {
            let step = (good + refused).div_euclid(2);
            let triangles = patch.proposal(self.tolerance_local * 2f64.powf(0.5 * f64::from(step)));
            match reference.distance(&triangles, self.job.cancel)? {
                Some(error) => {
                    if triangles.len() < best.triangles.len() {
                        best = Simpler { triangles, error };
                    }
                    good = step;
                }
                None => refused = step,
            }
        }
        self.job.progress.pass("simplify_across", 0, 0);
        Ok(best)
    }

    /// As `simpler`, but for regions that both have made an edge between two places of their border: they stay as they
    /// were, until no edge has triangles of its own in more regions than before.
    fn agreed(
        &self,
        border: &[bool],
        parts: &[Vec<[u32; 3]>],
        mut former: Vec<Simpler>,
        mut simpler: Vec<Simpler>,
    ) -> Vec<Simpler> {
        let most = self.shared_edges(border, parts.iter().map(Vec::as_slice));
        loop {
            let edges = self.shared_edges(border, simpler.iter().map(|s| s.triangles.as_slice()));
            let limit = |edge: &[u32; 2]| most.get(edge).map_or(2, |regions| regions.len().max(2));
            let crowded = edges.iter().filter(|(edge, regions)| regions.len() > limit(edge));
            let mut back: Vec<u32> = crowded.flat_map(|(_, regions)| regions).copied().collect();
            back.sort_unstable();
            back.dedup();
            back.retain(|region| !former[*region as usize].triangles.is_empty());
            if back.is_empty() {
                return simpler;
            }
            for region in back {
                let state = Simpler { triangles: Vec::new(), error: 0.0 };
                simpler[region as usize] = std::mem::replace(&mut former[region as usize], state);
            }
        }
    }

    /// Edges between places of the border: the region of each of their triangles.
    fn shared_edges<'t>(
        &self,
        border: &[bool],
        parts: impl Iterator<Item = &'t [[u32; 3]]>,
    ) -> HashMap<[u32; 2], Vec<u32>> {
        let mut edges: HashMap<[u32; 2], Vec<u32>> = HashMap::new();
        for (number, part) in (0..).zip(parts) {
            for triangle in part {
                let [a, b, c] = triangle.map(|v| self.places[v as usize]);
                for (a, b) in [(a, b), (b, c), (c, a)] {
                    if border[a as usize] && border[b as usize] {
                        edges.entry([a.min(b), a.max(b)]).or_default().push(number);
                    }
                }
            }
        }
        edges
    }
}

fn as_it_is(triangles: Vec<[u32; 3]>) -> Simpler {
    Simpler { triangles, error: 0.0 }
}

fn joined(states: Vec<Simpler>) -> Simpler {
    let error = states.iter().fold(0.0, |most: f64, state| most.max(state.error));
    Simpler { triangles: states.into_iter().flat_map(|state| state.triangles).collect(), error }
}

fn in_lots(states: Vec<Simpler>, count: usize) -> Vec<Simpler> {
    let mut states = states.into_iter();
    let next = || {
        let lot: Vec<Simpler> = states.by_ref().take(count).collect();
        (!lot.is_empty()).then(|| joined(lot))
    };
    std::iter::from_fn(next).collect()
}
