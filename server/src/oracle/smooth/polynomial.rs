//! Polynomials of a patch in powers of two of its barycentrics.

use glam::DVec3;

use super::Polynomial;

/// Place of the coefficient of x^m y^n: rows of constant n.
fn index(degree: usize, m: usize, n: usize) -> usize {
    n * (degree + 1) - n * n.saturating_sub(1) / 2 + m
}

fn choose(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64)
}

impl Polynomial {
    /// From a Bézier triangle's points in rows of constant third index: differences of the net are derivatives at its
    /// first corner.
    pub(super) fn of_net(degree: usize, point: impl Fn(usize) -> DVec3) -> Self {
        let coefficient = |m: usize, n: usize| {
            let mut sum = DVec3::ZERO;
            for (j, k) in (0..=m).flat_map(|j| (0..=n).map(move |k| (j, k))) {
                let sign = if (m - j + n - k).is_multiple_of(2) { 1.0 } else { -1.0 };
                sum += sign * choose(m, j) * choose(n, k) * point(index(degree, j, k));
            }
            sum * choose(degree, m + n) * choose(m + n, n)
        };
        Self::new(degree, coefficient)
    }

    fn new(degree: usize, coefficient: impl Fn(usize, usize) -> DVec3) -> Self {
        let all = (0..=degree).flat_map(|n| (0..=degree - n).map(move |m| (m, n)));
        Self { degree, coefficients: all.map(|(m, n)| coefficient(m, n)).collect() }
    }

    fn coefficient(&self, m: usize, n: usize) -> DVec3 {
        self.coefficients[index(self.degree, m, n)]
    }

    /// By x (axis 0) or y.
    pub(super) fn derivative(&self, axis: usize) -> Self {
        let coefficient = |m: usize, n: usize| {
            if axis == 0 {
                self.coefficient(m + 1, n) * (m + 1) as f64
            } else {
                self.coefficient(m, n + 1) * (n + 1) as f64
            }
        };
        Self::new(self.degree.saturating_sub(1), coefficient)
    }

    pub(super) fn times(&self, by: f64) -> Self {
        Self::new(self.degree, |m, n| self.coefficient(m, n) * by)
    }

    /// About as long as it gets in the triangle.
    pub(super) fn size(&self) -> f64 {
        self.coefficients.iter().map(|c| c.length()).fold(0.0, f64::max)
    }

    /// Value and slopes at (x, y), by Horner's rule.
    pub(in crate::oracle) fn first_order(&self, [x, y]: [f64; 2]) -> [DVec3; 3] {
        let [mut value, mut by_x, mut by_y] = [DVec3::ZERO; 3];
        let mut end = self.coefficients.len();
        for row in (0..=self.degree).rev() {
            let start = end - (self.degree + 1 - row);
            let (mut of_row, mut slope) = (DVec3::ZERO, DVec3::ZERO);
            for coefficient in self.coefficients[start..end].iter().rev() {
                slope = slope * x + of_row;
                of_row = of_row * x + *coefficient;
            }
            by_y = by_y * y + value;
            value = value * y + of_row;
            by_x = by_x * y + slope;
            end = start;
        }
        [value, by_x, by_y]
    }

    /// The same in powers of x − x0 and y − y0: its Taylor series, by dividing by them again and again.
    pub(in crate::oracle) fn about(&self, [x, y]: [f64; 2]) -> Self {
        let mut series = Self { degree: self.degree, coefficients: self.coefficients.clone() };
        let degree = self.degree;
        for n in 0..=degree {
            for low in 0..degree - n {
                for m in (low..degree - n).rev() {
                    let above = series.coefficients[index(degree, m + 1, n)];
                    series.coefficients[index(degree, m, n)] += above * x;
                }
            }
        }
        for m in 0..=degree {
            for low in 0..degree - m {
                for n in (low..degree - m).rev() {
                    let above = series.coefficients[index(degree, m, n + 1)];
                    series.coefficients[index(degree, m, n)] += above * y;
                }
            }
        }
        series
    }

    /// How far value and slopes get at most from those at x = y = 0 in the box |x| <= rx, |y| <= ry, by component.
    pub(in crate::oracle) fn spread(&self, [rx, ry]: [f64; 2]) -> [DVec3; 3] {
        let mut spread = [DVec3::ZERO; 3];
        let power = |r: f64, by: usize| r.powi(by as i32);
        for n in 0..=self.degree {
            for m in 0..=self.degree - n {
                let size = self.coefficient(m, n).abs();
                if m + n > 0 {
                    spread[0] += size * power(rx, m) * power(ry, n);
                }
                if m > 0 && m + n > 1 {
                    spread[1] += size * m as f64 * power(rx, m - 1) * power(ry, n);
                }
                if n > 0 && m + n > 1 {
                    spread[2] += size * n as f64 * power(rx, m) * power(ry, n - 1);
                }
            }
        }
        spread
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quartic() -> Polynomial {
        Polynomial::of_net(4, |k| DVec3::new((k as f64 * 1.7).sin(), k as f64, 1.0 / (k as f64 + 1.0)))
    }

    #[test]
    fn a_taylor_series_is_the_same_polynomial_with_its_slopes() {
        let (at, off, polynomial) = ([0.3, 0.2], [0.11, -0.07], quartic());
        let series = polynomial.about(at);
        let place = [at[0] + off[0], at[1] + off[1]];
        for k in 0..3 {
            assert!(series.first_order(off)[k].distance(polynomial.first_order(place)[k]) < 1e-12);
        }
        let slopes = [0, 1].map(|axis| polynomial.derivative(axis).first_order(place)[0]);
        assert!(slopes[0].distance(polynomial.first_order(place)[1]) < 1e-12);
        assert!(slopes[1].distance(polynomial.first_order(place)[2]) < 1e-12);
    }

    #[test]
    fn no_place_of_a_box_is_beyond_the_spread() {
        let series = quartic().about([0.4, 0.3]);
        let (radius, spread) = ([0.2, 0.1], series.spread([0.2, 0.1]));
        for (i, j) in (-4..=4).flat_map(|i| (-4..=4).map(move |j| (i, j))) {
            let place = [radius[0] * f64::from(i) / 4.0, radius[1] * f64::from(j) / 4.0];
            let (here, middle) = (series.first_order(place), series.first_order([0.0; 2]));
            for order in 0..3 {
                assert!((here[order] - middle[order]).abs().cmple(spread[order] + 1e-12).all());
            }
        }
    }
}
