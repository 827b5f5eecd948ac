//! GEOMETRY: how finely, and how seams and normals are made.

use clap::{Args, ValueEnum};

use super::values::not_negative;

#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Geometry")]
pub(crate) struct GeometryArgs {
    /// Split every triangle into 4^LEVEL, 0 to 12
    #[arg(long, value_name = "LEVEL", value_parser = clap::value_parser!(u32).range(0..=12), allow_hyphen_values = true)]
    pub(crate) uniform: Option<u32>,
    /// Refuse a plan with more triangles
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) max_triangles: Option<u64>,
    /// Normals of the displaced surface: from derivatives, or from the triangles
    #[arg(long, value_enum, default_value = "analytic")]
    pub(crate) normals: NormalsArg,
    /// How the sides of a seam become one
    #[arg(long, value_enum, default_value = "mean")]
    pub(crate) seams: SeamsArg,
    /// Width of the ramp that reconciles a seam's sides; 0 is off
    #[arg(long, value_name = "TEXELS", default_value = "3", value_parser = not_negative, allow_hyphen_values = true)]
    pub(crate) feather: f32,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum NormalsArg {
    #[default]
    Analytic,
    Geometric,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum SeamsArg {
    #[default]
    Mean,
    Dominant,
}
