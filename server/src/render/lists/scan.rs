//! Exclusive prefix sums on the device: reduce, scan the sums, scan.

use std::sync::Arc;

use displace_glsl::{
    SHADERS,
    layout::lists::{SCAN_BLOCK, ScanBlocksParams, ScanParams, ScanSumsParams},
};

use crate::{
    domain::Result,
    vulkan::{Device, Recorder, Stream},
};

/// Threads of a workgroup: one group works on one block.
const GROUP_THREADS: u64 = 64;

/// Device memory for prefix sums over up to a number of items.
pub struct Scan {
    block_sums: Stream,
    /// Low and high word.
    total: Stream,
}

impl Scan {
    pub fn new(device: &Arc<Device>, capacity: u64) -> Result<Self> {
        Ok(Self {
            block_sums: Stream::new(device, "scan block sums", 8, capacity.div_ceil(SCAN_BLOCK).max(1))?,
            total: Stream::from_slice(device, "scan total", &[0u32; 2])?,
        })
    }

    /// Records `offsets[i] = items[0] + ... + items[i - 1]` for the first `count` items, modulo 2^32: check
    /// [`Self::total`] where more could come out.
    pub fn record(&self, recorder: &mut Recorder<'_>, items: &Stream, offsets: &Stream, count: u64) -> Result<()> {
        let blocks = count.div_ceil(SCAN_BLOCK);
        let (count, block_count) = (count as u32, blocks as u32);
        let sums = ScanSumsParams { count, blocks: block_count };
        let threads = blocks * GROUP_THREADS;
        let block_sums = ("block_sums", &self.block_sums);
        recorder.dispatch(&SHADERS.scan_sums, threads, &sums, &[("items", items), block_sums])?;
        let of_blocks = ScanBlocksParams { count: block_count };
        recorder.dispatch(&SHADERS.scan_blocks, GROUP_THREADS, &of_blocks, &[block_sums, ("total", &self.total)])?;
        let scan = ScanParams { count, blocks: block_count };
        recorder.dispatch(&SHADERS.scan, threads, &scan, &[("items", items), block_sums, ("offsets", offsets)])?;
        Ok(())
    }

    /// The sum of all items of the scan that ran last.
    pub fn total(&self) -> Result<u64> {
        let words: Vec<u32> = self.total.read()?;
        Ok(u64::from(words[0]) | u64::from(words[1]) << 32)
    }
}
