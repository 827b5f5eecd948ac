//! Tables and push constants of the rasteriser's passes.

mirrors! {
    /// A run of triangles of one instance and one material.
    pub struct Part {
        pub first_triangle: u32,
        pub triangle_base: u32,
        pub screen_base: u32,
        pub instance: u32,
        pub material: u32,
        pub flags: u32,
        pub stands_for: u32,
        pub faces: u32,
    }

    /// Factors of a material.
    pub struct Material {
        pub base_color: [f32; 4],
        pub emissive: [f32; 3],
        pub metallic: f32,
        pub roughness: f32,
        pub normal_scale: f32,
        pub occlusion_strength: f32,
        pub alpha_cutoff: f32,
        pub flags: u32,
    }

    /// A map as a material uses it; `MAP_SLOTS` of them for each material.
    pub struct TextureUse {
        pub map_u: [f32; 3],
        pub map_v: [f32; 3],
        pub wrap: u32,
        pub uv_channel: u32,
        pub level_first: u32,
        pub level_count: u32,
    }

    pub struct Light {
        pub position: [f32; 3],
        pub kind: u32,
        pub direction: [f32; 3],
        pub range: f32,
        pub color: [f32; 3],
        pub cone_scale: f32,
        pub cone_offset: f32,
        pub radius: f32,
    }

    pub struct Fragment {
        pub id: u32,
        pub at_px: [f32; 2],
        pub extra: u32,
    }

    pub struct SurfacePoint {
        pub id: u32,
        pub material: u32,
        pub covered: u32,
        pub instance: u32,
        pub triangle: u32,
        pub vertices: [u32; 3],
        pub at: [f32; 3],
        pub at_dx: [f32; 3],
        pub at_dy: [f32; 3],
        pub position: [f32; 3],
        pub normal: [f32; 3],
        pub facing: [f32; 3],
        pub flip: f32,
        pub pixel: u32,
    }

    pub struct Appearance {
        pub base: [f32; 4],
        pub emissive: [f32; 3],
        pub metallic: f32,
        pub normal: [f32; 3],
        pub roughness: f32,
        pub occlusion: f32,
        pub flags: u32,
    }

    pub struct BvhNode {
        pub low: [f32; 3],
        pub skip: u32,
        pub high: [f32; 3],
        pub first: u32,
    }

    pub struct ShadowRaysParams {
        pub count: u32,
        pub lights: u32,
        pub k: u32,
        pub nodes: u32,
        pub part_last: u32,
        pub uv_channels: u32,
        pub has_colors: u32,
        pub offset_world: f32,
    }

    pub struct TransformParams {
        pub count: u32,
        pub instance: u32,
        pub vertex_first: u32,
        pub screen_first: u32,
        pub size_px: [f32; 2],
    }

    pub struct SetupParams {
        pub count: u32,
        pub first_triangle: u32,
        pub part_first: u32,
        pub part_last: u32,
        pub slab_px: [i32; 2],
        pub slab_size_px: [i32; 2],
        pub capacity: u32,
        pub blended: u32,
    }

    /// Push constants of every `raster_*` pass.
    pub struct RasterParams {
        pub count: u32,
        pub list_first: u32,
        pub part_first: u32,
        pub part_last: u32,
        pub slab_px: [i32; 2],
        pub slab_size_px: [i32; 2],
        pub stage: u32,
        pub all_depths: u32,
    }

    pub struct ClipParams {
        pub count: u32,
        pub list_first: u32,
        pub part_first: u32,
        pub part_last: u32,
    }

    pub struct TileCountsParams {
        pub count: u32,
        pub slab_px: [i32; 2],
        pub slab_size_px: [i32; 2],
    }

    pub struct TilesParams {
        pub count: u32,
        pub pair_first: u32,
        pub record_count: u32,
        pub slab_px: [i32; 2],
        pub slab_size_px: [i32; 2],
    }

    pub struct FragmentsParams {
        pub count: u32,
        pub slab_px: [i32; 2],
        pub slab_size_px: [i32; 2],
        pub part_last: u32,
        pub has_relief: u32,
    }

    pub struct SurfaceParams {
        pub count: u32,
        pub part_last: u32,
    }

    /// Push constants of every `texture_*` pass.
    pub struct TextureParams {
        pub count: u32,
        pub slot: u32,
        pub uv_channels: u32,
    }

    pub struct ProjectParams {
        pub count: u32,
        pub kind: u32,
        pub index: u32,
    }

    /// How a fragment lies under a projection.
    pub struct ProjectedFrame {
        pub tangent: [f32; 3],
        pub weight: f32,
        pub bitangent: [f32; 3],
    }

    pub struct ProjectBlendParams {
        pub count: u32,
        pub index: u32,
        pub is_slope: u32,
    }

    pub struct AppearanceParams {
        pub count: u32,
        pub maps: u32,
        pub has_colors: u32,
        pub is_projected: u32,
    }

    pub struct MomentsParams {
        pub count: u32,
        pub uv_channels: u32,
    }

    /// One standard deviation of slopes of normals along their principal axes.
    pub struct Spread {
        pub major: [f32; 3],
        pub minor: [f32; 3],
    }

    pub struct MaskedParams {
        pub count: u32,
        pub slab_px: [i32; 2],
        pub slab_size_px: [i32; 2],
        pub has_colors: u32,
        pub has_map: u32,
        pub stage: u32,
    }

    pub struct ShadePhongParams {
        pub count: u32,
        pub normals: u32,
        pub lights: u32,
        pub shadowed: u32,
        pub eye: [f32; 4],
        pub ambient: f32,
        pub reflectivity: f32,
        pub has_environment: u32,
    }

    pub struct ResolveParams {
        pub count: u32,
        pub outputs: u32,
        pub view_depth: [f32; 4],
        pub background: [f32; 3],
        pub has_backdrop: u32,
        pub uv_channels: u32,
        pub has_layers: u32,
    }

    pub struct CompositeParams {
        pub count: u32,
        pub solid: u32,
    }

    pub struct DownsampleParams {
        pub count: u32,
        pub width: u32,
        pub side: u32,
    }

    pub struct MipParams {
        pub count: u32,
        pub source_first: u32,
        pub target_first: u32,
        pub source_size: [u32; 2],
        pub target_size: [u32; 2],
    }
}

/// Bits of `Part::flags`.
pub const PART_MIRRORED: u32 = 1;
pub const PART_DOUBLE_SIDED: u32 = 2;
pub const PART_MASKED: u32 = 4;
pub const PART_COLORED: u32 = 8;
pub const PART_BLENDED: u32 = 16;
pub const PART_RELIEF: u32 = 64;
pub const PART_UNSEEN: u32 = 32;

/// Rows of `instance_rows` for each instance.
pub const INSTANCE_ROWS: usize = 10;

/// The lists that `setup` sorts triangles into, in the order of `counters`.
pub const LISTS: usize = 5;
pub const SMALL: usize = 0;
pub const MEDIUM: usize = 1;
pub const LARGE: usize = 2;
pub const SMALL_MASKED: usize = 3;
pub const LARGE_MASKED: usize = 4;

/// Records that one triangle can leave after clipping.
pub const MAX_PIECES: u32 = 7;
/// Samples that one small triangle can cover.
pub const SMALL_SAMPLES: u32 = 17 * 5;
/// Width of a tile, pixels.
pub const TILE_PX: u32 = 16;
/// Visibility samples of a pixel.
pub const SAMPLES: u32 = 4;

/// Bits of `Material::flags`.
pub const MATERIAL_UNLIT: u32 = 1;
pub const MATERIAL_NORMAL_MAP: u32 = 2;
pub const MATERIAL_STOCHASTIC: u32 = 4;

/// What each place of a material's map slots holds.
pub const MAP_SLOTS: usize = 10;
pub const MAP_BASE_COLOR: usize = 0;
pub const MAP_NORMAL: usize = 1;
pub const MAP_METALLIC_ROUGHNESS: usize = 2;
pub const MAP_OCCLUSION: usize = 3;
pub const MAP_EMISSIVE: usize = 4;
pub const MAP_NORMAL_MOMENTS: usize = 5;
/// The first of `bump::BUMP_SLOTS`; what they hold, `bump::Bump` says.
pub const MAP_DETAIL: usize = 6;

/// `BvhNode::first` of a node that has nodes below it.
pub const BVH_INNER: u32 = u32::MAX;

/// `Light::kind`.
pub const LIGHT_SUN: u32 = 0;
pub const LIGHT_POINT: u32 = 1;
pub const LIGHT_SPOT: u32 = 2;

/// `ShadePhongParams::normals`.
pub const NORMALS_OF_PIXELS: u32 = 0;
pub const NORMALS_OF_VERTICES: u32 = 1;
pub const NORMALS_OF_TRIANGLES: u32 = 2;

/// Bits of `ResolveParams::outputs`.
pub const OUTPUT_DEPTH: u32 = 1;
pub const OUTPUT_NORMAL: u32 = 2;
pub const OUTPUT_POSITION: u32 = 4;
pub const OUTPUT_UV: u32 = 8;
pub const OUTPUT_TRIANGLE: u32 = 16;
pub const OUTPUT_SAMPLES: u32 = 32;
