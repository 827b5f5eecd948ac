//! Quantities that vary over a triangle, known at its corners and up to a bound in between.

use glam::DVec3;

/// A vector field over a triangle: anywhere within `curvature` of what is interpolated between the corners.
#[derive(Clone, Copy, Debug)]
pub(super) struct Field {
    pub(super) corners: [DVec3; 3],
    pub(super) curvature: f64,
}

/// A number over a triangle, likewise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scalar {
    pub(super) corners: [f64; 3],
    pub(super) curvature: f64,
}

/// Σ λᵢ (1 − λᵢ)² / 2 is at most this: the remainder of interpolation, over the largest second derivative between
/// corners.
const REMAINDER: f64 = 2.0 / 9.0;

const PAIRS: [(usize, usize); 3] = [(0, 1), (1, 2), (2, 0)];

/// A B − Σ λᵢ Aᵢ Bᵢ for interpolated A and B is −Σ λᵢ λⱼ ΔA ΔB over the pairs: each λᵢ λⱼ is at most 1/4, and their sum 1/3.
fn cross_term(a: [f64; 3], b: [f64; 3]) -> f64 {
    let products = [a[0] * b[0], a[1] * b[1], a[2] * b[2]];
    let most = products.iter().fold(0.0, |most: f64, x| most.max(*x));
    (products.iter().sum::<f64>() / 4.0).min(most / 3.0)
}

impl Field {
    pub(super) fn linear(corners: [DVec3; 3]) -> Self {
        Self { corners, curvature: 0.0 }
    }

    /// How much any two corners differ.
    pub(super) fn steps(&self) -> [f64; 3] {
        PAIRS.map(|(i, j)| self.corners[i].distance(self.corners[j]))
    }

    /// The longest it gets.
    pub(super) fn most(&self) -> f64 {
        self.corners.iter().fold(0.0, |most: f64, c| most.max(c.length())) + self.curvature
    }

    /// The shortest that what is interpolated gets.
    fn least(&self) -> f64 {
        let [a, b, c] = self.corners;
        let middle = (a + b + c) / 3.0;
        let spread = self.corners.iter().fold(0.0, |most: f64, c| most.max(c.distance(middle)));
        (middle.length() - spread).max(0.0)
    }

    pub(super) fn add(self, o: Self) -> Self {
        let corners = std::array::from_fn(|k| self.corners[k] + o.corners[k]);
        Self { corners, curvature: self.curvature + o.curvature }
    }

    pub(super) fn times(self, s: Scalar) -> Self {
        let corners = std::array::from_fn(|k| self.corners[k] * s.corners[k]);
        let (a, b) = (self.most(), s.most());
        let curvature = self.curvature * b + a * s.curvature + cross_term(self.steps(), s.steps());
        Self { corners, curvature: curvature.min(2.0 * a * b) }
    }

    pub(super) fn dot(self, o: Self) -> Scalar {
        let corners = std::array::from_fn(|k| self.corners[k].dot(o.corners[k]));
        Scalar { corners, curvature: self.product_curvature(&o) }
    }

    pub(super) fn cross(self, o: Self) -> Self {
        let corners = std::array::from_fn(|k| self.corners[k].cross(o.corners[k]));
        Self { corners, curvature: self.product_curvature(&o) }
    }

    fn product_curvature(&self, o: &Self) -> f64 {
        let (a, b) = (self.most(), o.most());
        (self.curvature * b + a * o.curvature + cross_term(self.steps(), o.steps())).min(2.0 * a * b)
    }

    /// self / max(|by|, least). Along a line, with m = |by|, the second derivative is at most
    /// 2 |self'| |by'| / m² + 2 |self| |by'|² / m³.
    pub(super) fn over(self, by: Self, least: f64) -> Self {
        let corners = std::array::from_fn(|k| self.corners[k] / by.corners[k].length().max(least));
        let low = (by.least() - by.curvature).max(least);
        let high = by.most();
        let longest = |steps: [f64; 3]| steps.into_iter().fold(0.0, f64::max);
        let (own, step) = (longest(self.steps()), longest(by.steps()));
        let most = self.most();
        let mut curvature = self.curvature / low + most * by.curvature / (low * low);
        if step > 0.0 && high > least {
            curvature += REMAINDER * (2.0 * own * step / (low * low) + 2.0 * most * step * step / low.powi(3));
            // Where the least length takes over there is a kink.
            curvature += if low <= least { 2.0 / 3.0 * most * step / (least * least) } else { 0.0 };
        }
        let result = Self { corners, curvature: 0.0 };
        // Nowhere longer than this, and so never farther than twice that from anything.
        let bound = 2.0 * most / low;
        Self { curvature: if curvature < bound { curvature } else { bound }, ..result }
    }

    pub(super) fn unit(self) -> Self {
        let unit = self.over(self, 1e-12);
        Self { curvature: unit.curvature.min(2.0), ..unit }
    }
}

impl Scalar {
    pub(super) fn steps(&self) -> [f64; 3] {
        PAIRS.map(|(i, j)| (self.corners[i] - self.corners[j]).abs())
    }

    pub(super) fn most(&self) -> f64 {
        self.corners.iter().fold(0.0, |most: f64, c| most.max(c.abs())) + self.curvature
    }
}

/// How far to / (to + from) is at most from what is interpolated between the corners, `to` and `from` being linear.
/// Where both vanish at a corner it is not defined there, and any value in between may occur.
pub(super) fn ratio_curvature(to: [f64; 3], from: [f64; 3], range: f64) -> f64 {
    let both: [f64; 3] = std::array::from_fn(|k| to[k] + from[k]);
    let low = both.iter().fold(f64::INFINITY, |low, x| low.min(*x));
    let longest = |x: [f64; 3]| PAIRS.iter().fold(0.0, |most: f64, (i, j)| most.max((x[*i] - x[*j]).abs()));
    let curvature = REMAINDER * 2.0 * longest(both) * longest(to).max(longest(from)) / (low * low);
    if curvature < range { curvature } else { range }
}
