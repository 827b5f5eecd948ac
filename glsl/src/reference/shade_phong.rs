//! Twin of `shade_phong`: Phong's model (1975) at a place, for light that arrives there.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use super::{lights::Incoming, surroundings::Surroundings};

const SPECULAR_STRENGTH: f64 = 0.2;
const SPECULAR_EXPONENT: f64 = 32.0;

/// What a light adds at a place, of white.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reflected {
    pub diffuse: DVec3,
    pub specular: DVec3,
}

impl Reflected {
    /// Of a surface of linear base colour `base`.
    #[must_use]
    pub fn of(self, base: DVec3) -> DVec3 {
        base * self.diffuse + self.specular
    }

    /// The blend of three, as Gouraud (1971) has it.
    #[must_use]
    pub fn blended(corners: [Self; 3], weights: DVec3) -> Self {
        let sum = |part: fn(&Self) -> DVec3| {
            weights.x * part(&corners[0]) + weights.y * part(&corners[1]) + weights.z * part(&corners[2])
        };
        Self { diffuse: sum(|r| r.diffuse), specular: sum(|r| r.specular) }
    }
}

/// At `position`, seen from `eye`: w = 1 a place, w = 0 the direction towards an orthographic camera.
#[must_use]
pub fn reflected(arriving: &Incoming, position: DVec3, normal: DVec3, eye: glam::DVec4) -> Reflected {
    let cosine = normal.dot(arriving.direction);
    if cosine <= 0.0 {
        return Reflected::default();
    }
    let to_eye = (eye.truncate() - eye.w * position).normalize();
    let mirrored = 2.0 * cosine * normal - arriving.direction;
    let highlight = mirrored.dot(to_eye).max(0.0).powf(SPECULAR_EXPONENT);
    let scattered = arriving.irradiance * FRAC_1_PI;
    Reflected { diffuse: scattered * cosine, specular: scattered * (SPECULAR_STRENGTH * highlight) }
}

/// Light of an environment, from a surface of linear base colour `base`: its irradiance over pi in place of ambient light,
/// and a share `reflectivity` of what a mirror shows (reflection mapping, Blinn and Newell 1976), which is right as far as
/// the surroundings are away.
#[must_use]
pub fn from_surroundings(sky: &Surroundings, base: DVec3, occlusion: f64, reflectivity: f64) -> DVec3 {
    occlusion * (base * sky.diffuse + reflectivity * sky.facing)
}
