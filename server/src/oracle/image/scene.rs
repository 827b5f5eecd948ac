//! What the oracle shows: as a `RenderScene`, with positions in f64 and with what they are off by.

use std::sync::Arc;

use glam::DVec3;

use crate::domain::{
    image::{Lighting, RenderCamera, RenderInstance, RenderMaterial, RenderMesh, RenderScene, Shading},
    projection::{Projection, ProjectionBox},
    request::Aov,
};

/// A scene of triangles. Instances name meshes, meshes name materials, all of them there.
#[derive(Clone, Debug, Default)]
pub struct OracleScene {
    pub meshes: Vec<OracleMesh>,
    pub instances: Vec<RenderInstance>,
    pub materials: Vec<RenderMaterial>,
    pub camera: RenderCamera,
    pub lighting: Lighting,
    pub shading: Shading,
    pub projection: Projection,
    /// Mirrors one behind the other that rays follow: metals of roughness 0 under `Shading::Pbr`.
    pub bounces: u32,
    /// Of each vertex; at least 1 where there are vertices.
    pub uv_channels: u32,
    pub aovs: Vec<Aov>,
}

/// Triangles with attributes per vertex, as many of each as there are positions but where it says otherwise.
#[derive(Clone, Debug, Default)]
pub struct OracleMesh {
    /// Finite, mesh-local.
    pub positions: Vec<DVec3>,
    /// Of any length: they are interpolated, then made unit.
    pub normals: Arc<Vec<[f32; 3]>>,
    /// `uv_channels` of each vertex.
    pub uvs: Arc<Vec<[f32; 2]>>,
    /// Of corners, three for each triangle, and handedness, all 0 where there is none; empty without any.
    pub tangents: Arc<Vec<[f32; 4]>>,
    /// Linear RGBA; empty means white.
    pub colors: Arc<Vec<[f32; 4]>>,
    pub triangles: Arc<Vec<[u32; 3]>>,
    /// (first triangle, index into the scene's `materials`), ascending; covers all triangles.
    pub material_of_triangles: Vec<(u32, u32)>,
    /// No point of the triangles is farther from the surface they stand for, world units; 0 where they are it.
    pub residual_world: f64,
    /// Of the mesh before it is displaced.
    pub projection_box: ProjectionBox,
}

impl OracleScene {
    /// Of all meshes.
    #[must_use]
    pub fn residual_world(&self) -> f64 {
        self.meshes.iter().fold(0.0, |most, mesh| most.max(mesh.residual_world))
    }
}

impl From<&RenderMesh> for OracleMesh {
    fn from(mesh: &RenderMesh) -> Self {
        Self {
            positions: mesh.positions.iter().map(|p| DVec3::from_array(p.map(f64::from))).collect(),
            normals: Arc::clone(&mesh.normals),
            uvs: Arc::clone(&mesh.uvs),
            tangents: Arc::clone(&mesh.tangents),
            colors: Arc::clone(&mesh.colors),
            triangles: Arc::clone(&mesh.triangles),
            material_of_triangles: mesh.material_of_triangles.clone(),
            residual_world: 0.0,
            projection_box: mesh.projection_box,
        }
    }
}

impl From<&RenderScene> for OracleScene {
    fn from(scene: &RenderScene) -> Self {
        Self {
            meshes: scene.meshes.iter().map(OracleMesh::from).collect(),
            instances: scene.instances.clone(),
            materials: scene.materials.clone(),
            camera: scene.camera,
            lighting: scene.lighting.clone(),
            shading: scene.shading,
            projection: scene.projection,
            bounces: scene.bounces,
            uv_channels: scene.uv_channels,
            aovs: scene.aovs.clone(),
        }
    }
}
