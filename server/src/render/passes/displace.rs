//! The passes `rest`, `displace`, `displace_vector` and `displace_expression`: positions, one layer after
//! the other, so that each dispatch has one layer in its push constants.

use std::ops::Range;

use displace_glsl::{
    SHADERS,
    lattice::{edge_points, interior_points},
    layout::geometry::{DisplaceExpressionParams, DisplaceParams, DisplaceVectorParams, Layer, RestParams, kind},
    tables::Tables,
};

use super::streams::{BaseStreams, FineStreams};
use crate::{domain::Result, domain::mesh::Mesh, vulkan::Recorder};

pub fn record(
    recorder: &mut Recorder<'_>,
    tables: &Tables,
    mesh: &Mesh,
    base: &BaseStreams,
    fine: &FineStreams,
) -> Result<()> {
    let pass = Pass { tables, base, fine };
    for (detail, vertices) in runs(tables, mesh) {
        let layers = tables.details[detail as usize].clone();
        if layers.is_empty() {
            pass.rest(recorder, &vertices)?;
        }
        for (k, layer) in layers.enumerate() {
            pass.layer(recorder, &vertices, &tables.layers[layer as usize], k > 0)?;
        }
    }
    Ok(())
}

/// Ranges of fine vertices with one detail: primitives own contiguous avs, aes and triangles.
#[must_use]
pub fn runs(tables: &Tables, mesh: &Mesh) -> Vec<(u32, Range<u64>)> {
    let level = tables.lattice.level;
    let (per_edge, per_triangle) = (edge_points(level), interior_points(level));
    let edges = u64::from(tables.lattice.corners);
    let interiors = edges + u64::from(tables.lattice.edges) * per_edge;
    let scaled = |range: &Range<u32>, first: u64, each: u64| {
        first + u64::from(range.start) * each..first + u64::from(range.end) * each
    };
    let blocks: [&dyn Fn(usize) -> Range<u64>; 3] =
        [&|p| scaled(&mesh.primitives[p].avs, 0, 1), &|p| scaled(&mesh.primitives[p].aes, edges, per_edge), &|p| {
            scaled(&mesh.primitives[p].triangles, interiors, per_triangle)
        }];
    let mut runs: Vec<(u32, Range<u64>)> = Vec::new();
    for block in blocks {
        for p in 0..mesh.primitives.len() {
            let (detail, range) = (detail_of(tables, mesh, p), block(p));
            match runs.last_mut() {
                Some((last, open)) if *last == detail && open.end == range.start => open.end = range.end,
                _ => runs.push((detail, range)),
            }
        }
    }
    runs.retain(|(_, range)| !range.is_empty());
    runs
}

fn detail_of(tables: &Tables, mesh: &Mesh, p: usize) -> u32 {
    let first = mesh.primitives[p].triangles.start as usize;
    tables.base_triangles.get(first).map_or(0, |triangle| triangle.detail)
}

struct Pass<'a> {
    tables: &'a Tables,
    base: &'a BaseStreams,
    fine: &'a FineStreams,
}

impl Pass<'_> {
    fn rest(&self, recorder: &mut Recorder<'_>, vertices: &Range<u64>) -> Result<()> {
        let count = vertices.end - vertices.start;
        let params = RestParams { count: count as u32, first: vertices.start as u32 };
        let streams = [("base_position_u", &self.fine.base_position_u), ("positions", &self.fine.positions)];
        Ok(recorder.dispatch(&SHADERS.rest, count, &params, &streams)?)
    }

    fn layer(&self, recorder: &mut Recorder<'_>, vertices: &Range<u64>, layer: &Layer, on_top: bool) -> Result<()> {
        match layer.kind {
            kind::HEIGHT => self.height(recorder, vertices, layer, on_top),
            kind::EXPRESSION => self.expression(recorder, vertices, layer, on_top),
            _ => self.vector(recorder, vertices, layer, on_top),
        }
    }

    fn height(&self, recorder: &mut Recorder<'_>, vertices: &Range<u64>, layer: &Layer, on_top: bool) -> Result<()> {
        let count = vertices.end - vertices.start;
        let params = DisplaceParams {
            count: count as u32,
            first: vertices.start as u32,
            accumulate: u32::from(on_top),
            layer: *layer,
        };
        let streams = [
            ("base_position_u", &self.fine.base_position_u),
            ("base_direction_v", &self.fine.base_direction_v),
            ("texels", &self.base.texels),
            ("positions", &self.fine.positions),
        ];
        Ok(recorder.dispatch(&SHADERS.displace, count, &params, &streams)?)
    }

    fn vector(&self, recorder: &mut Recorder<'_>, vertices: &Range<u64>, layer: &Layer, on_top: bool) -> Result<()> {
        let count = vertices.end - vertices.start;
        let params = DisplaceVectorParams {
            count: count as u32,
            first: vertices.start as u32,
            accumulate: u32::from(on_top),
            layer: *layer,
        };
        let streams = [
            ("base_position_u", &self.fine.base_position_u),
            ("base_direction_v", &self.fine.base_direction_v),
            ("base_normals", &self.fine.base_normals),
            ("base_tangents", &self.fine.base_tangents),
            ("texels", &self.base.texels),
            ("positions", &self.fine.positions),
        ];
        Ok(recorder.dispatch(&SHADERS.displace_vector, count, &params, &streams)?)
    }

    fn expression(
        &self,
        recorder: &mut Recorder<'_>,
        vertices: &Range<u64>,
        layer: &Layer,
        on_top: bool,
    ) -> Result<()> {
        let count = vertices.end - vertices.start;
        let code = &self.tables.instructions[layer.first as usize..(layer.first + layer.row) as usize];
        let params = DisplaceExpressionParams {
            count: count as u32,
            first: vertices.start as u32,
            accumulate: u32::from(on_top),
            with_normals: u32::from(displace_glsl::expression::reads(code, 5..=7)),
            layer: *layer,
        };
        let streams = [
            ("base_position_u", &self.fine.base_position_u),
            ("base_direction_v", &self.fine.base_direction_v),
            ("base_normals", &self.fine.base_normals),
            ("instructions", &self.base.instructions),
            ("positions", &self.fine.positions),
        ];
        Ok(recorder.dispatch(&SHADERS.displace_expression, count, &params, &streams)?)
    }
}
