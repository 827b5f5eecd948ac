//! Twin of `texture_anisotropic`: trilinear taps in a row along the longer axis of the footprint (after Schilling, Knittel
//! and Strasser 1996, and McCormack et al. 1999).

use super::{
    super::mip::Level,
    bilinear,
    footprint::{Footprint, footprint},
    trilinear::between_levels,
};

/// At most `MAX_ANISOTROPY` taps, all of one level, as wide as the shorter axis.
///
/// The row is a box, as the pixel is, so taps weigh alike: with Gaussian weights errors at 85 degrees are two to three times
/// as large. They are in pairs on either side of the middle; the
/// outermost pair weighs as much as the row reaches into its cells, so that nothing jumps when a pair more is needed.
#[must_use]
pub fn anisotropic(levels: &[Level], uv: [f64; 2], dx: [f64; 2], dy: [f64; 2], wrap: [u32; 2]) -> [f64; 4] {
    let Some(footprint) = footprint(&levels[0], dx, dy) else {
        return bilinear(&levels[levels.len() - 1], uv, wrap);
    };
    // There is nothing finer than the finest level: its texels are the narrowest taps.
    let width = footprint.minor.max(1.0);
    let step = per_tap(&levels[0], &footprint, width);
    let half = 0.5 * (footprint.major / width).max(1.0);
    let narrowed = narrowed(half);
    let mut sum = [0.0; 4];
    for pair in 0..half.ceil() as usize {
        let weight = (half - pair as f64).min(1.0);
        let place = (pair as f64 + 0.5 * weight) * narrowed;
        for place in [-place, place] {
            let at = [uv[0] + place * step[0], uv[1] + place * step[1]];
            let tap = between_levels(levels, at, width.log2(), wrap);
            sum.iter_mut().zip(tap).for_each(|(sum, tap)| *sum += weight * tap / (2.0 * half));
        }
    }
    sum
}

/// From tap to tap, in units of the map.
fn per_tap(finest: &Level, footprint: &Footprint, width: f64) -> [f64; 2] {
    [footprint.along[0] * width / finest.width as f64, footprint.along[1] * width / finest.height as f64]
}

/// Taps have a width of their own. With r = 2 `half` their places have a variance of
/// (r^2 - (pairs - 1 + w^3) / half) / 12, w the weight of the outermost pair, and this makes it (r^2 - 1) / 12: with the
/// 1/12 of a tap, the box of width r. It is 1 where r is an even number, and 0 where the footprint is a circle, whose
/// longer axis has no direction.
fn narrowed(half: f64) -> f64 {
    let r = 2.0 * half;
    let pairs = half.ceil();
    let outermost = half - (pairs - 1.0);
    ((r * r - 1.0) / (r * r - (pairs - 1.0 + outermost.powi(3)) / half)).sqrt()
}
