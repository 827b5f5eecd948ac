//! The pure-data recipe of a job: passes, sizes and bytes, made before any device work.

use serde::{Deserialize, Serialize};

use super::{
    Error, Result,
    mesh::Mesh,
    request::{Geometry, Normals, SeamRule},
};

/// Elements of one page of a stream: no binding exceeds 128 MiB for elements up to 32 bytes.
pub const PAGE_ELEMENTS: u64 = 1 << 22;
/// Pages a shader can see at once, so 64 Mi elements per stream.
pub const MAX_PAGES: u64 = 16;
/// Details are evaluated for so many samples at a time, and what a sample and its derivatives take.
const SAMPLES: u64 = 1 << 20;
const SAMPLE_BYTES: u64 = 80;
/// Deepest uniform level: 4^12 triangles for each base triangle.
pub const MAX_LEVEL: u32 = 12;

/// How to displace one base mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SurfacePlan {
    /// Index into `Scene::meshes`.
    pub mesh: usize,
    pub level: u32,
    pub normals: NormalsPlan,
    pub seams: SeamsPlan,
    pub feather_texels: f32,
    /// Fine attribute vertices.
    pub vertices: u64,
    pub triangles: u64,
    /// Device memory for the base tables and the fine streams; maps are counted by the job.
    pub device_bytes: u64,
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
    pub fn uniform(index: usize, mesh: &Mesh, geometry: &Geometry) -> Result<Self> {
        let level = geometry.uniform_level;
        if level > MAX_LEVEL {
            return Err(Error::invalid(
                "geometry.uniform",
                format!("level {level} is above the limit; allowed are 0 to {MAX_LEVEL}"),
            ));
        }
        let triangles = (mesh.triangles.len() as u64) << (2 * level);
        let vertices = mesh.av_gv.len() as u64
            + mesh.ae_av.len() as u64 * displace_glsl::lattice::edge_points(level)
            + mesh.triangles.len() as u64 * displace_glsl::lattice::interior_points(level);
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
        let attribute_components: u64 = mesh.attributes.iter().map(|a| a.components as u64).sum();
        let per_vertex = 16 + 16 + 16 + 12 + 12 + 4 * attribute_components;
        let base_bytes = mesh.av_gv.len() as u64 * 96 + mesh.ae_av.len() as u64 * 32 + mesh.triangles.len() as u64 * 48;
        Ok(Self {
            mesh: index,
            level,
            normals: match geometry.normals {
                Normals::Analytic => NormalsPlan::Analytic,
                Normals::Geometric => NormalsPlan::Geometric,
            },
            seams: match geometry.seams {
                SeamRule::Mean => SeamsPlan::Mean,
                SeamRule::Dominant => SeamsPlan::Dominant,
            },
            feather_texels: geometry.feather_texels,
            vertices,
            triangles,
            device_bytes: vertices * per_vertex + triangles * 12 + base_bytes + SAMPLES * SAMPLE_BYTES,
        })
    }
}
