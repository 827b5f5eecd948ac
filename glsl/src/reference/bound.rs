//! How far at most the displaced surface is from a triangle with corners on it, over the same part of the base: an upper
//! bound of the distance from the surface to the triangle, and back. Twin of the `bound_*` passes.
//!
//! Maps are bounded exactly (`texels`), what bends besides by second order terms (`field`), expressions by intervals, smooth
//! bases by control nets (`smooth`).

mod expression;
mod field;
mod lattice;
mod layers;
mod linear;
mod pyramid;
mod ramps;
mod search;
mod smooth;
mod summary;
mod texels;

pub use lattice::Lattice;
pub use pyramid::Pyramid;

use glam::DVec3;

pub use summary::summaries;

use super::place::Places;
use crate::patches::inside;

/// What is asked of the bound.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Asked {
    /// Maps count at their texels alone, as other tools have it.
    pub at_texels: bool,
}

/// How much an expression's bound may be above the truth, as a share of the tolerance.
const RESOLUTION: f64 = 1.0 / 16.0;

/// The bound must not depend on which corner comes first: what one round accepted the next would find too far off.
fn ordered(mut corners: [DVec3; 3]) -> [DVec3; 3] {
    let order = |a: &DVec3, b: &DVec3| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z));
    corners.sort_unstable_by(order);
    corners
}

/// The largest distance anywhere on the triangle with these corners in base triangle t, as a share of `tolerance`; where
/// that exceeds `most`, anything above `most`.
#[must_use]
pub fn bound(places: &Places<'_>, asked: Asked, t: u32, corners: [DVec3; 3], tolerance: f64, most: f64) -> f64 {
    let triangle = &places.tables.base_triangles[t as usize];
    let (resolution, cap) = (RESOLUTION * tolerance, most * tolerance);
    let (av, detail, corners) = (triangle.av, triangle.detail, ordered(corners));
    let patch = layers::Patch { places, asked, av, patch: inside(t), detail, corners, resolution };
    let bend = smooth::bend(&patch);
    let own = bend + if bend > cap { 0.0 } else { patch.bound(cap - bend) };
    if own.is_nan() {
        return f64::INFINITY;
    }
    if own > cap || places.tables.correction(t).is_none() {
        return own / tolerance;
    }
    let sum = own + ramps::bound(&patch, t, cap - own);
    if sum.is_nan() { f64::INFINITY } else { sum / tolerance }
}
