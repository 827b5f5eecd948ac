//! What the renderer takes and gives: meshes, materials, a camera, and images per output.

use std::sync::Arc;

use glam::DMat4;
use serde::{Deserialize, Serialize};

use super::{
    Error, Result,
    detail::Wrap,
    request::{Aov, Rays, Shadows},
};

/// The pure-data recipe of a render.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ImagePlan {
    pub width: u32,
    pub height: u32,
    /// Visibility samples per pixel: 4.
    pub samples: u32,
    /// Traces the image instead: the image oracle's work, on the reference alone.
    pub rays: Option<Rays>,
    /// The image is made in slabs of at most so many pixels a side; a multiple of 16.
    pub slab_px: u32,
    pub device_bytes: u64,
}

/// How much a scene holds, known before any of it is made.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImageContents {
    /// Of all meshes, each counted once.
    pub vertices: u64,
    pub triangles: u64,
    /// Of all instances, each counted as often as it is used.
    pub instance_vertices: u64,
    pub instance_triangles: u64,
    /// Texels of the distinct base colour maps.
    pub texels: u64,
    pub has_colors: bool,
    pub aovs: Vec<Aov>,
}

impl ImagePlan {
    pub const MAX_SIDE: u32 = 16384;
    pub const MAX_SLAB: u32 = 512;

    /// Plans an image. Fails when a side is out of range.
    pub fn new(width: u32, height: u32, contents: &ImageContents) -> Result<Self> {
        for (field, side) in [("size.width", width), ("size.height", height)] {
            if !(1..=Self::MAX_SIDE).contains(&side) {
                let message = format!("{side} is out of range; 1 to {} pixels are allowed", Self::MAX_SIDE);
                return Err(Error::invalid(field, message));
            }
        }
        let slab_px = Self::MAX_SLAB;
        let slab_pixels = u64::from(width.min(slab_px)) * u64::from(height.min(slab_px));
        let device_bytes = contents.scene_bytes() + contents.work_bytes(slab_pixels);
        Ok(Self { width, height, samples: 4, rays: None, slab_px, device_bytes })
    }
}

/// How an image was taken, for the files that can hold it.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageSettings {
    /// A pixel: rays, or the renderer's samples of visibility. Their mean is the pixel: a box filter.
    pub samples: u32,
    pub shadows: Shadows,
    pub light: RenderLight,
    /// Name of the device.
    pub device: String,
    pub build: String,
    /// No point of what is shown is farther from the surface it stands for, world units.
    pub residual_world: f64,
}

impl ImageContents {
    /// Vertices (place, normal, uv, perhaps a colour), triangles, maps with their mips in half floats.
    fn scene_bytes(&self) -> u64 {
        let per_vertex = 12 + 12 + 8 + if self.has_colors { 16 } else { 0 };
        self.vertices * per_vertex + self.triangles * 12 + self.texels * 8 * 4 / 3
    }

    /// Screen vertices, lists, records and pairs of large triangles, and what each sample and pixel takes.
    fn work_bytes(&self, slab_pixels: u64) -> u64 {
        let screen = 16 * self.instance_vertices;
        let listed = self.instance_triangles.min(1 << 20);
        let records = self.instance_triangles.min(1 << 15) * 7 * (48 + 8) + (8 << 18);
        let per_sample = 8 + 16 + 60 + 16;
        let outputs: u64 = self.aovs.iter().map(|aov| aov.bytes()).sum();
        screen + listed * 20 + records + slab_pixels * (4 * per_sample + 4 + 16 + outputs)
    }
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

impl RenderScene {
    /// What a plan needs to know of it.
    #[must_use]
    pub fn contents(&self) -> ImageContents {
        let vertices = |mesh: &RenderMesh| mesh.positions.len() as u64;
        let triangles = |mesh: &RenderMesh| mesh.triangles.len() as u64;
        let used = || self.instances.iter().filter_map(|instance| self.meshes.get(instance.mesh));
        let mut maps: Vec<&Arc<ColorMap>> = self.materials.iter().filter_map(|m| m.base_color.as_ref()).collect();
        maps.sort_by_key(|map| Arc::as_ptr(map));
        maps.dedup_by_key(|map| Arc::as_ptr(map));
        ImageContents {
            vertices: self.meshes.iter().map(vertices).sum(),
            triangles: self.meshes.iter().map(triangles).sum(),
            instance_vertices: used().map(vertices).sum(),
            instance_triangles: used().map(triangles).sum(),
            texels: maps.iter().map(|map| map.texels.len() as u64).sum(),
            has_colors: self.meshes.iter().any(|mesh| !mesh.colors.is_empty()),
            aovs: self.aovs.clone(),
        }
    }
}

impl Aov {
    /// Per pixel.
    fn bytes(self) -> u64 {
        match self {
            Self::Depth | Self::Triangle => 4,
            Self::Uv => 8,
            Self::Normal | Self::Position => 12,
        }
    }
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

/// glTF's alpha mode MASK has a cut-off; other materials are opaque.
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

impl RenderCamera {
    /// Column-major.
    #[must_use]
    pub fn clip_from_world(&self) -> [f32; 16] {
        let [clip_from_view, view_from_world] =
            [self.clip_from_view, self.view_from_world].map(|m| DMat4::from_cols_array(&m.map(f64::from)));
        (clip_from_view * view_from_world).as_mat4().to_cols_array()
    }
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
    /// Of the camera, column-major.
    pub clip_from_world: Option<[f32; 16]>,
}
