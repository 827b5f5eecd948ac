//! What the user typed. Parsing looks at nothing outside the command line; what the flags mean, and the
//! files they name, is the business of `options` and `commands`.

mod camera;
mod chart;
mod detail;
mod geometry;
mod light;
mod look;
mod relief;
mod sequence;
pub(crate) mod values;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

pub(crate) use camera::CameraArgs;
pub(crate) use chart::{ChartArgs, SweepArg};
pub(crate) use detail::{ChannelArg, DetailArgs, PresetArg, SamplingArg, SpaceArg, WrapArg};
pub(crate) use geometry::{BaseArg, ErrorAtArg, GeometryArgs, NormalsArg, QualityArg, SeamsArg};
pub(crate) use light::{AlphaArg, FilterArg, LayoutArg, LightArgs, MomentsArg, ShadingArg, ShadowsArg};
pub(crate) use look::{LookArgs, ProjectionArg};
pub(crate) use relief::{ReliefArgs, SelfShadowArg, SilhouettesArg};
pub(crate) use sequence::{SequenceArgs, TessellationArg};
pub(crate) use values::LightArg;

const ABOUT: &str = "Tessellates, displaces and renders glTF meshes with Vulkan compute.";

const EXAMPLES: &str = "\
Examples:
  displace demo                                                     see what it does
  displace apply wall.glb --height bricks.png --scale 0.05 --tolerance 1e-3 -o out.glb
  displace render wall.glb --height bricks.png --scale 0.05 --uniform 6 -o out.png
  displace describe wall.glb                                        what a mesh holds
  displace measure wall.glb --height bricks.png --scale 0.05 out.glb how far a result is from the truth
  displace compare before.png after.png                             how far two images are apart
  displace chart wall.glb --height bricks.png --scale 0.05 -o chart which method is fast and near enough
  DISPLACE_SERVER=http://farm:7878 displace status                  use a server elsewhere

Without --server the service runs inside this command.
Exit codes: 0 done, 1 the job failed, 2 usage or bad input, 3 server unreachable or busy, 130 interrupted.";

#[derive(Debug, Parser)]
#[command(name = "displace", version = crate::version(), about = ABOUT, after_help = EXAMPLES, disable_version_flag = true, max_term_width = 110)]
#[command(subcommand_required = true, arg_required_else_help = true)]
pub(crate) struct Cli {
    #[command(flatten)]
    pub(crate) global: Global,
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// Flags that every command takes.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Global")]
pub(crate) struct Global {
    /// Use the server at this address, such as http://127.0.0.1:7878, instead of one in this process
    #[arg(long, global = true, value_name = "URL", env = "DISPLACE_SERVER", hide_env_values = true)]
    pub(crate) server: Option<String>,
    /// Device of the service in this process: part of its name, its index, its UUID, or `reference` (f64 on the CPU)
    #[arg(long, global = true, value_name = "NAME|INDEX|UUID|reference")]
    pub(crate) device: Option<String>,
    /// Write one JSON report to stdout
    #[arg(long, global = true)]
    pub(crate) json: bool,
    /// Compute even if the result is stored
    #[arg(long, global = true)]
    pub(crate) fresh: bool,
    /// Write nothing to stderr but errors
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub(crate) quiet: bool,
    /// Say more on stderr; -vv more still
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    pub(crate) verbose: u8,
    /// Print version and build id
    #[arg(short = 'V', long, action = clap::ArgAction::Version)]
    version: Option<bool>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run everything on sample data: meshes, images and a page that shows them
    Demo(DemoArgs),
    /// Displace a mesh and write the geometry as GLB
    Apply(Box<ApplyArgs>),
    /// Displace a mesh and write an image of it
    Render(Box<RenderArgs>),
    /// Say what a mesh holds, and what is wrong with it
    Describe(DescribeArgs),
    /// Say how far a mesh is from another, or from the surface a detail describes
    Measure(Box<MeasureArgs>),
    /// Say how far two images are apart: FLIP, RMSE, SSIM
    Compare(CompareArgs),
    /// Chart time against error of every method, on this mesh, detail and camera
    Chart(Box<ChartArgs>),
    /// Put, get, list and remove stored assets
    #[command(subcommand)]
    Assets(AssetsCommand),
    /// List the methods the service has
    Methods,
    /// Show the server's device, limits, load and totals
    Status,
    /// Ask whether the server lives, or is ready for work
    Health(HealthArgs),
    /// Write a completion script for a shell to stdout
    Completions(CompletionsArgs),
}

#[derive(Debug, Args)]
#[command(after_help = "Example:\n  displace demo --out demo && open demo/index.html")]
pub(crate) struct DemoArgs {
    /// Folder to write to; made when missing
    #[arg(long, value_name = "DIR", default_value = "displace-demo")]
    pub(crate) out: PathBuf,
}

/// How a detail is realised.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MethodArg {
    /// No detail: the base surface alone
    Flat,
    /// Vertices move along the surface's direction by a height
    Displacement,
    /// Vertices move by a vector
    Vector,
    /// Nothing moves: heights and normal maps bend normals, all together; for images
    Bump,
    /// Nothing moves: normal maps bend normals, and heights beside them count for nothing
    Normal,
    /// Heights per pixel: maps are shifted by the height where they are read; for images, as all that follow
    Parallax,
    /// The same, shifted by no more than the height
    ParallaxLimited,
    /// The same four times, with slopes
    ParallaxIterative,
    /// Even steps along the ray to the first below the heights
    Steep,
    /// The same, and the secant between the last two
    Occlusion,
    /// The same, and bisections between the last two
    Relief,
    /// Steps as long as cones over the texels allow, and bisections
    Cone,
    /// The first place at which the ray meets the heights, whatever they are
    Exact,
    /// For each material the cheapest that is predicted to be within --tolerance-px
    Auto,
}

impl MethodArg {
    /// Whether its triangles are made to be within one.
    pub(crate) fn keeps_tolerance(self) -> bool {
        matches!(self, Self::Displacement | Self::Vector | Self::Auto)
    }
}

/// How a GLB is packed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum CompressArg {
    /// f32 throughout
    #[default]
    None,
    /// 16 bits (KHR_mesh_quantization)
    Quantize,
    /// The same, packed (EXT_meshopt_compression)
    Meshopt,
}

const APPLY_EXAMPLES: &str = "\
Examples:
  displace apply wall.glb --height bricks.png --scale 0.05 -o out.glb          within 1/1000 of the diagonal
  displace apply wall.glb --height bricks.png --scale 0.05 --tolerance 1e-4 --quality high -o out.glb
  displace apply wall.glb --height bricks.png --scale 0.05 --compress meshopt -o out.glb
  displace apply wall.glb --height bricks.png --scale 0.05 --lods 4 -o out.glb
  displace apply wall.glb --height bricks.png --scale 0.05 --tolerance 1e-2 --normals map -o out.glb
  displace apply wall.glb --height bricks.png --tolerance-px 0.5 --view '0,1,3;0,0,0;40;1920x1080' -o out.glb
  displace apply ball.obj --expr '0.02*sin(20*pi*u)' --uniform 5 -o out.glb
  displace apply rock.gltf --direction dir.png --magnitude mag.png --scale 0.2 --uniform 6 -o out.glb
  displace apply house.glb --material Roof --height tiles.png --scale 0.1 \\
                           --material Wall --height bricks.png --scale 0.02 --uniform 5 -o out.glb
  displace apply wall.glb --height bricks.png --scale 0.05 --uniform 8 --dry-run --json";

#[derive(Debug, Args)]
#[command(after_help = APPLY_EXAMPLES)]
pub(crate) struct ApplyArgs {
    /// Mesh: .glb, .gltf, .obj or .ply
    #[arg(value_name = "MESH")]
    pub(crate) mesh: PathBuf,
    #[command(flatten)]
    pub(crate) detail: DetailArgs,
    #[command(flatten)]
    pub(crate) geometry: GeometryArgs,
    #[command(flatten)]
    pub(crate) look: LookArgs,
    /// How the detail is realised [default: auto with --view; else vector with vector maps, displacement with others]
    #[arg(long, value_enum, help_heading = "Method")]
    pub(crate) method: Option<MethodArg>,
    /// How the GLB is packed; quantized positions are within half a step of 1/65535 of the mesh's longest side
    #[arg(long, value_enum, default_value = "none", help_heading = "Output")]
    pub(crate) compress: CompressArg,
    /// Levels of detail, 1 to 8: each keeps 4 times the tolerance of the one before it (MSFT_lod)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=8), default_value = "1", conflicts_with = "uniform", help_heading = "Output")]
    pub(crate) lods: u32,
    /// Say triangles, bytes and time; compute nothing
    #[arg(long, help_heading = "Output")]
    pub(crate) dry_run: bool,
    /// GLB to write
    #[arg(short, long, value_name = "OUT.glb", required_unless_present = "dry_run", help_heading = "Output")]
    pub(crate) output: Option<PathBuf>,
}

/// An image beside the colour image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum AovArg {
    /// Distance along the viewing axis, world units
    Depth,
    /// Shading normal, world space
    Normal,
    /// Position, world space
    Position,
    Uv,
    /// Number of the triangle
    Triangle,
    /// How often samples of a pixel are covered, before depth and alpha decide
    Overdraw,
    /// How many triangles a pixel's samples show
    Samples,
    /// Fetches, steps and cap hits of methods that show heights per pixel
    Cost,
}

const RENDER_EXAMPLES: &str = "\
Examples:
  displace render model.glb -o flat.png
  displace render wall.glb --height bricks.png --scale 0.05 -o good_enough.png
  displace render wall.glb --height bricks.png --scale 0.05 --uniform 7 --orbit 30,20 -o out.png
  displace render wall.glb --height bricks.png --scale 0.05 --uniform 7 --camera Main --size 1920x1080 -o out.png
  displace render wall.glb --height bricks.png --scale 0.05 --method exact --self-shadow hard -o out.png
  displace render model.glb --aov depth,normal --eye 0,1,3 --look-at 0,0,0 --fov 40 -o layers.exr
  displace render model.glb --device reference --supersample 256 --shadows ray -o reference.exr
  displace render wall.glb --height bricks.png --scale 0.05 --tolerance-px 0.5 --tessellation hysteresis \\
                           --orbit 0,20 --orbit-frames 60 -o frames/out.png

An EXR holds linear colour and every AOV as layers. Beside a PNG each AOV is written as NAME.AOV.png.
Frames of a sequence are written as NAME-0000.png, NAME-0001.png, ...";

#[derive(Debug, Args)]
#[command(after_help = RENDER_EXAMPLES)]
pub(crate) struct RenderArgs {
    /// Mesh: .glb, .gltf, .obj or .ply
    #[arg(value_name = "MESH")]
    pub(crate) mesh: PathBuf,
    #[command(flatten)]
    pub(crate) detail: DetailArgs,
    #[command(flatten)]
    pub(crate) geometry: GeometryArgs,
    /// Show the surface itself, within 1/32 of a pixel, instead of triangles for it; needs --device reference
    #[arg(long, conflicts_with_all = ["refinement", "error_at", "quality"], help_heading = "Geometry")]
    pub(crate) exact: bool,
    #[command(flatten)]
    pub(crate) look: LookArgs,
    #[command(flatten)]
    pub(crate) camera: CameraArgs,
    #[command(flatten)]
    pub(crate) sequence: SequenceArgs,
    /// How the detail is realised [default: auto; with --uniform, --tolerance, --tolerance-world, --view, --exact or
    /// --preimage vector with vector maps, displacement with others; normal with normal maps alone]
    #[arg(long, value_enum, help_heading = "Method")]
    pub(crate) method: Option<MethodArg>,
    /// Samples a pixel: 4, 16, 64, 256 or 1024; with --device reference 1 to 1024 rays, traced in f64 [default: 4,
    /// rasterised]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024), help_heading = "Look")]
    pub(crate) supersample: Option<u32>,
    #[command(flatten)]
    pub(crate) light: LightArgs,
    #[command(flatten)]
    pub(crate) relief: ReliefArgs,
    /// More images: any of depth, normal, position, uv, triangle, overdraw, samples, cost
    #[arg(long, value_enum, value_name = "LIST", value_delimiter = ',', help_heading = "Output")]
    pub(crate) aov: Vec<AovArg>,
    /// Draw where this pixel lies on the base colour map that it shows, as OUT.preimage.png: its square, and the ellipse that
    /// elliptical filtering weighs texels in
    #[arg(long, value_name = "X,Y", value_parser = values::pixel, help_heading = "Output")]
    pub(crate) preimage: Option<[u32; 2]>,
    /// Image to write: .png is sRGB, 8 bit; .exr is linear float
    #[arg(short, long, value_name = "OUT.png|OUT.exr", help_heading = "Output")]
    pub(crate) output: PathBuf,
}

#[derive(Debug, Args)]
#[command(after_help = "Example:\n  displace describe model.glb --json | jq .meshes")]
pub(crate) struct DescribeArgs {
    /// Mesh: .glb, .gltf, .obj or .ply
    #[arg(value_name = "MESH")]
    pub(crate) mesh: PathBuf,
}

const MEASURE_EXAMPLES: &str = "\
Examples:
  displace measure wall.glb out.glb                                   two meshes
  displace measure wall.glb --height bricks.png --scale 0.05 out.glb  a result against the surface itself
  displace measure a.glb b.glb --precision 1e-6 --json | jq .hausdorff
  displace measure a.glb b.glb -o error.glb                           b, coloured by its distance to a

The Hausdorff distance is an interval that holds it, both ways; world units. RMS and normals are of samples.";

#[derive(Debug, Args)]
#[command(after_help = MEASURE_EXAMPLES)]
pub(crate) struct MeasureArgs {
    /// The reference: .glb, .gltf, .obj or .ply; with a detail, the surface it describes
    #[arg(value_name = "MESH")]
    pub(crate) mesh: PathBuf,
    /// The mesh that is judged: .glb, .gltf, .obj or .ply
    #[arg(value_name = "RESULT")]
    pub(crate) result: PathBuf,
    #[command(flatten)]
    pub(crate) detail: DetailArgs,
    /// The smooth surface under the reference's detail
    #[arg(long, value_enum, default_value = "flat", help_heading = "Geometry")]
    pub(crate) base: BaseArg,
    /// How the sides of the reference's seams become one
    #[arg(long, value_enum, default_value = "mean", help_heading = "Geometry")]
    pub(crate) seams: SeamsArg,
    /// Width of the ramp that reconciles a seam's sides; 0 is off
    #[arg(long, value_name = "TEXELS", default_value = "3", value_parser = values::not_negative, allow_hyphen_values = true, help_heading = "Geometry")]
    pub(crate) feather: f32,
    /// Width of the interval, as a share of the reference's diagonal, 1e-7 to 1
    #[arg(long, value_name = "P", default_value = "1e-4", value_parser = values::share, allow_hyphen_values = true)]
    pub(crate) precision: f64,
    /// Write the judged mesh coloured by its distance, with a scale beside it
    #[arg(short, long, value_name = "OUT.glb")]
    pub(crate) output: Option<PathBuf>,
}

const COMPARE_EXAMPLES: &str = "\
Examples:
  displace compare reference.png other.png
  displace compare reference.png other.png -o difference.png --json | jq .flip_mean
  displace compare a.exr b.exr          of renders with --aov depth,position also outlines and places

FLIP is taken at 67 pixels per degree; RMSE is of linear light; SSIM is of luma.";

#[derive(Debug, Args)]
#[command(after_help = COMPARE_EXAMPLES)]
pub(crate) struct CompareArgs {
    /// The reference: .png or .exr
    #[arg(value_name = "A")]
    pub(crate) a: PathBuf,
    /// What is judged, of the same size: .png or .exr
    #[arg(value_name = "B")]
    pub(crate) b: PathBuf,
    /// Image of the differences to write: FLIP of every pixel, from black, none, over violet and orange to pale yellow
    #[arg(short, long, value_name = "OUT.png")]
    pub(crate) output: Option<PathBuf>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum AssetsCommand {
    /// Upload files and print their names, one a line
    Put {
        #[arg(required = true, value_name = "FILE")]
        files: Vec<PathBuf>,
    },
    /// Download an asset to a file, or to stdout with `-o -`
    Get {
        /// `HASH/SIZE` or `assets/sha256/HASH/SIZE`
        #[arg(value_name = "NAME")]
        name: String,
        /// File to write; `-` is stdout
        #[arg(short, long, value_name = "FILE")]
        output: PathBuf,
    },
    /// List the assets
    Ls,
    /// Remove assets
    Rm {
        /// `HASH/SIZE` or `assets/sha256/HASH/SIZE`
        #[arg(required = true, value_name = "NAME")]
        names: Vec<String>,
    },
}

#[derive(Debug, Args)]
pub(crate) struct HealthArgs {
    /// `live`: the process answers; `ready`: it takes work
    #[arg(value_enum, default_value = "ready")]
    pub(crate) service: HealthService,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum HealthService {
    Live,
    Ready,
}

#[derive(Debug, Args)]
#[command(after_help = "Example:\n  displace completions bash > ~/.local/share/bash-completion/completions/displace")]
pub(crate) struct CompletionsArgs {
    #[arg(value_enum)]
    pub(crate) shell: clap_complete::Shell,
}
