//! Scenes that tell what they do not cover.

use std::sync::Arc;

use crate::domain::{
    Result,
    camera::render_camera,
    image::{Lighting, RenderCamera, RenderInstance, RenderMaterial, RenderMesh, RenderScene},
    mesh::Mesh,
    request::{Aov, CameraChoice},
    scene::Scene,
    surface::Surface,
};

/// What no surface here shows.
const MAGENTA: [f32; 3] = [1.0, 0.0, 1.0];
const GREY: f32 = 0.5;
pub(super) const IDENTITY: [f32; 16] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// Grey and unlit before magenta, seen from `eye`. Depth and position are told besides.
pub(super) fn scene(meshes: Vec<RenderMesh>, camera: RenderCamera) -> RenderScene {
    let instance = |mesh: usize| RenderInstance { mesh, world_from_mesh: IDENTITY, stands_for: None };
    RenderScene {
        instances: (0..meshes.len()).map(instance).collect(),
        meshes,
        materials: vec![grey()],
        camera,
        lighting: Lighting { lights: Vec::new(), environment: None, ambient: 1.0, background: MAGENTA },
        uv_channels: 1,
        aovs: vec![Aov::Depth, Aov::Position],
        ..RenderScene::default()
    }
}

pub(super) fn grey() -> RenderMaterial {
    RenderMaterial {
        base_color_factor: [GREY, GREY, GREY, 1.0],
        roughness_factor: 1.0,
        normal_scale: 1.0,
        occlusion_strength: 1.0,
        double_sided: true,
        unlit: true,
        ..RenderMaterial::default()
    }
}

pub(super) fn camera(
    eye: [f32; 3],
    target: [f32; 3],
    yfov_degrees: f32,
    [width, height]: [u32; 2],
) -> Result<RenderCamera> {
    let choice = CameraChoice::LookAt { eye, target, yfov_degrees };
    render_camera(&choice, &Scene::default(), [[-1.0; 3], [1.0; 3]], width, height)
}

/// As a mesh of the renderer, of the first material.
pub(super) fn shown(mesh: &Mesh, surface: &Surface) -> RenderMesh {
    let uvs = mesh.attributes.iter().position(|a| a.semantic == "TEXCOORD_0");
    let uvs = uvs.map(|index| bytemuck::cast_slice(&surface.attributes[index]).to_vec());
    RenderMesh {
        positions: Arc::new(surface.positions.clone()),
        normals: Arc::new(surface.normals.clone()),
        uvs: Arc::new(uvs.unwrap_or_else(|| vec![[0.0; 2]; surface.positions.len()])),
        triangles: Arc::new(surface.triangles.clone()),
        material_of_triangles: vec![(0, 0)],
        ..RenderMesh::default()
    }
}

/// Pixels that show some of what is behind.
pub(super) fn magenta_pixels(color: &[[f32; 4]]) -> usize {
    color.iter().filter(|color| color[1] < 0.99 * GREY).count()
}
