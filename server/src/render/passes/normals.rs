//! The passes `normals_analytic` and `normals_geometric`.

use std::{ops::Range, sync::Arc};

use displace_glsl::{
    SHADERS,
    lattice::{edge_points, interior_points},
    layout::geometry::{NormalsAnalyticParams, NormalsGeometricParams, block},
    tables::Tables,
};

use super::{
    jets::{Domain, Jets, all_details},
    reconcile::interior_domain,
    streams::{BaseStreams, CHUNK, FineStreams, SampleStreams},
    subdivide::blocks,
};
use crate::{
    domain::Result,
    vulkan::{Device, Recorder},
};

pub fn record_analytic(
    device: &Arc<Device>,
    recorder: &mut Recorder<'_>,
    tables: &Tables,
    base: &BaseStreams,
    fine: &FineStreams,
) -> Result<()> {
    let work = work(tables);
    let most = work.iter().map(|part| part.domain.count).max().unwrap_or(0);
    let chunk = SampleStreams::new(device, tables, most)?;
    let jets = Jets { tables, base, av_correction: &fine.av_correction, chunk: &chunk };
    for part in work {
        jets.record(recorder, &part.domain)?;
        part.normals(recorder, tables, base, fine, &chunk)?;
    }
    Ok(())
}

/// A chunk of vertices of one block and the samples around them.
pub(super) struct Part {
    pub(super) domain: Domain,
    /// Numbers of the vertices in their block.
    pub(super) vertices: Range<u64>,
}

impl Part {
    pub(super) fn normals(
        &self,
        recorder: &mut Recorder<'_>,
        tables: &Tables,
        base: &BaseStreams,
        fine: &FineStreams,
        chunk: &SampleStreams,
    ) -> Result<()> {
        let count = self.vertices.end - self.vertices.start;
        let params = NormalsAnalyticParams {
            count: count as u32,
            start: self.vertices.start as u32,
            first_sample: self.domain.start as u32,
            block: self.domain.block,
            lattice: tables.lattice,
        };
        let mut streams = vec![
            ("av_position_u", &base.av_position_u),
            ("av_direction_v", &base.av_direction_v),
            ("av_normal", &base.av_normal),
            ("av_tangent", &base.av_tangent),
            ("base_edges", &base.base_edges),
            ("base_triangles", &base.base_triangles),
            ("triangle_order", &base.triangle_order),
            ("contribution_first", &base.contribution_first),
            ("samples", &chunk.samples),
            ("jets", &chunk.jets),
            ("place_first", &chunk.listed.place_first),
            ("place_vertices", &chunk.listed.place_vertices),
            ("normals", &fine.normals),
        ];
        let shader = chunk.variant(&mut streams, &SHADERS.normals_analytic, &SHADERS.normals_analytic_smooth);
        Ok(recorder.dispatch(shader, count, &params, &streams)?)
    }
}

/// All vertices, cut into parts of about `CHUNK` samples.
fn work(tables: &Tables) -> Vec<Part> {
    let corners = tables.lattice.corners as usize;
    let edges = corners + tables.lattice.edges as usize;
    let points = edge_points(tables.lattice.level);
    let mut parts = list_parts(tables, block::CORNERS, 0..corners, 1);
    if points > 0 {
        parts.extend(list_parts(tables, block::EDGES, corners..edges, points));
    }
    let per_triangle = interior_points(tables.lattice.level);
    let border = u64::from(tables.uncorrected_triangles) * per_triangle;
    let end = tables.triangle_order.len() as u64 * per_triangle;
    parts.extend(interior_parts(tables, 0..border, per_triangle, false));
    parts.extend(interior_parts(tables, border..end, per_triangle, true));
    parts
}

/// Parts of the vertices that lists of contributions belong to, `points` vertices for each list.
fn list_parts(tables: &Tables, which: u32, lists: Range<usize>, points: u64) -> Vec<Part> {
    let item = |list: usize| u64::from(tables.contribution_first[list]);
    let corrected = !tables.corrections.is_empty();
    let mut parts = Vec::new();
    let mut first = lists.start;
    while first < lists.end {
        let mut end = first + 1;
        while end < lists.end && (item(end + 1) - item(first)) * points <= CHUNK {
            end += 1;
        }
        let vertices = (first - lists.start) as u64 * points..(end - lists.start) as u64 * points;
        let domain = Domain {
            block: which,
            start: item(first) * points,
            count: (item(end) - item(first)) * points,
            details: all_details(tables),
            hats: corrected,
            ramps: corrected,
        };
        parts.push(Part { domain, vertices });
        first = end;
    }
    parts
}

fn interior_parts(tables: &Tables, all: Range<u64>, points: u64, corrected: bool) -> Vec<Part> {
    let starts = all.clone().step_by(CHUNK as usize);
    let part = |start: u64| {
        let vertices = start..(start + CHUNK).min(all.end);
        Part { domain: interior_domain(tables, vertices.clone(), points, corrected), vertices }
    };
    starts.map(part).collect()
}

pub fn record_geometric(
    recorder: &mut Recorder<'_>,
    tables: &Tables,
    base: &BaseStreams,
    fine: &FineStreams,
) -> Result<()> {
    for (block, first, count) in blocks(tables) {
        let params =
            NormalsGeometricParams { count: count as u32, first: first as u32, block, lattice: tables.lattice };
        let streams = [
            ("av_position_u", &base.av_position_u),
            ("av_direction_v", &base.av_direction_v),
            ("av_normal", &base.av_normal),
            ("av_tangent", &base.av_tangent),
            ("base_edges", &base.base_edges),
            ("base_triangles", &base.base_triangles),
            ("contribution_first", &base.contribution_first),
            ("contributions", &base.contributions),
            ("positions", &fine.positions),
            ("normals", &fine.normals),
        ];
        recorder.dispatch(&SHADERS.normals_geometric, count, &params, &streams)?;
    }
    Ok(())
}
