//! Twin of `shade`: Phong's model with a directional light and ambient light.

use glam::DVec3;

const SPECULAR_STRENGTH: f64 = 0.2;
const SPECULAR_EXPONENT: f64 = 32.0;

#[derive(Clone, Copy, Debug)]
pub struct Light {
    /// Unit vector towards the light.
    pub direction: DVec3,
    pub color: DVec3,
    pub ambient: f64,
}

/// Colour of a surface of linear base colour `base`, seen from the unit direction `to_eye`.
#[must_use]
pub fn phong(light: &Light, base: DVec3, normal: DVec3, to_eye: DVec3) -> DVec3 {
    let cosine = normal.dot(light.direction);
    let mirrored = 2.0 * cosine * normal - light.direction;
    let highlight = if cosine > 0.0 { mirrored.dot(to_eye).max(0.0).powf(SPECULAR_EXPONENT) } else { 0.0 };
    base * light.ambient + light.color * (base * cosine.max(0.0) + SPECULAR_STRENGTH * highlight)
}
