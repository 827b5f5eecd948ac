//! Light as the renderer defines it: Phong's model for lights that have a place or a direction, and ambient light.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use super::world::{Seen, blend};
use crate::domain::image::{LightShape, Lighting, RenderLight, Shading};

/// Share and exponent of the highlight, the same for every material.
const HIGHLIGHT: f64 = 0.2;
const SHININESS: i32 = 32;

/// A light as it arrives at a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arriving {
    /// Unit, towards the light.
    pub(super) direction: DVec3,
    pub(super) distance: f64,
    irradiance: DVec3,
}

/// What arrives of a light where nothing is in between (KHR_lights_punctual).
pub(super) fn arriving(light: &RenderLight, position: DVec3) -> Arriving {
    let color = wide(light.color);
    match light.shape {
        LightShape::Sun { direction_world } => {
            Arriving { direction: wide(direction_world), distance: f64::INFINITY, irradiance: color }
        }
        LightShape::Point { position_world, range_world } => from(wide(position_world), range_world, color, position),
        LightShape::Spot { position_world, range_world, direction_world, cone_cosines: [inner, outer] } => {
            let all = from(wide(position_world), range_world, color, position);
            let cosine = -wide(direction_world).dot(all.direction);
            let wide = (f64::from(inner) - f64::from(outer)).max(1e-3);
            let share = ((cosine - f64::from(outer)) / wide).clamp(0.0, 1.0);
            Arriving { irradiance: all.irradiance * share * share, ..all }
        }
    }
}

fn from(light: DVec3, range: Option<f32>, color: DVec3, position: DVec3) -> Arriving {
    let distance = light.distance(position).max(1e-10);
    let window = range.map_or(1.0, |range| (1.0 - (distance / f64::from(range)).powi(4)).clamp(0.0, 1.0));
    Arriving { direction: (light - position) / distance, distance, irradiance: color * window / distance.powi(2) }
}

/// What comes back towards `eye` of a light that arrives, or 0 from behind: diffuse white, and the highlight.
type Reflection = (DVec3, DVec3);

/// Phong 1975.
fn reflection(light: &RenderLight, position: DVec3, normal: DVec3, eye: Eye) -> Reflection {
    let light = arriving(light, position);
    let cosine = normal.dot(light.direction);
    if cosine <= 0.0 {
        return (DVec3::ZERO, DVec3::ZERO);
    }
    let mirrored = 2.0 * cosine * normal - light.direction;
    let highlight = HIGHLIGHT * mirrored.dot(eye.from(position)).max(0.0).powi(SHININESS);
    (light.irradiance * (cosine * FRAC_1_PI), light.irradiance * (highlight * FRAC_1_PI))
}

/// Where the viewer is.
#[derive(Clone, Copy, Debug)]
pub(super) enum Eye {
    At(DVec3),
    /// Endlessly far in this direction, unit.
    Towards(DVec3),
}

impl Eye {
    fn from(self, position: DVec3) -> DVec3 {
        match self {
            Self::At(eye) => (eye - position).normalize(),
            Self::Towards(direction) => direction,
        }
    }
}

/// What comes back of a light towards the eye, were nothing in between.
pub(super) fn direct(shading: Shading, light: &RenderLight, seen: &Seen, eye: Eye) -> DVec3 {
    let (diffuse, highlight) = match shading {
        Shading::Flat => {
            let centre = seen.vertices.iter().map(|vertex| vertex.0).sum::<DVec3>() / 3.0;
            reflection(light, centre, seen.facing, eye)
        }
        Shading::Gouraud => {
            let of = seen.vertices.map(|(position, normal)| reflection(light, position, normal, eye));
            (blend(seen.weights, of.map(|r| r.0)), blend(seen.weights, of.map(|r| r.1)))
        }
        Shading::Phong | Shading::Pbr => reflection(light, seen.position, seen.look.normal, eye),
    };
    diffuse * seen.look.base.truncate() + highlight
}

/// What comes back of ambient light, and what shines by itself.
pub(super) fn indirect(lighting: &Lighting, seen: &Seen) -> DVec3 {
    f64::from(lighting.ambient) * seen.look.open * seen.look.base.truncate() + seen.look.emissive
}

fn wide(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_that_comes_back_the_way_it_came_is_brightest() {
        let light = RenderLight { ..RenderLight::sun([0.0, 1.0, 0.0]) };
        let at = |normal, eye| reflection(&light, DVec3::ZERO, normal, Eye::Towards(eye));
        let near = |a: DVec3, b: f64| (a - b).abs().max_element() < 1e-6;
        let (diffuse, highlight) = at(DVec3::Y, DVec3::Y);
        assert!(near(diffuse, 1.0) && near(highlight, 0.2), "{diffuse} {highlight}");
        assert!(near(at(DVec3::Y, DVec3::X).1, 0.0));
        assert_eq!(at(-DVec3::Y, DVec3::Y), (DVec3::ZERO, DVec3::ZERO));
        // The mirrored light lies at twice the tilt: its cosine to +Y is 2 · 0.8² − 1.
        let (diffuse, highlight) = at(DVec3::new(0.6, 0.8, 0.0), DVec3::Y);
        assert!(near(diffuse, 0.8) && near(highlight, 0.2 * 0.28f64.powi(32)), "{diffuse} {highlight}");
    }

    #[test]
    fn a_point_one_unit_away_shines_as_the_sun_does() {
        let point = arriving(&RenderLight::point([0.0, 1.0, 0.0]), DVec3::ZERO);
        let sun = arriving(&RenderLight::sun([0.0, 1.0, 0.0]), DVec3::ZERO);
        assert_eq!((point.direction, point.irradiance), (sun.direction, sun.irradiance));
        assert_eq!(arriving(&RenderLight::point([0.0, 2.0, 0.0]), DVec3::ZERO).irradiance * 4.0, sun.irradiance);
    }
}
