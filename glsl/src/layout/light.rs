//! Push constants of the passes of physically based light and of the environment.

/// Cells of the table of reflected shares each way; its averages follow as one row more.
pub const TABLE_SIDE: u32 = 128;
/// Samples of a cell, a power of two.
pub const TABLE_SAMPLES: u32 = 1024;

mirrors! {
    pub struct BrdfTableParams {
        pub count: u32,
        pub side: u32,
        pub samples: u32,
    }

    pub struct BrdfAveragesParams {
        pub count: u32,
    }
}
