//! LOOK of images alone: how light becomes colour.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

/// Shadows of lights.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ShadowsArg {
    None,
    /// By rays towards the lights
    Ray,
    /// By what the lights see: faster, and off by a texel at edges
    Map,
}

/// How light becomes colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ShadingArg {
    /// Phong's model, once for each triangle
    Flat,
    /// Phong's model at the vertices, blended
    Gouraud,
    /// Phong's model at each pixel
    Phong,
    /// The metallic-roughness model of glTF
    Pbr,
}

/// How maps are read between and over their texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum FilterArg {
    /// The nearest texel of the finest level
    Nearest,
    /// Between texels of the finest level
    Bilinear,
    /// Between two levels of the mip pyramid
    Trilinear,
    /// Up to 16 trilinear values along the pixel's longer side
    Anisotropic,
    /// An elliptical Gaussian over the pixel
    Ewa,
}

/// How materials of alpha mode BLEND are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum AlphaArg {
    /// Cut off at 0.5
    Mask,
    /// In layers from front to back, up to 8
    Blend,
    /// Each sample by chance, as likely as alpha says: noise that more samples lessen
    Stochastic,
}

#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Look")]
pub(crate) struct LightArgs {
    /// Surroundings that light the scene: an equirectangular map, Radiance HDR or OpenEXR
    #[arg(long, value_name = "HDR")]
    pub(crate) env: Option<PathBuf>,
    /// Shadows of lights that have a place or a direction
    #[arg(long, value_enum, value_name = "KIND", default_value = "none")]
    pub(crate) shadows: ShadowsArg,
    /// How light becomes colour
    #[arg(long, value_enum, value_name = "KIND", default_value = "phong")]
    pub(crate) shading: ShadingArg,
    /// How maps are read between and over their texels
    #[arg(long, value_enum, value_name = "KIND", default_value = "trilinear")]
    pub(crate) filter: FilterArg,
    /// How materials of alpha mode BLEND are shown
    #[arg(long, value_enum, value_name = "KIND", default_value = "blend")]
    pub(crate) alpha: AlphaArg,
}
