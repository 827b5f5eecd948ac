//! The passes `samples` and `jets_*`: displacements with derivatives, for a chunk of samples.
//! A chunk's samples end up as those at the vertices themselves, its jets as the corrected sums.

use displace_glsl::{
    SHADERS,
    layout::{
        geometry::{
            JetsCorrectionParams, JetsExpressionParams, JetsHeightParams, JetsVectorParams, OWN, SamplesParams, kind,
        },
        smooth::FieldsParams,
    },
    tables::Tables,
};

use super::streams::{BaseStreams, SampleStreams};
use crate::{
    domain::Result,
    vulkan::{Recorder, Stream},
};

/// What the jet passes need throughout a job.
pub struct Jets<'a> {
    pub tables: &'a Tables,
    pub base: &'a BaseStreams,
    pub av_correction: &'a Stream,
    pub chunk: &'a SampleStreams,
}

/// A chunk of samples of one block.
#[derive(Clone, Debug)]
pub struct Domain {
    pub block: u32,
    /// Number of the first sample in its block; 0 for `PLACES`, where a chunk has its own list.
    pub start: u64,
    pub count: u64,
    /// Details that occur in it, without 0.
    pub details: Vec<u32>,
    /// Whether corner corrections are added.
    pub hats: bool,
    /// Whether the ramps of seams are added.
    pub ramps: bool,
}

impl Jets<'_> {
    pub fn record(&self, recorder: &mut Recorder<'_>, domain: &Domain) -> Result<()> {
        let layers: u32 = domain.details.iter().map(|d| self.tables.details[*d as usize].len() as u32).sum();
        // A single detail's first layer writes every jet; otherwise they start from zero.
        let fresh = !domain.ramps && domain.details.len() == 1 && layers > 0 && self.has_one_detail(domain);
        if !fresh {
            recorder.fill(&self.chunk.jets, 0)?;
        }
        if domain.ramps {
            for side in 0..3 {
                for rank in 0..self.tables.max_rank {
                    self.add(recorder, domain, side, rank, true)?;
                }
            }
        }
        self.add(recorder, domain, OWN, 0, !fresh)
    }

    /// Whether no sample of the chunk is without detail.
    fn has_one_detail(&self, domain: &Domain) -> bool {
        domain.details.first().is_some_and(|d| self.tables.base_triangles.iter().all(|t| t.detail == *d))
    }

    fn add(&self, recorder: &mut Recorder<'_>, domain: &Domain, side: u32, rank: u32, accumulate: bool) -> Result<()> {
        self.samples(recorder, domain, side, rank)?;
        self.fields(recorder, domain.count)?;
        let mut on_top = accumulate;
        for &detail in &domain.details {
            for layer in self.tables.details[detail as usize].clone() {
                self.layer(recorder, domain.count, detail, layer, on_top)?;
                on_top = true;
            }
        }
        if domain.hats {
            self.correction(recorder, domain.count)?;
        }
        Ok(())
    }

    fn samples(&self, recorder: &mut Recorder<'_>, domain: &Domain, side: u32, rank: u32) -> Result<()> {
        let params = SamplesParams {
            count: domain.count as u32,
            start: domain.start as u32,
            block: domain.block,
            side,
            rank,
            rule: self.tables.rule,
            lattice: self.tables.lattice,
        };
        let base = self.base;
        let streams = [
            ("base_triangles", &base.base_triangles),
            ("base_edges", &base.base_edges),
            ("contributions", &base.contributions),
            ("triangle_order", &base.triangle_order),
            ("seam_corners", &base.seam_corners),
            ("seams", &base.seams),
            ("seam_sides", &base.seam_sides),
            ("triangle_correction", &base.triangle_correction),
            ("corrections", &base.corrections),
            ("places", &self.chunk.listed.places),
            ("samples", &self.chunk.samples),
        ];
        Ok(recorder.dispatch(&SHADERS.samples, domain.count, &params, &streams)?)
    }

    /// What a smooth base is like at the samples.
    fn fields(&self, recorder: &mut Recorder<'_>, count: u64) -> Result<()> {
        if self.tables.patches.is_none() {
            return Ok(());
        }
        let base = self.base;
        let streams = [
            ("av_position_u", &base.av_position_u),
            ("av_direction_v", &base.av_direction_v),
            ("av_normal", &base.av_normal),
            ("av_tangent", &base.av_tangent),
            ("base_edges", &base.base_edges),
            ("base_triangles", &base.base_triangles),
            ("patch_nodes", &base.patch_nodes),
            ("patch_points", &base.patch_points),
            ("samples", &self.chunk.samples),
            ("fields", &self.chunk.fields),
        ];
        Ok(recorder.dispatch(&SHADERS.fields, count, &FieldsParams { count: count as u32 }, &streams)?)
    }

    fn layer(&self, recorder: &mut Recorder<'_>, count: u64, detail: u32, layer: u32, on_top: bool) -> Result<()> {
        let (base, accumulate) = (self.base, u32::from(on_top));
        let mut streams = vec![
            ("av_position_u", &base.av_position_u),
            ("av_direction_v", &base.av_direction_v),
            ("av_normal", &base.av_normal),
            ("av_tangent", &base.av_tangent),
            ("base_edges", &base.base_edges),
            ("base_triangles", &base.base_triangles),
            ("samples", &self.chunk.samples),
            ("jets", &self.chunk.jets),
            ("layers", &base.layers),
        ];
        let threads = count;
        let count = count as u32;
        match self.tables.layers[layer as usize].kind {
            kind::HEIGHT => {
                streams.push(("texels", &base.texels));
                let params = JetsHeightParams { count, detail, layer, accumulate };
                let shader = self.chunk.variant(&mut streams, &SHADERS.jets_height, &SHADERS.jets_height_smooth);
                recorder.dispatch(shader, threads, &params, &streams)?;
            }
            kind::EXPRESSION => {
                streams.push(("instructions", &base.instructions));
                let params = JetsExpressionParams { count, detail, layer, accumulate };
                let shader =
                    self.chunk.variant(&mut streams, &SHADERS.jets_expression, &SHADERS.jets_expression_smooth);
                recorder.dispatch(shader, threads, &params, &streams)?;
            }
            _ => {
                streams.push(("texels", &base.texels));
                let params = JetsVectorParams { count, detail, layer, accumulate };
                let shader = self.chunk.variant(&mut streams, &SHADERS.jets_vector, &SHADERS.jets_vector_smooth);
                recorder.dispatch(shader, threads, &params, &streams)?;
            }
        }
        Ok(())
    }

    fn correction(&self, recorder: &mut Recorder<'_>, count: u64) -> Result<()> {
        let base = self.base;
        let streams = [
            ("av_position_u", &base.av_position_u),
            ("av_direction_v", &base.av_direction_v),
            ("av_normal", &base.av_normal),
            ("av_tangent", &base.av_tangent),
            ("base_edges", &base.base_edges),
            ("base_triangles", &base.base_triangles),
            ("samples", &self.chunk.samples),
            ("jets", &self.chunk.jets),
            ("av_correction", self.av_correction),
        ];
        Ok(recorder.dispatch(
            &SHADERS.jets_correction,
            count,
            &JetsCorrectionParams { count: count as u32 },
            &streams,
        )?)
    }
}

/// Details that have layers, in rising number.
#[must_use]
pub fn all_details(tables: &Tables) -> Vec<u32> {
    (1..tables.details.len() as u32).collect()
}

/// Details of the base triangles at ranks `first..=last` of the triangle order, which is sorted by detail.
#[must_use]
pub fn details_between(tables: &Tables, first: u64, last: u64) -> Vec<u32> {
    let lists = &tables.triangle_order[first as usize..=last as usize];
    let mut details: Vec<u32> = lists.iter().map(|t| tables.base_triangles[*t as usize].detail).collect();
    details.sort_unstable();
    details.dedup();
    details.retain(|detail| *detail != 0);
    details
}
