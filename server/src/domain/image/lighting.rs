//! What shines, and how light becomes colour.

use std::{f32::consts::PI, sync::Arc};

use serde::{Deserialize, Serialize};

use crate::domain::environment::Environment;

/// Share of what a mirror would show of an environment that Phong's model adds: that of its highlight.
pub const REFLECTIVITY: f32 = 0.2;

/// What shines.
#[derive(Clone, Debug, PartialEq)]
pub struct Lighting {
    pub lights: Vec<RenderLight>,
    /// Light from endlessly far away, by direction; seen behind everything, too.
    pub environment: Option<Arc<Environment>>,
    /// Radiance of light from everywhere, of white.
    pub ambient: f32,
    /// Linear RGB behind everything, where there is no environment.
    pub background: [f32; 3],
}

impl Default for Lighting {
    /// A sun from above the right shoulder.
    fn default() -> Self {
        let s = 1.0 / 3f32.sqrt();
        Self { lights: vec![RenderLight::sun([s, s, s])], environment: None, ambient: 0.2, background: [0.05; 3] }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RenderLight {
    pub shape: LightShape,
    /// Linear: irradiance of a sun on what faces it, radiant intensity of others. Pi lights white diffuse to 1.
    pub color: [f32; 3],
    /// Of a ball that shines, world units; of a sun, the sine of half its angular diameter; 0: a point.
    pub radius: f32,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum LightShape {
    Sun {
        /// Unit, towards the light.
        direction_world: [f32; 3],
    },
    Point {
        position_world: [f32; 3],
        /// World units; nothing arrives from farther. `None`: endless.
        range_world: Option<f32>,
    },
    Spot {
        position_world: [f32; 3],
        range_world: Option<f32>,
        /// Unit, where it shines.
        direction_world: [f32; 3],
        /// Cosines of the angles at which light begins to fade, and at which it ends.
        cone_cosines: [f32; 2],
    },
}

impl RenderLight {
    /// As bright as the sun at one unit of length.
    #[must_use]
    pub fn point(position_world: [f32; 3]) -> Self {
        Self { shape: LightShape::Point { position_world, range_world: None }, color: [PI; 3], radius: 0.0 }
    }

    /// Under which a white diffuse surface that faces it looks white.
    #[must_use]
    pub fn sun(direction_world: [f32; 3]) -> Self {
        Self { shape: LightShape::Sun { direction_world }, color: [PI; 3], radius: 0.0 }
    }
}

/// How light becomes colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Shading {
    /// Phong's model with the triangle's own normal, once for each triangle.
    Flat,
    /// Phong's model at the vertices, blended between them (Gouraud 1971).
    Gouraud,
    /// Phong's model at each pixel.
    #[default]
    Phong,
    /// The metallic-roughness model at each pixel (glTF 2.0, appendix B), with what facets pass on to each other.
    Pbr,
}

/// How maps are read between and over their texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Filter {
    /// The nearest texel of the finest level.
    Nearest,
    /// Between the texels of the finest level.
    Bilinear,
    /// Between two levels of the mip pyramid (Williams 1983).
    #[default]
    Trilinear,
    /// By up to 16 trilinear values along the longer side of the pixel.
    Anisotropic,
    /// By an elliptical Gaussian (Heckbert 1989).
    Ewa,
}
