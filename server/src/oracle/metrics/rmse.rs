//! Root mean square error in linear light.

use rayon::prelude::*;

use super::picture::Picture;

/// Over the three channels of all pixels; alpha is not counted, light above 1 is. For pictures of one size.
#[must_use]
pub fn rmse_linear(a: &Picture, b: &Picture) -> f64 {
    let row = a.width.max(1) as usize;
    let rows = a.linear.par_chunks(row).zip(b.linear.par_chunks(row));
    let of_row = |(a, b): (&[[f32; 3]], &[[f32; 3]])| a.iter().zip(b).map(|(a, b)| square(*a, *b)).sum::<f64>();
    // Row by row, so that the sum does not depend on the threads.
    let sums: Vec<f64> = rows.map(of_row).collect();
    (sums.iter().sum::<f64>() / (3 * a.linear.len()).max(1) as f64).sqrt()
}

fn square(a: [f32; 3], b: [f32; 3]) -> f64 {
    (0..3).map(|k| (f64::from(a[k]) - f64::from(b[k])).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::{super::painted, *};

    #[test]
    fn a_constant_difference_is_the_error() {
        let a = painted(9, 5, |x, _| [x as f32, 0.25, 0.5]);
        let b = painted(9, 5, |x, _| [x as f32 + 0.5, 0.75, 1.0]);
        assert_eq!(rmse_linear(&a, &b), 0.5);
    }

    #[test]
    fn one_channel_of_one_pixel_counts_as_its_share() {
        let a = painted(2, 2, |_, _| [0.0; 3]);
        let b = painted(2, 2, |x, y| [0.0, if (x, y) == (1, 0) { 3.0 } else { 0.0 }, 0.0]);
        assert_eq!(rmse_linear(&a, &b), (9.0f64 / 12.0).sqrt());
    }
}
