//! What the renderer takes and gives: meshes, materials, a camera, and images per output.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::{detail::Wrap, request::Aov};

/// The pure-data recipe of a render.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ImagePlan {
    pub width: u32,
    pub height: u32,
    /// Visibility samples per pixel: 4.
    pub samples: u32,
    pub device_bytes: u64,
}

/// Everything an image shows, in host memory.
#[derive(Clone, Debug, Default)]
pub struct RenderScene {
    pub meshes: Vec<RenderMesh>,
    pub instances: Vec<RenderInstance>,
    pub materials: Vec<RenderMaterial>,
    pub camera: RenderCamera,
    pub light: RenderLight,
    pub aovs: Vec<Aov>,
}

#[derive(Clone, Debug, Default)]
pub struct RenderMesh {
    pub positions: Arc<Vec<[f32; 3]>>,
    pub normals: Arc<Vec<[f32; 3]>>,
    /// The UV set of the base colour map of each vertex's material; (0, 0) where it has none.
    pub uvs: Arc<Vec<[f32; 2]>>,
    /// Linear RGBA; empty means white.
    pub colors: Arc<Vec<[f32; 4]>>,
    pub triangles: Arc<Vec<[u32; 3]>>,
    /// (first triangle, index into `materials`), ascending; covers all triangles.
    pub material_of_triangles: Vec<(u32, u32)>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RenderInstance {
    pub mesh: usize,
    /// Column-major.
    pub world_from_mesh: [f32; 16],
}

#[derive(Clone, Debug)]
pub struct RenderMaterial {
    /// Linear RGBA.
    pub base_color_factor: [f32; 4],
    pub base_color: Option<Arc<ColorMap>>,
    pub map_from_uv: [[f32; 3]; 2],
    pub wrap: [Wrap; 2],
    pub double_sided: bool,
    pub alpha_cutoff: Option<f32>,
}

/// A decoded colour image: linear RGBA f32, row-major, level 0 only (the renderer builds the mips).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColorMap {
    pub width: u32,
    pub height: u32,
    pub texels: Vec<[f32; 4]>,
}

/// Column-major matrices; depth is reversed: near is 1, far is 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RenderCamera {
    pub view_from_world: [f32; 16],
    pub clip_from_view: [f32; 16],
    pub eye_world: [f32; 3],
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderLight {
    /// Unit vector towards the light.
    pub direction_world: [f32; 3],
    pub color: [f32; 3],
    pub ambient: f32,
    /// Linear RGB behind everything.
    pub background: [f32; 3],
}

impl Default for RenderLight {
    fn default() -> Self {
        let s = 1.0 / 3f32.sqrt();
        Self { direction_world: [s, s, s], color: [1.0; 3], ambient: 0.2, background: [0.05; 3] }
    }
}

/// The images of one render, row-major from the top left.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImageSet {
    pub width: u32,
    pub height: u32,
    /// Linear RGBA.
    pub color: Vec<[f32; 4]>,
    /// View-space distance along the viewing axis, world units; infinity where nothing is.
    pub depth: Option<Vec<f32>>,
    pub normal: Option<Vec<[f32; 3]>>,
    pub position: Option<Vec<[f32; 3]>>,
    pub uv: Option<Vec<[f32; 2]>>,
    /// Triangle number over all instances in order; `u32::MAX` where nothing is.
    pub triangle: Option<Vec<u32>>,
}
