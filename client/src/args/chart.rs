//! `displace chart`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{CameraArgs, DetailArgs, LightArgs, LookArgs};

const EXAMPLES: &str = "\
Examples:
  displace chart wall.glb --height bricks.png --scale 0.05 -o chart && open chart/index.html
  displace chart wall.glb --height bricks.png --scale 0.05 --eye 0,1,3 --look-at 0,0,0 --size 512x512 -o chart
  displace chart wall.glb --height bricks.png --scale 0.05 --stability -o stability && open stability/index.html
  displace chart wall.glb --height bricks.png --scale 0.05 -o chart --json | jq '.points[] | select(.fronts[] == \"flip\")'
  displace chart wall.glb --height bricks.png --scale 0.05 --sweep angle,distance,amplitude -o chart

The truth is the surface itself by rays in f64. DIR gets index.html, chart.svg, chart.csv, chart.json and images.
A method that the detail does not go with is left out, with a warning that says why.";

#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, mut_arg("size", |size| size.default_value("256x256")))]
pub(crate) struct ChartArgs {
    /// Mesh: .glb, .gltf, .obj or .ply
    #[arg(value_name = "MESH")]
    pub(crate) mesh: PathBuf,
    #[command(flatten)]
    pub(crate) detail: DetailArgs,
    #[command(flatten)]
    pub(crate) look: LookArgs,
    #[command(flatten)]
    pub(crate) camera: CameraArgs,
    #[command(flatten)]
    pub(crate) light: LightArgs,
    /// Runs of each setting, whose median counts, 1 to 100; what has taken half a second is not run again
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=100), help_heading = "Chart")]
    pub(crate) repeats: u32,
    /// Rays a pixel of the truth, 1 to 1024
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=1024), help_heading = "Chart")]
    pub(crate) truth_samples: u32,
    /// Look for where methods fail in place of what they take: breakdown points, curves, invariants
    #[arg(long, conflicts_with_all = ["repeats", "truth_samples", "sweep"], help_heading = "Chart")]
    pub(crate) stability: bool,
    /// What is swept besides, at every value each method by one small image: where methods break
    #[arg(long, value_enum, value_delimiter = ',', value_name = "LIST", help_heading = "Chart")]
    pub(crate) sweep: Vec<SweepArg>,
    /// Folder to write to; made when missing
    #[arg(short, long, value_name = "DIR", help_heading = "Output")]
    pub(crate) output: PathBuf,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SweepArg {
    /// Between the view and the surface, 5 to 85 degrees
    Angle,
    /// 1 to 16 times as far away
    Distance,
    /// 1/4 to 4 times the scale of the detail
    Amplitude,
}
