//! The pass `subdivide`: the base surface at every fine vertex.

use displace_glsl::{
    SHADERS,
    lattice::{edge_points, interior_points},
    layout::geometry::{SubdivideParams, block},
    tables::Tables,
};

use super::streams::{BaseStreams, FineStreams};
use crate::{domain::Result, vulkan::Recorder};

/// The blocks of fine vertices: (block, first fine vertex, vertices).
#[must_use]
pub fn blocks(tables: &Tables) -> [(u32, u64, u64); 3] {
    let level = tables.lattice.level;
    let corners = u64::from(tables.lattice.corners);
    let edges = u64::from(tables.lattice.edges) * edge_points(level);
    let interiors = tables.base_triangles.len() as u64 * interior_points(level);
    [(block::CORNERS, 0, corners), (block::EDGES, corners, edges), (block::INTERIORS, corners + edges, interiors)]
}

pub fn record(recorder: &mut Recorder<'_>, tables: &Tables, base: &BaseStreams, fine: &FineStreams) -> Result<()> {
    for (block, first, count) in blocks(tables) {
        let params = SubdivideParams {
            count: count as u32,
            first: first as u32,
            block,
            with_normals: u32::from(!fine.base_normals.is_empty()),
            with_tangents: u32::from(!fine.base_tangents.is_empty()),
            lattice: tables.lattice,
        };
        let mut streams = vec![
            ("av_position_u", &base.av_position_u),
            ("av_direction_v", &base.av_direction_v),
            ("av_normal", &base.av_normal),
            ("av_tangent", &base.av_tangent),
            ("base_edges", &base.base_edges),
            ("base_triangles", &base.base_triangles),
            ("base_position_u", &fine.base_position_u),
            ("base_direction_v", &fine.base_direction_v),
            ("base_normals", &fine.base_normals),
            ("base_tangents", &fine.base_tangents),
        ];
        if tables.patches.is_none() {
            recorder.dispatch(&SHADERS.subdivide, count, &params, &streams)?;
        } else {
            streams.extend([("patch_nodes", &base.patch_nodes), ("patch_points", &base.patch_points)]);
            recorder.dispatch(&SHADERS.subdivide_smooth, count, &params, &streams)?;
        }
    }
    Ok(())
}
