//! Light and colour as the renderer defines them: Phong's model with a directional light and ambient light, and
//! base colour maps, read between their texels.

use glam::{DVec3, DVec4};

use super::super::field::wrapped;
use crate::domain::{
    detail::{Sampling, Wrap},
    image::{ColorMap, RenderLight},
};

/// Share and exponent of the highlight, the same for every material.
const HIGHLIGHT: f64 = 0.2;
const SHININESS: i32 = 32;
/// Farther texels than this have no others between them.
const FARTHEST: f64 = (1u64 << 52) as f64;

/// A light that shines from one direction, and light from everywhere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Light {
    /// Unit vector towards the light.
    pub(super) direction: DVec3,
    color: DVec3,
    ambient: f64,
}

impl From<&RenderLight> for Light {
    fn from(light: &RenderLight) -> Self {
        let wide = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
        Self { direction: wide(light.direction_world), color: wide(light.color), ambient: f64::from(light.ambient) }
    }
}

impl Light {
    /// What comes back whether the light is seen or not.
    pub(super) fn indirect(&self, base: DVec3) -> DVec3 {
        self.ambient * base
    }

    /// What comes back of the light itself (Phong 1975), towards the unit vector `to_eye`; 0 from behind.
    pub(super) fn direct(&self, base: DVec3, normal: DVec3, to_eye: DVec3) -> DVec3 {
        let cosine = normal.dot(self.direction);
        if cosine <= 0.0 {
            return DVec3::ZERO;
        }
        let mirrored = 2.0 * cosine * normal - self.direction;
        let highlight = HIGHLIGHT * mirrored.dot(to_eye).max(0.0).powi(SHININESS);
        self.color * (cosine * base + highlight)
    }
}

/// The map at (u, v) of [0, 1]², texel i of n at (i + 1/2) / n: at its finest level, whatever the pixel's size;
/// many samples a pixel are the filter.
pub(super) fn bilinear(map: &ColorMap, at: [f64; 2], wrap: [Wrap; 2]) -> DVec4 {
    let size = [map.width, map.height];
    let place = [0, 1].map(|k| (at[k] * f64::from(size[k]) - 0.5).clamp(-FARTHEST, FARTHEST));
    let first = place.map(f64::floor);
    let texel = |i: i64, j: i64| {
        let x = wrapped(first[0] as i64 + i, size[0], wrap[0], Sampling::Center) as usize;
        let y = wrapped(first[1] as i64 + j, size[1], wrap[1], Sampling::Center) as usize;
        DVec4::from_array(map.texels[y * map.width as usize + x].map(f64::from))
    };
    let (s, t) = (place[0] - first[0], place[1] - first[1]);
    (texel(0, 0) * (1.0 - s) + texel(1, 0) * s) * (1.0 - t) + (texel(0, 1) * (1.0 - s) + texel(1, 1) * s) * t
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_that_comes_back_the_way_it_came_is_brightest() {
        let light = Light::from(&RenderLight { direction_world: [0.0, 1.0, 0.0], ..RenderLight::default() });
        let base = DVec3::new(0.5, 0.25, 1.0);
        assert_eq!(light.direct(base, DVec3::Y, DVec3::Y), base + 0.2);
        assert_eq!(light.direct(base, DVec3::Y, DVec3::X), base);
        assert_eq!(light.direct(base, -DVec3::Y, DVec3::Y), DVec3::ZERO);
        assert_eq!(light.indirect(base), f64::from(0.2f32) * base);
        let tilted = DVec3::new(0.6, 0.8, 0.0);
        // The mirrored light lies at twice the tilt: its cosine to +Y is 2 · 0.8² − 1.
        let expected = 0.8 * base + 0.2 * 0.28f64.powi(32);
        assert!((light.direct(base, tilted, DVec3::Y) - expected).length() < 1e-15);
    }

    #[test]
    fn maps_are_bilinear_between_texels_and_wrap() {
        let texels = [0.0, 1.0, 2.0, 7.0].map(|x| [x; 4]).to_vec();
        let map = ColorMap { width: 2, height: 2, texels };
        let value = |u, v, wrap| bilinear(&map, [u, v], [wrap; 2]).x;
        assert_eq!(value(0.5, 0.5, Wrap::Clamp), 2.5);
        assert_eq!(value(0.375, 0.75, Wrap::Clamp), 3.25);
        assert_eq!(value(0.0, 0.25, Wrap::Repeat), 0.5);
        assert_eq!(value(0.0, 0.25, Wrap::Mirror), 0.0);
        assert_eq!(value(-7.5, 0.25, Wrap::Clamp), 0.0);
        assert!(value(1e300, -1e300, Wrap::Repeat).is_finite());
    }
}
