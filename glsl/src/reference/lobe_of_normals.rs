//! Twin of `lobe_of_normals.glsl`: what GGX becomes over normals whose slopes scatter like a Gaussian.
//!
//! What a distant pixel should show is the mean of the model over all its normals. LEADR's lobe (Dupuy et al. 2013) is
//! Beckmann's with another covariance, and Beckmann's is not what smooth surfaces have here; GGX of a larger alpha has the
//! tails of GGX where the normals' Gaussian has none, and loses 11 % of the energy at slopes of 0.2 and 37 % at 0.4, since
//! its masking is that of rough surfaces; a few normals out of the Gaussian show as so many highlights where the lobe is
//! narrower than their distance. But slopes of GGX's facets have Student's bivariate distribution with two degrees of
//! freedom, which is a mean of Gaussians of variance alpha^2 / (2 E), E exponentially distributed: each is scattered in
//! closed form, without any lobe being widened by guess.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use super::{
    brdf::{MIN_COSINE, visibility, visible_normal},
    moments::Spread,
};

/// Gaussians that stand for GGX.
const PARTS: u32 = 12;
/// Values of E between which the mean is taken (the trapezoidal rule in its logarithm, which errs by 1/500 on GGX itself
/// within ten alphas): from next to none of the lobe, to what next to nothing of it is beyond.
const MOST_E: f64 = 8.0;
const LEAST_E: f64 = 0.02;
/// Share of alpha^2 below which normals count as one.
const LEAST_SPREAD: f64 = 1e-3;
/// Half vectors farther from the normal have no slope worth the name.
const LEAST_NH: f64 = 1e-3;

/// Normals around `n`, in units of slope.
#[derive(Clone, Copy, Debug)]
pub struct Scatter {
    /// Unit.
    pub n: DVec3,
    /// Unit, across the normal.
    axes: [DVec3; 2],
    /// Along them.
    variance: DVec2,
}

impl Scatter {
    #[must_use]
    pub fn new(n: DVec3, spread: &Spread) -> Self {
        let variance = DVec2::new(spread.major.length_squared(), spread.minor.length_squared());
        // What bends normals further has not turned the spread with them.
        let x = spread.major - spread.major.dot(n) * n;
        let x = x / x.length_squared().max(1e-30).sqrt();
        Self { n, axes: [x, n.cross(x)], variance }
    }

    #[must_use]
    pub fn is_one_normal(&self, alpha: f64) -> bool {
        self.variance.x <= LEAST_SPREAD * alpha * alpha
    }

    fn along(&self, v: DVec3) -> DVec2 {
        DVec2::new(v.dot(self.axes[0]), v.dot(self.axes[1]))
    }

    /// The lobe of the normal of a slope, and the cosine of light, over GGX's density `apart` from its middle, times
    /// pi / alpha^2 (alpha^2 + |apart|^2)^2.
    fn over_slope(&self, slope: DVec2, apart: DVec2, alpha: f64, [v, l, h]: [DVec3; 3]) -> f64 {
        let n = visible_normal((self.n + slope.x * self.axes[0] + slope.y * self.axes[1]).normalize(), v);
        let nl = n.dot(l).min(1.0);
        if nl <= 0.0 {
            return 0.0;
        }
        let squared = alpha * alpha;
        let density = squared * n.dot(h).powi(2) + n.cross(h).length_squared();
        let ratio = (squared + apart.length_squared()) / density;
        ratio * ratio * visibility(alpha, n.dot(v).clamp(MIN_COSINE, 1.0), nl) * nl
    }

    /// Mean over the normals of distribution, masking over 4 (n.l) (n.v), and the light's cosine.
    #[must_use]
    pub fn lobe(&self, alpha: f64, v: DVec3, l: DVec3) -> f64 {
        let h = (v + l).normalize();
        let nh = self.n.dot(h);
        if nh < LEAST_NH {
            return 0.0;
        }
        let x = self.along(h) / nh;
        let squared = alpha * alpha;
        let step = (MOST_E * (squared + x.length_squared()) / (LEAST_E * squared)).ln() / f64::from(PARTS - 1);
        let part = |k: u32| {
            let e = MOST_E * (-f64::from(k) * step).exp();
            step * e * (-e).exp() * self.part(x, squared / (2.0 * e), k, alpha, [v, l, h])
        };
        (0..PARTS).map(part).sum()
    }

    /// Of the Gaussian of variance `tau`: the normals that have a facet at `x` are another, met by two of its points along
    /// the axes in turn.
    fn part(&self, x: DVec2, tau: f64, k: u32, alpha: f64, directions: [DVec3; 3]) -> f64 {
        let total = self.variance + tau;
        let pulled = self.variance / total;
        let weight = (-0.5 * x.dot(x / total)).exp() / (2.0 * PI * (total.x * total.y).sqrt());
        let axis = if k.is_multiple_of(2) { DVec2::X } else { DVec2::Y };
        let reach = (2.0 * tau * pulled).map(f64::sqrt) * axis;
        let apart = x * (tau / total);
        let at = |reach: DVec2| self.over_slope(pulled * x + reach, apart - reach, alpha, directions);
        weight * 0.5 * (at(reach) + at(-reach))
    }

    /// Mean cosine of light from `l` over normals that face it: the mean of a Gaussian's positive part, within 1 % of its
    /// deviation its softplus.
    #[must_use]
    pub fn cosine(&self, l: DVec3) -> f64 {
        const STEEPNESS: f64 = 1.7376;
        let shrunk = (1.0 + self.variance.element_sum()).sqrt().recip();
        let along = self.along(l);
        let deviation = (shrunk * (along * along).dot(self.variance).sqrt()).max(1e-6);
        let mean = shrunk * self.n.dot(l);
        mean.max(0.0) + deviation / STEEPNESS * (-STEEPNESS * mean.abs() / deviation).exp().ln_1p()
    }
}
