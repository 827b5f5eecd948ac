//! Simplification: rounds of collapses, then flips that let more vertices go.

use displace_glsl::reference::collapse::{Candidate, Simplified, Stars};
use rayon::prelude::*;

use super::Work;
use crate::domain::Result;

/// Rounds of flips before vertices are tried again.
pub(super) const FLIP_ROUNDS: u32 = 3;
/// Each round draws in at least one vertex; a mesh that needs more rounds than this is good enough.
pub(super) const MOST_ROUNDS: u32 = 1000;

impl Work<'_> {
    /// Collapses all that can be, then flips and collapses again `sweeps` times. Returns the rounds of collapses.
    pub(super) fn simplify(&self, mesh: &mut Simplified, sweeps: u32) -> Result<u32> {
        let mut candidates = vec![Candidate::None; mesh.vertices.len()];
        let mut rounds = 0;
        self.collapse(mesh, &mut candidates, (0..mesh.vertices.len() as u32).collect(), &mut rounds)?;
        for _ in 0..sweeps {
            let touched = self.flip(mesh)?;
            if touched.is_empty() {
                break;
            }
            self.collapse(mesh, &mut candidates, touched, &mut rounds)?;
        }
        Ok(rounds)
    }

    fn collapse(
        &self,
        mesh: &mut Simplified,
        candidates: &mut [Candidate],
        mut dirty: Vec<u32>,
        rounds: &mut u32,
    ) -> Result<()> {
        while *rounds < MOST_ROUNDS {
            self.job.cancel.check()?;
            self.job.progress.pass("collapse", u64::from(*rounds), u64::from(*rounds) + 1);
            let stars = Stars::new(mesh.vertices.len(), &mesh.triangles);
            let selected = self.select(mesh, &stars, candidates, &dirty, *rounds);
            if selected.is_empty() {
                break;
            }
            dirty = mesh.apply(&stars, candidates, &selected);
            selected.iter().for_each(|vertex| candidates[*vertex as usize] = Candidate::None);
            *rounds += 1;
        }
        Ok(())
    }

    /// The vertices that come before their neighbours. Only where estimates decide between them are errors found out.
    fn select(
        &self,
        mesh: &Simplified,
        stars: &Stars,
        candidates: &mut [Candidate],
        dirty: &[u32],
        round: u32,
    ) -> Vec<u32> {
        self.judged(mesh, stars, |judge| {
            fill(candidates, dirty, dirty.par_iter().map(|vertex| judge.estimate(*vertex)).collect());
            loop {
                let known: &[Candidate] = candidates;
                let first = |vertex: &u32| mesh.comes_first(stars, known, *vertex, round);
                let first: Vec<u32> = (0..candidates.len() as u32).into_par_iter().filter(first).collect();
                let is_estimate = |vertex: &u32| matches!(known[*vertex as usize], Candidate::AtLeast { .. });
                let (unsure, sure): (Vec<u32>, Vec<u32>) = first.into_iter().partition(is_estimate);
                if unsure.is_empty() {
                    return sure;
                }
                fill(candidates, &unsure, unsure.par_iter().map(|vertex| judge.candidate(*vertex)).collect());
            }
        })
    }

    /// Returns the vertices around which triangles changed.
    fn flip(&self, mesh: &mut Simplified) -> Result<Vec<u32>> {
        let mut all = Vec::new();
        for _ in 0..FLIP_ROUNDS {
            self.job.cancel.check()?;
            let stars = Stars::new(mesh.vertices.len(), &mesh.triangles);
            let flips: Vec<_> = self.judged(mesh, &stars, |judge| {
                let errors: Vec<f64> = mesh.triangles.par_iter().map(|facet| judge.error_of(facet, 1.0)).collect();
                (0..mesh.triangles.len() as u32).into_par_iter().map(|t| judge.flip(t, &errors)).collect()
            });
            let touched = mesh.flip(&flips);
            if touched.is_empty() {
                break;
            }
            all.extend(touched);
        }
        let stars = Stars::new(mesh.vertices.len(), &mesh.triangles);
        let around = |vertex: &u32| stars.of(*vertex).iter().flat_map(|t| mesh.triangles[*t as usize].gv);
        let mut around: Vec<u32> = all.iter().flat_map(around).collect();
        around.sort_unstable();
        around.dedup();
        Ok(around)
    }
}

fn fill(candidates: &mut [Candidate], of: &[u32], found: Vec<Candidate>) {
    of.iter().zip(found).for_each(|(vertex, found)| candidates[*vertex as usize] = found);
}
