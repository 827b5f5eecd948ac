//! One displacement for a geometric vertex with several attribute vertices. The twin of
//! `reconcile_corners.comp`.

use glam::DVec3;

use super::samples::share;
use crate::{
    layout::geometry::{Seam, SeamSide},
    tables::Tables,
};

/// Sides that every side is compared with.
const COMPARED: u32 = 32;

/// What a seam's sides become, and how far apart they were: exactly where at most 32 sides meet, else at least
/// half as far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reconciled {
    pub displacement: DVec3,
    pub mismatch: f64,
}

/// `candidate(k)` is the displacement of `seam_corners[k]` by itself.
#[must_use]
pub fn reconcile(tables: &Tables, seam: &Seam, candidate: impl Fn(u32) -> DVec3) -> Reconciled {
    let distinct: Vec<(u32, DVec3)> =
        distinct(&tables.seam_corners, seam).map(|rank| (rank, candidate(seam.first + rank))).collect();
    let displacement = distinct.iter().map(|(rank, d)| *d * share(seam.distinct, tables.rule, *rank)).sum();
    let few = distinct.partition_point(|(rank, _)| *rank < COMPARED);
    let before = |k: usize| distinct[..k.min(few)].iter();
    let pairs = distinct.iter().enumerate().flat_map(|(k, a)| before(k).map(move |b| a.1.distance(b.1)));
    Reconciled { displacement, mismatch: pairs.fold(0.0, f64::max) }
}

/// What av `seam_corners[k]` is short of the reconciled displacement.
#[must_use]
pub fn correction(
    tables: &Tables,
    seam: &Seam,
    rank: u32,
    displacement: DVec3,
    candidate: impl Fn(u32) -> DVec3,
) -> DVec3 {
    displacement - candidate(seam.first + tables.seam_corners[(seam.first + rank) as usize].same_as)
}

/// Ranks of the sides that count.
pub(super) fn distinct<'a>(sides: &'a [SeamSide], seam: &'a Seam) -> impl Iterator<Item = u32> + 'a {
    (0..seam.count).filter(|rank| sides[(seam.first + rank) as usize].same_as == *rank)
}
