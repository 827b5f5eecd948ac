//! How the result is made of triangles.

use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Geometry {
    pub refinement: Refinement,
    /// Most triangles of the result, all meshes together.
    pub max_triangles: Option<u64>,
    pub normals: Normals,
    pub seams: SeamRule,
    /// Width of the ramp that reconciles mismatched seams, in texels; 0 is off.
    pub feather_texels: f32,
    pub base: Base,
}

/// The smooth surface under the detail; see [`crate::domain::base`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
pub enum Base {
    #[default]
    Flat,
    /// PN triangles.
    Pn,
    /// Phong tessellation.
    Phong,
    /// The limit of Loop's subdivision.
    Loop,
}

impl Base {
    pub const ALL: [Self; 4] = [Self::Flat, Self::Pn, Self::Phong, Self::Loop];

    /// As the API and the command line have it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Flat => "flat",
            Self::Pn => "pn",
            Self::Phong => "phong",
            Self::Loop => "loop",
        }
    }
}

/// What decides how fine the result is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Refinement {
    /// Each triangle becomes 4^level. 0 to 12.
    Uniform(u32),
    /// The surface itself, which no triangles stand for.
    Exact,
    Tolerance(Tolerance),
}

/// As few triangles as keep the result near the surface.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tolerance {
    pub allowed: Allowed,
    pub error_at: ErrorAt,
    pub quality: Quality,
}

/// Largest distance allowed between the surface and the triangles for it, both ways.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Allowed {
    /// Share of the undisplaced scene's diagonal, 1e-6 to 1.
    Diagonal(f64),
    /// World units, above 0.
    World(f64),
    /// Pixels in every view, 0.01 to 1000; up to 64 views, and without any in the camera of the image.
    Pixels { tolerance_px: f64, views: Vec<ToleranceView> },
}

/// A perspective image that the tolerance is meant for; +Y is up.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ToleranceView {
    /// World units.
    pub eye: [f32; 3],
    /// World units; not the eye itself.
    pub target: [f32; 3],
    /// Vertical, 0.1 to 179.
    pub yfov_degrees: f32,
    /// Pixels, 1 to 16384.
    pub width: u32,
    pub height: u32,
}

/// Where the distance is held.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum ErrorAt {
    /// Everywhere, certified.
    #[default]
    Surface,
    /// Where texels lie, as published counts of other tessellators do; between them nothing is said.
    Texels,
}

/// What is spent on having few triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Quality {
    #[default]
    Normal,
    /// Two to three times the work for up to a tenth fewer triangles, and a longer search across base triangles.
    High,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
pub enum Normals {
    #[default]
    Analytic,
    Geometric,
    /// Analytic at vertices, and between them from a normal map of so many texels a side; none: as many as the detail's
    /// largest map has.
    Map {
        size: Option<u32>,
    },
}

/// How the values of a seam's sides become one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
pub enum SeamRule {
    #[default]
    Mean,
    Dominant,
}

impl Geometry {
    /// The tolerance, where one decides.
    #[must_use]
    pub fn tolerance(&self) -> Option<&Tolerance> {
        match &self.refinement {
            Refinement::Tolerance(tolerance) => Some(tolerance),
            Refinement::Uniform(_) | Refinement::Exact => None,
        }
    }

    /// Whether the surface itself is asked for.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.refinement == Refinement::Exact
    }
}

impl Allowed {
    /// The number alone, in the unit of its kind.
    #[must_use]
    pub fn value(&self) -> f64 {
        match self {
            Self::Diagonal(value) | Self::World(value) | Self::Pixels { tolerance_px: value, .. } => *value,
        }
    }

    /// The same kind with another number.
    #[must_use]
    pub fn with_value(&self, value: f64) -> Self {
        match self {
            Self::Diagonal(_) => Self::Diagonal(value),
            Self::World(_) => Self::World(value),
            Self::Pixels { views, .. } => Self::Pixels { tolerance_px: value, views: views.clone() },
        }
    }

    /// What the number counts, for messages.
    #[must_use]
    pub fn unit(&self) -> &'static str {
        match self {
            Self::Diagonal(_) => "of the diagonal",
            Self::World(_) => "world units",
            Self::Pixels { .. } => "pixels",
        }
    }
}
