//! Twin of `texture_ewa`: the elliptical weighted average (Greene and Heckbert 1986, Heckbert 1989).

use super::{
    super::mip::Level,
    WRAP_CLAMP, bilinear, covering,
    footprint::{Footprint, footprint},
    mix, places, texel,
};

/// Texels that the shorter half axis spans at least, wherever there are so many: the level is chosen by it.
const FINEST_TEXELS: f64 = 2.0;
/// Weights are exp(-r^2 / 2) - exp(-2) within r = 2: the Gaussian ends without a step.
const REACH: f64 = 2.0;
/// Variance of these weights along an axis, (1 - 5 e^-2) / (1 - 3 e^-2).
const KERNEL_VARIANCE: f64 = 0.544_321_158_144_394_5;
/// In texels: with less, the ellipse could slip between texels. No level that halves falls below it.
const LEAST_VARIANCE: f64 = 0.15;
/// In texels: no ellipse reaches the map from farther away, so what is clamped need not be followed there.
const FAR: f64 = 64.0;

/// Where the footprint is smaller than a texel it fades into [`bilinear`], which a Gaussian over so few texels cannot
/// reproduce; where it spans more than 3.4 to 4 texels of a level, into the next one.
#[must_use]
pub fn ewa(levels: &[Level], uv: [f64; 2], dx: [f64; 2], dy: [f64; 2], wrap: [u32; 2]) -> [f64; 4] {
    let coarsest = levels.len() - 1;
    let Some(footprint) = footprint(&levels[0], dx, dy) else {
        return bilinear(&levels[coarsest], uv, wrap);
    };
    let fade = (2.0 * footprint.major - 1.0).clamp(0.0, 1.0);
    if fade == 0.0 {
        return bilinear(&levels[0], uv, wrap);
    }
    let level = (footprint.minor / FINEST_TEXELS).max(1.0).log2().min(coarsest as f64);
    let finer = level.floor() as usize;
    let t = (4.0 * (level - finer as f64) - 3.0).max(0.0);
    let spread = spread(&footprint, coarsest);
    let mut value = elliptical(&levels[0], &levels[finer], uv, spread, wrap);
    if t > 0.0 {
        value = mix(value, elliptical(&levels[0], &levels[finer + 1], uv, spread, wrap), t);
    }
    if fade < 1.0 { mix(bilinear(&levels[0], uv, wrap), value, fade) } else { value }
}

/// J J^T, shrunk to what the coarsest level needs: that bounds the texels under the ellipse.
fn spread(footprint: &Footprint, coarsest: usize) -> [f64; 3] {
    let widest = 2.0 * FINEST_TEXELS * (coarsest as f64).exp2();
    let shrink = (widest / footprint.minor).min(1.0).powi(2);
    footprint.spread.map(|s| s * shrink)
}

/// Variance of the Gaussian in texels of a level whose texels are 1/s as wide as the finest.
///
/// The pixel's box has J J^T / 12 in texels of the finest level. Bilinear reconstruction there adds 1/6. The level's texels
/// are themselves means over (1/s)^2 of the finest, which already holds (1/s^2 - 1) / 12. In texels of the level that is
/// s J J^T s / 12 + s^2 / 6 - (1 - s^2) / 12, the same total whatever the level.
fn variance(finest: &Level, level: &Level, [xx, xy, yy]: [f64; 3]) -> [f64; 3] {
    let sx = level.width as f64 / finest.width as f64;
    let sy = level.height as f64 / finest.height as f64;
    let along = |s: f64, squared: f64| s * s * (squared / 12.0 + 0.25) - 1.0 / 12.0;
    let mut v = [along(sx, xx), sx * sy * xy / 12.0, along(sy, yy)];
    // Along a single texel nothing changes.
    for (size, k) in [(level.width, 0), (level.height, 2)] {
        if size == 1 {
            (v[k], v[1]) = (LEAST_VARIANCE, 0.0);
        }
    }
    let least = 0.5 * (v[0] + v[2]) - (0.5 * (v[0] - v[2])).hypot(v[1]);
    let missing = (LEAST_VARIANCE - least).max(0.0);
    [v[0] + missing, v[1], v[2] + missing]
}

fn elliptical(finest: &Level, level: &Level, uv: [f64; 2], spread: [f64; 3], wrap: [u32; 2]) -> [f64; 4] {
    let [xx, xy, yy] = variance(finest, level, spread).map(|v| v / KERNEL_VARIANCE);
    let determinant = xx * yy - xy * xy;
    let mut centre = places(level, uv);
    for (k, size) in [level.width, level.height].into_iter().enumerate() {
        if wrap[k] == WRAP_CLAMP {
            centre[k] = centre[k].clamp(-FAR, size as f64 + FAR);
        }
    }
    let (mut sum, mut total) = ([0.0; 4], 0.0);
    let reach = REACH * yy.sqrt();
    for y in (centre[1] - reach).ceil() as i64..=(centre[1] + reach).floor() as i64 {
        let dy = y as f64 - centre[1];
        // The row's part of the ellipse yy dx^2 - 2 xy dx dy + xx dy^2 = REACH^2 determinant.
        let middle = centre[0] + dy * xy / yy;
        let half = ((REACH * REACH - dy * dy / yy).max(0.0) * determinant / yy).sqrt();
        for x in (middle - half).ceil() as i64..=(middle + half).floor() as i64 {
            let dx = x as f64 - centre[0];
            let squared = (yy * dx * dx - 2.0 * xy * dx * dy + xx * dy * dy) / determinant;
            let weight = ((-0.5 * squared).exp() - (-0.5 * REACH * REACH).exp()).max(0.0);
            let value = texel(level, x, y, wrap);
            sum.iter_mut().zip(value).for_each(|(sum, value)| *sum += weight * value);
            total += weight;
        }
    }
    covering(level, sum.map(|sum| sum / total))
}
