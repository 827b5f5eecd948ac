//! GEOMETRY: how finely, and how seams and normals are made.

use clap::{Args, ValueEnum};

use crate::error::{Error, Result};

use super::values::{View, length, not_negative, pixels, tolerance_share, view};

#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Geometry")]
pub(crate) struct GeometryArgs {
    /// Split every triangle into 4^LEVEL, 0 to 12
    #[arg(long, value_name = "LEVEL", value_parser = clap::value_parser!(u32).range(0..=12), allow_hyphen_values = true, group = "refinement")]
    pub(crate) uniform: Option<u32>,
    /// Stay within this share of the scene's diagonal of the surface, 1e-6 to 1, with few triangles [apply: 1e-3]
    #[arg(long, value_name = "SHARE", value_parser = tolerance_share, allow_hyphen_values = true, group = "refinement")]
    pub(crate) tolerance: Option<f64>,
    /// The same in world units
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true, group = "refinement")]
    pub(crate) tolerance_world: Option<f64>,
    /// The same in pixels of every --view, 0.01 to 1000; without any, of the image or of every frame [render: 0.5]
    #[arg(long, value_name = "PIXELS", value_parser = pixels, allow_hyphen_values = true, group = "refinement")]
    pub(crate) tolerance_px: Option<f64>,
    /// An image that --tolerance-px is meant for: eye, target, vertical degrees, size; up to 64 of them
    #[arg(long, value_name = "EYE;LOOK;FOV;WxH", value_parser = view, allow_hyphen_values = true, requires = "tolerance_px")]
    pub(crate) view: Vec<View>,
    /// Where a tolerance holds: everywhere, certified, or at texels alone, as others count [default: surface]
    #[arg(long, value_enum, value_name = "WHERE", conflicts_with = "uniform")]
    pub(crate) error_at: Option<ErrorAtArg>,
    /// What a tolerance spends on having few triangles: high takes two to three times as long [default: normal]
    #[arg(long, value_enum, conflicts_with = "uniform")]
    pub(crate) quality: Option<QualityArg>,
    /// Most triangles: a --uniform above it is refused, a tolerance gets as near as they allow
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) max_triangles: Option<u64>,
    /// Normals of the displaced surface: from derivatives, from the triangles, or between vertices from a map [apply]
    #[arg(long, value_enum, default_value = "analytic")]
    pub(crate) normals: NormalsArg,
    /// Texels of a side of that map, 4 to 4096 [default: those of the largest map, or 1024]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(4..=4096))]
    pub(crate) normal_map_size: Option<u32>,
    /// The smooth surface under the detail: the triangles themselves, PN triangles, Phong tessellation, or the limit
    /// of Loop's subdivision
    #[arg(long, value_enum, default_value = "flat")]
    pub(crate) base: BaseArg,
    /// How the sides of a seam become one
    #[arg(long, value_enum, default_value = "mean")]
    pub(crate) seams: SeamsArg,
    /// Width of the ramp that reconciles a seam's sides; 0 is off
    #[arg(long, value_name = "TEXELS", default_value = "3", value_parser = not_negative, allow_hyphen_values = true)]
    pub(crate) feather: f32,
}

impl GeometryArgs {
    /// Share of the diagonal that `apply` keeps when nothing else is said.
    const TOLERANCE: f64 = 1e-3;
    /// Pixels that `render` keeps.
    const TOLERANCE_PX: f64 = 0.5;

    /// Whether anything says how fine the result is.
    pub(crate) fn is_refined(&self) -> bool {
        self.uniform.is_some() || self.tolerance.or(self.tolerance_world).or(self.tolerance_px).is_some()
    }

    /// Whether that is something else than pixels of the image itself.
    pub(crate) fn is_fixed(&self) -> bool {
        self.uniform.is_some() || self.tolerance.or(self.tolerance_world).is_some() || !self.view.is_empty()
    }

    /// Pixels are those of some image: one of `--view`, where the command has no frames of its own.
    pub(crate) fn require_views(&self) -> Result<()> {
        if self.tolerance_px.is_none() || !self.view.is_empty() {
            return Ok(());
        }
        let message = "--tolerance-px needs the images whose pixels are meant: give one or more --view 'EYE;LOOK;FOV;WxH', or render a sequence";
        Err(Error::usage("--view", message))
    }

    /// A flag that says something of a tolerance.
    pub(crate) fn tolerance_flag(&self) -> Option<&'static str> {
        let flags = [("--error-at", self.error_at.is_some()), ("--quality", self.quality.is_some())];
        flags.into_iter().find_map(|(flag, given)| given.then_some(flag))
    }

    /// With the tolerance that `render` has by default, where nothing else is said.
    pub(crate) fn or_pixels(self) -> Self {
        if self.is_refined() { self } else { Self { tolerance_px: Some(Self::TOLERANCE_PX), ..self } }
    }

    /// With the tolerance that `apply` has by default, where nothing else is said.
    pub(crate) fn or_tolerance(self) -> Self {
        if self.is_refined() { self } else { Self { tolerance: Some(Self::TOLERANCE), ..self } }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ErrorAtArg {
    Surface,
    Texels,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum QualityArg {
    Normal,
    High,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum NormalsArg {
    #[default]
    Analytic,
    Geometric,
    Map,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum BaseArg {
    #[default]
    Flat,
    Pn,
    Phong,
    Loop,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum SeamsArg {
    #[default]
    Mean,
    Dominant,
}
