//! How far at most the displaced surface is from a triangle with corners on it, over the same part of the base: an upper
//! bound of the distance from the surface to the triangle, and back. Twin of `refine_test`.
//!
//! Maps are bounded exactly (`texels`), what bends besides by second order terms (`field`), expressions by intervals.

mod expression;
mod field;
mod layers;
mod ramps;
mod texels;

use glam::DVec3;

use super::place::Places;

/// What is asked of the bound.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Asked {
    /// Maps count at their texels alone, as other tools have it.
    pub at_texels: bool,
}

/// The largest distance anywhere on the triangle with these corners in base triangle t; where that exceeds `cap`, anything
/// above `cap`.
#[must_use]
pub fn bound(places: &Places<'_>, asked: Asked, t: u32, corners: [DVec3; 3], cap: f64) -> f64 {
    let triangle = &places.tables.base_triangles[t as usize];
    let patch = layers::Patch { places, asked, av: triangle.av, detail: triangle.detail, corners };
    let own = patch.bound(cap);
    if own > cap || places.tables.correction(t).is_none() {
        return own;
    }
    own + ramps::bound(places, asked, t, corners, cap - own)
}
