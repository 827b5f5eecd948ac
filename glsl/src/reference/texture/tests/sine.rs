//! A closed form: under a box of width w, a wave of frequency f keeps sin(z) / z of its amplitude, z = pi f w.

use std::f64::consts::{PI, TAU};

use super::{Filter, REPEAT, filtered, grey};

const SIDE: usize = 256;

/// The share of the amplitude of a wave of `waves` periods along u that a filter leaves, for a pixel with sides of `across`
/// texels along u and `down` along v.
fn left(filter: Filter, waves: usize, across: f64, down: f64) -> f64 {
    let levels = grey(SIDE, 4, |x, _| (TAU * (waves * x) as f64 / SIDE as f64).sin());
    let (dx, dy) = ([across / SIDE as f64, 0.0], [0.0, down / 4.0]);
    let steps = 4096;
    let product = |i: usize| {
        let u = (i as f64 + 0.5) / f64::from(steps);
        let phase = TAU * waves as f64 * (u - 0.5 / SIDE as f64);
        2.0 * phase.sin() * filtered(filter, &levels, [u, 0.37], dx, dy, REPEAT)[0]
    };
    (0..steps as usize).map(product).sum::<f64>() / f64::from(steps)
}

fn sinc(z: f64) -> f64 {
    if z == 0.0 { 1.0 } else { z.sin() / z }
}

/// What bilinear reconstruction leaves: its kernel is the square of a box.
fn reconstructed(waves: usize) -> f64 {
    sinc(PI * waves as f64 / SIDE as f64).powi(2)
}

/// sin(z)/z and exp(-z^2/6) have the same first and second order, and differ by at most z^4 / 180; lattice and
/// end of the Gaussian are allowed 1/100. Above z = 2 both are small: what is left differs by at most 0.2.
#[test]
fn ewa_leaves_of_a_wave_what_a_box_leaves_up_to_the_fourth_order() {
    for (across, down) in [(2.0, 2.0), (3.0, 3.0), (3.9, 2.0), (8.0, 2.0), (24.0, 3.0)] {
        for waves in [1, 2, 4, 8, 16, 24, 32] {
            let z = PI * waves as f64 / SIDE as f64 * across;
            let off = (left(Filter::Ewa, waves, across, down) - sinc(z) * reconstructed(waves)).abs();
            assert!(off <= (z.powi(4) / 180.0).min(0.2) + 0.01, "{across} x {down} texels, z = {z}: {off}");
        }
    }
}

/// The mean of N waves at even steps over a box of width w is sin(z) / (N sin(z / N)); a tap of its own width keeps
/// between a box and a box with a tent after it: sinc(z / N)^3 to sinc(z / N).
#[test]
fn even_rows_of_taps_leave_of_a_wave_what_their_sum_says() {
    for taps in [2.0, 4.0, 8.0, 16.0] {
        for width in [1.0, 2.0, 4.0] {
            for waves in [1, 2, 4, 8, 16, 24] {
                let z = PI * waves as f64 / SIDE as f64 * width * taps;
                let row = sinc(z) / sinc(z / taps);
                let found = left(Filter::Anisotropic, waves, width * taps, width);
                let least = row * sinc(z / taps).powi(3);
                let bounds = if width > 1.0 { [least, row] } else { [row * reconstructed(waves); 2] };
                let (low, high) = (bounds[0].min(bounds[1]), bounds[0].max(bounds[1]));
                assert!((low - 1e-3..=high + 1e-3).contains(&found), "{taps} of {width}, z = {z}: {found}");
            }
        }
    }
}
