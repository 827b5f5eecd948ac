//! Twin of `lights.glsl`: what arrives of a light that has a place or a direction (KHR_lights_punctual), or of a ball of
//! light around it.

use std::f64::consts::TAU;

use glam::DVec3;

use super::keys::mixed;
use crate::layout::raster::{LIGHT_SPOT, LIGHT_SUN, Light};

/// Directions that a ball of light is looked up in.
pub const LIGHT_SAMPLES: u32 = 16;

const GOLDEN_ANGLE: f64 = 2.399_963_229_73;

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
    // Not inside of a ball.
    let mut share = 1.0 / squared.max(f64::from(light.radius).powi(2));
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

/// Samples of a light.
#[must_use]
pub fn samples(light: &Light) -> u32 {
    if light.radius > 0.0 { LIGHT_SAMPLES } else { 1 }
}

/// In [0, 1) each way: how a pixel turns the directions of light number `l`.
#[must_use]
pub fn turn(pixel: [u32; 2], l: u32) -> [f64; 2] {
    let key = mixed(mixed(mixed(pixel[0]) ^ pixel[1]) ^ l);
    [key, mixed(key)].map(|key| f64::from(key >> 8) / 16_777_216.0)
}

/// What arrives from sample `k` of a light, the k-th ring of a spiral of as many over the solid angle of the ball: light
/// from a ball is as bright all over, so that a plane which faces it takes what it takes of a point.
#[must_use]
pub fn incoming_of(light: &Light, position: DVec3, k: u32, turn: [f64; 2]) -> Incoming {
    let all = incoming(light, position);
    let radius = f64::from(light.radius);
    if radius <= 0.0 {
        return all;
    }
    let sine =
        if light.kind == LIGHT_SUN { radius } else { radius / wide(light.position).distance(position).max(radius) };
    let (cosine, n) = ((1.0 - sine * sine).max(0.0).sqrt(), f64::from(LIGHT_SAMPLES));
    let towards = 1.0 - (f64::from(k) + turn[0]) / n * (1.0 - cosine);
    let aside = (1.0 - towards * towards).max(0.0).sqrt();
    let angle = GOLDEN_ANGLE * f64::from(k) + TAU * turn[1];
    let other = if all.direction.x.abs() < 0.7 { DVec3::X } else { DVec3::Y };
    let x = all.direction.cross(other).normalize();
    let y = all.direction.cross(x);
    let direction = towards * all.direction + aside * (angle.cos() * x + angle.sin() * y);
    Incoming { direction, irradiance: all.irradiance * (2.0 / ((1.0 + cosine) * n)) }
}

/// How far a light is in a direction of one of its samples.
#[must_use]
pub fn distance(light: &Light, position: DVec3, direction: DVec3) -> f64 {
    if light.kind == LIGHT_SUN {
        return f64::INFINITY;
    }
    let way = wide(light.position) - position;
    let along = way.dot(direction);
    if light.radius <= 0.0 {
        return way.length();
    }
    along - (f64::from(light.radius).powi(2) - (way - along * direction).length_squared()).max(0.0).sqrt()
}

/// What of sample `k` arrives: `stored` is the share of the whole light, or below 0 holds a bit for each sample.
#[must_use]
pub fn arriving_of(stored: f64, k: u32) -> f64 {
    if stored < 0.0 { f64::from((-1.0 - stored) as u32 >> k & 1) } else { stored }
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

    /// Mean over pixels of what a surface takes of a light.
    fn mean(light: &Light, position: DVec3, share: impl Fn(DVec3) -> f64) -> f64 {
        let pixels = (0..64).flat_map(|y| (0..64).map(move |x| [x, y]));
        let of_pixel = |pixel| {
            let sample = |k| incoming_of(light, position, k, turn(pixel, 0));
            (0..LIGHT_SAMPLES).map(sample).map(|s| s.irradiance.x * share(s.direction)).sum::<f64>()
        };
        pixels.map(of_pixel).sum::<f64>() / 4096.0
    }

    #[test]
    fn a_plane_that_faces_a_ball_takes_pi_radiance_times_the_square_of_radius_over_distance() {
        for (radius, distance) in [(0.5, 2.0), (1.9, 2.0), (0.001, 2.0), (1.0, 50.0)] {
            let ball = Light { radius: radius as f32, position: [0.0, distance as f32, 0.0], ..lamp(LIGHT_POINT) };
            let radiance = 8.0 / (std::f64::consts::PI * radius * radius);
            let expected = std::f64::consts::PI * radiance * (radius / distance).powi(2);
            let found = mean(&ball, DVec3::ZERO, |d| d.y.max(0.0));
            // Stratified along cosines: each pixel's mean of 16 is off by 1/16 of their range at most, and pixels' by less.
            assert!((found / expected - 1.0).abs() < 1e-3, "{found} for {expected}");
        }
    }

    #[test]
    fn a_sun_fills_its_angle_and_no_more() {
        let sine = 0.25f64.sin();
        let sun = Light {
            kind: LIGHT_SUN,
            radius: sine as f32,
            direction: [0.0, 1.0, 0.0],
            color: [3.0; 3],
            ..Light::default()
        };
        let (mut widest, cosine) = (1.0f64, 0.25f64.cos());
        for k in 0..LIGHT_SAMPLES {
            for pixel in [[0, 0], [1, 0], [900, 77]] {
                let towards = incoming_of(&sun, DVec3::ZERO, k, turn(pixel, 3)).direction;
                assert!((towards.length() - 1.0).abs() < 1e-12);
                widest = widest.min(towards.y);
            }
        }
        assert!(widest > cosine - 1e-7 && widest < cosine + 0.1 * (1.0 - cosine), "{widest}");
        assert!((mean(&sun, DVec3::ZERO, |d| d.y.max(0.0)) / 3.0 - 1.0).abs() < 1e-3);
    }

    #[test]
    fn the_penumbra_behind_a_half_plane_is_as_wide_as_the_ball_looks_from_its_edge() {
        // The edge at height 1 over the ground, the ball at height 3: shadow begins and ends R h / (H - h) from the middle.
        let ball = Light { radius: 0.5, position: [0.0, 3.0, 0.0], ..lamp(LIGHT_POINT) };
        let share = |x: f64| {
            let passes = |d: DVec3| if x + d.x / d.y > 0.0 { 1.0 } else { 0.0 };
            let position = DVec3::new(x, 0.0, 0.0);
            mean(&ball, position, |d| passes(d) * d.y) / mean(&ball, position, |d| d.y)
        };
        // The rim as tangents from the edge have it: R / sqrt(2^2 - R^2) = tan of the half angle.
        let half = 0.5 / (4.0f64 - 0.25).sqrt();
        assert_eq!((share(-1.02 * half), share(1.02 * half)), (0.0, 1.0));
        assert!(share(-0.9 * half) > 0.0 && share(0.9 * half) < 1.0 && (share(0.0) - 0.5).abs() < 0.01);
    }

    #[test]
    fn what_is_stored_is_a_share_or_a_bit_for_each_sample() {
        assert_eq!([0, 5].map(|k| arriving_of(0.25, k)), [0.25; 2]);
        let bits = f64::from(-1.0f32 - 0b1000_0000_0000_0101 as f32);
        assert_eq!([0, 1, 2, 15].map(|k| arriving_of(bits, k)), [1.0, 0.0, 1.0, 1.0]);
        assert_eq!([0, 15].map(|k| arriving_of(-1.0, k)), [0.0; 2]);
    }

    #[test]
    fn a_ball_is_as_far_as_its_surface() {
        let ball = Light { radius: 0.5, ..lamp(LIGHT_POINT) };
        assert_eq!(distance(&ball, DVec3::ZERO, DVec3::Y), 1.5);
        assert_eq!(distance(&lamp(LIGHT_POINT), DVec3::ZERO, DVec3::Y), 2.0);
    }
}
