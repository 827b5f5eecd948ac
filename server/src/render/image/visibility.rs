//! Fills the visibility buffer of a slab: transform, setup, and a path for each size of triangle.

use std::ops::Range;

use displace_glsl::{
    ComputeShader, SHADERS,
    layout::raster::{
        ClipParams, LARGE, LARGE_MASKED, LISTS, MAP_BASE_COLOR, MAX_PIECES, MEDIUM, MaskedParams, RasterParams, SMALL,
        SMALL_MASKED, SetupParams, TileCountsParams, TilesParams, TransformParams,
    },
};

use crate::{domain::Result, vulkan::Stream};

use super::{
    Frame, Run, Slab,
    layers::Layer,
    relief::{self, Stage},
    shading,
    streams::{LARGE_CHUNK, PAIR_CHUNK, RANGE_TRIANGLES, SceneStreams, WorkStreams},
    tables::Batch,
};

const GROUP_THREADS: u64 = 64;

/// What every step here works on.
struct Job<'a, 'r> {
    run: &'a mut Run<'r>,
    frame: &'a Frame<'a>,
    slab: Slab,
    target: Target<'a>,
    keys: Keys,
}

/// How keys are written.
#[derive(Clone, Copy, PartialEq)]
enum Keys {
    Whole,
    /// By halves, where atomics have 32 bits: depths of all triangles, then ids of those that are as near.
    Depths,
    Ids,
}

impl Keys {
    /// What a device takes to write them.
    fn all(run: &Run<'_>) -> &'static [Self] {
        if run.device.has_int64_atomics() { &[Self::Whole] } else { &[Self::Depths, Self::Ids] }
    }

    /// As in `visibility.glsl`.
    fn stage(self) -> u32 {
        u32::from(self == Self::Ids)
    }

    fn of(self, whole: &'static ComputeShader, words: &'static ComputeShader) -> &'static ComputeShader {
        if self == Self::Whole { whole } else { words }
    }
}

/// What becomes of covered samples.
#[derive(Clone, Copy)]
enum Target<'a> {
    /// The nearest of what is not blended is seen.
    Solid,
    /// What is blended goes to a layer of its own.
    Layer(Layer<'a>),
    /// All are counted, of what is blended or of what is not.
    Count { blended: bool },
}

/// The nearest triangle of each sample, of all that are not blended.
pub(crate) fn fill(run: &mut Run<'_>, frame: &Frame<'_>, slab: Slab, first_slab: bool) -> Result<()> {
    run.record(|recorder| {
        relief::clear_costs(recorder, frame)?;
        Ok(recorder.fill(&frame.work.visibility, 0)?)
    })?;
    for &keys in Keys::all(run) {
        let mut job = Job { run, frame, slab, target: Target::Solid, keys };
        for batch in &frame.tables.batches {
            // A single batch stays on the screen for all slabs.
            if (first_slab && keys != Keys::Ids) || frame.tables.batches.len() > 1 {
                job.transform(batch)?;
            }
            job.draw_range(batch, &batch.triangles)?;
        }
    }
    Ok(())
}

/// The nearest blended triangle of each sample that lies behind those of the layer before and before what is solid.
pub(crate) fn peel<'a>(run: &mut Run<'_>, frame: &'a Frame<'a>, slab: Slab, layer: Layer<'a>) -> Result<()> {
    run.record(|recorder| Ok(recorder.fill(layer.keys, 0)?))?;
    for &keys in Keys::all(run) {
        let mut job = Job { run, frame, slab, target: Target::Layer(layer), keys };
        for batch in frame.tables.batches.iter().filter(|batch| !batch.blended.is_empty()) {
            if frame.tables.batches.len() > 1 {
                job.transform(batch)?;
            }
            job.draw_range(batch, &batch.blended)?;
        }
    }
    Ok(())
}

/// How often each pixel's samples are covered, whatever is before them. After `fill`.
pub(crate) fn count(run: &mut Run<'_>, frame: &Frame<'_>, slab: Slab) -> Result<()> {
    run.record(|recorder| Ok(recorder.fill(&frame.work.outputs.overdraw, 0)?))?;
    let mut job = Job { run, frame, slab, target: Target::Count { blended: false }, keys: Keys::Whole };
    for batch in &frame.tables.batches {
        if frame.tables.batches.len() > 1 {
            job.transform(batch)?;
        }
        job.target = Target::Count { blended: false };
        job.draw_range(batch, &batch.triangles)?;
        job.target = Target::Count { blended: true };
        job.draw_range(batch, &batch.blended)?;
    }
    Ok(())
}

impl<'a> Job<'a, '_> {
    fn transform(&mut self, batch: &Batch) -> Result<()> {
        let Frame { plan, streams, work, .. } = self.frame;
        self.run.record(|recorder| {
            for on_screen in &batch.instances {
                let params = TransformParams {
                    count: on_screen.vertices as u32,
                    instance: on_screen.instance,
                    vertex_first: on_screen.vertex_first,
                    screen_first: on_screen.screen_first,
                    size_px: [plan.width as f32, plan.height as f32],
                };
                let bound = [
                    ("positions", &streams.positions),
                    ("instance_rows", &streams.instance_rows),
                    ("screen", &work.screen),
                ];
                recorder.dispatch(&SHADERS.transform, on_screen.vertices, &params, &bound)?;
            }
            Ok(())
        })
    }

    fn draw_range(&mut self, batch: &Batch, triangles: &Range<u64>) -> Result<()> {
        let mut first = triangles.start;
        while first < triangles.end {
            let end = (first + RANGE_TRIANGLES).min(triangles.end);
            self.draw(batch, first, end - first)?;
            first = end;
        }
        Ok(())
    }

    /// Draws `count` triangles from `first` on, numbered over all instances.
    fn draw(&mut self, batch: &Batch, first: u64, count: u64) -> Result<()> {
        let lengths = self.setup(batch, first, count)?;
        let list = |index: usize| (index as u64 * self.frame.work.list_capacity, lengths[index]);
        let lists: [(u64, u64); LISTS] = std::array::from_fn(list);
        self.draw_whole(batch, lists[SMALL], lists[MEDIUM])?;
        if matches!(self.target, Target::Count { .. }) {
            // Whatever their alpha.
            self.draw_whole(batch, lists[SMALL_MASKED], (0, 0))?;
            self.draw_large(batch, lists[LARGE], false)?;
            return self.draw_large(batch, lists[LARGE_MASKED], false);
        }
        self.draw_small_masked(batch, lists[SMALL_MASKED])?;
        self.draw_large(batch, lists[LARGE], false)?;
        self.draw_large(batch, lists[LARGE_MASKED], true)
    }

    /// Sorts the triangles by size; says how many fell into each list.
    fn setup(&mut self, batch: &Batch, first: u64, count: u64) -> Result<Vec<u64>> {
        let Frame { streams, work, .. } = self.frame;
        let (slab_px, slab_size_px) = self.slab.px();
        let params = SetupParams {
            count: count as u32,
            first_triangle: first as u32,
            part_first: batch.parts.start as u32,
            part_last: batch.parts.end as u32 - 1,
            slab_px,
            slab_size_px,
            capacity: work.list_capacity as u32,
            blended: u32::from(matches!(self.target, Target::Layer(_) | Target::Count { blended: true })),
        };
        self.run.record(|recorder| {
            recorder.fill(&work.counters, 0)?;
            let bound = [
                ("triangles", &streams.triangles),
                ("parts", &streams.parts),
                ("screen", &work.screen),
                ("counters", &work.counters),
                ("lists", &work.lists),
            ];
            Ok(recorder.dispatch(&SHADERS.setup, count, &params, &bound)?)
        })?;
        let lengths: Vec<u32> = work.counters.read()?;
        Ok(lengths.into_iter().map(|length| u64::from(length).min(work.list_capacity)).collect())
    }

    /// Where covered samples go, and what they must pass on their way.
    fn targets(&self) -> Vec<(&'static str, &'a Stream)> {
        let solid = &self.frame.work.visibility;
        match self.target {
            Target::Solid => vec![("visibility", solid)],
            Target::Count { .. } => vec![("overdraw", &self.frame.work.outputs.overdraw)],
            Target::Layer(Layer { keys, nearer }) => vec![("visibility", keys), ("solid", solid), ("nearer", nearer)],
        }
    }

    fn raster_params(&self, batch: &Batch, first: u64, count: u64) -> RasterParams {
        let (slab_px, slab_size_px) = self.slab.px();
        RasterParams {
            count: count as u32,
            list_first: first as u32,
            part_first: batch.parts.start as u32,
            part_last: batch.parts.end as u32 - 1,
            slab_px,
            slab_size_px,
            stage: self.keys.stage(),
            all_depths: u32::from(self.frame.scene.marcher().is_some_and(|marcher| marcher.finds_depth)),
        }
    }

    /// Small and medium triangles without an alpha cut-off.
    fn draw_whole(&mut self, batch: &Batch, small: (u64, u64), medium: (u64, u64)) -> Result<()> {
        let small_params = self.raster_params(batch, small.0, small.1);
        let medium_params = self.raster_params(batch, medium.0, medium.1);
        let (streams, work) = (self.frame.streams, self.frame.work);
        let bound = [&self.targets()[..], &triangle_bindings(streams, work)].concat();
        let [small_shader, medium_shader] = match self.target {
            Target::Solid => [
                self.keys.of(&SHADERS.raster_small, &SHADERS.raster_small_words),
                self.keys.of(&SHADERS.raster_medium, &SHADERS.raster_medium_words),
            ],
            Target::Count { .. } => [&SHADERS.raster_small_counted, &SHADERS.raster_medium_counted],
            Target::Layer(_) => [
                self.keys.of(&SHADERS.raster_small_peeled, &SHADERS.raster_small_peeled_words),
                self.keys.of(&SHADERS.raster_medium_peeled, &SHADERS.raster_medium_peeled_words),
            ],
        };
        self.run.record(|recorder| {
            if small.1 > 0 {
                recorder.dispatch(small_shader, small.1, &small_params, &bound)?;
            }
            if medium.1 > 0 {
                recorder.dispatch(medium_shader, medium.1 * GROUP_THREADS, &medium_params, &bound)?;
            }
            Ok(())
        })
    }

    /// Small triangles with an alpha cut-off, so many at a time that their samples fit.
    fn draw_small_masked(&mut self, batch: &Batch, (list_first, length): (u64, u64)) -> Result<()> {
        let Frame { streams, work, .. } = self.frame;
        let mut done = 0;
        while done < length {
            let count = (length - done).min(work.masked_small_chunk);
            let params = self.raster_params(batch, list_first + done, count);
            let bound = [&self.targets()[..], &triangle_bindings(streams, work), &fragment_bindings(work)].concat();
            let shader = self.keys.of(&SHADERS.raster_small_masked, &SHADERS.raster_small_masked_words);
            self.run.record(|recorder| {
                recorder.fill(&work.fragment_count, 0)?;
                Ok(recorder.dispatch(shader, count, &params, &bound)?)
            })?;
            self.test_fragments()?;
            done += count;
        }
        Ok(())
    }

    /// Large triangles: records, then tiles.
    fn draw_large(&mut self, batch: &Batch, (list_first, length): (u64, u64), masked: bool) -> Result<()> {
        let mut done = 0;
        while done < length {
            let count = (length - done).min(LARGE_CHUNK);
            let pairs = self.make_records(batch, list_first + done, count)?;
            let chunk = if masked { self.frame.work.masked_pair_chunk.min(PAIR_CHUNK) } else { PAIR_CHUNK };
            let mut first = 0;
            while first < pairs {
                let taken = (pairs - first).min(chunk);
                self.draw_pairs(batch, first, taken, count * u64::from(MAX_PIECES), masked)?;
                first += taken;
            }
            done += count;
        }
        Ok(())
    }

    /// Clips triangles of a list into records and counts the tiles they meet.
    fn make_records(&mut self, batch: &Batch, list_first: u64, count: u64) -> Result<u64> {
        let Frame { streams, work, .. } = self.frame;
        let records = count * u64::from(MAX_PIECES);
        let (slab_px, slab_size_px) = self.slab.px();
        let clip = ClipParams {
            count: count as u32,
            list_first: list_first as u32,
            part_first: batch.parts.start as u32,
            part_last: batch.parts.end as u32 - 1,
        };
        let counts = TileCountsParams { count: records as u32, slab_px, slab_size_px };
        self.run.record(|recorder| {
            let bound = [
                ("triangles", &streams.triangles),
                ("parts", &streams.parts),
                ("screen", &work.screen),
                ("lists", &work.lists),
                ("positions", &streams.positions),
                ("instance_rows", &streams.instance_rows),
                ("records", &work.records),
            ];
            recorder.dispatch(&SHADERS.clip, count, &clip, &bound)?;
            let bound = [("records", &work.records), ("counts", &work.tile_counts)];
            recorder.dispatch(&SHADERS.tile_counts, records, &counts, &bound)?;
            work.scan.record(recorder, &work.tile_counts, &work.tile_offsets, records)
        })?;
        work.scan.total()
    }

    fn draw_pairs(&mut self, batch: &Batch, first: u64, count: u64, records: u64, masked: bool) -> Result<()> {
        let work = self.frame.work;
        let (slab_px, slab_size_px) = self.slab.px();
        let tiles = TilesParams {
            count: count as u32,
            pair_first: first as u32,
            record_count: records as u32,
            slab_px,
            slab_size_px,
        };
        let params = self.raster_params(batch, 0, count);
        let shader = match self.target {
            _ if masked => self.keys.of(&SHADERS.raster_large_masked, &SHADERS.raster_large_masked_words),
            Target::Solid => self.keys.of(&SHADERS.raster_large, &SHADERS.raster_large_words),
            Target::Count { .. } => &SHADERS.raster_large_counted,
            Target::Layer(_) => self.keys.of(&SHADERS.raster_large_peeled, &SHADERS.raster_large_peeled_words),
        };
        let mut targets = self.targets();
        self.run.record(|recorder| {
            let bound = [("records", &work.records), ("offsets", &work.tile_offsets), ("pairs", &work.pairs)];
            recorder.dispatch(&SHADERS.tiles, count, &tiles, &bound)?;
            targets.extend([("records", &work.records), ("pairs", &work.pairs)]);
            if masked {
                recorder.fill(&work.fragment_count, 0)?;
                targets.extend(fragment_bindings(work));
            }
            Ok(recorder.dispatch(shader, count * GROUP_THREADS, &params, &targets)?)
        })?;
        if masked { self.test_fragments() } else { Ok(()) }
    }

    /// The alpha test of the fragments that a masked pass has left.
    fn test_fragments(&mut self) -> Result<()> {
        let Frame { streams, work, .. } = self.frame;
        let count = fragment_count(work)?;
        let (slab_px, slab_size_px) = self.slab.px();
        let map = &work.mapped[MAP_BASE_COLOR];
        let params = MaskedParams {
            count: count as u32,
            slab_px,
            slab_size_px,
            has_colors: u32::from(self.frame.tables.colored),
            has_map: u32::from(!map.is_empty()),
            stage: self.keys.stage(),
        };
        let shader = self.keys.of(&SHADERS.masked, &SHADERS.masked_words);
        let (frame, slab, again) = (self.frame, self.slab, self.keys == Keys::Ids);
        self.run.record(|recorder| {
            shading::record_surface(recorder, frame, count)?;
            relief::record(recorder, frame, slab, count, Stage::Tests { again })?;
            shading::record_map(recorder, frame, MAP_BASE_COLOR, count)?;
            let bound = [
                ("visibility", &work.visibility),
                ("fragments", &work.fragments),
                ("points", &work.points),
                ("materials", &streams.materials),
                ("colors", &streams.colors),
                ("mapped_base_color", map),
            ];
            Ok(recorder.dispatch(shader, count, &params, &bound)?)
        })
    }
}

fn triangle_bindings<'a>(streams: &'a SceneStreams, work: &'a WorkStreams) -> [(&'static str, &'a Stream); 4] {
    [("triangles", &streams.triangles), ("parts", &streams.parts), ("screen", &work.screen), ("lists", &work.lists)]
}

fn fragment_bindings(work: &WorkStreams) -> [(&'static str, &Stream); 2] {
    [("fragment_count", &work.fragment_count), ("fragments", &work.fragments)]
}

/// How many fragments the last pass that makes them has made.
pub(crate) fn fragment_count(work: &WorkStreams) -> Result<u64> {
    let count: Vec<u32> = work.fragment_count.read()?;
    Ok(u64::from(count[0]).min(work.fragments.len()))
}
