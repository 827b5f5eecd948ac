//! Phong's model (1975) at a place, of a triangle or between vertices, and reflection mapping (Blinn and Newell 1976).

use std::f64::consts::FRAC_1_PI;

use glam::{DMat3, DVec3};

use super::{
    brdf::{by_cosine, visible},
    environment::Sky,
    lobe::{self, Directions, Lobe},
    shading::{Eye, arriving_from},
    world::{Seen, blend},
};
use crate::domain::image::{REFLECTIVITY, RenderLight, Shading};

/// Share and exponent of the highlight, the same for every material.
const HIGHLIGHT: f64 = 0.2;
const SHININESS: i32 = 32;

/// What comes back towards `eye` of a light that arrives, or 0 from behind: diffuse white, and the highlight.
type Reflection = (DVec3, DVec3);

fn reflection(light: &RenderLight, at: [f64; 2], position: DVec3, normal: DVec3, eye: Eye) -> Reflection {
    let light = arriving_from(light, position, at);
    let cosine = normal.dot(light.direction);
    if cosine <= 0.0 {
        return (DVec3::ZERO, DVec3::ZERO);
    }
    let mirrored = 2.0 * cosine * normal - light.direction;
    let highlight = HIGHLIGHT * mirrored.dot(eye.from(position)).max(0.0).powi(SHININESS);
    (light.irradiance * (cosine * FRAC_1_PI), light.irradiance * (highlight * FRAC_1_PI))
}

/// A place as the model sees it.
pub(super) struct Phong<'s> {
    pub(super) shading: Shading,
    pub(super) seen: &'s Seen,
    pub(super) eye: Eye,
}

impl Phong<'_> {
    /// What comes back of a light towards the eye, were nothing in between.
    pub(super) fn direct(&self, light: &RenderLight, at: [f64; 2]) -> DVec3 {
        let (seen, eye) = (self.seen, self.eye);
        let (diffuse, highlight) = match self.shading {
            Shading::Flat => {
                let centre = seen.vertices.iter().map(|vertex| vertex.0).sum::<DVec3>() / 3.0;
                reflection(light, at, centre, seen.facing, eye)
            }
            Shading::Gouraud => {
                let of = seen.vertices.map(|(position, normal)| reflection(light, at, position, normal, eye));
                (blend(seen.weights, of.map(|r| r.0)), blend(seen.weights, of.map(|r| r.1)))
            }
            Shading::Phong | Shading::Pbr => reflection(light, at, seen.position, seen.look.normal, eye),
        };
        diffuse * seen.look.base.truncate() + highlight
    }

    /// What comes back of the surroundings, at the place itself and its own normal or the triangle's: irradiance over pi in
    /// place of ambient light, and a share of what a mirror shows.
    pub(super) fn reflected(&self, sky: &Sky<'_>, directions: &Directions) -> DVec3 {
        let seen = self.seen;
        let view = self.eye.from(seen.position);
        let normal = visible(if self.shading == Shading::Flat { seen.facing } else { seen.look.normal }, view);
        let mirror = sky.radiance(2.0 * normal.dot(view) * normal - view);
        let diffuse = lobe::reflected(sky, &Lambert { normal }, directions);
        diffuse * seen.look.base.truncate() + f64::from(REFLECTIVITY) * mirror
    }
}

/// What a white diffuse surface reflects.
struct Lambert {
    normal: DVec3,
}

impl Lobe for Lambert {
    fn value(&self, light: DVec3) -> DVec3 {
        DVec3::splat(self.density(light))
    }

    fn sample(&self, at: [f64; 2]) -> DVec3 {
        let (tangent, bitangent) = self.normal.any_orthonormal_pair();
        DMat3::from_cols(tangent, bitangent, self.normal) * by_cosine(at)
    }

    fn density(&self, light: DVec3) -> f64 {
        self.normal.dot(light).max(0.0) * FRAC_1_PI
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_that_comes_back_the_way_it_came_is_brightest() {
        let light = RenderLight::sun([0.0, 1.0, 0.0]);
        let at = |normal, eye| reflection(&light, [0.0; 2], DVec3::ZERO, normal, Eye::Towards(eye));
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
    fn directions_are_drawn_by_their_cosine() {
        let lobe = Lambert { normal: DVec3::new(0.48, 0.6, -0.64) };
        let middle = |k: u32| (f64::from(k) + 0.5) / 100.0;
        let drawn = (0..10_000).map(|k| lobe.sample([middle(k / 100), middle(k % 100)]));
        let (mut mean, mut cosines) = (DVec3::ZERO, 0.0);
        for light in drawn {
            mean += light * 1e-4;
            cosines += lobe.density(light) * 1e-4;
        }
        // The means of cosines, and of cosines over pi, that are as frequent as they are large.
        assert!((mean - lobe.normal * (2.0 / 3.0)).length() < 2e-4, "{mean}");
        assert!((cosines - 2.0 / 3.0 * FRAC_1_PI).abs() < 1e-4, "{cosines}");
    }
}
