//! Light as the renderer defines it: what arrives of what has a place or a direction, and how a surface answers to it and
//! to its surroundings.
//!
//! Surroundings are taken from the whole hemisphere of the shading normal, also where a normal map bends it and some of
//! that is below the real surface: the renderer fades reflections there.

use glam::DVec3;

use super::{
    brdf::Microfacets,
    environment::Sky,
    lobe::{Directions, Lobe, reflected},
    phong::Phong,
    world::Seen,
};
use crate::domain::image::{LightShape, Lighting, RenderLight, Shading};

/// A light as it arrives at a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arriving {
    /// Unit, towards the light.
    pub(super) direction: DVec3,
    pub(super) distance: f64,
    pub(super) irradiance: DVec3,
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

/// The same of one direction towards a light that has a size; `at` is a place of [0, 1)². Directions are as likely as they
/// count on a surface that faces the light, which so takes what it takes of one without a size.
pub(super) fn arriving_from(light: &RenderLight, position: DVec3, at: [f64; 2]) -> Arriving {
    let (all, radius) = (arriving(light, position), f64::from(light.radius));
    if radius == 0.0 {
        return all;
    }
    let is_sun = all.distance == f64::INFINITY;
    let sine = if is_sun { radius } else { (radius / all.distance).min(1.0) };
    // Inside of a ball as on it.
    let inside = if is_sun { 1.0 } else { (all.distance / radius).min(1.0).powi(2) };
    let (aside, turn) = (sine * at[0].sqrt(), std::f64::consts::TAU * at[1]);
    let towards = (1.0 - aside * aside).sqrt();
    let (x, y) = all.direction.any_orthonormal_pair();
    let direction = towards * all.direction + aside * (turn.cos() * x + turn.sin() * y);
    let sagitta = (radius * radius - (all.distance * aside).powi(2)).max(0.0).sqrt();
    let distance = if is_sun { all.distance } else { all.distance * towards - sagitta };
    Arriving { direction, distance, irradiance: all.irradiance * inside / towards.max(1e-9) }
}

fn from(light: DVec3, range: Option<f32>, color: DVec3, position: DVec3) -> Arriving {
    let distance = light.distance(position).max(1e-10);
    let window = range.map_or(1.0, |range| (1.0 - (distance / f64::from(range)).powi(4)).clamp(0.0, 1.0));
    Arriving { direction: (light - position) / distance, distance, irradiance: color * window / distance.powi(2) }
}

/// Where the viewer is.
#[derive(Clone, Copy, Debug)]
pub(super) enum Eye {
    At(DVec3),
    /// Endlessly far in this direction, unit.
    Towards(DVec3),
}

impl Eye {
    /// Unit.
    pub(super) fn from(self, position: DVec3) -> DVec3 {
        match self {
            Self::At(eye) => (eye - position).normalize(),
            Self::Towards(direction) => direction,
        }
    }
}

/// How a place answers to light.
#[expect(clippy::large_enum_variant, reason = "one lives at a time, on the stack")]
pub(super) enum Model<'s> {
    Phong(Phong<'s>),
    Pbr { seen: &'s Seen, surface: Microfacets },
}

impl<'s> Model<'s> {
    pub(super) fn new(shading: Shading, seen: &'s Seen, eye: Eye) -> Self {
        let look = &seen.look;
        if shading != Shading::Pbr {
            return Self::Phong(Phong { shading, seen, eye });
        }
        let (base, view) = (look.base.truncate(), eye.from(seen.position));
        Self::Pbr { seen, surface: Microfacets::new(base, look.metallic, look.roughness, look.normal, view) }
    }

    /// What comes back of a light towards the eye, were nothing in between.
    /// By one direction, where the light has a size: `at` is a place of [0, 1)².
    pub(super) fn direct(&self, light: &RenderLight, at: [f64; 2]) -> DVec3 {
        match self {
            Self::Phong(phong) => phong.direct(light, at),
            Self::Pbr { seen, surface } => {
                let light = arriving_from(light, seen.position, at);
                light.irradiance * surface.value(light.direction)
            }
        }
    }

    /// What comes back of light from everywhere, and what shines by itself.
    pub(super) fn indirect(&self, lighting: &Lighting, sky: Option<&Sky<'_>>, directions: &Directions) -> DVec3 {
        let ambient = f64::from(lighting.ambient);
        let (seen, around) = match self {
            Self::Phong(phong) => {
                let sky = sky.map_or(DVec3::ZERO, |sky| phong.reflected(sky, directions));
                (phong.seen, ambient * phong.seen.look.base.truncate() + sky)
            }
            Self::Pbr { seen, surface } => {
                let sky = sky.map_or(DVec3::ZERO, |sky| reflected(sky, surface, directions));
                (*seen, ambient * surface.share_of_everywhere() + sky)
            }
        };
        seen.look.open * around + seen.look.emissive
    }
}

fn wide(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_one_unit_away_shines_as_the_sun_does() {
        let point = arriving(&RenderLight::point([0.0, 1.0, 0.0]), DVec3::ZERO);
        let sun = arriving(&RenderLight::sun([0.0, 1.0, 0.0]), DVec3::ZERO);
        assert_eq!((point.direction, point.irradiance), (sun.direction, sun.irradiance));
        assert_eq!(arriving(&RenderLight::point([0.0, 2.0, 0.0]), DVec3::ZERO).irradiance * 4.0, sun.irradiance);
    }
}
