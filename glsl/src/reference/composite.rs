//! Twin of `composite`: surfaces of a pixel one behind the other, sample by sample (Porter and Duff 1984).

use glam::DVec3;

/// Surfaces of a sample that are told apart, the nearest; farther ones are left out.
pub const MAX_LAYERS: usize = 8;

/// What a pixel sees of the layers so far.
#[derive(Clone, Copy, Debug)]
pub struct Layered {
    pub color: DVec3,
    /// Share of what is behind them that each sample sees.
    pub transmittance: [f64; 4],
}

impl Default for Layered {
    fn default() -> Self {
        Self { color: DVec3::ZERO, transmittance: [1.0; 4] }
    }
}

impl Layered {
    /// Puts a surface behind the others: where it covers samples, it takes `alpha` of what they see.
    pub fn add(&mut self, covered: &[usize], radiance: DVec3, alpha: f64) {
        for &s in covered {
            self.color += radiance * (0.25 * self.transmittance[s] * alpha);
            self.transmittance[s] *= 1.0 - alpha;
        }
    }

    /// Before what is behind everything.
    #[must_use]
    pub fn before(&self, backdrop: DVec3) -> DVec3 {
        self.color + backdrop * (0.25 * self.transmittance.iter().sum::<f64>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_surface_takes_its_share_of_what_those_before_it_leave() {
        let mut pixel = Layered::default();
        pixel.add(&[0, 1, 2, 3], DVec3::X, 0.5);
        pixel.add(&[0, 1], DVec3::Y, 0.75);
        let seen = pixel.before(DVec3::Z);
        assert!((seen - DVec3::new(0.5, 0.1875, 0.3125)).length() < 1e-15, "{seen}");
    }

    #[test]
    fn nothing_is_seen_behind_what_is_solid() {
        let mut pixel = Layered::default();
        pixel.add(&[0, 1, 2, 3], DVec3::X, 1.0);
        pixel.add(&[0, 1, 2, 3], DVec3::Y, 1.0);
        assert_eq!(pixel.before(DVec3::Z), DVec3::X);
    }
}
