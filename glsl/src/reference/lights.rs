//! Twin of `lights.glsl`: what arrives of a light that has a place or a direction (KHR_lights_punctual).

use glam::DVec3;

use crate::layout::raster::{LIGHT_SPOT, LIGHT_SUN, Light};

/// What arrives at a place if nothing is in between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Incoming {
    /// Unit, towards the light.
    pub direction: DVec3,
    /// On a surface that faces the light.
    pub irradiance: DVec3,
}

#[must_use]
pub fn incoming(light: &Light, position: DVec3) -> Incoming {
    let (color, direction) = (wide(light.color), wide(light.direction));
    if light.kind == LIGHT_SUN {
        return Incoming { direction, irradiance: color };
    }
    let way = wide(light.position) - position;
    let squared = way.length_squared().max(1e-20);
    let towards = way / squared.sqrt();
    let mut share = 1.0 / squared;
    if light.range > 0.0 {
        let near = squared / f64::from(light.range).powi(2);
        share *= (1.0 - near * near).clamp(0.0, 1.0);
    }
    if light.kind == LIGHT_SPOT {
        let inside = -direction.dot(towards) * f64::from(light.cone_scale) + f64::from(light.cone_offset);
        share *= inside.clamp(0.0, 1.0).powi(2);
    }
    Incoming { direction: towards, irradiance: color * share }
}

fn wide(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::raster::LIGHT_POINT;

    fn lamp(kind: u32) -> Light {
        Light { kind, position: [0.0, 2.0, 0.0], direction: [0.0, -1.0, 0.0], color: [8.0; 3], ..Light::default() }
    }

    #[test]
    fn a_point_fades_with_the_square_of_its_distance_and_ends_at_its_range() {
        let near = incoming(&lamp(LIGHT_POINT), DVec3::ZERO);
        assert_eq!(near, Incoming { direction: DVec3::Y, irradiance: DVec3::splat(2.0) });
        let ranged = Light { range: 2.0, ..lamp(LIGHT_POINT) };
        assert_eq!(incoming(&ranged, DVec3::ZERO).irradiance, DVec3::ZERO);
        assert_eq!(incoming(&ranged, DVec3::new(0.0, 1.0, 0.0)).irradiance, DVec3::splat(8.0 * (1.0 - 1.0 / 16.0)));
    }

    #[test]
    fn a_spot_shines_within_its_cone() {
        // Inner cone 0, outer cone 45 degrees.
        let outer = 0.5f32.sqrt();
        let scale = 1.0 / (1.0 - outer);
        let spot = Light { cone_scale: scale, cone_offset: -outer * scale, ..lamp(LIGHT_SPOT) };
        assert!((incoming(&spot, DVec3::ZERO).irradiance.x - 2.0).abs() < 1e-6);
        assert!(incoming(&spot, DVec3::new(2.01, 0.0, 0.0)).irradiance.x < 1e-9);
        assert!(incoming(&spot, DVec3::new(1.9, 0.0, 0.0)).irradiance.x > 0.0);
    }
}
