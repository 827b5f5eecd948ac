//! Levels of detail: how much coarser each is than the one before it, and how small it looks when it is near enough.

use std::f64::consts::PI;

/// Each level keeps so many times the tolerance of the one before it. Four and not two: on smooth relief triangles go
/// with one over the tolerance, so a level has a quarter of those before it, is near enough from four times as far, and a
/// chain takes a third more than its first level however long it is.
pub const STEP: f64 = 4.0;

/// Levels of a chain at most: the last is held to 16 384 times the first one's tolerance.
pub const MOST: u32 = 8;

/// The image that thresholds are meant for, pixels.
const IMAGE: [f64; 2] = [1920.0, 1080.0];

/// The least share of the image that a mesh covers while level k of its chain is shown, for each level: strictly
/// falling, and 0 for the last.
///
/// `tolerances_local` are those of the levels; `radius_local` is that of a sphere around the mesh. Seen small
/// where the next level's tolerance t looks a pixel long, the sphere is a disc of radius r / t pixels: pi (r / t)^2
/// pixels of the image. However near that is, level k ends at a share of 2^-(k + 1): what a share of 1 ends is never shown
/// by viewers that count what they show.
#[must_use]
pub fn coverages(radius_local: f64, tolerances_local: &[f64]) -> Vec<f64> {
    // Of views, a coarser level may be held to less than the one before it: what it shows is elsewhere.
    let halved = |before: &mut f64, tolerance: &f64| {
        let share = PI * (radius_local / tolerance).powi(2) / (IMAGE[0] * IMAGE[1]);
        *before = share.min(0.5 * *before);
        Some(*before)
    };
    tolerances_local.iter().skip(1).scan(1.0, halved).chain([0.0]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thresholds_fall_whatever_the_tolerances_do() {
        let found = coverages(1.0, &[1e-2, 4e-2, 3e-2, 0.5, 0.5]);
        assert!(found.is_sorted_by(|a, b| a > b), "{found:?}");
    }

    #[test]
    fn a_level_ends_where_the_next_ones_tolerance_is_a_pixel() {
        let found = coverages(1.0, &[1e-3, 4e-3, 16e-3]);
        // A sphere of 250 pixels radius, and one of 62.5.
        assert_eq!(found.len(), 3);
        assert!((found[0] - PI * 250.0 * 250.0 / 2_073_600.0).abs() < 1e-12, "{found:?}");
        assert!((found[1] - found[0] / 16.0).abs() < 1e-12 && found[2] == 0.0, "{found:?}");
    }

    #[test]
    fn shares_fall_however_small_the_tolerances_are() {
        let found = coverages(1.0, &[1e-9, 4e-9, 16e-9, 64e-9]);
        assert_eq!(found, [0.5, 0.25, 0.125, 0.0]);
        assert_eq!(coverages(1.0, &[1e-3]), [0.0]);
    }
}
