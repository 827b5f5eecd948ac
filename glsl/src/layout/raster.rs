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
    }

    pub struct Material {
        pub base_color: [f32; 4],
        pub map_u: [f32; 3],
        pub map_v: [f32; 3],
        pub alpha_cutoff: f32,
        pub wrap: u32,
        pub level_first: u32,
        pub level_count: u32,
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
        pub position: [f32; 3],
        pub normal: [f32; 3],
        pub uv: [f32; 2],
        pub uv_dx: [f32; 2],
        pub uv_dy: [f32; 2],
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
    }

    /// Push constants of every `raster_*` pass.
    pub struct RasterParams {
        pub count: u32,
        pub list_first: u32,
        pub part_first: u32,
        pub part_last: u32,
        pub slab_px: [i32; 2],
        pub slab_size_px: [i32; 2],
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
    }

    pub struct SurfaceParams {
        pub count: u32,
        pub part_last: u32,
    }

    pub struct BaseColorParams {
        pub count: u32,
    }

    pub struct MaskedParams {
        pub count: u32,
        pub slab_px: [i32; 2],
        pub slab_size_px: [i32; 2],
    }

    pub struct ShadeParams {
        pub count: u32,
        pub outputs: u32,
        pub eye: [f32; 4],
        pub view_depth: [f32; 4],
        pub light_direction: [f32; 3],
        pub light_color: [f32; 3],
        pub background: [f32; 3],
        pub ambient: f32,
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

/// Bits of `ShadeParams::outputs`.
pub const OUTPUT_DEPTH: u32 = 1;
pub const OUTPUT_NORMAL: u32 = 2;
pub const OUTPUT_POSITION: u32 = 4;
pub const OUTPUT_UV: u32 = 8;
pub const OUTPUT_TRIANGLE: u32 = 16;
