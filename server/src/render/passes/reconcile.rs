//! The passes `reconcile_corners` and `reconcile_edges`: one place for each geometric vertex. The insides
//! of corrected triangles follow with `reconcile_interiors`.

use std::{ops::Range, sync::Arc};

use displace_glsl::{
    SHADERS,
    lattice::{edge_points, interior_points},
    layout::geometry::{ReconcileCornersParams, ReconcileEdgesParams, ReconcileInteriorsParams, Seam, block},
    tables::Tables,
};

use super::{
    jets::{Domain, Jets, all_details, details_between},
    streams::{BaseStreams, CHUNK, FineStreams, SampleStreams},
};
use crate::{
    domain::Result,
    vulkan::{Device, Recorder},
};

pub fn record(
    device: &Arc<Device>,
    recorder: &mut Recorder<'_>,
    tables: &Tables,
    base: &BaseStreams,
    fine: &FineStreams,
) -> Result<()> {
    let pass = Pass { device, tables, base, fine };
    pass.corners(recorder)?;
    pass.edges(recorder)?;
    pass.interiors(recorder)
}

/// Corners alone: what `FineStreams::for_normals` needs.
pub fn record_corners(
    device: &Arc<Device>,
    recorder: &mut Recorder<'_>,
    tables: &Tables,
    base: &BaseStreams,
    fine: &FineStreams,
) -> Result<()> {
    Pass { device, tables, base, fine }.corners(recorder)
}

struct Pass<'a> {
    device: &'a Arc<Device>,
    tables: &'a Tables,
    base: &'a BaseStreams,
    fine: &'a FineStreams,
}

impl Pass<'_> {
    fn corners(&self, recorder: &mut Recorder<'_>) -> Result<()> {
        let all = &self.tables.seam_vertices;
        if all.is_empty() {
            return Ok(());
        }
        let chunks = seam_chunks(all, 1);
        let chunk = SampleStreams::new(self.device, self.tables, longest(all, &chunks))?;
        chunks.into_iter().try_for_each(|seams| self.corner_chunk(recorder, &chunk, seams))
    }

    fn corner_chunk(&self, recorder: &mut Recorder<'_>, chunk: &SampleStreams, seams: Range<usize>) -> Result<()> {
        let sides = sides(&self.tables.seam_vertices, &seams);
        self.jets(
            recorder,
            chunk,
            &Domain {
                block: block::SEAM_CORNERS,
                start: sides.start,
                count: sides.end - sides.start,
                details: all_details(self.tables),
                hats: false,
                ramps: false,
            },
        )?;
        let count = seams.len() as u64;
        let params = ReconcileCornersParams {
            count: count as u32,
            start: seams.start as u32,
            first_sample: sides.start as u32,
            rule: self.tables.rule,
        };
        let streams = [
            ("av_position_u", &self.base.av_position_u),
            ("seam_vertices", &self.base.seam_vertices),
            ("seam_corners", &self.base.seam_corners),
            ("jets", &chunk.jets),
            ("av_correction", &self.fine.av_correction),
            ("positions", &self.fine.positions),
            ("counters", &self.fine.counters),
        ];
        Ok(recorder.dispatch(&SHADERS.reconcile_corners, count, &params, &streams)?)
    }

    fn edges(&self, recorder: &mut Recorder<'_>) -> Result<()> {
        let points = edge_points(self.tables.lattice.level);
        if self.tables.seams.is_empty() || points == 0 {
            return Ok(());
        }
        let chunks = seam_chunks(&self.tables.seams, points);
        let chunk = SampleStreams::new(self.device, self.tables, longest(&self.tables.seams, &chunks) * points)?;
        for seams in chunks {
            self.edge_chunk(recorder, &chunk, seams, points)?;
        }
        Ok(())
    }

    fn edge_chunk(
        &self,
        recorder: &mut Recorder<'_>,
        chunk: &SampleStreams,
        seams: Range<usize>,
        points: u64,
    ) -> Result<()> {
        let sides = sides(&self.tables.seams, &seams);
        self.jets(
            recorder,
            chunk,
            &Domain {
                block: block::SEAM_EDGES,
                start: sides.start * points,
                count: (sides.end - sides.start) * points,
                details: all_details(self.tables),
                hats: !self.tables.corrections.is_empty(),
                ramps: false,
            },
        )?;
        let count = seams.len() as u64 * points;
        let params = ReconcileEdgesParams {
            count: count as u32,
            start: (seams.start as u64 * points) as u32,
            first_sample: (sides.start * points) as u32,
            rule: self.tables.rule,
            lattice: self.tables.lattice,
        };
        let mut streams = vec![
            ("av_position_u", &self.base.av_position_u),
            ("av_direction_v", &self.base.av_direction_v),
            ("av_normal", &self.base.av_normal),
            ("av_tangent", &self.base.av_tangent),
            ("base_edges", &self.base.base_edges),
            ("base_triangles", &self.base.base_triangles),
            ("seams", &self.base.seams),
            ("seam_sides", &self.base.seam_sides),
            ("jets", &chunk.jets),
            ("positions", &self.fine.positions),
            ("counters", &self.fine.counters),
        ];
        let shader = chunk.variant(&mut streams, &SHADERS.reconcile_edges, &SHADERS.reconcile_edges_smooth);
        Ok(recorder.dispatch(shader, count, &params, &streams)?)
    }

    fn interiors(&self, recorder: &mut Recorder<'_>) -> Result<()> {
        let points = interior_points(self.tables.lattice.level);
        let start = u64::from(self.tables.uncorrected_triangles) * points;
        let end = self.tables.triangle_order.len() as u64 * points;
        if start == end {
            return Ok(());
        }
        let chunk = SampleStreams::new(self.device, self.tables, CHUNK.min(end - start))?;
        for first in (start..end).step_by(CHUNK as usize) {
            self.interior_chunk(recorder, &chunk, first..(first + CHUNK).min(end), points)?;
        }
        Ok(())
    }

    fn interior_chunk(
        &self,
        recorder: &mut Recorder<'_>,
        chunk: &SampleStreams,
        range: Range<u64>,
        points: u64,
    ) -> Result<()> {
        self.jets(recorder, chunk, &interior_domain(self.tables, range.clone(), points, true))?;
        let count = range.end - range.start;
        let params =
            ReconcileInteriorsParams { count: count as u32, start: range.start as u32, lattice: self.tables.lattice };
        let mut streams = vec![
            ("av_position_u", &self.base.av_position_u),
            ("av_direction_v", &self.base.av_direction_v),
            ("av_normal", &self.base.av_normal),
            ("av_tangent", &self.base.av_tangent),
            ("base_edges", &self.base.base_edges),
            ("base_triangles", &self.base.base_triangles),
            ("triangle_order", &self.base.triangle_order),
            ("samples", &chunk.samples),
            ("jets", &chunk.jets),
            ("positions", &self.fine.positions),
        ];
        let shader = chunk.variant(&mut streams, &SHADERS.reconcile_interiors, &SHADERS.reconcile_interiors_smooth);
        Ok(recorder.dispatch(shader, count, &params, &streams)?)
    }

    fn jets(&self, recorder: &mut Recorder<'_>, chunk: &SampleStreams, domain: &Domain) -> Result<()> {
        let Self { tables, base, fine, .. } = self;
        Jets { tables, base, av_correction: &fine.av_correction, chunk }.record(recorder, domain)
    }
}

/// Samples `range` of the inside of base triangles, in their order.
#[must_use]
pub fn interior_domain(tables: &Tables, range: Range<u64>, points: u64, corrected: bool) -> Domain {
    // Ramps bring in the details of neighbours.
    let details = if corrected {
        all_details(tables)
    } else {
        details_between(tables, range.start / points, (range.end - 1) / points)
    };
    Domain {
        block: block::INTERIORS,
        start: range.start,
        count: range.end - range.start,
        details,
        hats: corrected,
        ramps: corrected,
    }
}

/// The entries of the list of sides that a range of seams owns.
fn sides(all: &[Seam], seams: &Range<usize>) -> Range<u64> {
    let (first, last) = (&all[seams.start], &all[seams.end - 1]);
    u64::from(first.first)..u64::from(last.first + last.count)
}

/// Most sides of one chunk.
fn longest(all: &[Seam], chunks: &[Range<usize>]) -> u64 {
    chunks.iter().map(|seams| sides(all, seams)).map(|sides| sides.end - sides.start).max().unwrap_or(0)
}

/// Ranges of seams of at most about `CHUNK` samples each.
fn seam_chunks(all: &[Seam], points: u64) -> Vec<Range<usize>> {
    let mut chunks = Vec::new();
    let (mut start, mut samples) = (0, 0);
    for (k, seam) in all.iter().enumerate() {
        let more = u64::from(seam.count) * points;
        if samples > 0 && samples + more > CHUNK {
            chunks.push(start..k);
            (start, samples) = (k, 0);
        }
        samples += more;
    }
    chunks.push(start..all.len());
    chunks
}
