//! A position inside a base triangle that touches seams. The twin of `reconcile_interiors.comp`.

use glam::DVec3;

use super::{frame::Jet, samples::Sample};
use crate::tables::Tables;

/// `own` is the sample at the vertex itself, `jet` the sum of all samples' jets.
#[must_use]
pub fn position(tables: &Tables, own: &Sample, jet: Jet) -> DVec3 {
    own.site.position(tables) + jet.x_axis
}
