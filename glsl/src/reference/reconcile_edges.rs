//! One displacement for a fine vertex on a seam. The twin of `reconcile_edges.comp`.

use glam::DVec3;

use super::{
    reconcile_corners::{Reconciled, distinct},
    samples::share,
};
use crate::{layout::geometry::Seam, tables::Tables};

/// `candidate(k)` is the displacement of `seam_sides[k]` there, its corners corrected. The mismatch is
/// taken against the first side.
#[must_use]
pub fn reconcile(tables: &Tables, seam: &Seam, candidate: impl Fn(u32) -> DVec3) -> Reconciled {
    let mut result = Reconciled { displacement: DVec3::ZERO, mismatch: 0.0 };
    let dominant = candidate(seam.first);
    for rank in distinct(&tables.seam_sides, seam) {
        let d = candidate(seam.first + rank);
        result.displacement += d * share(seam.distinct, tables.rule, rank);
        result.mismatch = result.mismatch.max(d.distance(dominant));
    }
    result
}
