//! Simplification: rounds of collapses, then flips that let more vertices go.

use displace_glsl::reference::{
    collapse::{Candidate, Judge, Simplified, Stars},
    flip::Flip,
    keys,
};
use rayon::prelude::*;

use super::Work;
use crate::domain::Result;

/// Rounds of flips before vertices are tried again.
pub(super) const FLIP_ROUNDS: u32 = 3;
/// Each round draws in at least one vertex; a mesh that needs more rounds than this is good enough.
pub(super) const MOST_ROUNDS: u32 = 1000;
/// A vertex is guessed to cost this share of what it cost before its neighbours changed.
const SHARE_OF_BEFORE: f64 = 0.95;
/// What vertices that could not go count as, as a share of the tolerance: they are tried again after cheaper neighbours.
const TOO_DEAR: f64 = 1.0;

/// Of more triangles, a vertex whose guess comes first goes if it may at all, whatever it turns out to cost: finding out
/// about its neighbours too takes a tenth of the instructions and saves a hundredth of the triangles. Below, the order of
/// what is left decides how few there can be.
const MANY: usize = 3 << 14;

/// What is known of each vertex.
struct Known {
    candidates: Vec<Candidate>,
    /// What those that were asked about may cost, as a share of the tolerance: what is lost at the vertex, or a share of the
    /// cost once that was found out. Old guesses stand: triangles only grow, and what was dear is seldom cheap later.
    guesses: Vec<Option<f64>>,
}

impl Known {
    fn none(vertices: usize) -> Self {
        Self { candidates: vec![Candidate::None; vertices], guesses: vec![None; vertices] }
    }

    /// Of vertices around which triangles changed.
    fn guess(&mut self, judge: &Judge<'_>, dirty: &[u32]) {
        let guess = |vertex: &u32| self.guesses[*vertex as usize].or_else(|| judge.least(*vertex));
        let found: Vec<Option<f64>> = dirty.par_iter().map(guess).collect();
        for (vertex, guess) in dirty.iter().zip(found) {
            self.guesses[*vertex as usize] = guess;
            self.candidates[*vertex as usize] = guess.map_or(Candidate::None, |error| Candidate::Guess { error });
        }
    }

    /// Of a vertex that is gone.
    fn forget(&mut self, vertex: u32) {
        self.candidates[vertex as usize] = Candidate::None;
        self.guesses[vertex as usize] = None;
    }

    fn find_out(&mut self, judge: &Judge<'_>, unsure: &[u32]) {
        let found: Vec<Candidate> = unsure.par_iter().map(|vertex| judge.candidate(*vertex)).collect();
        for (vertex, found) in unsure.iter().zip(found) {
            self.candidates[*vertex as usize] = found;
            self.guesses[*vertex as usize] = Some(SHARE_OF_BEFORE * found.error().unwrap_or(TOO_DEAR));
        }
    }
}

impl Work<'_> {
    /// Collapses all that can be, then flips and collapses again `sweeps` times. Of vertices that cost the same, another
    /// goes first in another `order`. Returns the rounds of collapses.
    pub(super) fn simplify(&self, mesh: &mut Simplified, sweeps: u32, order: u32) -> Result<u32> {
        let mut known = Known::none(mesh.vertices.len());
        mesh.keys.iter_mut().for_each(|key| *key = keys::mixed(*key ^ order));
        let mut rounds = 0;
        self.collapse(mesh, &mut known, (0..mesh.vertices.len() as u32).collect(), &mut rounds)?;
        for _ in 0..sweeps {
            let touched = self.flip(mesh)?;
            if touched.is_empty() {
                break;
            }
            self.collapse(mesh, &mut known, touched, &mut rounds)?;
        }
        Ok(rounds)
    }

    fn collapse(&self, mesh: &mut Simplified, known: &mut Known, mut dirty: Vec<u32>, rounds: &mut u32) -> Result<()> {
        while *rounds < MOST_ROUNDS {
            self.job.cancel.check()?;
            self.job.progress.pass("collapse", u64::from(*rounds), u64::from(*rounds) + 1);
            let stars = Stars::new(mesh.vertices.len(), &mesh.triangles);
            let selected = self.select(mesh, &stars, known, &dirty, *rounds);
            if selected.is_empty() {
                break;
            }
            dirty = mesh.apply(&stars, &known.candidates, &selected);
            selected.iter().for_each(|vertex| known.forget(*vertex));
            *rounds += 1;
        }
        Ok(())
    }

    /// The vertices that come before their neighbours. Only where guesses decide between them are errors found out; of
    /// more than [`MANY`] triangles, guesses decide.
    fn select(&self, mesh: &Simplified, stars: &Stars, known: &mut Known, dirty: &[u32], round: u32) -> Vec<u32> {
        self.judged(mesh, stars, |judge| {
            known.guess(judge, dirty);
            let turn = |(vertex, candidate): (usize, &Candidate)| mesh.turn(vertex as u32, candidate, round);
            let mut turns: Vec<u64> = known.candidates.par_iter().enumerate().map(turn).collect();
            let mut open: Vec<u32> = (0..turns.len() as u32).collect();
            let guesses_decide = mesh.triangles.len() > MANY;
            let mut selected = Vec::new();
            let mut seen = vec![false; turns.len()];
            loop {
                let first = |vertex: &u32| mesh.comes_first(stars, &turns, *vertex);
                let first: Vec<u32> = open.into_par_iter().filter(first).collect();
                let is_guess = |vertex: &u32| matches!(known.candidates[*vertex as usize], Candidate::Guess { .. });
                let (unsure, sure): (Vec<u32>, Vec<u32>) = first.into_iter().partition(is_guess);
                // Else selected when they were found out.
                if !guesses_decide {
                    selected.extend(sure);
                }
                if unsure.is_empty() {
                    return selected;
                }
                known.find_out(judge, &unsure);
                for vertex in &unsure {
                    let found = &known.candidates[*vertex as usize];
                    if guesses_decide && *found != Candidate::None {
                        selected.push(*vertex);
                    } else {
                        turns[*vertex as usize] = mesh.turn(*vertex, found, round);
                    }
                }
                // Others come no earlier than before: only these and those around may now come first.
                open = mesh.around(stars, &unsure, &mut seen);
            }
        })
    }

    /// Returns the vertices around which triangles changed.
    fn flip(&self, mesh: &mut Simplified) -> Result<Vec<u32>> {
        let mut errors = vec![0.0; mesh.triangles.len()];
        let mut wanted: Vec<Option<Flip>> = vec![None; mesh.triangles.len()];
        let mut changed: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
        let mut touched = Vec::new();
        let mut stars = Stars::new(mesh.vertices.len(), &mesh.triangles);
        for _ in 0..FLIP_ROUNDS {
            self.job.cancel.check()?;
            self.judged(mesh, &stars, |judge| {
                let found: Vec<f64> =
                    changed.par_iter().map(|t| judge.error_of(&mesh.triangles[*t as usize], 1.0)).collect();
                changed.iter().zip(found).for_each(|(t, error)| errors[*t as usize] = error);
                want(judge, &changed, &errors, &mut wanted);
            });
            let turned = mesh.flip(&wanted);
            if turned.triangles.is_empty() {
                break;
            }
            changed = turned.triangles;
            touched.extend(turned.vertices);
            stars = Stars::new(mesh.vertices.len(), &mesh.triangles);
        }
        Ok(mesh.around(&stars, &touched, &mut vec![false; mesh.vertices.len()]))
    }
}

/// Finds out what the changed triangles and their neighbours want most, each side once.
fn want(judge: &Judge<'_>, changed: &[u32], errors: &[f64], wanted: &mut [Option<Flip>]) {
    let list = judge.mesh.with_neighbours(judge.stars, changed);
    let is_listed = |t: u32| list.binary_search(&t).is_ok();
    let skips = |t: u32, other: u32| other < t && is_listed(other);
    let found: Vec<Flip> =
        list.par_iter().flat_map_iter(|t| judge.flips(*t, errors, |other| skips(*t, other))).collect();
    list.iter().for_each(|t| wanted[*t as usize] = None);
    for flip in found {
        for t in flip.triangles.into_iter().filter(|t| is_listed(*t)) {
            wanted[t as usize] = Some(flip.better(wanted[t as usize]));
        }
    }
}
