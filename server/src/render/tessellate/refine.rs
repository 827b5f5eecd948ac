//! Refinement: rounds of longest-edge bisection where the bound is not kept.

use displace_glsl::{
    layout::refine::RefinedTriangle,
    reference::{
        bound::{MapPlace, bound_in_map},
        collapse::{Facet, Simplified},
        place::share_of,
        refine::{Refined, barycentrics, longest_side, marks},
    },
};
use rayon::prelude::*;

use super::Work;
use crate::{domain::Result, render::passes};

/// A mesh that has grown by rounds.
pub(super) struct Grown {
    pub(super) mesh: Simplified,
    pub(super) rounds: u32,
    pub(super) mismatch: f64,
    /// Of vertices, where refinement needs it; see `Places::vertex_in_map`.
    pub(super) in_map: Vec<MapPlace>,
}

/// States of triangles.
const NEW: u32 = 0;
const GOOD: u32 = 1;
const BAD: u32 = 2;
/// Within the tolerance, and not within the share of it that is asked for.
const FAIR: u32 = 3;
/// Where a surface jumps no triangle is near it all over. One that is as small as this share of the tolerance is let be.
const JUMP: f64 = 0.25;

impl Work<'_> {
    /// Every triangle within the tolerance, and, if no more than `most_finer` are, within `share` of it; none where that
    /// takes more than `limit` triangles.
    pub(super) fn refine(&self, share: f64, most_finer: usize, limit: u64) -> Result<Option<Grown>> {
        let mut refined = Refined::of(self.places.base);
        let mut grown = self.start()?;
        let mut finer = false;
        loop {
            self.job.cancel.check()?;
            self.job.progress.pass("refine", u64::from(grown.rounds), u64::from(grown.rounds) + 1);
            let wanted = self.wanted(&mut refined, &grown, share, finer);
            let marks = marks(&refined, &wanted);
            let added: u64 = refined.triangles.iter().flat_map(|t| t.ge).map(|ge| u64::from(marks[ge as usize])).sum();
            let fits = refined.triangles.len() as u64 + added <= limit;
            if !fits && !finer {
                return Ok(None);
            }
            if added == 0 && !finer && refined.triangles.len() <= most_finer {
                finer = true;
                continue;
            }
            if !fits || added == 0 || !refined.halves_exactly(self.places.base, &marks) {
                grown.mesh.triangles = refined.triangles.iter().map(Facet::from).collect();
                grown.mesh.vertices = refined.vertices;
                return Ok(Some(grown));
            }
            refined = refined.split(self.places.base, &marks);
            grown.rounds += 1;
            self.place(&refined, &mut grown)?;
        }
    }

    /// The base mesh, displaced.
    pub(super) fn start(&self) -> Result<Grown> {
        let refined = Refined::of(self.places.base);
        let triangles = refined.triangles.iter().map(Facet::from).collect();
        let mesh = Simplified { vertices: refined.vertices.clone(), triangles, ..Simplified::default() };
        let mut grown = Grown { mesh, rounds: 0, mismatch: self.places.mismatch, in_map: Vec::new() };
        self.place(&refined, &mut grown)?;
        Ok(grown)
    }

    /// Displaces the vertices that are new.
    pub(super) fn place(&self, refined: &Refined, grown: &mut Grown) -> Result<()> {
        let new = &refined.vertices[grown.mesh.positions.len()..];
        let placed: Vec<_> = new.par_iter().map(|vertex| self.places.vertex(vertex)).collect();
        grown.mismatch = placed.iter().fold(grown.mismatch, |most, (_, mismatch)| most.max(*mismatch));
        let broken = placed.iter().filter(|(position, _)| !position.as_vec3().is_finite()).count();
        grown.mesh.positions.extend(placed.into_iter().map(|(position, _)| position));
        grown.in_map.par_extend(new.par_iter().map(|vertex| self.places.vertex_in_map(vertex)));
        passes::check_finite(self.mesh, broken as u64)
    }

    /// 1 for each triangle that is to be split, fair ones where it is to be `finer`; states of new ones are found out.
    fn wanted(&self, refined: &mut Refined, grown: &Grown, share: f64, finer: bool) -> Vec<u32> {
        let mut states = std::mem::take(&mut refined.states);
        let new = states.par_iter_mut().zip(&refined.triangles).filter(|(state, _)| **state == NEW);
        new.for_each(|(state, triangle)| *state = self.state(refined, grown, triangle, share));
        refined.states = states;
        let is_wanted = |state: u32| state == BAD || finer && state == FAIR;
        refined.states.iter().map(|state| u32::from(is_wanted(*state))).collect()
    }

    fn state(&self, refined: &Refined, grown: &Grown, triangle: &RefinedTriangle, share: f64) -> u32 {
        let base = &self.places.base.triangles[triangle.base as usize];
        let corners = triangle.gv.map(|gv| share_of(barycentrics(&refined.vertices[gv as usize], base)));
        let in_map = std::array::from_fn(|k| {
            let known = grown.in_map[triangle.gv[k] as usize];
            if known.is_known() { known } else { self.places.in_map(triangle.base, corners[k]) }
        });
        let whole = self.tolerance(triangle.gv.map(|gv| grown.mesh.positions[gv as usize]));
        let error = bound_in_map(self.places, self.asked, triangle.base, corners, in_map, whole, 1.0);
        let longest = refined.edges[triangle.ge[longest_side(&refined.edges, triangle)] as usize].length_square;
        let is_speck = || f64::from(longest).sqrt() < JUMP * whole;
        match error {
            _ if error <= share => GOOD,
            _ if error <= 1.0 => FAIR,
            _ if error == f64::INFINITY && is_speck() => GOOD,
            _ => BAD,
        }
    }
}
