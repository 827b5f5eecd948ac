//! FLIP (Andersson et al. 2020), by NVIDIA's own program: the difference an observer sees who alternates two images.

use nv_flip::FlipImageRgb8;
use rayon::prelude::*;

use super::{light::byte, percentile, picture::Picture};
use crate::domain::{Result, cancel::Cancel};

/// A screen 0.7 m wide of 3840 pixels, 0.7 m away: what the authors take.
pub const PIXELS_PER_DEGREE: f32 = 67.0;
/// Rows that are compared at once.
const BAND_ROWS: usize = 128;
/// The filters reach 10 rows at these pixels per degree.
const MARGIN_ROWS: usize = 12;

/// The error of every pixel, row-major from the top left: 0, the same, to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorMap {
    pub width: u32,
    pub height: u32,
    pub errors: Vec<f32>,
}

/// LDR-FLIP of what two pictures of one size show in 8-bit sRGB; light above 1 is cut. Ends early when cancelled.
pub fn error_map(a: &Picture, b: &Picture, cancel: &Cancel) -> Result<ErrorMap> {
    let (width, height) = (a.width, a.height);
    let bytes = [a, b].map(|p| p.linear.par_iter().flat_map_iter(|light| light.map(byte)).collect::<Vec<u8>>());
    let bands = (0..height as usize).into_par_iter().step_by(BAND_ROWS);
    // A pixel sees no farther than the filters reach, so bands with margins give the same bits as the whole.
    let bands: Vec<Vec<f32>> = bands
        .map(|first| {
            cancel.check()?;
            Ok(band(&bytes, width, height as usize, first))
        })
        .collect::<Result<_>>()?;
    Ok(ErrorMap { width, height, errors: bands.concat() })
}

fn band(bytes: &[Vec<u8>; 2], width: u32, height: usize, first: usize) -> Vec<f32> {
    let end = (first + BAND_ROWS).min(height);
    let (top, bottom) = (first.saturating_sub(MARGIN_ROWS), (end + MARGIN_ROWS).min(height));
    let row_bytes = 3 * width as usize;
    let rows = |bytes: &Vec<u8>| {
        let rows = &bytes[top * row_bytes..bottom * row_bytes];
        FlipImageRgb8::with_data(width, (bottom - top) as u32, rows)
    };
    let errors = nv_flip::flip(rows(&bytes[0]), rows(&bytes[1]), PIXELS_PER_DEGREE).to_vec();
    errors[(first - top) * width as usize..(end - top) * width as usize].to_vec()
}

impl ErrorMap {
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.errors.iter().map(|e| f64::from(*e)).sum::<f64>() / self.errors.len().max(1) as f64
    }

    /// What 99 of 100 pixels do not exceed.
    #[must_use]
    pub fn p99(&self) -> f64 {
        percentile(self.errors.clone(), 0.99)
    }

    /// The map as 8-bit RGB in the colours of the authors' program: magma, black is the same, pale yellow is 1.
    #[must_use]
    pub fn colors(&self) -> Vec<u8> {
        let colors = magma();
        self.errors.iter().flat_map(|error| colors(*error)).collect()
    }
}

/// The colours of magma: from black at 0 to pale yellow at 1, sRGB.
pub fn magma() -> impl Fn(f32) -> [u8; 3] {
    let table = nv_flip::magma_lut().to_vec();
    move |share| {
        let index = 3 * usize::from((share * 255.0 + 0.5) as u8);
        [table[index], table[index + 1], table[index + 2]]
    }
}

#[cfg(test)]
mod tests {
    use super::{super::painted, *};

    fn noise(seed: u32) -> impl Fn(u32, u32) -> [f32; 3] {
        move |x, y| [0, 1, 2].map(|k| ((x * 7919 + y * 104_729 + k * 31 + seed * 17) % 251) as f32 / 250.0)
    }

    #[test]
    fn bands_give_the_bits_of_the_whole() {
        let height = 2 * BAND_ROWS as u32 + 37;
        let (a, b) = (painted(24, height, noise(1)), painted(24, height, noise(2)));
        let whole = [&a, &b].map(|p| {
            let bytes: Vec<u8> = p.linear.iter().flat_map(|light| light.map(byte)).collect();
            FlipImageRgb8::with_data(24, height, &bytes)
        });
        let [reference, test] = whole;
        let expected = nv_flip::flip(reference, test, PIXELS_PER_DEGREE).to_vec();
        let errors = error_map(&a, &b, &Cancel::default()).unwrap().errors;
        assert_eq!(errors, expected);
        assert!(expected.iter().any(|error| *error > 0.1));
    }

    #[test]
    fn black_and_white_are_as_far_apart_as_can_be() {
        let (black, white) = (painted(30, 30, |_, _| [0.0; 3]), painted(30, 30, |_, _| [1.0; 3]));
        let errors = error_map(&black, &white, &Cancel::default()).unwrap();
        assert!(errors.mean() > 0.96 && errors.p99() <= 1.0, "{} {}", errors.mean(), errors.p99());
    }

    #[test]
    fn an_image_of_one_pixel_is_compared() {
        let (a, b) = (painted(1, 1, |_, _| [1.0; 3]), painted(1, 1, |_, _| [0.0; 3]));
        assert!(error_map(&a, &b, &Cancel::default()).unwrap().mean() > 0.9);
    }
}
