//! Twin of the `flip_*` passes: the side between two triangles of one base triangle is turned where that lowers the larger
//! of their errors. Fewer errors near the tolerance let further vertices go.

use super::collapse::{Facet, Judge, Simplified};

/// Two triangles that share a side, and what becomes of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flip {
    /// Ascending.
    pub triangles: [u32; 2],
    pub after: [Facet; 2],
    /// By how much the larger error falls, as a share of the tolerance.
    pub gain: f64,
}

/// A flip that gains less is left alone: it could be turned back for ever.
const LEAST_GAIN: f64 = 1e-3;

impl Judge<'_> {
    /// The flip of one of a triangle's sides that gains most; `errors` are those of all triangles, as shares of the
    /// tolerance.
    #[must_use]
    pub fn flip(&self, t: u32, errors: &[f64]) -> Option<Flip> {
        let mut best: Option<Flip> = None;
        for side in 0..3 {
            let least = best.map_or(LEAST_GAIN, |best| best.gain);
            best = self.flip_of(t, side, errors, least).or(best);
        }
        best
    }

    /// Only where it gains more than `least`.
    fn flip_of(&self, t: u32, side: usize, errors: &[f64], least: f64) -> Option<Flip> {
        let own = self.mesh.triangles[t as usize];
        let [a, b, c] = [0, 1, 2].map(|k| own.gv[(side + k) % 3]);
        let other = self.across(t, a, b)?;
        let facet = self.mesh.triangles[other as usize];
        let d = facet.gv.into_iter().find(|gv| *gv != a && *gv != b)?;
        let after = [[c, a, d], [d, b, c]].map(|gv| Facet { gv, base: own.base });
        let before = errors[t as usize].max(errors[other as usize]);
        let most = before - least;
        let allowed = |after: &Facet| self.may_follow(&own, after);
        if facet.base != own.base || most <= 0.0 || !after.iter().all(allowed) {
            return None;
        }
        let first = self.error_of(&after[0], most);
        let worst = if first < most { first.max(self.error_of(&after[1], most)) } else { first };
        (worst < most).then(|| Flip { triangles: [t.min(other), t.max(other)], after, gain: before - worst })
    }

    /// The one other triangle at side ab.
    fn across(&self, t: u32, a: u32, b: u32) -> Option<u32> {
        let [a, b] = [[a, b], [b, a]].into_iter().min_by_key(|[hub, _]| self.stars.of(*hub).len())?;
        let has_b = |o: &&u32| **o != t && self.mesh.triangles[**o as usize].gv.contains(&b);
        let mut others = self.stars.of(a).iter().filter(has_b);
        let other = others.next()?;
        others.next().is_none().then_some(*other)
    }
}

impl Simplified {
    /// Makes the flips that both of their triangles want most; `flips[t]` is what triangle t wants. Returns the vertices
    /// of the triangles that changed.
    pub fn flip(&mut self, flips: &[Option<Flip>]) -> Vec<u32> {
        let mut touched = Vec::new();
        for (t, flip) in (0..).zip(flips) {
            let Some(flip) = flip.filter(|flip| flip.triangles[0] == t) else { continue };
            let mate = flips[flip.triangles[1] as usize];
            if mate.is_none_or(|mate| mate.triangles != flip.triangles) {
                continue;
            }
            for (triangle, after) in flip.triangles.into_iter().zip(flip.after) {
                self.triangles[triangle as usize] = after;
                touched.extend(after.gv);
            }
        }
        touched.sort_unstable();
        touched.dedup();
        touched
    }
}
