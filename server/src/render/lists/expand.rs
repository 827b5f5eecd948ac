//! Places for items that need several.

use displace_glsl::{SHADERS, layout::lists::ExpandParams};

use crate::{
    domain::Result,
    vulkan::{Recorder, Stream},
};

/// Records `places[offsets[i] + k] = (i, k)` for every k below the count of item i; `offsets` are the exclusive sums of
/// the counts of `items` items, `count` their total.
pub fn record(recorder: &mut Recorder<'_>, offsets: &Stream, places: &Stream, items: u64, count: u64) -> Result<()> {
    if items == 0 {
        return Ok(());
    }
    let params = ExpandParams { count: count as u32, items: items as u32 };
    recorder.dispatch(&SHADERS.expand, count, &params, &[("offsets", offsets), ("places", places)])?;
    Ok(())
}
