//! LOOK: what the surface looks like.

use std::path::PathBuf;

use clap::Args;

use super::values::{LightArg, light, unit_interval};

#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Look")]
pub(crate) struct LookArgs {
    /// Base colour map, sRGB, for every material; apply writes it to the GLB
    #[arg(long, value_name = "MAP")]
    pub(crate) base_color: Option<PathBuf>,
    /// Opacity map for every material, its alpha or else its red, as large as base colour maps; apply writes it to the GLB
    #[arg(long, value_name = "MAP")]
    pub(crate) opacity: Option<PathBuf>,
    /// A light, repeatable: the direction towards a sun and how large it looks, or the place of a point light and its
    /// radius, world space [default: the file's, else 1,1,1]
    #[arg(long, value_name = "X,Y,Z[@DEGREES]|point:X,Y,Z[,R]", value_parser = light, allow_hyphen_values = true)]
    pub(crate) light: Vec<LightArg>,
    /// Ambient light, linear, 0 to 1 [default: 0.2]
    #[arg(long, value_name = "A", value_parser = unit_interval, allow_hyphen_values = true)]
    pub(crate) ambient: Option<f32>,
}
