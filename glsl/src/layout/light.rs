//! Push constants of the passes of physically based light and of the environment.

/// Cells of the table of reflected shares each way; its averages follow as one row more.
pub const TABLE_SIDE: u32 = 128;
/// Samples of a cell, a power of two.
pub const TABLE_SAMPLES: u32 = 1024;

/// Widths of the levels of an environment that lobes of roughness k / 12, k from 1, see: twice their heights. No texel is
/// wider than the narrowest lobe it is read for.
pub const LOBE_WIDTHS: [u32; 12] = [512, 256, 256, 128, 128, 64, 64, 64, 64, 64, 64, 64];

/// Samples of a texel of such a level, by its number: where it has few texels, more.
#[must_use]
pub fn lobe_samples(k: usize) -> u32 {
    if LOBE_WIDTHS[k] >= 256 { 256 } else { 512 }
}

mirrors! {
    pub struct BrdfTableParams {
        pub count: u32,
        pub side: u32,
        pub samples: u32,
    }

    pub struct BrdfAveragesParams {
        pub count: u32,
    }

    pub struct EnvironmentLevelParams {
        pub count: u32,
        pub target_first: u32,
        pub target_size: [u32; 2],
        pub mips: u32,
        pub samples: u32,
        pub roughness: f32,
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

    pub struct SurroundingsParams {
        pub count: u32,
        pub normals: u32,
        pub mips: u32,
        pub lobes: u32,
        pub eye: [f32; 4],
    }

    /// What a fragment sees of an environment.
    pub struct Surroundings {
        pub diffuse: [f32; 3],
        pub specular: [f32; 3],
    }
}
