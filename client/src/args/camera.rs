//! CAMERA: where a picture is taken from.

use clap::Args;

use super::values::{Orbit, Size, field_of_view, orbit, point, size};

/// Without any: the file's first camera, or one that frames the scene.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Camera (default: the file's first, or one that frames the scene)")]
pub(crate) struct CameraArgs {
    /// A camera of the file, by name
    #[arg(long, value_name = "NAME", conflicts_with_all = ["eye", "orbit", "fov"])]
    pub(crate) camera: Option<String>,
    /// Place of the eye, world space
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true, requires = "look_at", conflicts_with = "orbit", group = "place")]
    pub(crate) eye: Option<[f32; 3]>,
    /// What the eye looks at
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true, requires = "eye")]
    pub(crate) look_at: Option<[f32; 3]>,
    /// Vertical field of view with --eye or --orbit, 1 to 170 degrees [default: 40]
    #[arg(long, value_name = "DEG", value_parser = field_of_view, allow_hyphen_values = true, requires = "place")]
    pub(crate) fov: Option<f32>,
    /// Look at the scene's centre from this azimuth and elevation, degrees; the distance frames the scene
    #[arg(long, value_name = "AZ,EL[,DIST]", value_parser = orbit, allow_hyphen_values = true, group = "place")]
    pub(crate) orbit: Option<Orbit>,
    /// Size of the image in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size)]
    pub(crate) size: Size,
}
