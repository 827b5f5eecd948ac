//! What the oracle shows: as a `RenderScene`, with positions in f64 and with what they are off by.

use std::sync::Arc;

use glam::DVec3;

use crate::domain::{
    image::{RenderCamera, RenderInstance, RenderLight, RenderMaterial, RenderMesh, RenderScene},
    request::Aov,
};

/// A scene of triangles. Instances name meshes, meshes name materials, all of them there.
#[derive(Clone, Debug, Default)]
pub struct OracleScene {
    pub meshes: Vec<OracleMesh>,
    pub instances: Vec<RenderInstance>,
    pub materials: Vec<RenderMaterial>,
    pub camera: RenderCamera,
    pub light: RenderLight,
    pub aovs: Vec<Aov>,
}

/// Triangles with attributes per vertex, as many of each as there are positions.
#[derive(Clone, Debug, Default)]
pub struct OracleMesh {
    /// Finite, mesh-local.
    pub positions: Vec<DVec3>,
    /// Of any length: they are interpolated, then made unit.
    pub normals: Arc<Vec<[f32; 3]>>,
    /// Of the base colour map.
    pub uvs: Arc<Vec<[f32; 2]>>,
    /// Linear RGBA; empty means white.
    pub colors: Arc<Vec<[f32; 4]>>,
    pub triangles: Arc<Vec<[u32; 3]>>,
    /// (first triangle, index into the scene's `materials`), ascending; covers all triangles.
    pub material_of_triangles: Vec<(u32, u32)>,
    /// No point of the triangles is farther from the surface they stand for, world units; 0 where they are it.
    pub residual_world: f64,
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
            colors: Arc::clone(&mesh.colors),
            triangles: Arc::clone(&mesh.triangles),
            material_of_triangles: mesh.material_of_triangles.clone(),
            residual_world: 0.0,
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
            light: scene.light,
            aovs: scene.aovs.clone(),
        }
    }
}
