//! What was found of triangles that take long to bound: a vertex is judged anew whenever a triangle around it changes, and
//! most of the triangles it would leave are those of the last time.

use std::{
    collections::HashMap,
    hash::{BuildHasherDefault, Hash, Hasher},
    sync::{Mutex, PoisonError},
};

use super::Facet;

/// Errors of triangles of one mesh, whose vertices do not move, at one tolerance. What is known changes no result: it is
/// what would be found again.
#[derive(Debug, Default)]
pub struct Found {
    parts: [Mutex<Part>; PARTS],
}

type Part = HashMap<Question, f64, BuildHasherDefault<Mixer>>;

/// Threads seldom wait for each other among so many.
const PARTS: usize = 32;
/// A part with more questions than this, some 40 bytes each, forgets them all.
const MOST_KNOWN: usize = 1 << 14;

/// Corners ascending, the base triangle, and the most that was asked for: above it, errors are not found out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Question {
    gv: [u32; 3],
    base: u32,
    most: u64,
}

impl Hash for Question {
    fn hash<H: Hasher>(&self, state: &mut H) {
        let pair = |a: u32, b: u32| u64::from(a) << 32 | u64::from(b);
        let [a, b, c] = self.gv;
        [pair(a, b), pair(c, self.base), self.most].into_iter().for_each(|word| state.write_u64(word));
    }
}

impl Found {
    /// The error of a triangle at `most`; `find` finds what is not known.
    pub(super) fn of(&self, facet: Facet, most: f64, find: impl FnOnce() -> f64) -> f64 {
        let mut gv = facet.gv;
        gv.sort_unstable();
        let question = Question { gv, base: facet.base, most: most.to_bits() };
        let part = &self.parts[gv.iter().fold(0, |sum, gv| sum ^ (*gv as usize)) % PARTS];
        let known = part.lock().unwrap_or_else(PoisonError::into_inner).get(&question).copied();
        known.unwrap_or_else(|| {
            let error = find();
            let mut part = part.lock().unwrap_or_else(PoisonError::into_inner);
            if part.len() >= MOST_KNOWN {
                part.clear();
            }
            part.insert(question, error);
            error
        })
    }
}

/// Multiplies and turns (as rustc's own tables do): quick, for numbers that nobody chooses.
#[derive(Default)]
struct Mixer(u64);

const FACTOR: u64 = 0xF135_7AEA_2E62_A9C5;

impl Hasher for Mixer {
    fn finish(&self) -> u64 {
        self.0.rotate_left(26)
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|byte| self.write_u64(u64::from(*byte)));
    }

    fn write_u64(&mut self, x: u64) {
        self.0 = (self.0 ^ x).wrapping_mul(FACTOR).rotate_left(5);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FACET: Facet = Facet { gv: [3, 1, 2], base: 0 };

    #[test]
    fn an_error_is_found_once_whichever_corner_comes_first() {
        let found = Found::default();
        assert_eq!(found.of(FACET, 1.0, || 0.5), 0.5);
        assert_eq!(found.of(Facet { gv: [1, 2, 3], ..FACET }, 1.0, || unreachable!()), 0.5);
    }

    #[test]
    fn another_base_triangle_or_another_most_is_another_question() {
        let found = Found::default();
        for (k, (base, most)) in [(0, 1.0), (0, 0.5), (1, 1.0)].into_iter().enumerate() {
            assert_eq!(found.of(Facet { base, ..FACET }, most, || k as f64), k as f64);
        }
    }
}
