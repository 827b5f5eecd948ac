//! The bound of listed triangles on the device.

use std::sync::Arc;

use displace_glsl::{
    SHADERS,
    layout::bound::{BoundFieldsParams, BoundLineCountsParams, BoundLinesParams, BoundRampsParams, Line},
    reference::{bound::Asked, place::Places},
};

use super::{
    maps::{Maps, OnMap},
    tables::BoundTables,
};
use crate::{
    domain::Result,
    render::{
        JobContext,
        lists::{expand, scan::Scan},
    },
    vulkan::{Device, Recorder, Stream},
};

const WORD: u32 = 4;
const PAIR: u32 = 8;
const MAT3: u32 = 36;

/// The tables of one mesh on a device.
pub struct Bounds {
    device: Arc<Device>,
    vertices: Stream,
    triangles: Stream,
    ramps: Stream,
    ramp_parts: Stream,
    maps: Maps,
}

/// Triangles or lines, and what is found of them.
#[derive(Clone, Copy)]
pub(super) struct Regions<'r> {
    pub(super) facets: &'r Stream,
    pub(super) lines: &'r Stream,
    /// The base triangles that facets lie in.
    pub(super) triangles: &'r Stream,
    pub(super) of_lines: bool,
    pub(super) count: u64,
    /// Local units.
    pub(super) cap: f32,
    bounds: &'r Stream,
    /// Of lines.
    displaced: &'r Stream,
}

impl Bounds {
    /// `places` are those of tables that [`super::tables::supports`] says yes to.
    pub fn new(job: &JobContext<'_>, device: &Arc<Device>, places: &Places<'_>, asked: Asked) -> Result<Self> {
        let tables = BoundTables::new(places);
        Ok(Self {
            device: Arc::clone(device),
            vertices: Stream::from_slice(device, "bound_vertices", &tables.vertices)?,
            triangles: Stream::from_slice(device, "bound_triangles", &tables.triangles)?,
            ramps: Stream::from_slice(device, "ramps", &tables.ramps)?,
            ramp_parts: Stream::from_slice(device, "ramp_parts", &tables.ramp_parts)?,
            maps: Maps::new(job, device, places, &tables, asked)?,
        })
    }

    /// Records the bounds of the first `count` of `facets`, local units; of those above `cap` anything above it. At seams
    /// and where triangles may be large what was recorded has to run first: what follows goes into the recorder that comes
    /// back.
    pub fn record<'r>(
        &self,
        job: &'r JobContext<'_>,
        mut recorder: Recorder<'r>,
        facets: &Stream,
        count: u64,
        cap: f32,
    ) -> Result<(Recorder<'r>, Stream)> {
        let device = &self.device;
        let bounds = Stream::new(device, "bounds", WORD, count)?;
        let nothing = Stream::new(device, "no lines", size_of::<Line>() as u32, 0)?;
        let displaced = Stream::new(device, "displaced", MAT3, 0)?;
        let regions = Regions {
            facets,
            lines: &nothing,
            triangles: &self.triangles,
            of_lines: false,
            count,
            cap,
            bounds: &bounds,
            displaced: &displaced,
        };
        recorder = self.record_regions(job, recorder, &regions)?;
        if !self.ramps.is_empty() {
            recorder = self.record_ramps(job, recorder, &regions)?;
        }
        Ok((recorder, bounds))
    }

    fn record_regions<'r>(
        &self,
        job: &'r JobContext<'_>,
        mut recorder: Recorder<'r>,
        regions: &Regions<'_>,
    ) -> Result<Recorder<'r>> {
        let on = OnMap::new(&self.device, regions.count)?;
        for layer in 0..self.maps.layers().max(1) {
            recorder = self.maps.record(job, recorder, regions, layer, &on)?;
            self.record_field(&mut recorder, regions, layer, &on.bounds)?;
        }
        Ok(recorder)
    }

    fn record_field(
        &self,
        recorder: &mut Recorder<'_>,
        regions: &Regions<'_>,
        layer: u32,
        map_bounds: &Stream,
    ) -> Result<()> {
        let (count, of_lines) = (regions.count as u32, u32::from(regions.of_lines));
        let params = BoundFieldsParams { count, of_lines, accumulate: u32::from(layer > 0) };
        let streams = [
            ("facets", regions.facets),
            ("lines", regions.lines),
            ("bound_triangles", &self.triangles),
            ("bound_vertices", &self.vertices),
            ("map_bounds", map_bounds),
            ("bounds", regions.bounds),
            ("displaced", regions.displaced),
        ];
        recorder.dispatch(&SHADERS.bound_fields, regions.count, &params, &streams)?;
        Ok(())
    }

    /// Adds what ramps come to to the bounds of triangles.
    fn record_ramps<'r>(
        &self,
        job: &'r JobContext<'_>,
        mut recorder: Recorder<'r>,
        of: &Regions<'_>,
    ) -> Result<Recorder<'r>> {
        let (device, count) = (&self.device, of.count);
        let line_counts = Stream::new(device, "line_counts", WORD, count)?;
        let line_offsets = Stream::new(device, "line_offsets", WORD, count)?;
        let scan = Scan::new(device, count)?;
        let params = BoundLineCountsParams { count: count as u32, cap: of.cap };
        let streams = [
            ("facets", of.facets),
            ("bound_triangles", &self.triangles),
            ("ramps", &self.ramps),
            ("bounds", of.bounds),
            ("line_counts", &line_counts),
        ];
        recorder.dispatch(&SHADERS.bound_line_counts, count, &params, &streams)?;
        scan.record(&mut recorder, &line_counts, &line_offsets, count)?;
        recorder.finish()?;
        let mut recorder = device.recorder(job.cancel, job.progress);
        let total = scan.total()?;
        if total == 0 {
            return Ok(recorder);
        }
        let lines = self.record_lines(&mut recorder, of, &line_offsets, total)?;
        let bounds = Stream::new(device, "line_bounds", WORD, total)?;
        let displaced = Stream::new(device, "displaced", MAT3, total)?;
        // What lines come to has no cap: they are short.
        let regions =
            Regions { lines: &lines, of_lines: true, count: total, bounds: &bounds, displaced: &displaced, ..*of };
        recorder = self.record_regions(job, recorder, &regions)?;
        let streams = [
            ("facets", of.facets),
            ("bound_triangles", &self.triangles),
            ("ramps", &self.ramps),
            ("ramp_parts", &self.ramp_parts),
            ("line_counts", &line_counts),
            ("line_offsets", &line_offsets),
            ("line_bounds", &bounds),
            ("displaced", &displaced),
            ("bounds", of.bounds),
        ];
        recorder.dispatch(&SHADERS.bound_ramps, count, &BoundRampsParams { count: count as u32 }, &streams)?;
        Ok(recorder)
    }

    fn record_lines(
        &self,
        recorder: &mut Recorder<'_>,
        of: &Regions<'_>,
        line_offsets: &Stream,
        total: u64,
    ) -> Result<Stream> {
        let places = Stream::new(&self.device, "places", PAIR, total)?;
        let lines = Stream::new(&self.device, "lines", size_of::<Line>() as u32, total)?;
        expand::record(recorder, line_offsets, &places, of.count, total)?;
        let streams = [
            ("facets", of.facets),
            ("bound_triangles", &self.triangles),
            ("ramps", &self.ramps),
            ("ramp_parts", &self.ramp_parts),
            ("places", &places),
            ("next_lines", &lines),
        ];
        recorder.dispatch(&SHADERS.bound_lines, total, &BoundLinesParams { count: total as u32 }, &streams)?;
        Ok(lines)
    }
}
