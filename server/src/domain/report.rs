//! What a job says of itself. Field names are those of the CLI's JSON.

use serde::{Deserialize, Serialize};

use super::{
    chart::Chart, choice::Choice, image::MarchCounters, measurement::Measurement, sequence::SequenceReport,
    stability::Stability,
};

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Report {
    pub method: String,
    pub triangles_in: u64,
    pub triangles: u64,
    pub vertices: u64,
    /// How near the result is to the surface, where a tolerance decided.
    #[serde(default, flatten, skip_serializing_if = "Option::is_none")]
    pub fitted: Option<Fitted>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seams: Option<Seams>,
    /// Result triangles that face against their base triangle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flipped: Option<u64>,
    /// What `compare` found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub comparison: Option<Comparison>,
    /// What `measure` found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measurement: Option<Measurement>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stretch: Option<Stretch>,
    /// Level 0 first; none where no levels were asked for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lods: Vec<Lod>,
    /// Those made for the result.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub normal_maps: Vec<NormalMap>,
    /// Of methods that show heights per pixel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub counters: Option<MarchCounters>,
    /// Of `Method::Auto`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub choices: Vec<Choice>,
    /// What `chart` found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chart: Option<Chart>,
    /// What `chart` found where it was asked for stability.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stability: Option<Stability>,
    /// The frames of a sequence.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sequence: Option<SequenceReport>,
    pub warnings: Vec<Warning>,
    pub passes: Vec<PassTime>,
    pub total_ms: f64,
    pub device: String,
    pub cached: bool,
}

/// Lengths are in `accuracy.unit`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fitted {
    /// As asked for.
    pub tolerance: f64,
    /// What the result keeps: more where the request was clamped or the budget ended refinement.
    pub achieved_tolerance: f64,
    pub accuracy: Accuracy,
    /// Of splitting and collapsing edges, of the mesh that took most.
    pub rounds: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Accuracy {
    /// No place is farther from the surface.
    pub bound: f64,
    /// The largest distance found, by looking at places of triangles; see the API.
    pub measured: f64,
    pub unit: ToleranceUnit,
}

/// That of the request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ToleranceUnit {
    #[serde(rename = "diagonal")]
    Diagonal,
    #[serde(rename = "world")]
    World,
    #[serde(rename = "px")]
    Pixels,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Seams {
    /// Largest distance between the places of one geometric vertex: 0 by construction, measured.
    pub gap_max: f64,
    /// Largest disagreement of the two sides of a seam before reconciling, local units.
    pub mismatch_max: f64,
}

/// How far two images are apart (`oracle::metrics`).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// FLIP at 67 pixels per degree: 0, the same, to 1.
    pub flip_mean: f64,
    pub flip_p99: f64,
    /// Root mean square error in linear light.
    pub rmse_linear: f64,
    /// Structural similarity of luma, 1 is the same; absent for images of less than 11 x 11 pixels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ssim: Option<f64>,
    /// Pixels covered in one image alone; absent where an image does not tell what it covers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub silhouette_xor_px: Option<u64>,
    /// World distance of the places shown at the same pixel, as many pixels as it is long when seen face-on: the
    /// 99th percentile. Absent where an image lacks positions or coverage, or the first its camera, or where no pixel
    /// is covered in both.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hit_error_px: Option<f64>,
}

/// One level of detail; lengths are in the unit of `Fitted`. A mesh whose chain ended earlier counts with its last level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Lod {
    pub triangles: u64,
    pub vertices: u64,
    /// What it keeps; of several meshes the worst.
    pub tolerance: f64,
    /// No place is farther from the surface.
    pub bound: f64,
}

/// A normal map that carries what the triangles of a primitive leave out of the surface.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NormalMap {
    pub mesh: String,
    pub primitive: u32,
    /// Level of detail.
    pub lod: u32,
    /// Texels along u and along v.
    pub size: [u32; 2],
    /// Share of the texels that the primitive covers.
    pub coverage: f64,
    /// Texels whose normal points into the triangle that has them, which a map cannot hold: they lie in it.
    pub clamped: u64,
    /// Angles between the surface's normals and those that a reader of the map sees, at places spread evenly.
    pub angle_p50_deg: f64,
    pub angle_p99_deg: f64,
}

/// How much the displacement stretches the base: the largest factor by which it lengthens any direction on a
/// result triangle, 1 where it stretches nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stretch {
    /// 99 of 100 result triangles are stretched no more.
    pub p99: f64,
    pub max: f64,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Warning {
    pub code: String,
    pub message: String,
}

impl Warning {
    pub fn new(code: &str, message: impl Into<String>) -> Self {
        Self { code: code.into(), message: message.into() }
    }

    /// `figure` has no proven bound, for the reason `why`: it must not be read as one.
    #[must_use]
    pub fn estimated_not_certified(figure: &str, why: &str) -> Self {
        let message = format!("{figure} is an estimate, not a bound: {why}");
        Self::new("estimated_not_certified", message)
    }
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PassTime {
    pub name: String,
    pub ms: f64,
    pub bytes: u64,
}

/// What work would take, told without doing it. Where a tolerance decides, only the work tells what it takes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    pub triangles_in: u64,
    pub triangles: Option<u64>,
    pub vertices: Option<u64>,
    pub device_bytes: Option<u64>,
    /// Host memory for the outputs.
    pub output_bytes: Option<u64>,
    pub warnings: Vec<Warning>,
}
