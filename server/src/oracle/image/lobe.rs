//! Light from everywhere that a surface sends to the viewer: by samples of both its factors (Veach 1995).

use glam::DVec3;

use super::{environment::Sky, sampling::Further};

/// Pairs of directions that a ray of the camera is followed by.
const PAIRS: u32 = 4;

/// How a surface reflects light towards one viewer.
pub(super) trait Lobe {
    /// Share of the radiance from a unit direction that leaves towards the viewer, times the light's cosine, per
    /// steradian; 0 from below the surface.
    fn value(&self, light: DVec3) -> DVec3;

    /// A direction by `density`, unit, from a place of [0, 1)².
    fn sample(&self, at: [f64; 2]) -> DVec3;

    /// Of `sample`, per steradian; over 0 where `value` is.
    fn density(&self, light: DVec3) -> f64;
}

/// Places of [0, 1)² for the directions that one ray of the camera is followed by: by the sky, and by the surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Directions {
    pub(super) by: [Further; 2],
    /// Of the camera's rays in a pixel.
    pub(super) sample: u32,
}

/// The integral of the sky's radiance times a lobe. Nothing is in between.
pub(super) fn reflected(sky: &Sky<'_>, lobe: &impl Lobe, directions: &Directions) -> DVec3 {
    if !sky.shines() {
        return DVec3::ZERO;
    }
    let first = directions.sample.wrapping_mul(PAIRS);
    let pair = |k: u32| {
        let [by_sky, by_lobe] = directions.by.map(|by| by.at(first.wrapping_add(k)));
        weighed(sky, lobe, sky.sample(by_sky)) + weighed(sky, lobe, lobe.sample(by_lobe))
    };
    (0..PAIRS).map(pair).sum::<DVec3>() / f64::from(PAIRS)
}

/// By the balance heuristic: one sample of each density, and the sum of both below.
fn weighed(sky: &Sky<'_>, lobe: &impl Lobe, light: DVec3) -> DVec3 {
    let value = lobe.value(light);
    if value == DVec3::ZERO {
        return DVec3::ZERO;
    }
    sky.radiance(light) * value / (sky.density(light) + lobe.density(light))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use super::{
        super::{brdf::Microfacets, sampling::Places},
        *,
    };
    use crate::domain::environment::Environment;

    /// Red from the one side and blue from the other, with a small sun.
    fn map() -> Environment {
        let color = |i: u32| if i % 32 < 16 { [1.0, 0.2, 0.0] } else { [0.0, 0.2, 1.0] };
        let mut map = Environment { width: 32, height: 16, texels: (0..512).map(color).collect() };
        map.texels[5 * 32 + 20] = [200.0; 3];
        map
    }

    /// By a grid of 32 places a texel each way.
    fn integral(sky: &Sky<'_>, lobe: &impl Lobe) -> DVec3 {
        let (columns, rows) = (1024, 512);
        let mut sum = DVec3::ZERO;
        for (i, j) in (0..columns * rows).map(|k| (k % columns, k / columns)) {
            let (sine, cosine) = (TAU * (f64::from(i) + 0.5) / f64::from(columns)).sin_cos();
            let (out, up) = (PI * (f64::from(j) + 0.5) / f64::from(rows)).sin_cos();
            let light = DVec3::new(out * cosine, up, out * sine);
            sum += out * sky.radiance(light) * lobe.value(light);
        }
        sum * TAU * PI / f64::from(columns * rows)
    }

    fn pixel(sky: &Sky<'_>, lobe: &impl Lobe, x: u32, samples: u32) -> DVec3 {
        let by = [0, 1].map(|number| Places::of_pixel(x, 0).further(number));
        let sum: DVec3 = (0..samples).map(|sample| reflected(sky, lobe, &Directions { by, sample })).sum();
        sum / f64::from(samples)
    }

    fn surfaces() -> [Microfacets; 4] {
        let (normal, view) = (DVec3::new(0.36, 0.8, -0.48), DVec3::new(0.0, 0.6, -0.8));
        let base = DVec3::new(0.9, 0.5, 0.3);
        [(0.0, 0.3), (0.0, 1.0), (1.0, 0.3), (1.0, 0.7)].map(|(m, r)| Microfacets::new(base, m, r, normal, view))
    }

    #[test]
    fn samples_are_the_integral_over_all_directions() {
        let (map, surfaces) = (map(), surfaces());
        let sky = Sky::new(&map);
        for surface in &surfaces {
            let (found, expected) = (pixel(&sky, surface, 0, 1 << 14), integral(&sky, surface));
            let off = ((found - expected) / expected).abs().max_element();
            assert!(off < 3e-4, "{found} for {expected}");
        }
    }

    #[test]
    fn pixels_of_64_rays_are_off_by_a_hundredth_under_a_small_sun() {
        let (map, surfaces) = (map(), surfaces());
        let sky = Sky::new(&map);
        for surface in &surfaces {
            let expected = integral(&sky, surface);
            let square = |x| ((pixel(&sky, surface, x, 64) - expected) / expected).length_squared() / 3.0;
            let off = ((0..64).map(square).sum::<f64>() / 64.0).sqrt();
            assert!(off < 0.01, "{off}");
        }
    }

    #[test]
    fn black_surroundings_light_nothing() {
        let black = Environment { width: 2, height: 1, texels: vec![[0.0; 3]; 2] };
        assert_eq!(pixel(&Sky::new(&black), &surfaces()[0], 0, 4), DVec3::ZERO);
    }
}
