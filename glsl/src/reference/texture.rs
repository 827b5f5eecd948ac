//! Twins of the passes `texture_*`: what a map shows of a pixel, by each filter.
//!
//! A pixel is a box (its value is the mean over its square), a map is what [`bilinear`] makes of its finest level. All
//! filters agree with [`bilinear`] where the pixel is smaller than half a texel, and all but [`nearest`] and
//! [`bilinear`] are continuous in the derivatives.

mod anisotropic;
mod bilinear;
mod ewa;
mod footprint;
mod nearest;
mod trilinear;

pub use anisotropic::anisotropic;
pub use bilinear::bilinear;
pub use ewa::ewa;
pub use nearest::nearest;
pub use trilinear::{level_of, trilinear};

use super::mip::Level;

/// Numbers as in `texture.glsl`.
pub const WRAP_REPEAT: u32 = 0;
pub const WRAP_MIRROR: u32 = 1;
pub const WRAP_CLAMP: u32 = 2;

/// Longest side of a footprint in its shortest, beyond which the shortest is widened; as in `texture_footprint.glsl`.
pub const MAX_ANISOTROPY: f64 = 16.0;

/// The filters, in the order of what they cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    Nearest,
    /// Of the finest level.
    Bilinear,
    Trilinear,
    Anisotropic,
    Ewa,
}

impl Filter {
    pub const ALL: [Self; 5] = [Self::Nearest, Self::Bilinear, Self::Trilinear, Self::Anisotropic, Self::Ewa];
}

/// Linear RGBA at `uv` for a pixel whose sides are `dx` and `dy`, in units of the map; `levels` from the finest on.
#[must_use]
pub fn filtered(
    filter: Filter,
    levels: &[Level],
    uv: [f64; 2],
    dx: [f64; 2],
    dy: [f64; 2],
    wrap: [u32; 2],
) -> [f64; 4] {
    match filter {
        Filter::Nearest => nearest(&levels[0], uv, wrap),
        Filter::Bilinear => bilinear(&levels[0], uv, wrap),
        Filter::Trilinear => trilinear(levels, uv, dx, dy, wrap),
        Filter::Anisotropic => anisotropic(levels, uv, dx, dy, wrap),
        Filter::Ewa => ewa(levels, uv, dx, dy, wrap),
    }
}

/// Whole numbers beyond 2^53 have no texels between them; this keeps the texel numbers within i64.
const FARTHEST: f64 = (1u64 << 53) as f64;

/// Places in texels: texel i is at i.
fn places(level: &Level, uv: [f64; 2]) -> [f64; 2] {
    [uv[0] * level.width as f64 - 0.5, uv[1] * level.height as f64 - 0.5].map(|p| p.clamp(-FARTHEST, FARTHEST))
}

/// The texel that stands for number `i` of an endless row.
fn wrapped(i: i64, size: usize, mode: u32) -> usize {
    let size = size as i64;
    let i = match mode {
        WRAP_REPEAT => i.rem_euclid(size),
        WRAP_MIRROR => {
            let i = i.rem_euclid(2 * size);
            if i < size { i } else { 2 * size - 1 - i }
        }
        _ => i.clamp(0, size - 1),
    };
    i as usize
}

fn texel(level: &Level, x: i64, y: i64, wrap: [u32; 2]) -> [f64; 4] {
    level.texels[wrapped(y, level.height, wrap[1]) * level.width + wrapped(x, level.width, wrap[0])]
}

fn mix(a: [f64; 4], b: [f64; 4], t: f64) -> [f64; 4] {
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * t)
}

/// Alpha as the level's scale has it, so that levels cover alike.
fn covering(level: &Level, [r, g, b, a]: [f64; 4]) -> [f64; 4] {
    [r, g, b, (a * level.alpha_scale).min(1.0)]
}

#[cfg(test)]
mod tests;
