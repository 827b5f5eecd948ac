//! A loaded glTF asset: base meshes, instances, materials and cameras, and the document to write back.

use bytes::Bytes;

use super::{mesh::Mesh, report::Warning};

/// A glTF asset ready for work. `document` and `buffers` keep everything, understood or not, so that
/// what is not touched passes through.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// The whole glTF JSON.
    pub document: serde_json::Value,
    /// The bytes of each glTF buffer.
    pub buffers: Vec<Bytes>,
    /// One per glTF mesh that has triangles.
    pub meshes: Vec<SceneMesh>,
    /// Uses of `meshes` by nodes of the default scene.
    pub instances: Vec<Instance>,
    pub materials: Vec<Material>,
    pub images: Vec<SceneImage>,
    pub cameras: Vec<Camera>,
    /// Diagonal of the undisplaced scene's box, world units.
    pub diagonal: f64,
    /// Box of the undisplaced scene, world units.
    pub bounds: [[f32; 3]; 2],
    /// What was wrong or repaired while loading.
    pub warnings: Vec<Warning>,
}

#[derive(Clone, Debug, Default)]
pub struct SceneMesh {
    pub gltf_mesh: usize,
    pub mesh: Mesh,
}

/// `world_from_mesh` is column-major, as in glTF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    pub mesh: usize,
    pub world_from_mesh: [f32; 16],
}

#[derive(Clone, Debug, Default)]
pub struct Material {
    pub name: Option<String>,
    /// Linear RGBA.
    pub base_color_factor: [f32; 4],
    pub base_color: Option<TextureUse>,
    pub has_normal_map: bool,
    /// TEXCOORD_n of the normal map.
    pub normal_uv_set: u32,
    pub double_sided: bool,
    /// Cut-off of alpha mode MASK.
    pub alpha_cutoff: Option<f32>,
    /// KHR_materials_displacement(s): H = factor · red + offset.
    pub displacement: Option<MaterialDisplacement>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct MaterialDisplacement {
    pub texture: TextureUse,
    pub factor: f32,
    pub offset: f32,
}

/// A texture as a material uses it.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureUse {
    /// Index into `Scene::images`.
    pub image: usize,
    pub uv_set: u32,
    pub wrap: [super::detail::Wrap; 2],
    /// KHR_texture_transform as rows of uv' = M (u, v, 1).
    pub map_from_uv: [[f32; 3]; 2],
}

/// Encoded bytes of an image of the file; `None` when the file names one that could not be found.
#[derive(Clone, Debug, Default)]
pub struct SceneImage {
    pub media_type: String,
    pub bytes: Option<Bytes>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    pub name: Option<String>,
    pub world_from_camera: [f32; 16],
    /// Vertical field of view in radians; `None` for orthographic.
    pub yfov_radians: Option<f32>,
    /// Half height of an orthographic view, world units.
    pub ymag: f32,
    pub znear: f32,
    pub zfar: Option<f32>,
}
