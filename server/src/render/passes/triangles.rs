//! The pass `triangles`.

use displace_glsl::{SHADERS, layout::geometry::TrianglesParams, tables::Tables};

use super::streams::{BaseStreams, FineStreams};
use crate::{domain::Result, vulkan::Recorder};

pub fn record(recorder: &mut Recorder<'_>, tables: &Tables, base: &BaseStreams, fine: &FineStreams) -> Result<()> {
    let count = fine.triangles.len();
    let params = TrianglesParams { count: count as u32, first: 0, lattice: tables.lattice };
    let streams = [
        ("base_triangles", &base.base_triangles),
        ("triangle_facing", &base.triangle_facing),
        ("positions", &fine.positions),
        ("triangles", &fine.triangles),
        ("counters", &fine.counters),
    ];
    Ok(recorder.dispatch(&SHADERS.triangles, count, &params, &streams)?)
}
