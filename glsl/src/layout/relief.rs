//! Tables, streams and push constants of heights that are shown per pixel.

mirrors! {
    /// How a material shows heights per pixel.
    pub struct Relief {
        pub map_u: [f32; 3],
        pub map_v: [f32; 3],
        pub uv_channel: u32,
        pub wrap: u32,
        pub level_first: u32,
        pub level_count: u32,
        pub low: f32,
        pub high: f32,
        pub thinnest_texels: f32,
        pub steps: u32,
    }

    /// A level of a height map, and what goes with it.
    pub struct ReliefLevel {
        pub size: [u32; 2],
        pub height_first: u32,
        pub bound_first: u32,
        pub cone_first: u32,
    }

    /// The way of a ray over a height map.
    pub struct Course {
        pub nodes: u32,
        pub material: u32,
        pub level: u32,
        pub cosine: f32,
    }

    /// What a method found on a course.
    pub struct March {
        pub s: f32,
        pub place: [f32; 2],
        pub fetches: u32,
        pub steps: u32,
        pub capped: u32,
    }

    /// Push constants of every pass that marches.
    pub struct MarchParams {
        pub count: u32,
        pub setting: f32,
    }

    /// Push constants of `cone_map`.
    pub struct ConeMapParams {
        pub count: u32,
        pub wrap: u32,
        pub high: f32,
        pub level: ReliefLevel,
    }

    pub struct RelieveParams {
        pub count: u32,
        pub uv_channels: u32,
        pub finds_depth: u32,
        pub has_outlines: u32,
        pub tests: u32,
        pub lifts: u32,
    }

    pub struct CourseLightParams {
        pub count: u32,
        pub uv_channels: u32,
        pub light: u32,
    }

    pub struct SelfShadowParams {
        pub count: u32,
        pub lights: u32,
        pub light: u32,
        pub soft: u32,
    }

    pub struct TallyParams {
        pub count: u32,
        pub slab_px: [i32; 2],
        pub slab_size_px: [i32; 2],
    }

    /// Push constants of every pass that makes courses.
    pub struct CourseParams {
        pub count: u32,
        pub uv_channels: u32,
    }
}

/// Nodes that a course has room for.
pub const COURSE_NODES: usize = 9;
/// `March::s` where the surface is not met.
pub const MISSED: f32 = -1.0;
