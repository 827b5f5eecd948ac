//! What `measure` tells. Field names are those of the CLI's JSON; lengths in world units.

use serde::{Deserialize, Serialize};

use super::report::Stretch;

/// How far a mesh is from another, or from the displaced surface it stands for.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Measurement {
    pub hausdorff: Hausdorff,
    /// Root mean square distance over places spread evenly over both.
    pub rms: f64,
    /// Angle between shading normals at places and at those nearest to them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal_deg: Option<NormalDeviation>,
    /// Widest crack of the second: of borders the first does not have.
    pub seam_gap: f64,
    pub volume: Volume,
    /// Of the surface that a detail describes, over its base; none where the reference is a mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stretch: Option<Stretch>,
    /// Of the first scene's box, undisplaced.
    pub diagonal: f64,
    /// Width of the interval that was asked for.
    pub precision: f64,
    pub unit: String,
    pub a: SheetFacts,
    pub b: SheetFacts,
}

/// The two-sided Hausdorff distance is in [lo, hi].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Hausdorff {
    pub lo: f64,
    pub hi: f64,
    pub a_to_b: Distance,
    pub b_to_a: Distance,
}

/// The largest distance from one to the other is in [lo, hi]; mean and root mean square are of samples.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Distance {
    pub lo: f64,
    pub hi: f64,
    pub mean: f64,
    pub rms: f64,
    /// A place that is at least `lo` away, and the place nearest to it.
    pub at: [f64; 3],
    pub nearest: [f64; 3],
}

/// Degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NormalDeviation {
    pub p50: f64,
    pub p95: f64,
    pub p99: f64,
    pub max: f64,
}

/// Enclosed volumes; none of what is not closed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Volume {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub a: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub b: Option<f64>,
}

/// One of the two by itself. Of a surface: the triangles it was diced into.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SheetFacts {
    pub triangles: u64,
    pub area: f64,
    pub boundary_edges: u64,
    pub non_manifold_edges: u64,
    pub degenerate_triangles: u64,
    pub components: u64,
    pub euler_characteristic: i64,
    /// Triangles that face against their own shading normals; absent of a surface, whose normals are its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub facing_back: Option<u64>,
    /// Largest distance of a diced surface's triangles to it; 0 of a mesh.
    pub residual: f64,
    /// Pairs of triangles that run through each other; absent where they were not searched for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub self_intersections: Option<u64>,
}
