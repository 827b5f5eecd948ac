//! SEQUENCE: images one after the other.

use clap::{Args, ValueEnum};

#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Sequence")]
pub(crate) struct SequenceArgs {
    /// As many images of one turn around the scene, from --orbit's azimuth on, 1 to 1000: OUT-0000.png, OUT-0001.png, ...
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000), requires = "orbit", group = "sequence")]
    pub(crate) orbit_frames: Option<u32>,
    /// Images along the way that this animation of the file takes its camera, or --camera
    #[arg(long, value_name = "NAME|INDEX", requires = "pace", conflicts_with = "place", group = "sequence")]
    pub(crate) animation: Option<String>,
    /// As many of them, from the first key to the last, 1 to 1000
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000), requires = "animation", group = "pace")]
    pub(crate) frames: Option<u32>,
    /// So many of them a second
    #[arg(long, value_name = "F", requires = "animation", group = "pace")]
    pub(crate) fps: Option<f64>,
    /// How triangles follow the camera of a sequence: one mesh for all frames, another for each, or one that is kept while it
    /// suits and led over to the next; --tolerance-px then is of the frames [default: frozen]
    #[arg(long, value_enum, value_name = "HOW", requires = "sequence")]
    pub(crate) tessellation: Option<TessellationArg>,
}

impl SequenceArgs {
    pub(crate) fn is_asked(&self) -> bool {
        self.orbit_frames.is_some() || self.animation.is_some()
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum TessellationArg {
    Frozen,
    PerFrame,
    Hysteresis,
}
