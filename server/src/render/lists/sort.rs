//! Radix sort, a digit of 4 bits at a time, from the lowest.

use std::sync::Arc;

use displace_glsl::{
    SHADERS,
    layout::lists::{DIGIT_BITS, SCAN_BLOCK, SortCountsParams, SortScatterParams},
};

use super::scan::Scan;
use crate::{
    domain::Result,
    vulkan::{Device, Recorder, Stream},
};

/// Threads of a workgroup: one group works on one block.
const GROUP_THREADS: u64 = 64;
/// Key and value.
const RECORD_BYTES: u32 = 8;

/// Device memory to sort up to a number of records.
pub struct Sort {
    scan: Scan,
    counts: Stream,
    offsets: Stream,
    spare: Stream,
}

impl Sort {
    pub fn new(device: &Arc<Device>, capacity: u64) -> Result<Self> {
        let counts = capacity.div_ceil(SCAN_BLOCK).max(1) << DIGIT_BITS;
        Ok(Self {
            scan: Scan::new(device, counts)?,
            counts: Stream::new(device, "sort counts", 4, counts)?,
            offsets: Stream::new(device, "sort offsets", 4, counts)?,
            spare: Stream::new(device, "sort spare", RECORD_BYTES, capacity.max(1))?,
        })
    }

    /// Records the first `count` of `records`, pairs of key and value, in the order of the lowest `bits` of their keys.
    /// Equal keys keep their order. Works on whole pairs of digits, so keys have no bits from `bits` up to the next
    /// multiple of 8.
    pub fn record(&self, recorder: &mut Recorder<'_>, records: &Stream, count: u64, bits: u32) -> Result<()> {
        let blocks = count.div_ceil(SCAN_BLOCK);
        let threads = blocks * GROUP_THREADS;
        let (count, block_count) = (count as u32, blocks as u32);
        for digit in 0..bits.div_ceil(2 * DIGIT_BITS) * 2 {
            let shift = digit * DIGIT_BITS;
            let (from, to) = if digit % 2 == 0 { (records, &self.spare) } else { (&self.spare, records) };
            let params = SortCountsParams { count, blocks: block_count, shift };
            let streams = [("records", from), ("counts", &self.counts)];
            recorder.dispatch(&SHADERS.sort_counts, threads, &params, &streams)?;
            self.scan.record(recorder, &self.counts, &self.offsets, blocks << DIGIT_BITS)?;
            let params = SortScatterParams { count, blocks: block_count, shift };
            let streams = [("records", from), ("offsets", &self.offsets), ("sorted", to)];
            recorder.dispatch(&SHADERS.sort_scatter, threads, &params, &streams)?;
        }
        Ok(())
    }
}
