//! Push constants of the passes of physically based light and of the environment.

/// Cells of the table of reflected shares each way; its averages follow as one row more.
pub const TABLE_SIDE: u32 = 128;
/// Samples of a cell, a power of two.
pub const TABLE_SAMPLES: u32 = 1024;

/// Widths of the levels of an environment that lobes of roughness k / 12, k from 1, see: twice their heights. No texel is
/// wider than the narrowest lobe it is read for.
pub const LOBE_WIDTHS: [u32; 12] = [512, 256, 256, 128, 128, 64, 64, 64, 64, 64, 64, 64];

/// Levels of an environment that lobes see: perceptual roughness, width, height and samples of a texel, for a map of that
/// width. Where the map has less to show than a level could, the level is smaller; where it has few texels, they have more
/// samples.
#[must_use]
pub fn lobe_levels(map_width: u32) -> [LobeLevel; LOBE_WIDTHS.len()] {
    let most = (2 * map_width).next_power_of_two().max(64);
    std::array::from_fn(|k| {
        let width = LOBE_WIDTHS[k].min(most);
        let samples = if width >= 256 { 256 } else { 512 };
        LobeLevel { roughness: (k + 1) as f32 / LOBE_WIDTHS.len() as f32, size: [width, width / 2], samples }
    })
}

/// See `lobe_levels`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LobeLevel {
    pub roughness: f32,
    pub size: [u32; 2],
    /// A power of two.
    pub samples: u32,
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
        pub lobes: u32,
        pub eye: [f32; 4],
    }

    /// What a fragment sees of an environment.
    pub struct Surroundings {
        pub diffuse: [f32; 3],
        pub specular: [f32; 3],
    }
}
