//! LOOK of heights that are shown per pixel.

use clap::{Args, ValueEnum};

/// Whether relief takes its own light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SelfShadowArg {
    None,
    /// A march towards each light is stopped or not
    Hard,
    /// By how far the way towards a light comes below the heights
    Soft,
}

/// Whether relief changes the outline of what it is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SilhouettesArg {
    None,
    /// Through prisms over the triangles: as the displaced surface has it
    Shell,
    /// Over a quadric that the surface is near to at each vertex: cheaper
    Quadric,
}

/// For methods that show heights per pixel.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Relief")]
pub(crate) struct ReliefArgs {
    /// Steps of each march, with --method steep, occlusion, relief and cone, 1 to 512 [default: by angle and by the map's
    /// thinnest feature]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=512))]
    pub(crate) steps: Option<u32>,
    /// Whether relief takes its own light, with methods that find depth
    #[arg(long, value_enum, value_name = "KIND", default_value = "none")]
    pub(crate) self_shadow: SelfShadowArg,
    /// Whether relief changes the outline of what it is on, with methods that find depth
    #[arg(long, value_enum, value_name = "KIND", default_value = "none")]
    pub(crate) silhouettes: SilhouettesArg,
}
