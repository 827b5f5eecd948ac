//! Scales of alpha that keep how much of a cut-out map is left, level by level (Castano 2010).

use super::Level;
use crate::reference::texture::bilinear;

/// Samples along a side of a level at most; up to 256 texels, four by four of each texel.
const MOST_SAMPLES: usize = 1024;
const SAMPLES_PER_TEXEL: usize = 4;
/// Thresholds are found to 2^-24, as fine as f32 below 1.
const STEPS: usize = 24;

/// Sets `alpha_scale` of every level but the finest so that bilinear values of scaled alpha reach `cutoff`, within
/// 0 to 1, on the same share of the map as on the finest level, or on the next share that the level can have. Without
/// this, fences and leaves thin out with distance: means of few opaque texels fall below the cut-off.
pub fn keep_coverage(levels: &mut [Level], cutoff: f64, wrap: [u32; 2]) {
    let Some((finest, coarser)) = levels.split_first_mut() else { return };
    finest.alpha_scale = 1.0;
    let target = share(&alphas(finest, wrap), cutoff);
    for level in coarser {
        level.alpha_scale = 1.0;
        level.alpha_scale = cutoff / threshold(&alphas(level, wrap), cutoff, target);
    }
}

/// The share of a level's area where scaled alpha reaches `cutoff`, sampled.
#[must_use]
pub fn coverage(level: &Level, cutoff: f64, wrap: [u32; 2]) -> f64 {
    share(&alphas(level, wrap), cutoff)
}

/// Bilinear alpha at evenly spread places.
fn alphas(level: &Level, wrap: [u32; 2]) -> Vec<f64> {
    let [columns, rows] = [level.width, level.height].map(|size| (size * SAMPLES_PER_TEXEL).min(MOST_SAMPLES));
    let place = |i: usize, count: usize| (i as f64 + 0.5) / count as f64;
    let at = |i: usize| bilinear(level, [place(i % columns, columns), place(i / columns, rows)], wrap)[3];
    (0..columns * rows).map(at).collect()
}

fn share(alphas: &[f64], threshold: f64) -> f64 {
    alphas.iter().filter(|alpha| **alpha >= threshold).count() as f64 / alphas.len() as f64
}

/// The threshold nearest to `cutoff` that leaves a share of `target`, by bisection: the share falls as the threshold rises.
/// Where the share steps over `target`, the side of the step that is closer.
fn threshold(alphas: &[f64], cutoff: f64, target: f64) -> f64 {
    let now = share(alphas, cutoff);
    if now == target {
        return cutoff;
    }
    // `near` is on the side of the cut-off, `far` is where the share is met or stepped over.
    let (mut near, mut far) = (cutoff, if now > target { 1.0 } else { 0.0 });
    for _ in 0..STEPS {
        let middle = 0.5 * (near + far);
        let found = share(alphas, middle);
        if (found > target) == (now > target) && found != target { near = middle } else { far = middle }
    }
    let off = |threshold: f64| (share(alphas, threshold) - target).abs();
    let best = if off(near) < off(far) { near } else { far };
    best.max(0.5f64.powi(STEPS as i32))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::texture::WRAP_REPEAT;

    const WRAP: [u32; 2] = [WRAP_REPEAT; 2];

    fn chain(width: usize, height: usize, alpha: impl Fn(usize, usize) -> f64) -> Vec<Level> {
        let texels = (0..width * height).map(|i| [1.0, 1.0, 1.0, alpha(i % width, i / width)]).collect();
        Level { width, height, texels, alpha_scale: 1.0 }.chain()
    }

    /// Wires one texel wide, whose thickness varies so that means differ.
    fn fence() -> Vec<Level> {
        let thickness = |x: usize, y: usize| 1.0 - ((x * 37 + y * 101) % 64) as f64 / 320.0;
        chain(128, 96, |x, y| if x % 7 == 0 || y % 11 == 0 { thickness(x, y) } else { 0.0 })
    }

    /// Leaves of random place, size and slant on a soft ground.
    fn leaves() -> Vec<Level> {
        let leaf = |k: f64, x: f64, y: f64| {
            let (cx, cy) = ((k * 37.7) % 64.0, (k * 23.3) % 64.0);
            let (dx, dy) = (x - cx, y - cy);
            let (u, v) = (dx * k.cos() + dy * k.sin(), dy * k.cos() - dx * k.sin());
            1.5 - (u * u / (9.0 + k) + v * v / 3.0)
        };
        chain(64, 64, |x, y| {
            (0..24).map(|k| leaf(f64::from(k), x as f64, y as f64)).fold(0.0, f64::max).clamp(0.0, 1.0)
        })
    }

    /// Levels of more than this many texels have enough different values to meet a share.
    fn of_many_texels(levels: &[Level]) -> impl Iterator<Item = &Level> {
        levels.iter().filter(|level| level.texels.len() >= 48)
    }

    #[test]
    fn every_level_covers_as_much_as_the_finest() {
        for mut levels in [fence(), leaves()] {
            for cutoff in [0.25, 0.5, 0.8] {
                let worst = |levels: &[Level]| {
                    let target = coverage(&levels[0], cutoff, WRAP);
                    let off = |level: &Level| (coverage(level, cutoff, WRAP) - target).abs();
                    of_many_texels(levels).map(off).fold(0.0, f64::max)
                };
                levels.iter_mut().for_each(|level| level.alpha_scale = 1.0);
                let before = worst(&levels);
                keep_coverage(&mut levels, cutoff, WRAP);
                let after = worst(&levels);
                println!("cut-off {cutoff}: off by {before:.4} without, {after:.4} with scales");
                assert!(after <= 0.01, "off by {after} at {cutoff}");
                assert!(cutoff != 0.5 || before > 0.1, "{before}: nothing to mend");
            }
        }
    }

    #[test]
    fn where_nothing_or_everything_is_left_alpha_stays() {
        for alpha in [0.0, 1.0] {
            let mut levels = chain(9, 6, |_, _| alpha);
            keep_coverage(&mut levels, 0.5, WRAP);
            assert!(levels.iter().all(|level| level.alpha_scale == 1.0), "alpha {alpha}");
        }
    }

    #[test]
    fn a_single_texel_covers_all_or_nothing_whichever_is_closer() {
        for (opaque, expected) in [(2, 0.0), (14, 1.0)] {
            let mut levels = chain(16, 1, |x, _| f64::from(u8::from(x < opaque)));
            keep_coverage(&mut levels, 0.5, WRAP);
            let last = levels.last().unwrap();
            assert_eq!(coverage(last, 0.5, WRAP), expected, "{opaque} of 16");
            assert!(last.alpha_scale.is_finite() && last.alpha_scale > 0.0);
        }
    }
}
