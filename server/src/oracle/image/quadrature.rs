//! Gauss's quadrature.

use std::f64::consts::PI;

/// Places and weights on [0, 1] of the rule that is exact up to degree 2 `count` - 1 (Gauss 1814): roots of Legendre's
/// polynomial, by Newton from their asymptotes.
pub(super) fn gauss(count: usize) -> Vec<[f64; 2]> {
    (0..count)
        .map(|k| {
            let mut x = (PI * (k as f64 + 0.75) / (count as f64 + 0.5)).cos();
            for _ in 0..8 {
                let (value, slope) = legendre(count, x);
                x -= value / slope;
            }
            let slope = legendre(count, x).1;
            [0.5 - 0.5 * x, 1.0 / ((1.0 - x * x) * slope * slope)]
        })
        .collect()
}

/// Legendre's polynomial and its derivative, inside (-1, 1).
fn legendre(degree: usize, x: f64) -> (f64, f64) {
    let (mut before, mut last) = (1.0, x);
    for k in 2..=degree {
        let k = k as f64;
        (before, last) = (last, ((2.0 * k - 1.0) * x * last - (k - 1.0) * before) / k);
    }
    (last, degree as f64 * (before - x * last) / (1.0 - x * x))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_integrated_exactly() {
        for count in [1, 2, 5, 32, 128] {
            let rule = gauss(count);
            for power in [0, 1, 2 * count as i32 - 1] {
                let sum: f64 = rule.iter().map(|[x, weight]| weight * x.powi(power)).sum();
                assert!((sum * f64::from(power + 1) - 1.0).abs() < 1e-11, "{count} nodes, power {power}: {sum}");
            }
        }
    }
}
