//! Twin of the `flip_*` passes: the side between two triangles of one base triangle is turned where that lowers the larger
//! of their errors. Fewer errors near the tolerance let further vertices go.

use super::{
    collapse::{Facet, Judge, Simplified, Stars, rank},
    keys,
};

/// Two triangles that share a side, and what becomes of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flip {
    /// Ascending.
    pub triangles: [u32; 2],
    pub after: [Facet; 2],
    /// By how much the larger error falls, as a share of the tolerance.
    pub gain: f64,
    /// Of the vertices that the turned side joins: tells equal gains apart.
    key: u32,
}

/// What one round of flips changed.
#[derive(Clone, Debug, Default)]
pub struct Turned {
    /// Ascending.
    pub triangles: Vec<u32>,
    /// Those of the triangles, ascending.
    pub vertices: Vec<u32>,
}

/// A flip that gains less is left alone: it could be turned back for ever.
const LEAST_GAIN: f64 = 1e-3;

impl Flip {
    /// The flip that a triangle wants more.
    #[must_use]
    pub fn better(self, other: Option<Self>) -> Self {
        let order = |flip: &Self| (rank(flip.gain), flip.key);
        other.filter(|other| order(other) > order(&self)).unwrap_or(self)
    }
}

impl Judge<'_> {
    /// The flips of a triangle's sides that gain something, but for sides that `skips` the triangle across; `errors` are
    /// those of all triangles, as shares of the tolerance.
    #[must_use]
    pub fn flips(&self, t: u32, errors: &[f64], skips: impl Fn(u32) -> bool) -> Vec<Flip> {
        let facet = self.mesh.triangles[t as usize];
        let across = |k: usize| across(self.mesh, self.stars, t, [facet.gv[k], facet.gv[(k + 1) % 3]]);
        let sides = (0..3).filter_map(|k| Some((k, across(k)?))).filter(|(_, other)| !skips(*other));
        sides.filter_map(|(k, other)| self.flip_of([t, other], k, errors)).collect()
    }

    fn flip_of(&self, triangles: [u32; 2], side: usize, errors: &[f64]) -> Option<Flip> {
        let [own, other] = triangles.map(|t| self.mesh.triangles[t as usize]);
        let [a, b, c] = [0, 1, 2].map(|k| own.gv[(side + k) % 3]);
        let d = other.gv.into_iter().find(|gv| *gv != a && *gv != b)?;
        let before = triangles.iter().fold(0.0, |most: f64, t| most.max(errors[*t as usize]));
        let most = before - LEAST_GAIN;
        if other.base != own.base || most <= 0.0 {
            return None;
        }
        let worst = self.turned([a, b, c, d], own.base, most)?;
        let after = [[c, a, d], [d, b, c]].map(|gv| Facet { gv, base: own.base });
        let key = keys::edge([c, d].map(|gv| self.mesh.keys[gv as usize]));
        let [low, high] = [triangles[0].min(triangles[1]), triangles[0].max(triangles[1])];
        Some(Flip { triangles: [low, high], after, gain: before - worst, key })
    }
}

/// The one other triangle at side ab.
fn across(mesh: &Simplified, stars: &Stars, t: u32, [a, b]: [u32; 2]) -> Option<u32> {
    let [a, b] = [[a, b], [b, a]].into_iter().min_by_key(|[hub, _]| stars.of(*hub).len())?;
    let has_b = |o: &&u32| **o != t && mesh.triangles[**o as usize].gv.contains(&b);
    let mut others = stars.of(a).iter().filter(has_b);
    let other = others.next()?;
    others.next().is_none().then_some(*other)
}

impl Simplified {
    /// Makes the flips that both of their triangles want most; `flips[t]` is what triangle t wants.
    pub fn flip(&mut self, flips: &[Option<Flip>]) -> Turned {
        let mut turned = Turned::default();
        for (t, flip) in (0..).zip(flips) {
            let Some(flip) = flip.filter(|flip| flip.triangles[0] == t) else { continue };
            let mate = flips[flip.triangles[1] as usize];
            if mate.is_none_or(|mate| mate.triangles != flip.triangles) {
                continue;
            }
            for (triangle, after) in flip.triangles.into_iter().zip(flip.after) {
                self.triangles[triangle as usize] = after;
                turned.triangles.push(triangle);
                turned.vertices.extend(after.gv);
            }
        }
        for list in [&mut turned.triangles, &mut turned.vertices] {
            list.sort_unstable();
            list.dedup();
        }
        turned
    }

    /// These triangles and those that share a side with one of them, ascending.
    #[must_use]
    pub fn with_neighbours(&self, stars: &Stars, triangles: &[u32]) -> Vec<u32> {
        let mut all = triangles.to_vec();
        for t in triangles {
            let gv = self.triangles[*t as usize].gv;
            all.extend((0..3).filter_map(|k| across(self, stars, *t, [gv[k], gv[(k + 1) % 3]])));
        }
        all.sort_unstable();
        all.dedup();
        all
    }
}
