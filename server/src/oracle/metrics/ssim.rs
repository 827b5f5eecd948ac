//! Structural similarity (Wang et al. 2004) of luma.

use rayon::prelude::*;

use super::{light::luma, picture::Picture};

const SIGMA_PX: f64 = 1.5;
const RADIUS: usize = 5;
const WINDOW: usize = 2 * RADIUS + 1;
/// (K L)² of the paper for K of 0.01 and 0.03; L, the range of the values, is 1.
const STABILISERS: [f64; 2] = [1e-4, 9e-4];

/// Mean over all pixels whose window of 11 x 11 lies within the image, weighted by a Gaussian of 1.5 pixels; 1 is the
/// same. `None` for pictures smaller than the window. For pictures of one size.
#[must_use]
pub fn ssim(a: &Picture, b: &Picture) -> Option<f64> {
    let (width, height) = (a.width as usize, a.height as usize);
    if width < WINDOW || height < WINDOW {
        return None;
    }
    let planes = [a, b].map(|p| p.linear.par_iter().map(|light| luma(*light)).collect::<Vec<f64>>());
    let weights = gaussian();
    let rows = (0..height - 2 * RADIUS).into_par_iter();
    let sums: Vec<f64> = rows.map(|y| row(&planes, width, y, &weights)).collect();
    Some(sums.iter().sum::<f64>() / ((width - 2 * RADIUS) * (height - 2 * RADIUS)) as f64)
}

fn gaussian() -> [f64; WINDOW] {
    let weights: [f64; WINDOW] =
        std::array::from_fn(|k| (-0.5 * ((k as f64 - RADIUS as f64) / SIGMA_PX).powi(2)).exp());
    let sum: f64 = weights.iter().sum();
    weights.map(|w| w / sum)
}

/// a, b, a², b², ab.
type Moments = [f64; 5];

/// Sum of the index over the windows whose top row is `y`.
fn row(planes: &[Vec<f64>; 2], width: usize, y: usize, weights: &[f64; WINDOW]) -> f64 {
    let mut columns = vec![Moments::default(); width];
    for (k, weight) in weights.iter().enumerate() {
        let line = (y + k) * width..(y + k + 1) * width;
        let pairs = planes[0][line.clone()].iter().zip(&planes[1][line]);
        for (moments, (a, b)) in columns.iter_mut().zip(pairs) {
            add(moments, *weight, [*a, *b, a * a, b * b, a * b]);
        }
    }
    columns.windows(WINDOW).map(|window| index(gathered(window, weights))).sum()
}

fn gathered(window: &[Moments], weights: &[f64; WINDOW]) -> Moments {
    let mut sum = Moments::default();
    window.iter().zip(weights).for_each(|(moments, weight)| add(&mut sum, *weight, *moments));
    sum
}

fn add(sum: &mut Moments, weight: f64, moments: Moments) {
    sum.iter_mut().zip(moments).for_each(|(sum, moment)| *sum += weight * moment);
}

/// Equation 13 of the paper.
fn index([a, b, aa, bb, ab]: Moments) -> f64 {
    let [c1, c2] = STABILISERS;
    let (variance_a, variance_b, covariance) = (aa - a * a, bb - b * b, ab - a * b);
    let structure = (2.0 * covariance + c2) / (variance_a + variance_b + c2);
    (2.0 * a * b + c1) / (a * a + b * b + c1) * structure
}

#[cfg(test)]
mod tests {
    use super::{
        super::{light::linear_from_encoded, painted},
        *,
    };

    fn grey(encoded: f64) -> [f32; 3] {
        [linear_from_encoded(encoded) as f32; 3]
    }

    #[test]
    fn a_shifted_constant_leaves_the_luminance_term_alone() {
        let (a, b) = (painted(20, 15, |_, _| grey(0.25)), painted(20, 15, |_, _| grey(0.75)));
        let expected = (2.0 * 0.25 * 0.75 + 1e-4) / (0.25 * 0.25 + 0.75 * 0.75 + 1e-4);
        assert!((ssim(&a, &b).unwrap() - expected).abs() < 1e-6);
    }

    #[test]
    fn a_negative_of_fine_stripes_has_the_opposite_structure() {
        let stripes = |odd: f64, even: f64| painted(32, 32, move |x, _| grey(if x % 2 == 1 { odd } else { even }));
        let (a, b) = (stripes(0.25, 0.75), stripes(0.75, 0.25));
        // Both means are 1/2 and both variances 1/16, so that the covariance is -1/16.
        let expected = (-0.125 + 9e-4) / (0.125 + 9e-4);
        assert!((ssim(&a, &b).unwrap() - expected).abs() < 1e-3);
    }

    #[test]
    fn an_image_smaller_than_the_window_has_none() {
        let white = |_, _| [1.0; 3];
        assert_eq!(ssim(&painted(10, 11, white), &painted(10, 11, white)), None);
        assert_eq!(ssim(&painted(11, 11, white), &painted(11, 11, white)), Some(1.0));
    }
}
