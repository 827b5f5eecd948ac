//! LOOK: what the surface looks like.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::values::{LightArg, light, unit_interval};

/// Where on its maps a surface is read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum ProjectionArg {
    /// At texture coordinates
    #[default]
    Uv,
    /// Around +Y, from the centre of the mesh's box
    Sphere,
    /// By Everson's printed formula, which mirrors half of it
    SphereAsPrinted,
    /// Along X
    PlanarX,
    /// Along Y, from above
    #[value(alias = "planar")]
    PlanarY,
    /// Along Z
    PlanarZ,
    /// Along the axis nearest to the normal
    Box,
    /// Along all three axes, blended by the normal
    Triplanar,
}

#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Look")]
pub(crate) struct LookArgs {
    /// Base colour map, sRGB, for every material; apply writes it to the GLB
    #[arg(long, value_name = "MAP")]
    pub(crate) base_color: Option<PathBuf>,
    /// Opacity map for every material, its alpha or else its red, as large as base colour maps; apply writes it to the GLB
    #[arg(long, value_name = "MAP")]
    pub(crate) opacity: Option<PathBuf>,
    /// Metallic-roughness map, linear, green roughness and blue metallic, for every material; apply writes it to the GLB
    #[arg(long, value_name = "MAP")]
    pub(crate) metallic_roughness: Option<PathBuf>,
    /// Occlusion map, linear, its red, for every material; apply writes it to the GLB
    #[arg(long, value_name = "MAP")]
    pub(crate) occlusion: Option<PathBuf>,
    /// Emissive map, sRGB, for every material; apply writes it to the GLB
    #[arg(long, value_name = "MAP")]
    pub(crate) emissive: Option<PathBuf>,
    /// Where maps are read, in images: at texture coordinates, or where the place in the mesh is projected to
    #[arg(long, value_enum, value_name = "KIND", default_value = "uv")]
    pub(crate) projection: ProjectionArg,
    /// A light, repeatable: the direction towards a sun and how large it looks, or the place of a point light and its
    /// radius, world space [default: the file's, else 1,1,1]
    #[arg(long, value_name = "X,Y,Z[@DEGREES]|point:X,Y,Z[,R]", value_parser = light, allow_hyphen_values = true)]
    pub(crate) light: Vec<LightArg>,
    /// Ambient light, linear, 0 to 1 [default: 0.2]
    #[arg(long, value_name = "A", value_parser = unit_interval, allow_hyphen_values = true)]
    pub(crate) ambient: Option<f32>,
}
