//! Twin of `texture_trilinear`: two levels, chosen by the longer side of the pixel (Williams 1983).

use super::{super::mip::Level, bilinear, mix};

/// Level of detail: log2 of the pixel's longer side in texels of the finest level; the coarsest where the sides are not
/// numbers.
#[must_use]
pub fn level_of(levels: &[Level], dx: [f64; 2], dy: [f64; 2]) -> f64 {
    let size = [levels[0].width as f64, levels[0].height as f64];
    let squared = |d: [f64; 2]| (d[0] * size[0]).powi(2) + (d[1] * size[1]).powi(2);
    let (x, y) = (squared(dx), squared(dy));
    let coarsest = (levels.len() - 1) as f64;
    if (x + y).is_finite() { (0.5 * x.max(y).max(1.0).log2()).clamp(0.0, coarsest) } else { coarsest }
}

#[must_use]
pub fn trilinear(levels: &[Level], uv: [f64; 2], dx: [f64; 2], dy: [f64; 2], wrap: [u32; 2]) -> [f64; 4] {
    between_levels(levels, uv, level_of(levels, dx, dy), wrap)
}

/// The map at a level of detail, whole numbers being levels.
pub(super) fn between_levels(levels: &[Level], uv: [f64; 2], level: f64, wrap: [u32; 2]) -> [f64; 4] {
    let level = level.clamp(0.0, (levels.len() - 1) as f64);
    let finer = level.floor() as usize;
    let coarser = (finer + 1).min(levels.len() - 1);
    let t = level - finer as f64;
    mix(bilinear(&levels[finer], uv, wrap), bilinear(&levels[coarser], uv, wrap), t)
}
