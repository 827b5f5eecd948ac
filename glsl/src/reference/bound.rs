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
mod rows;
mod search;
mod smooth;
mod straight;
mod summary;
mod texels;

pub use lattice::Lattice;
pub(in crate::reference) use layers::in_map;
pub use pyramid::Pyramid;
pub(in crate::reference) use straight::direction;
pub use texels::MapPlace;

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
fn ordered(corners: [DVec3; 3], in_map: [MapPlace; 3]) -> ([DVec3; 3], [MapPlace; 3]) {
    let mut order = [0, 1, 2];
    let before = |i: usize, j: usize| {
        let (a, b) = (corners[i], corners[j]);
        a.x < b.x || a.x == b.x && (a.y < b.y || a.y == b.y && a.z < b.z)
    };
    for (i, j) in [(0, 1), (1, 2), (0, 1)] {
        if before(order[j], order[i]) {
            order.swap(i, j);
        }
    }
    (order.map(|k| corners[k]), order.map(|k| in_map[k]))
}

/// The largest distance anywhere on the triangle with these corners in base triangle t, as a share of `tolerance`; where
/// that exceeds `most`, anything above `most`.
#[must_use]
pub fn bound(places: &Places<'_>, asked: Asked, t: u32, corners: [DVec3; 3], tolerance: f64, most: f64) -> f64 {
    bound_in_map(places, asked, t, corners, [MapPlace::NONE; 3], tolerance, most)
}

/// Whether the texels of a triangle with these corners are looked at one by one, few as they are: not worth remembering.
pub(in crate::reference) fn is_direct(places: &Places<'_>, t: u32, in_map: &[MapPlace; 3]) -> bool {
    let direction = places.straight.get(t as usize).copied().unwrap_or(f64::NAN);
    direction >= 0.0 && search::is_small(in_map)
}

/// As [`bound`], where it is known where the corners lie in the one map of the base triangle; see [`Places::in_map`].
#[must_use]
pub fn bound_in_map(
    places: &Places<'_>,
    asked: Asked,
    t: u32,
    corners: [DVec3; 3],
    in_map: [MapPlace; 3],
    tolerance: f64,
    most: f64,
) -> f64 {
    let (resolution, cap) = (RESOLUTION * tolerance, most * tolerance);
    let (corners, in_map) = ordered(corners, in_map);
    if let Some(own) = straight::bound(places, asked, t, in_map, cap) {
        return own / tolerance;
    }
    let triangle = &places.tables.base_triangles[t as usize];
    let (av, detail) = (triangle.av, triangle.detail);
    let patch = layers::Patch { places, asked, av, patch: inside(t), detail, corners, in_map, resolution };
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
