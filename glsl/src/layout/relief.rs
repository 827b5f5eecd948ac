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
        pub ends: u32,
    }

    /// What is beyond each side of a triangle, which leads from corner k to the next.
    pub struct ChartSides {
        /// Number of a triangle, [`CHART_OPEN`] or [`CHART_SEAM`].
        pub across: [u32; 3],
        /// See [`Crossing`].
        pub how: [u32; 3],
    }

    /// What a method found on a course.
    pub struct March {
        pub s: f32,
        pub place: [f32; 2],
        pub fetches: u32,
        pub steps: u32,
        pub capped: u32,
    }

    /// Where a ray has met a height map, or the border of its chart.
    pub struct Landing {
        pub x: [f32; 3],
        pub place: [f32; 2],
        pub turns: [f32; 2],
        pub kind: u32,
        pub lift: f32,
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

    /// Push constants of `land` and `relieve`.
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
        pub has_outlines: u32,
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

    /// Push constants of passes that make courses.
    pub struct CourseParams {
        pub count: u32,
        pub uv_channels: u32,
    }

    pub struct CourseFlatParams {
        pub count: u32,
        pub uv_channels: u32,
        pub finds_depth: u32,
    }
}

/// How one triangle lies on the map beside another, across a side of both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Crossing {
    /// Of that other triangle.
    pub side: u32,
    pub mirrored: bool,
    /// What is to be added to its places: whole numbers, at most [`MOST_TURNS`].
    pub turns: [i32; 2],
}

impl Crossing {
    #[must_use]
    pub fn packed(self) -> u32 {
        let turn = |axis: usize| self.turns[axis] as u32 & 0x3FFF;
        self.side | u32::from(self.mirrored) << 2 | turn(0) << 3 | turn(1) << 17
    }

    #[must_use]
    pub fn of(packed: u32) -> Self {
        let turn = |shift: u32| (packed << (18 - shift)) as i32 >> 18;
        Self { side: packed & 3, mirrored: packed & 4 != 0, turns: [turn(3), turn(17)] }
    }
}

/// Fits 14 bits.
pub const MOST_TURNS: i32 = 8191;
/// `ChartSides::across` where nothing of the mesh is.
pub const CHART_OPEN: u32 = u32::MAX;
/// `ChartSides::across` where the surface goes on, and is elsewhere on the map.
pub const CHART_SEAM: u32 = u32::MAX - 1;

/// Nodes that a course has room for.
pub const COURSE_NODES: usize = 9;
/// `March::s` where the surface is not met.
pub const MISSED: f32 = -1.0;
