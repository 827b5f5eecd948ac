//! What the renderer takes and gives: meshes, materials, a camera, and images per output.

mod alpha;
mod bump;
mod curvature;
mod lighting;
mod plan;
mod relief;
pub mod shadow_map;

use std::sync::Arc;

use displace_glsl::layout::raster::{MAP_NORMAL_MOMENTS, MAP_SLOTS};
use glam::DMat4;

use super::{
    detail::Wrap,
    projection::{Projection, ProjectionBox},
    request::{Aov, Shadows},
};

pub use alpha::{AlphaMode, BLEND_CUTOFF, RenderAlpha};
pub use bump::{BumpKind, BumpUse, RenderBump, RenderFormula};
pub use curvature::curvatures;
pub use lighting::{Filter, LightShape, Lighting, REFLECTIVITY, RenderLight, Shading};
pub use plan::{ImageContents, ImagePlan};
pub use relief::{HeightMap, MarchCounters, ReliefSettings, RenderRelief, SelfShadow, Silhouettes};

/// How an image was taken, for the files that can hold it.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageSettings {
    /// A pixel: rays, or the renderer's samples of visibility. Their mean is the pixel: a box filter.
    pub samples: u32,
    pub shadows: Shadows,
    pub lighting: Lighting,
    /// Name of the device.
    pub device: String,
    pub build: String,
    /// No point of what is shown is farther from the surface it stands for, world units.
    pub residual_world: f64,
}

/// Everything an image shows, in host memory.
#[derive(Clone, Debug, Default)]
pub struct RenderScene {
    pub meshes: Vec<RenderMesh>,
    pub instances: Vec<RenderInstance>,
    pub materials: Vec<RenderMaterial>,
    pub camera: RenderCamera,
    pub lighting: Lighting,
    pub shading: Shading,
    pub shadows: Shadows,
    pub filter: Filter,
    pub projection: Projection,
    pub relief: ReliefSettings,
    /// Materials that mirror what is around them, each at most once.
    pub reflectors: Vec<Reflector>,
    /// Mirrors one behind the other that rays follow; the rasteriser follows none.
    pub bounces: u32,
    /// Of each vertex; at least 1 where there are vertices.
    pub uv_channels: u32,
    pub aovs: Vec<Aov>,
}

impl RenderScene {
    /// What a plan needs to know of it.
    #[must_use]
    pub fn contents(&self) -> ImageContents {
        let vertices = |mesh: &RenderMesh| mesh.positions.len() as u64;
        let triangles = |mesh: &RenderMesh| mesh.triangles.len() as u64;
        let used = || self.instances.iter().filter_map(|instance| self.meshes.get(instance.mesh));
        let maps = || self.materials.iter().flat_map(|material| &material.maps);
        ImageContents {
            vertices: self.meshes.iter().map(vertices).sum(),
            triangles: self.meshes.iter().map(triangles).sum(),
            instance_vertices: used().map(vertices).sum(),
            instance_triangles: used().map(triangles).sum(),
            texels: distinct(maps().flatten().map(|used| &used.map)).map(|map| map.texels.len() as u64).sum(),
            outlined: self.outlined(),
            silhouettes: self.relief.silhouettes,
            relief_texels: distinct(self.materials.iter().filter_map(|material| Some(&material.relief.as_ref()?.map)))
                .map(|map| map.heights.len() as u64)
                .sum(),
            has_colors: self.meshes.iter().any(|mesh| !mesh.colors.is_empty()),
            uv_channels: self.uv_channels,
            shadow_lights: if self.has_shadows() { self.lighting.lights.len() as u32 } else { 0 },
            shadow_map_texels: if self.shadows == Shadows::Map { shadow_map::texels(&self.lighting.lights) } else { 0 },
            has_occluders: self.shadows == Shadows::Ray,
            environment: self.lighting.environment.as_ref().map(|map| [map.width, map.height]),
            reflection_texels: self.reflectors.iter().map(|r| 8 * u64::from(r.size_px).pow(2)).sum(),
            has_layers: self.materials.iter().any(|material| material.alpha == RenderAlpha::Blend),
            has_tangents: self.meshes.iter().any(|mesh| !mesh.tangents.is_empty()),
            has_moments: self.has_map(MAP_NORMAL_MOMENTS),
            is_projected: self.projection != Projection::Uv,
            map_slots: (0..MAP_SLOTS).filter(|slot| self.has_map(*slot)).count() as u32,
            has_formulas: self.materials.iter().any(|material| !material.bump.formulas.is_empty()),
            aovs: self.aovs.clone(),
        }
    }

    /// Triangles of all meshes, and of all instances, that relief gives other outlines.
    fn outlined(&self) -> [u64; 2] {
        if self.relief.silhouettes == Silhouettes::None || !self.marcher().is_some_and(|marcher| marcher.finds_depth) {
            return [0; 2];
        }
        let is_outlined = |material: u32| {
            let material = &self.materials[material as usize];
            material.relief.is_some() && material.alpha != RenderAlpha::Blend
        };
        let of_mesh = |mesh: &RenderMesh| {
            let ends = mesh.material_of_triangles.iter().skip(1).map(|run| run.0);
            let ends = ends.chain([mesh.triangles.len() as u32]);
            let runs = mesh.material_of_triangles.iter().zip(ends).filter(|((_, material), _)| is_outlined(*material));
            runs.map(|(run, end)| u64::from(end - run.0)).sum()
        };
        let meshes: Vec<u64> = self.meshes.iter().map(of_mesh).collect();
        let instances = self.instances.iter().filter(|instance| instance.stands_for.is_none());
        [meshes.iter().sum(), instances.filter_map(|instance| meshes.get(instance.mesh)).sum()]
    }

    /// Whether any material bends normals by more than its own normal map.
    #[must_use]
    pub fn is_bumped(&self) -> bool {
        self.materials.iter().any(|material| !material.bump.is_empty())
    }

    /// How heights are found per pixel; none where no material has any that are shown so.
    #[must_use]
    pub fn marcher(&self) -> Option<&'static displace_glsl::methods::Marcher> {
        let has_relief = self.materials.iter().any(|material| material.relief.is_some());
        self.relief.method.marcher().filter(|_| has_relief)
    }

    /// Whether what arrives of lights is told for each fragment.
    #[must_use]
    pub fn has_shadows(&self) -> bool {
        let in_relief = self.marcher().is_some() && self.relief.self_shadow != SelfShadow::None;
        self.shadows != Shadows::None || in_relief
    }

    /// Whether any material has a map in this place of its `maps`.
    #[must_use]
    pub fn has_map(&self, slot: usize) -> bool {
        self.materials.iter().any(|material| material.maps[slot].is_some())
    }
}

fn distinct<'a, T: 'a>(maps: impl Iterator<Item = &'a Arc<T>>) -> impl Iterator<Item = &'a Arc<T>> {
    let mut maps: Vec<_> = maps.collect();
    maps.sort_by_key(|map| Arc::as_ptr(map));
    maps.dedup_by_key(|map| Arc::as_ptr(map));
    maps.into_iter()
}

/// A material whose surfaces see what is around the middle of their box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reflector {
    /// Index into `materials`.
    pub material: u32,
    /// Of each of six images.
    pub size_px: u32,
    /// What is seen are the walls of a box, that of all else.
    pub in_room: bool,
}

#[derive(Clone, Debug, Default)]
pub struct RenderMesh {
    pub positions: Arc<Vec<[f32; 3]>>,
    pub normals: Arc<Vec<[f32; 3]>>,
    /// `uv_channels` of each vertex; (0, 0) where it has none.
    pub uvs: Arc<Vec<[f32; 2]>>,
    /// Of corners, three for each triangle: in the mesh's space, unit, and handedness, all 0 where there is none.
    /// Empty when no triangle has any.
    pub tangents: Arc<Vec<[f32; 4]>>,
    /// Linear RGBA; empty means white.
    pub colors: Arc<Vec<[f32; 4]>>,
    pub triangles: Arc<Vec<[u32; 3]>>,
    /// Of vertices, along which heights are above the base, of any length; empty where these are the normals.
    pub directions: Arc<Vec<[f32; 3]>>,
    /// (first triangle, index into `materials`), ascending; covers all triangles.
    pub material_of_triangles: Vec<(u32, u32)>,
    /// Of the mesh before it is displaced.
    pub projection_box: ProjectionBox,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RenderInstance {
    pub mesh: usize,
    /// Column-major.
    pub world_from_mesh: [f32; 16],
    /// Of the renderer's own: the instance in whose place it is drawn.
    pub stands_for: Option<usize>,
}

#[derive(Clone, Debug, Default)]
pub struct RenderMaterial {
    /// Linear RGBA.
    pub base_color_factor: [f32; 4],
    pub metallic_factor: f32,
    /// Perceptual.
    pub roughness_factor: f32,
    /// Linear radiance.
    pub emissive_factor: [f32; 3],
    pub normal_scale: f32,
    pub occlusion_strength: f32,
    /// By `MAP_BASE_COLOR` and its siblings. Normal maps hold vectors, [-1, 1], or slopes where there are moments; what
    /// details hold, `bump` says.
    pub maps: [Option<RenderMap>; MAP_SLOTS],
    pub bump: RenderBump,
    pub relief: Option<RenderRelief>,
    pub double_sided: bool,
    pub alpha: RenderAlpha,
    pub unlit: bool,
}

/// A map as a material uses it.
#[derive(Clone, Debug)]
pub struct RenderMap {
    pub map: Arc<ColorMap>,
    /// Of each vertex's `uvs`.
    pub uv_channel: u32,
    pub map_from_uv: [[f32; 3]; 2],
    pub wrap: [Wrap; 2],
}

/// A decoded image: linear RGBA f32, or vectors, row-major, level 0 only (the renderer builds the mips).
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
    /// How often samples of the pixel were covered, before depth and alpha decided.
    pub overdraw: Option<Vec<u32>>,
    /// Triangles that the pixel's samples show, each counted once.
    pub samples: Option<Vec<u32>>,
    /// Fetches, steps and cap hits of what the pixel's samples show of relief.
    pub cost: Option<Vec<[f32; 3]>>,
    /// Of all relief; none where a method shows none.
    pub counters: Option<MarchCounters>,
    /// Of the camera, column-major.
    pub clip_from_world: Option<[f32; 16]>,
    /// In some places more blended surfaces lie one behind the other than are shown.
    pub layers_left_out: bool,
}
