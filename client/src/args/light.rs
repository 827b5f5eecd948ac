//! LOOK of images alone: how light becomes colour.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

/// How a map lays out light from everywhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum LayoutArg {
    /// Longitude and latitude
    Equirect,
    /// Six squares: a cross of 4 x 3 or 3 x 4, or a row
    Cube,
    /// A mirror ball
    Sphere,
}

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

/// Whether normals keep their scatter when they are filtered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MomentsArg {
    /// The mean normal of a pixel
    Off,
    /// All normals of a pixel, with --shading pbr: highlights of distant normal maps stay as wide and dim as they are
    On,
}

#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Look")]
pub(crate) struct LightArgs {
    /// Surroundings that light the scene: Radiance HDR or OpenEXR
    #[arg(long, value_name = "HDR")]
    pub(crate) env: Option<PathBuf>,
    /// How the map of --env lays light out
    #[arg(long, value_enum, value_name = "KIND", default_value = "equirect", requires = "env")]
    pub(crate) env_layout: LayoutArg,
    /// A material that mirrors what is around it, repeatable: seen from the middle of its box
    #[arg(long, value_name = "MATERIAL")]
    pub(crate) reflect: Vec<String>,
    /// Pixels each way of the six images of what a reflector sees
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = clap::value_parser!(u32).range(16..=1024), requires = "reflect")]
    pub(crate) reflect_size: u32,
    /// What reflectors see are the walls of the box around all else
    #[arg(long, requires = "reflect")]
    pub(crate) reflect_box: bool,
    /// Mirrors one behind the other that rays follow, with --device reference and --supersample
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=16))]
    pub(crate) bounces: u32,
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
    /// Whether normals of maps keep their scatter when they are filtered, as second moments of slopes
    #[arg(long, value_enum, value_name = "WHETHER", default_value = "off")]
    pub(crate) moments: MomentsArg,
}
