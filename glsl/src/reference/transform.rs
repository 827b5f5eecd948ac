//! Twin of `transform` and of `snap.glsl`: to homogeneous pixels, and on to 24.8 fixed point.

use glam::{DVec2, DVec4};

/// Fixed-point units of one pixel.
pub const SUBPIXELS: f64 = 256.0;
/// Vertices farther out than this are clipped.
pub const GUARD_PX: f64 = 32767.0;

/// A vertex in fixed point, and its reversed depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Snapped {
    pub x: i64,
    pub y: i64,
    pub depth: f64,
}

/// Homogeneous pixels (x w, y w, z, w) of a place in a mesh; `rows` are the first rows of an instance.
#[must_use]
pub fn homogeneous(rows: &[[f32; 4]], p: [f32; 3]) -> DVec4 {
    let p = DVec4::new(f64::from(p[0]), f64::from(p[1]), f64::from(p[2]), 1.0);
    let row = |k: usize| DVec4::from_array(rows[k].map(f64::from)).dot(p);
    DVec4::new(row(0), row(1), row(2), row(3))
}

/// One bit per plane of the view that the vertex is outside of: left, right, top, bottom, near, far.
#[must_use]
pub fn outside_planes(h: DVec4, size_px: DVec2) -> u32 {
    let outside = [h.x < 0.0, h.x > size_px.x * h.w, h.y < 0.0, h.y > size_px.y * h.w, h.z > h.w, h.z < 0.0];
    outside.iter().enumerate().map(|(bit, outside)| u32::from(*outside) << bit).sum()
}

/// Whether the vertex cannot be projected, or lands outside the guard band.
#[must_use]
pub fn needs_clip(h: DVec4) -> bool {
    let projects = h.w > 0.0 && h.z <= h.w && h.z >= 0.0;
    !projects || h.x.abs() > GUARD_PX * h.w || h.y.abs() > GUARD_PX * h.w
}

/// The vertex in fixed point; its w is positive.
#[must_use]
pub fn snapped(h: DVec4) -> Snapped {
    let fixed = |x: f64| (x / h.w * SUBPIXELS).round_ties_even() as i64;
    Snapped { x: fixed(h.x), y: fixed(h.y), depth: (h.z / h.w).clamp(0.0, 1.0) }
}
