//! Polynomials of a patch in powers of two of its barycentrics.

use glam::DVec3;

use super::Polynomial;

/// Place of the coefficient of x^m y^n: rows of constant n.
fn index(degree: usize, m: usize, n: usize) -> usize {
    (0..n).map(|row| degree + 1 - row).sum::<usize>() + m
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
                let sign = if (m - j + n - k) % 2 == 0 { 1.0 } else { -1.0 };
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
            if axis == 0 { self.coefficient(m + 1, n) * (m + 1) as f64 } else { self.coefficient(m, n + 1) * (n + 1) as f64 }
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

    /// The same in powers of x − x0 and y − y0: its Taylor series.
    pub(in crate::oracle) fn about(&self, [x, y]: [f64; 2]) -> Self {
        Self::new(self.degree, |p, q| {
            let mut sum = DVec3::ZERO;
            for n in q..=self.degree - p {
                for m in p..=self.degree - n {
                    let power = x.powi((m - p) as i32) * y.powi((n - q) as i32);
                    sum += self.coefficient(m, n) * (choose(m, p) * choose(n, q) * power);
                }
            }
            sum
        })
    }

    /// The value and the two slopes where x = y = 0.
    pub(in crate::oracle) fn first_order(&self) -> [DVec3; 3] {
        let slope = |m: usize, n: usize| if self.degree > 0 { self.coefficient(m, n) } else { DVec3::ZERO };
        [self.coefficient(0, 0), slope(1, 0), slope(0, 1)]
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
