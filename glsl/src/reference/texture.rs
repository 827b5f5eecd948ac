//! Twins of the passes `texture_*`: what a map shows of a pixel, by each filter.

use super::mip::Level;

/// Numbers as in `texture.glsl`.
pub const WRAP_REPEAT: u32 = 0;
pub const WRAP_MIRROR: u32 = 1;
pub const WRAP_CLAMP: u32 = 2;

const FARTHEST: f64 = (1u64 << 53) as f64;

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

fn mix(a: [f64; 4], b: [f64; 4], t: f64) -> [f64; 4] {
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * t)
}

#[must_use]
pub fn bilinear(level: &Level, uv: [f64; 2], wrap: [u32; 2]) -> [f64; 4] {
    // Whole numbers beyond 2^53 have no texels between them; this keeps the texel numbers within i64.
    let p = [uv[0] * level.width as f64 - 0.5, uv[1] * level.height as f64 - 0.5].map(|p| p.clamp(-FARTHEST, FARTHEST));
    let (x, y) = (p[0].floor(), p[1].floor());
    let column = |dx: i64| wrapped(x as i64 + dx, level.width, wrap[0]);
    let row = |dy: i64| wrapped(y as i64 + dy, level.height, wrap[1]) * level.width;
    let at = |dx, dy| level.texels[row(dy) + column(dx)];
    let (tx, ty) = (p[0] - x, p[1] - y);
    let [r, g, b, a] = mix(mix(at(0, 0), at(1, 0), tx), mix(at(0, 1), at(1, 1), tx), ty);
    [r, g, b, (a * level.alpha_scale).min(1.0)]
}

/// Level of detail: log2 of the pixel's longer side in texels of the finest level.
#[must_use]
pub fn level_of(levels: &[Level], dx: [f64; 2], dy: [f64; 2]) -> f64 {
    let size = [levels[0].width as f64, levels[0].height as f64];
    let squared = |d: [f64; 2]| (d[0] * size[0]).powi(2) + (d[1] * size[1]).powi(2);
    let footprint = squared(dx).max(squared(dy));
    (0.5 * footprint.max(1.0).log2()).clamp(0.0, (levels.len() - 1) as f64)
}

#[must_use]
pub fn trilinear(levels: &[Level], uv: [f64; 2], dx: [f64; 2], dy: [f64; 2], wrap: [u32; 2]) -> [f64; 4] {
    let level = level_of(levels, dx, dy);
    let finer = level.floor() as usize;
    let coarser = (finer + 1).min(levels.len() - 1);
    let t = level - finer as f64;
    mix(bilinear(&levels[finer], uv, wrap), bilinear(&levels[coarser], uv, wrap), t)
}
