//! Tables and push constants of shadow maps.

mirrors! {
    /// A side of what a light sees; `SHADOW_FACES` of them for each light.
    pub struct ShadowFace {
        pub row_x: [f32; 4],
        pub row_y: [f32; 4],
        pub row_z: [f32; 4],
        pub row_w: [f32; 4],
        pub first: u32,
        pub size: u32,
        pub bias: f32,
        pub bias_share: f32,
    }

    pub struct ShadowDepthsParams {
        pub count: u32,
        pub slab_px: [i32; 2],
        pub slab_size_px: [i32; 2],
        pub first: u32,
        pub size: u32,
    }

    pub struct ShadowMapParams {
        pub count: u32,
        pub lights: u32,
        pub any_normal: u32,
    }
}

/// Sides of a light: +x, -x, +y, -y, +z, -z; one and the same six times for what looks one way.
pub const SHADOW_FACES: usize = 6;
