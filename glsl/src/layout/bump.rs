//! Tables and push constants of the passes that bend normals.

mirrors! {
    /// How a material bends its normals besides its own normal map.
    pub struct Bump {
        pub kinds: [u32; 4],
        pub scales: [f32; 4],
        pub expression_first: u32,
        pub expression_count: u32,
        pub flags: u32,
    }

    /// Heights from a formula, as a material uses it.
    pub struct BumpFormula {
        pub map_u: [f32; 3],
        pub map_v: [f32; 3],
        pub uv_channel: u32,
        pub first: u32,
        pub count: u32,
        pub scale: f32,
    }

    pub struct BumpParams {
        pub count: u32,
        pub maps: u32,
        pub uv_channels: u32,
        pub has_tangents: u32,
        pub has_rises: u32,
    }

    pub struct BumpExpressionParams {
        pub count: u32,
        pub uv_channels: u32,
    }
}

/// Maps by which one material may bend its normals: `MAP_DETAIL` and the slots after it.
pub const BUMP_SLOTS: usize = 4;
/// Formulas of one material.
pub const MOST_FORMULAS: usize = 8;

/// What the map of a slot holds, `Bump::kinds`.
pub const BUMP_NONE: u32 = 0;
pub const BUMP_HEIGHT: u32 = 1;
pub const BUMP_TANGENT: u32 = 2;
pub const BUMP_OBJECT: u32 = 3;
pub const BUMP_CYSLICE: u32 = 4;

/// Bit of `Bump::flags`.
pub const BUMP_FACETED: u32 = 1;
