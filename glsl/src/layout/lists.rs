//! Push constants of the passes over lists: prefix sums, and what is made of them.

mirrors! {
    pub struct ScanSumsParams {
        pub count: u32,
        pub blocks: u32,
    }

    pub struct ScanBlocksParams {
        pub count: u32,
    }

    pub struct ScanParams {
        pub count: u32,
        pub blocks: u32,
    }

    pub struct CompactParams {
        pub count: u32,
    }

    pub struct ExpandParams {
        pub count: u32,
        pub items: u32,
    }

    pub struct SortCountsParams {
        pub count: u32,
        pub blocks: u32,
        pub shift: u32,
    }

    pub struct SortScatterParams {
        pub count: u32,
        pub blocks: u32,
        pub shift: u32,
    }
}

/// Items that one workgroup of a prefix sum or a sort takes.
pub const SCAN_BLOCK: u64 = 2048;
/// Bits that one round of a sort goes by.
pub const DIGIT_BITS: u32 = 4;
