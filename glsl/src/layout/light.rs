//! Push constants of the passes of physically based light and of the environment.

/// Cells of the table of reflected shares each way; its averages follow as one row more.
pub const TABLE_SIDE: u32 = 128;
/// Samples of a cell, a power of two.
pub const TABLE_SAMPLES: u32 = 1024;

/// Directions that a surface's lobe is looked up in.
pub const LOBE_SAMPLES: u32 = 32;

mirrors! {
    pub struct BrdfTableParams {
        pub count: u32,
        pub side: u32,
        pub samples: u32,
    }

    pub struct BrdfAveragesParams {
        pub count: u32,
    }

    pub struct ShadePbrParams {
        pub count: u32,
        pub lights: u32,
        pub shadowed: u32,
        pub multiple_scattering: u32,
        pub eye: [f32; 4],
        pub ambient: f32,
        pub has_environment: u32,
    }

    pub struct BackdropParams {
        pub count: u32,
        pub slab_px: [i32; 2],
        pub slab_size_px: [i32; 2],
        pub mips: u32,
        pub direction: [f32; 3],
        pub direction_dx: [f32; 3],
        pub direction_dy: [f32; 3],
    }

    pub struct SurroundingsParams {
        pub count: u32,
        pub normals: u32,
        pub mips: u32,
        pub samples: u32,
        pub eye: [f32; 4],
        pub of_material: u32,
        pub has_room: u32,
        pub centre: [f32; 3],
        pub low: [f32; 3],
        pub high: [f32; 3],
    }

    pub struct LightAimsParams {
        pub count: u32,
        pub lights: u32,
        pub k: u32,
        pub any_normal: u32,
    }

    /// What a fragment sees of an environment.
    pub struct Surroundings {
        pub diffuse: [f32; 3],
        pub facing: [f32; 3],
        pub grazing: [f32; 3],
    }
}
