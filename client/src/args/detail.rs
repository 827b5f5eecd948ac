//! DETAIL: what is on the surface. The order of these flags has meaning (`options::detail`), so each
//! keeps every occurrence and clap's index of it.

use std::path::PathBuf;

use clap::{ArgAction, Args, ValueEnum};

use super::values::{Swizzle, finite, swizzle};

/// One group of details per material; layers of a group add. A flag such as --scale belongs to the map or
/// expression before it; before the first of its group it holds for the whole group.
#[derive(Debug, Default, Args)]
#[command(
    next_help_heading = "Detail (a modifier belongs to the map before it; before the first map, to all of the group)"
)]
pub(crate) struct DetailArgs {
    /// Grey height map: PNG, JPEG, TIFF, EXR or HDR
    #[arg(long, value_name = "MAP", action = ArgAction::Append)]
    pub(crate) height: Vec<PathBuf>,
    /// Vector displacement map
    #[arg(long, value_name = "MAP", action = ArgAction::Append)]
    pub(crate) vector: Vec<PathBuf>,
    /// RGB direction map; goes with --magnitude
    #[arg(long, value_name = "MAP", action = ArgAction::Append)]
    pub(crate) direction: Vec<PathBuf>,
    /// Grey magnitude map; goes with --direction
    #[arg(long, value_name = "MAP", action = ArgAction::Append)]
    pub(crate) magnitude: Vec<PathBuf>,
    /// Height as an expression of u, v, x, y, z and the normal, such as '0.1*sin(20*pi*u)'
    #[arg(long, value_name = "EXPR", action = ArgAction::Append, allow_hyphen_values = true)]
    pub(crate) expr: Vec<String>,
    /// Normal map, as glTF has them; beside heights or vectors it describes the same surface, and vertices move while
    /// normals are the base's, bent by it
    #[arg(long, value_name = "MAP", action = ArgAction::Append)]
    pub(crate) normal: Vec<PathBuf>,
    /// Open a group for this material; flags before the first hold for all materials not named
    #[arg(long, value_name = "NAME", action = ArgAction::Append)]
    pub(crate) material: Vec<String>,
    /// Mesh units per unit of the map; of a normal map, strength of its slopes [default: 1]
    #[arg(long, value_name = "S", action = ArgAction::Append, value_parser = finite, allow_hyphen_values = true)]
    pub(crate) scale: Vec<f32>,
    /// Value of the map that leaves the surface where it is [default: 0; 0.5 for integer vector maps; with --direction it is the magnitude's, 0]
    #[arg(long, value_name = "M", action = ArgAction::Append, value_parser = finite, allow_hyphen_values = true)]
    pub(crate) midlevel: Vec<f32>,
    /// Space of a vector, direction or normal map [default: tangent]
    #[arg(long, value_enum, action = ArgAction::Append)]
    pub(crate) space: Vec<SpaceArg>,
    /// Order and sign of a vector or normal map's components, upper case negates [default: rgb]
    #[arg(long, value_name = "RGB", action = ArgAction::Append, value_parser = swizzle)]
    pub(crate) swizzle: Vec<Swizzle>,
    /// Where texels lie: at centres, or on nodes that span the map [default: center]
    #[arg(long, value_enum, action = ArgAction::Append)]
    pub(crate) sampling: Vec<SamplingArg>,
    /// What lies outside the map [default: repeat]
    #[arg(long, value_enum, action = ArgAction::Append)]
    pub(crate) wrap: Vec<WrapArg>,
    /// Channel of a height map [default: r]
    #[arg(long, value_enum, action = ArgAction::Append)]
    pub(crate) channel: Vec<ChannelArg>,
    /// Texture coordinates that the group's maps and expressions read: TEXCOORD_N [default: 0]
    #[arg(long, value_name = "N", action = ArgAction::Append, value_parser = clap::value_parser!(u32).range(0..=7))]
    pub(crate) uv_set: Vec<u32>,
    /// Read a height map as a depth map: 1 - value
    #[arg(long, action = ArgAction::Append, num_args = 0, default_missing_value = "true", value_parser = clap::value_parser!(bool))]
    pub(crate) invert_height: Vec<bool>,
    /// Map rows start at the bottom
    #[arg(long, action = ArgAction::Append, num_args = 0, default_missing_value = "true", value_parser = clap::value_parser!(bool))]
    pub(crate) flip_v: Vec<bool>,
    /// Green of a normal map points down: negate it
    #[arg(long, action = ArgAction::Append, num_args = 0, default_missing_value = "true", value_parser = clap::value_parser!(bool))]
    pub(crate) flip_green: Vec<bool>,
    /// Decode a normal map so that zero is exact: (c - 128) / 127 of 8 bits, instead of glTF's 2 c / 255 - 1
    #[arg(long, action = ArgAction::Append, num_args = 0, default_missing_value = "true", value_parser = clap::value_parser!(bool))]
    pub(crate) exact_zero: Vec<bool>,
    /// Printed formula of the literature instead of the right one
    #[arg(long, value_enum, action = ArgAction::Append)]
    pub(crate) preset: Vec<PresetArg>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SpaceArg {
    Tangent,
    Object,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SamplingArg {
    Center,
    Node,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum WrapArg {
    Repeat,
    Mirror,
    Clamp,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ChannelArg {
    R,
    G,
    B,
    A,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PresetArg {
    /// West 2007: directions are used as stored, in [0, 1]; heights displace inwards, and bump bends facets
    AsPrinted,
    /// CySlice's shader: red of a normal map leans along T, green along S, which mirrored UVs turn round
    Cyslice,
}
