//! Lists of what is flagged.

use std::sync::Arc;

use displace_glsl::{SHADERS, layout::lists::CompactParams};

use super::scan::Scan;
use crate::{
    domain::Result,
    vulkan::{Device, Recorder, Stream},
};

/// Device memory to compact up to a number of items.
pub struct Compact {
    scan: Scan,
    offsets: Stream,
}

impl Compact {
    pub fn new(device: &Arc<Device>, capacity: u64) -> Result<Self> {
        Ok(Self {
            scan: Scan::new(device, capacity)?,
            offsets: Stream::new(device, "compact offsets", 4, capacity.max(1))?,
        })
    }

    /// Records the numbers of the items whose flag is 1, in order. Flags are 0 or 1; `kept` has room for them.
    pub fn record(&self, recorder: &mut Recorder<'_>, flags: &Stream, kept: &Stream, count: u64) -> Result<()> {
        self.scan.record(recorder, flags, &self.offsets, count)?;
        let streams = [("flags", flags), ("offsets", &self.offsets), ("kept", kept)];
        recorder.dispatch(&SHADERS.compact, count, &CompactParams { count: count as u32 }, &streams)?;
        Ok(())
    }

    /// How many the last run kept.
    pub fn total(&self) -> Result<u64> {
        self.scan.total()
    }
}
