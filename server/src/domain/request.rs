//! Requests after parsing: ranges checked, defaults not yet applied where they depend on the asset.
//!
//! Serialised, they are the canonical form that result keys are made of: defaults are filled in, so equal
//! requests give equal bytes.

mod geometry;
mod maps;

pub use displace_glsl::methods::Method;
pub use geometry::{
    Allowed, Base, ErrorAt, Geometry, Normals, Quality, Refinement, SeamRule, Tolerance, ToleranceView,
};
pub use maps::{LookMap, LookMaps};
use serde::{Deserialize, Serialize};

use super::{
    Digest,
    detail::{Sampling, Wrap},
    environment::EnvironmentLayout,
    image::{AlphaMode, Filter, RenderLight, SelfShadow, Shading, Silhouettes},
};

/// Work to be estimated.
#[derive(Clone, Debug, Serialize)]
pub enum EstimateRequest {
    Displace(Box<DisplaceRequest>),
    Render(Box<RenderRequest>),
}

impl EstimateRequest {
    /// As [`DisplaceRequest::assets`].
    #[must_use]
    pub fn assets(&self) -> Vec<Digest> {
        match self {
            Self::Displace(request) => request.assets(),
            Self::Render(request) => request.assets(),
        }
    }

    /// The geometry half.
    #[must_use]
    pub fn surface(&self) -> &DisplaceRequest {
        match self {
            Self::Displace(request) => request,
            Self::Render(request) => &request.surface,
        }
    }
}

/// The geometry half of every job.
#[derive(Clone, Debug, Serialize)]
pub struct DisplaceRequest {
    pub mesh: Digest,
    /// External files of a .gltf, by the URI the file uses.
    pub resources: Vec<(String, Digest)>,
    /// Detail per material; `material: None` is every material not named by another entry.
    pub details: Vec<MaterialDetail>,
    pub method: Method,
    pub geometry: Geometry,
    pub maps: LookMaps,
    pub compression: Compression,
    /// Levels of detail: 1, the result alone, to [`lods::MOST`](super::lods::MOST).
    pub lods: u32,
}

/// How the GLB is packed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
pub enum Compression {
    #[default]
    None,
    /// KHR_mesh_quantization.
    Quantize,
    /// The same under EXT_meshopt_compression.
    Meshopt,
}

impl DisplaceRequest {
    /// Every asset the request names, each once, in the order of digests.
    #[must_use]
    pub fn assets(&self) -> Vec<Digest> {
        let maps = self.details.iter().flat_map(|detail| &detail.layers).flat_map(|layer| layer.source.assets());
        let resources = self.resources.iter().map(|(_, asset)| *asset);
        let mut assets: Vec<Digest> = resources.chain(maps).chain([self.mesh]).chain(self.maps.assets()).collect();
        assets.sort_unstable();
        assets.dedup();
        assets
    }
}

#[derive(Clone, Debug, Serialize)]
pub struct RenderRequest {
    pub surface: DisplaceRequest,
    pub camera: CameraChoice,
    pub width: u32,
    pub height: u32,
    pub look: Look,
    pub aovs: Vec<Aov>,
    pub format: ImageFormat,
    /// A pixel of which a picture is made on the map that it shows.
    pub preimage: Option<[u32; 2]>,
    /// Rays a pixel; none where the renderer's own samples of visibility do.
    pub samples: Option<u32>,
}

impl RenderRequest {
    /// Pixels that its triangles may be off by in its own camera, where that is what decides.
    #[must_use]
    pub fn own_camera_px(&self) -> Option<f64> {
        match &self.surface.geometry.tolerance()?.allowed {
            Allowed::Pixels { tolerance_px, views } if views.is_empty() => Some(*tolerance_px),
            _ => None,
        }
    }

    /// As [`DisplaceRequest::assets`].
    #[must_use]
    pub fn assets(&self) -> Vec<Digest> {
        let mut assets: Vec<Digest> = self.surface.assets().into_iter().chain(self.look.environment).collect();
        assets.sort_unstable();
        assets.dedup();
        assets
    }

    /// Rays a pixel where the surface itself is shown and nothing is said of how many.
    pub const DEFAULT_SAMPLES: u32 = 64;
    pub const SAMPLES: std::ops::RangeInclusive<u32> = 1..=1024;

    /// What has to be traced, if anything.
    #[must_use]
    pub fn rays(&self) -> Option<Rays> {
        let needed = self.surface.geometry.is_exact().then_some(Self::DEFAULT_SAMPLES);
        self.samples.or(needed).map(|samples| Rays { samples, shadows: self.look.shadows })
    }
}

/// An image by rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Rays {
    /// A pixel.
    pub samples: u32,
    pub shadows: Shadows,
}

/// A mesh to be measured against a reference: a mesh as it is (method flat), or the surface its detail describes.
#[derive(Clone, Debug, Serialize)]
pub struct MeasureRequest {
    /// Its level says nothing.
    pub reference: DisplaceRequest,
    pub mesh: Digest,
    /// External files of a .gltf, by the URI the file uses.
    pub resources: Vec<(String, Digest)>,
    /// Width of the interval asked for, as a share of the reference's diagonal.
    pub precision: f64,
    /// Whether to make the mesh coloured by its distance.
    pub colors: bool,
}

impl MeasureRequest {
    /// Every asset the request names, each once, in the order of digests.
    #[must_use]
    pub fn assets(&self) -> Vec<Digest> {
        let own = self.resources.iter().map(|(_, asset)| *asset).chain([self.mesh]);
        let mut assets: Vec<Digest> = self.reference.assets().into_iter().chain(own).collect();
        assets.sort_unstable();
        assets.dedup();
        assets
    }
}

/// Two images to be compared; `a` is the reference.
#[derive(Clone, Debug, Serialize)]
pub struct CompareRequest {
    pub a: Digest,
    pub b: Digest,
}

#[derive(Clone, Debug, Serialize)]
pub struct MaterialDetail {
    pub material: Option<String>,
    pub layers: Vec<LayerRequest>,
    pub uv_set: u32,
}

#[derive(Clone, Debug, Serialize)]
pub struct LayerRequest {
    pub source: SourceRequest,
    pub scale: f32,
    pub midlevel: Option<f32>,
    pub invert_height: bool,
    pub flip_v: bool,
    pub preset: Preset,
}

#[derive(Clone, Debug, Serialize)]
pub enum SourceRequest {
    Height { map: MapRequest, channel: Channel },
    Vector { map: MapRequest, space: Space, swizzle: Swizzle },
    DirectionMagnitude { direction: MapRequest, magnitude: MapRequest, space: Space, swizzle: Swizzle },
    Expression { source: String },
    Normal { map: MapRequest, space: Space, swizzle: Swizzle, flip_green: bool, exact_zero: bool },
}

impl SourceRequest {
    #[must_use]
    pub fn is_normal(&self) -> bool {
        matches!(self, Self::Normal { .. })
    }

    fn assets(&self) -> Vec<Digest> {
        match self {
            Self::Height { map, .. } | Self::Vector { map, .. } | Self::Normal { map, .. } => vec![map.asset],
            Self::DirectionMagnitude { direction, magnitude, .. } => vec![direction.asset, magnitude.asset],
            Self::Expression { .. } => Vec::new(),
        }
    }
}

#[derive(Clone, Debug, Serialize)]
pub struct MapRequest {
    pub asset: Digest,
    pub wrap: Option<Wrap>,
    pub sampling: Sampling,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
pub enum Channel {
    #[default]
    R,
    G,
    B,
    A,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
pub enum Space {
    #[default]
    Tangent,
    Object,
}

/// Source of each output component: axis 0..3 of the map and its sign. `rgb` is the identity; upper case
/// in text means negative (`rGb` negates the second).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
pub struct Swizzle(pub [(u8, bool); 3]);

impl Default for Swizzle {
    fn default() -> Self {
        Self([(0, false), (1, false), (2, false)])
    }
}

/// Printed formulas of the literature this grew from, kept so that the difference can be shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
pub enum Preset {
    #[default]
    Right,
    /// West 2007: directions are not remapped from [0, 1] to [−1, 1], heights displace inwards, and bump bends the
    /// normals of triangles.
    AsPrinted,
    /// CySlice's shader: the frame of a normal map, and which channel leans which way.
    CySlice,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum CameraChoice {
    /// The file's first camera, or an orbit that frames the scene.
    Default,
    Named(String),
    LookAt {
        eye: [f32; 3],
        target: [f32; 3],
        yfov_degrees: f32,
    },
    /// Azimuth and elevation in degrees about the scene's centre; distance in world units.
    Orbit {
        azimuth_degrees: f32,
        elevation_degrees: f32,
        distance: Option<f32>,
        yfov_degrees: f32,
    },
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Look {
    /// Empty: those of the file, or a sun.
    pub lights: Vec<RenderLight>,
    /// Ambient light, linear, 0 to 1.
    pub ambient: f32,
    pub shading: Shading,
    pub filter: Filter,
    pub alpha: AlphaMode,
    pub shadows: Shadows,
    /// Map of radiance.
    pub environment: Option<Digest>,
    /// Whether slopes of normal maps are filtered with their second moments.
    pub moments: bool,
    pub environment_layout: EnvironmentLayout,
    pub reflections: Vec<ReflectionRequest>,
    /// Mirrors one behind the other that rays follow.
    pub bounces: u32,
    pub relief: ReliefLook,
}

/// How methods show heights that show them per pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ReliefLook {
    /// Of each march; 0: as many as the angle and the map ask for.
    pub steps: u32,
    pub self_shadow: SelfShadow,
    pub silhouettes: Silhouettes,
}

/// A material whose surfaces mirror what is around them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReflectionRequest {
    /// Its name.
    pub material: String,
    pub size_px: u32,
    pub in_room: bool,
}

/// Whether surfaces take each other's light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Shadows {
    #[default]
    None,
    /// By a ray towards the light.
    Ray,
    /// By the depths that the light sees.
    Map,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
pub enum Aov {
    Depth,
    Normal,
    Position,
    Uv,
    Triangle,
    /// How often samples of a pixel are covered.
    Overdraw,
    /// Triangles that a pixel's samples show.
    Samples,
    /// What showing heights per pixel took.
    Cost,
}

impl Aov {
    /// Whether it tells of the rasteriser rather than of the scene, so that rays have no answer.
    #[must_use]
    pub fn is_of_rasteriser(self) -> bool {
        matches!(self, Self::Overdraw | Self::Samples | Self::Cost)
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
pub enum ImageFormat {
    #[default]
    Png,
    Exr,
}
