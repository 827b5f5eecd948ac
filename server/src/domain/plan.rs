//! The pure-data recipe of a job: passes, sizes and bytes, made before any device work.

mod tolerance;
mod view;

use serde::{Deserialize, Serialize};

use super::{
    Error, Result,
    mesh::Mesh,
    report::Warning,
    request::{Geometry, Normals, SeamRule, Tolerance},
    scene::Scene,
};

pub use tolerance::{BYTES_PER_TRIANGLE, MOST_TRIANGLES, Reserve, TolerancePlan};
pub use view::ViewPlan;

/// Elements of one page of a stream: no binding exceeds 128 MiB for elements up to 32 bytes.
pub const PAGE_ELEMENTS: u64 = 1 << 22;
/// Pages a shader can see at once, so 64 Mi elements per stream, and 512 Mi texels.
pub const MAX_PAGES: u64 = 16;
/// Values of all maps of one mesh: words of 4 bytes, so that eight times as many fit a page.
pub const MAX_TEXELS: u64 = 8 * PAGE_ELEMENTS * MAX_PAGES;
/// Details are evaluated for so many samples at a time, and what a sample and its derivatives take.
const SAMPLES: u64 = 1 << 20;
const SAMPLE_BYTES: u64 = 84;
/// Of a sample over a smooth base, besides.
const FIELDS_BYTES: u64 = 108;
/// Deepest uniform level: 4^12 triangles for each base triangle.
pub const MAX_LEVEL: u32 = 12;

/// How to displace one base mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SurfacePlan {
    /// Index into `Scene::meshes`.
    pub mesh: usize,
    pub tessellation: TessellationPlan,
    pub normals: NormalsPlan,
    pub seams: SeamsPlan,
    pub feather_texels: f32,
    /// Fine attribute vertices; of a tolerance those of the base mesh, which are the least that the result has.
    pub vertices: u64,
    /// As `vertices`.
    pub triangles: u64,
    /// Device memory for the base tables and the fine streams, of a tolerance for the base alone; maps are counted by
    /// the job.
    pub device_bytes: u64,
}

/// What makes the fine triangles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TessellationPlan {
    /// Each triangle becomes 4^level.
    Uniform { level: u32 },
    /// As many as it takes.
    Tolerance(TolerancePlan),
}

impl TessellationPlan {
    /// Level of the lattice that the base tables are made for: 0, the base mesh itself, where a tolerance decides.
    #[must_use]
    pub fn lattice_level(&self) -> u32 {
        match self {
            Self::Uniform { level } => *level,
            Self::Tolerance(_) => 0,
        }
    }

    /// Whether vertices, triangles and bytes are known before the work is done.
    #[must_use]
    pub fn is_counted(&self) -> bool {
        matches!(self, Self::Uniform { .. })
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum NormalsPlan {
    Analytic,
    Geometric,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SeamsPlan {
    Mean,
    Dominant,
}

impl SurfacePlan {
    /// Plans a uniform subdivision. Fails with `TooLarge` when a stream would not fit its pages.
    pub fn uniform(index: usize, mesh: &Mesh, level: u32, geometry: &Geometry) -> Result<Self> {
        if level > MAX_LEVEL {
            return Err(Error::invalid(
                "geometry.uniform",
                format!("level {level} is above the limit; allowed are 0 to {MAX_LEVEL}"),
            ));
        }
        let plan = Self::of(index, mesh, TessellationPlan::Uniform { level }, geometry);
        let Self { vertices, triangles, .. } = plan;
        let limit = PAGE_ELEMENTS * MAX_PAGES;
        if triangles > limit || vertices > limit {
            return Err(Error::too_large(
                "geometry.uniform",
                format!(
                    "level {level} makes {triangles} triangles and {vertices} vertices of mesh '{}'; at most {limit} of each fit one mesh: lower the level",
                    mesh.name
                ),
            ));
        }
        Ok(plan)
    }

    /// Plans for what keeps a tolerance, with a warning where less is asked for than f32 positions hold. Fails with
    /// `TooLarge` when the base mesh alone has more than [`MOST_TRIANGLES`].
    pub fn within_tolerance(
        index: usize,
        scene: &Scene,
        tolerance: &Tolerance,
        geometry: &Geometry,
        max_triangles: u64,
    ) -> Result<(Self, Option<Warning>)> {
        let (mut fitted, warning) = TolerancePlan::new(scene, index, tolerance, max_triangles)?;
        let mesh = &scene.meshes[index].mesh;
        let is_tied = matches!(geometry.normals, Normals::Map { .. }) || mesh.is_deformed();
        fitted.spans_base = fitted.views.is_empty() && !is_tied;
        let plan = Self::of(index, mesh, TessellationPlan::Tolerance(fitted), geometry);
        if plan.triangles > MOST_TRIANGLES {
            let message = format!(
                "mesh '{}' has {} triangles; at most {MOST_TRIANGLES} are refined: split the mesh, or give a uniform level",
                mesh.name, plan.triangles
            );
            return Err(Error::too_large("mesh", message));
        }
        Ok((plan, warning))
    }

    /// With what the lattice of the tessellation makes.
    fn of(index: usize, mesh: &Mesh, tessellation: TessellationPlan, geometry: &Geometry) -> Self {
        let level = tessellation.lattice_level();
        let triangles = (mesh.triangles.len() as u64) << (2 * level);
        let vertices = mesh.av_gv.len() as u64
            + mesh.ae_av.len() as u64 * displace_glsl::lattice::edge_points(level)
            + mesh.triangles.len() as u64 * displace_glsl::lattice::interior_points(level);
        Self {
            mesh: index,
            tessellation,
            normals: geometry.normals.into(),
            seams: geometry.seams.into(),
            feather_texels: geometry.feather_texels,
            vertices,
            triangles,
            device_bytes: device_bytes(mesh, vertices, triangles),
        }
    }
}

fn device_bytes(mesh: &Mesh, vertices: u64, triangles: u64) -> u64 {
    let attribute_components: u64 = mesh.attributes.iter().map(|a| a.components as u64).sum();
    let per_vertex = 16 + 16 + 16 + 12 + 12 + 4 * attribute_components;
    let base_bytes = mesh.av_gv.len() as u64 * 96 + mesh.ae_av.len() as u64 * 32 + mesh.triangles.len() as u64 * 48;
    let smooth_bytes = mesh.patches.as_ref().map_or(0, |patches| patches.bytes() + SAMPLES * FIELDS_BYTES);
    vertices * per_vertex + triangles * 12 + base_bytes + SAMPLES * SAMPLE_BYTES + smooth_bytes
}

impl From<Normals> for NormalsPlan {
    fn from(normals: Normals) -> Self {
        match normals {
            Normals::Analytic | Normals::Map { .. } => Self::Analytic,
            Normals::Geometric => Self::Geometric,
        }
    }
}

impl From<SeamRule> for SeamsPlan {
    fn from(rule: SeamRule) -> Self {
        match rule {
            SeamRule::Mean => Self::Mean,
            SeamRule::Dominant => Self::Dominant,
        }
    }
}
