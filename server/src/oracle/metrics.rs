//! How far two images are apart: to the eye (FLIP), in light (RMSE), in structure (SSIM), and, where they carry what
//! the surface is, in outline and in place.

pub mod flip;
pub mod hit;
pub mod light;
pub mod picture;
pub mod rmse;
pub mod silhouette;
pub mod ssim;

use crate::domain::{Error, Result, cancel::Cancel, report::Comparison};

use flip::ErrorMap;
use picture::Picture;

/// Every metric of two pictures, and the FLIP error of every pixel. `a` is the reference: FLIP, SSIM and RMSE are the
/// same either way, the hit error is measured in the pixels of `a`. Fails when the sizes differ, naming `b`.
pub fn compare(a: &Picture, b: &Picture, cancel: &Cancel) -> Result<(Comparison, ErrorMap)> {
    same_size(a, b)?;
    let errors = flip::error_map(a, b, cancel)?;
    let ssim = ssim::ssim(a, b);
    cancel.check()?;
    let comparison = Comparison {
        flip_mean: errors.mean(),
        flip_p99: errors.p99(),
        rmse_linear: rmse::rmse_linear(a, b),
        ssim,
        silhouette_xor_px: silhouette::xor_px(a, b),
        hit_error_px: hit::hit_error(a, b).map(|error| error.p99),
    };
    Ok((comparison, errors))
}

fn same_size(a: &Picture, b: &Picture) -> Result<()> {
    if (a.width, a.height) == (b.width, b.height) {
        return Ok(());
    }
    let message = format!(
        "the image has {} x {} pixels and a has {} x {}; give two images of one size",
        b.width, b.height, a.width, a.height
    );
    Err(Error::invalid("b", message))
}

/// The value that `share` of all values do not exceed, between two ranks by linear interpolation (Hyndman and Fan
/// 1996, type 7). Values are no NaN; of none it is 0.
fn percentile(mut values: Vec<f32>, share: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let rank = share * (values.len() - 1) as f64;
    let (_, low, above) = values.select_nth_unstable_by(rank as usize, f32::total_cmp);
    let low = f64::from(*low);
    let high = above.iter().copied().min_by(f32::total_cmp).map_or(low, f64::from);
    low + rank.fract() * (high - low)
}

/// For tests: an image of which every pixel is given by a function of its column and row.
#[cfg(test)]
fn painted(width: u32, height: u32, paint: impl Fn(u32, u32) -> [f32; 3]) -> Picture {
    let linear = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| paint(x, y)).collect();
    Picture { width, height, linear, ..Picture::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_percentile_lies_between_its_ranks() {
        assert_eq!(percentile(vec![], 0.99), 0.0);
        assert_eq!(percentile(vec![7.0], 0.99), 7.0);
        assert_eq!(percentile(vec![3.0, 1.0, 2.0], 0.5), 2.0);
        assert_eq!(percentile(vec![4.0, 1.0, 2.0, 3.0], 0.5), 2.5);
        let hundred_and_one = (0..=100).rev().map(|k| k as f32).collect();
        assert_eq!(percentile(hundred_and_one, 0.99), 99.0);
    }

    #[test]
    fn an_image_does_not_differ_from_itself() {
        let noise = |x: u32, y: u32| [0, 1, 2].map(|k| ((x * 7919 + y * 104_729 + k * 31) % 251) as f32 / 250.0);
        let picture = Picture {
            covered: Some((0..40 * 30).map(|k| k % 3 != 0).collect()),
            positions: Some(vec![[1.0, 2.0, 3.0]; 40 * 30]),
            clip_from_world: Some(std::array::from_fn(|k| if k % 5 == 0 { 1.0 } else { 0.0 })),
            ..painted(40, 30, noise)
        };
        let (comparison, errors) = compare(&picture, &picture, &Cancel::default()).unwrap();
        let expected = Comparison {
            ssim: Some(1.0),
            silhouette_xor_px: Some(0),
            hit_error_px: Some(0.0),
            ..Comparison::default()
        };
        assert_eq!(comparison, expected);
        assert!(errors.colors().chunks_exact(3).all(|color| color == [0, 0, 4]), "the least of magma");
    }

    #[test]
    fn images_of_two_sizes_are_refused() {
        let black = |_, _| [0.0; 3];
        let error = compare(&painted(3, 2, black), &painted(2, 3, black), &Cancel::default()).unwrap_err();
        assert_eq!(error.field.as_deref(), Some("b"));
        assert!(error.message.contains("2 x 3") && error.message.contains("3 x 2"), "{error}");
    }

    #[test]
    fn a_cancelled_comparison_stops() {
        let picture = painted(8, 8, |_, _| [0.5; 3]);
        let cancel = Cancel::default();
        cancel.cancel();
        assert!(compare(&picture, &picture, &cancel).is_err());
    }
}
