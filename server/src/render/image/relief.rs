//! Heights that are shown per pixel: the maps on the device, and the passes that find what a ray strikes.

mod cones;

use std::sync::Arc;

use displace_glsl::{
    SHADERS,
    layout::relief::{
        COURSE_NODES, ConeMapParams, Course, CourseFlatParams, CourseLightParams, CourseParams, Landing, March,
        MarchParams, Relief, ReliefLevel, RelieveParams, SelfShadowParams, TallyParams,
    },
    methods::{Marcher, Needs},
    reference::relief::{HeightLevel, exact},
};

use crate::{
    domain::request::Shadows,
    domain::{
        Error, Result,
        image::{HeightMap, ImageSet, RenderMaterial, RenderRelief, RenderScene, SelfShadow, Silhouettes},
    },
    vulkan::{Device, Recorder, Stream},
};

use super::{Frame, Slab};
use cones::Coned;

pub use cones::KeptCones;

/// Of one stream.
const MOST_WORDS: usize = 1 << 29;

/// Of all materials, in their order; empty where none has relief.
#[derive(Debug, Default)]
pub(crate) struct ReliefTables {
    pub(crate) reliefs: Vec<Relief>,
    pub(crate) levels: Vec<ReliefLevel>,
    /// Heights, and what the method needs beside them.
    texels: Vec<f32>,
    cones: Vec<ConeMapParams>,
    coned: Vec<Coned>,
}

impl ReliefTables {
    pub(crate) fn new(scene: &RenderScene) -> Result<Self> {
        let mut tables = Self::default();
        let Some(marcher) = scene.marcher() else { return Ok(tables) };
        let mut known: Vec<(&Arc<HeightMap>, Relief)> = Vec::new();
        for RenderMaterial { relief, .. } in &scene.materials {
            let Some(relief) = relief else {
                tables.reliefs.push(Relief::default());
                continue;
            };
            let map = match known.iter().find(|(map, _)| Arc::ptr_eq(map, &relief.map)) {
                Some((_, map)) => *map,
                None => tables.add(&relief.map, marcher.needs)?,
            };
            known.push((&relief.map, map));
            tables.reliefs.push(of_material(map, relief));
        }
        Ok(tables)
    }

    /// All levels of a map, the finest first.
    fn add(&mut self, map: &Arc<HeightMap>, needs: Needs) -> Result<Relief> {
        let size = [map.width, map.height];
        if map.heights.len() as u64 != u64::from(size[0]) * u64::from(size[1]) || map.heights.is_empty() {
            return Err(Error::internal("a height map has not as many heights as texels"));
        }
        let [low, high] = map.range();
        let (level_first, cone_first) = (self.levels.len() as u32, self.cones.len());
        let finest = HeightLevel { size, heights: map.heights.clone(), repeats: map.repeats };
        for level in finest.chain() {
            self.add_level(&level, needs);
        }
        if needs == Needs::Cones {
            self.coned.push(Coned::new(map, cone_first..self.cones.len()));
        }
        if self.texels.len() > MOST_WORDS {
            let message = format!("the height maps have more than {MOST_WORDS} values: scale them down");
            return Err(Error::too_large("details", message));
        }
        let level_count = self.levels.len() as u32 - level_first;
        let thinnest_texels = map.thinnest_texels;
        Ok(Relief {
            wrap: wrap(map.repeats),
            level_first,
            level_count,
            low,
            high,
            thinnest_texels,
            ..Relief::default()
        })
    }

    fn add_level(&mut self, of: &HeightLevel, needs: Needs) {
        let mut level = ReliefLevel { size: of.size, height_first: self.texels.len() as u32, ..ReliefLevel::default() };
        self.texels.extend_from_slice(&of.heights);
        match needs {
            Needs::Heights => {}
            Needs::Bounds => {
                level.bound_first = self.texels.len() as u32;
                self.texels.extend(exact::bounds(of));
            }
            Needs::Cones => {
                level.cone_first = self.texels.len() as u32;
                self.texels.resize(self.texels.len() + of.heights.len(), 0.0);
                let (count, high) = (of.heights.len() as u32, of.heights.iter().copied().fold(f32::MIN, f32::max));
                self.cones.push(ConeMapParams { count, wrap: wrap(of.repeats), high, level });
            }
        }
        self.levels.push(level);
    }
}

fn of_material(map: Relief, relief: &RenderRelief) -> Relief {
    let [map_u, map_v] = relief.map_from_uv;
    Relief { map_u, map_v, uv_channel: relief.uv_channel, steps: relief.steps, ..map }
}

/// As `tiled.glsl` has it.
fn wrap(repeats: [bool; 2]) -> u32 {
    let [u, v] = repeats.map(|repeats| u32::from(!repeats) * 2);
    u | v << 2
}

/// The maps, for all of a render.
pub(crate) struct ReliefStreams {
    pub(crate) reliefs: Stream,
    levels: Stream,
    texels: Stream,
}

impl ReliefStreams {
    pub(crate) fn upload(device: &Arc<Device>, tables: &ReliefTables) -> Result<Self> {
        Ok(Self {
            reliefs: Stream::from_slice(device, "reliefs", &tables.reliefs)?,
            levels: Stream::from_slice(device, "relief levels", &tables.levels)?,
            texels: Stream::of_texels(device, &tables.texels)?,
        })
    }

    /// Makes what methods need of maps and is not known.
    pub(crate) fn record_maps(&self, recorder: &mut Recorder<'_>, tables: &ReliefTables) -> Result<()> {
        for params in tables.cones.iter().filter(|params| params.count > 0) {
            recorder.dispatch(&SHADERS.cone_map, u64::from(params.count), params, &[("texels", &self.texels)])?;
        }
        Ok(())
    }
}

/// Of the fragments of a slab; empty where no material has relief.
pub(crate) struct MarchStreams {
    courses: Stream,
    nodes: Stream,
    marches: Stream,
    landings: Stream,
    /// Of pixels: fetches, steps, marches that their bound ended, marches.
    costs: Stream,
}

impl MarchStreams {
    pub(crate) fn new(device: &Arc<Device>, tables: &ReliefTables, fragments: u64, pixels: u64) -> Result<Self> {
        let [len, pixels] = if tables.reliefs.is_empty() { [0; 2] } else { [fragments, pixels] };
        Ok(Self {
            courses: Stream::new(device, "courses", size_of::<Course>() as u32, len)?,
            nodes: Stream::new(device, "course nodes", 16, len * COURSE_NODES as u64)?,
            marches: Stream::new(device, "marches", size_of::<March>() as u32, len)?,
            landings: Stream::new(device, "landings", size_of::<Landing>() as u32, len)?,
            costs: Stream::new(device, "costs", 16, pixels)?,
        })
    }
}

/// What fragments are that are moved to what is struck under them.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Stage {
    /// Samples whose depth decides what is seen; told again for the second half of keys.
    Tests { again: bool },
    /// What is seen; again for further outputs.
    Shows { again: bool },
}

impl Stage {
    /// Whether the same was marched before.
    fn is_again(self) -> bool {
        matches!(self, Self::Tests { again: true } | Self::Shows { again: true })
    }

    fn tests(self) -> bool {
        matches!(self, Self::Tests { .. })
    }
}

/// Moves the first `count` points to what is struck under them; nothing where no material has relief.
pub(crate) fn record(
    recorder: &mut Recorder<'_>,
    frame: &Frame<'_>,
    slab: Slab,
    count: u64,
    stage: Stage,
) -> Result<()> {
    let Some(marcher) = frame.scene.marcher().filter(|_| count > 0) else { return Ok(()) };
    record_levels(recorder, frame, count)?;
    record_courses(recorder, frame, count)?;
    record_marches(recorder, frame, marcher, count)?;
    // What finds no depth tests none.
    let is_asked = marcher.finds_depth || !stage.tests();
    if is_asked && !stage.is_again() {
        record_costs(recorder, frame, slab, count)?;
    }
    record_struck(recorder, frame, marcher, count, stage)
}

/// Before the first march of a slab.
pub(crate) fn clear_costs(recorder: &mut Recorder<'_>, frame: &Frame<'_>) -> Result<()> {
    if frame.work.march.costs.is_empty() {
        return Ok(());
    }
    Ok(recorder.fill(&frame.work.march.costs, 0)?)
}

fn record_costs(recorder: &mut Recorder<'_>, frame: &Frame<'_>, slab: Slab, count: u64) -> Result<()> {
    let work = frame.work;
    let (slab_px, slab_size_px) = slab.px();
    let params = TallyParams { count: count as u32, slab_px, slab_size_px };
    let bound = [
        ("points", &work.points),
        ("courses", &work.march.courses),
        ("marches", &work.march.marches),
        ("costs", &work.march.costs),
    ];
    Ok(recorder.dispatch(&SHADERS.tally, count, &params, &bound)?)
}

/// Adds what a slab's marches took to the images; of each square of `side` pixels all.
pub(crate) fn copy_costs(frame: &Frame<'_>, slab: Slab, images: &mut ImageSet) -> Result<()> {
    if frame.work.march.costs.is_empty() {
        return Ok(());
    }
    let costs: Vec<[u32; 4]> = frame.work.march.costs.read_range(0..slab.pixels())?;
    let counters = images.counters.get_or_insert_default();
    for [fetches, steps, cap_hits, rays] in costs.iter().map(|cost| cost.map(u64::from)) {
        counters.fetches += fetches;
        counters.steps += steps;
        counters.cap_hits += cap_hits;
        counters.rays += rays;
    }
    let (side, width) = (frame.side as usize, images.width as usize);
    let Some(image) = &mut images.cost else { return Ok(()) };
    for (i, cost) in costs.iter().enumerate() {
        let [x, y] = [i % slab.size[0] as usize, i / slab.size[0] as usize];
        let [left, top] = slab.origin.map(|o| o as usize);
        let pixel = &mut image[(top + y) / side * width + (left + x) / side];
        (0..3).for_each(|k| pixel[k] += cost[k] as f32);
    }
    Ok(())
}

/// Normals of what was struck, where maps are seen larger than they are; once those of slopes are known.
pub(crate) fn record_normals(recorder: &mut Recorder<'_>, frame: &Frame<'_>, count: u64) -> Result<()> {
    let Frame { scene, streams, work, .. } = frame;
    if !scene.marcher().is_some_and(|marcher| marcher.finds_depth) || !scene.is_bumped() {
        return Ok(());
    }
    let params = CourseParams { count: count as u32, uv_channels: scene.uv_channels };
    let bound = [
        ("points", &work.points),
        ("uvs", &streams.uvs),
        ("reliefs", &streams.relief.reliefs),
        ("relief_levels", &streams.relief.levels),
        ("courses", &work.march.courses),
        ("landings", &work.march.landings),
        ("bumps", &streams.bump.bumps),
        ("appearances", &work.appearances),
        ("positions", &streams.positions),
        ("instance_rows", &streams.instance_rows),
        ("texels", &streams.relief.texels),
    ];
    Ok(recorder.dispatch(&SHADERS.relief_normals, count, &params, &bound)?)
}

/// Takes from what arrives of each light what relief keeps off.
pub(crate) fn record_self_shadow(recorder: &mut Recorder<'_>, frame: &Frame<'_>, count: u64) -> Result<()> {
    let Frame { scene, tables, work, .. } = frame;
    let Some(marcher) = scene.marcher().filter(|_| scene.relief.self_shadow != SelfShadow::None) else {
        return Ok(());
    };
    if scene.shadows == Shadows::None {
        recorder.fill(&work.shadows, 1f32.to_bits())?;
    }
    let soft = scene.relief.self_shadow == SelfShadow::Soft;
    for light in 0..tables.lights.len() as u32 {
        record_ways_to_light(recorder, frame, light, count)?;
        if soft {
            record_marches(recorder, frame, &Marcher { shader: &SHADERS.soft_shadow, ..*marcher }, count)?;
        } else {
            record_marches(recorder, frame, marcher, count)?;
        }
        let lights = tables.lights.len() as u32;
        let params = SelfShadowParams { count: count as u32, lights, light, soft: u32::from(soft) };
        let bound = [("courses", &work.march.courses), ("marches", &work.march.marches), ("shadows", &work.shadows)];
        recorder.dispatch(&SHADERS.self_shadow, count, &params, &bound)?;
    }
    Ok(())
}

fn record_ways_to_light(recorder: &mut Recorder<'_>, frame: &Frame<'_>, light: u32, count: u64) -> Result<()> {
    let Frame { scene, streams, work, .. } = frame;
    let params = CourseLightParams { count: count as u32, uv_channels: scene.uv_channels, light };
    let bound = [
        ("points", &work.points),
        ("instance_rows", &streams.instance_rows),
        ("positions", &streams.positions),
        ("normals", &streams.normals),
        ("uvs", &streams.uvs),
        ("reliefs", &streams.relief.reliefs),
        ("relief_levels", &streams.relief.levels),
        ("texels", &streams.relief.texels),
        ("lights", &streams.lights),
        ("courses", &work.march.courses),
        ("course_nodes", &work.march.nodes),
        ("triangles", &streams.triangles),
        ("chart_sides", &streams.chart_sides),
    ];
    Ok(recorder.dispatch(&SHADERS.course_light, count, &params, &bound)?)
}

/// Else rays keep to charts.
fn has_outlines(scene: &RenderScene) -> u32 {
    u32::from(scene.relief.silhouettes != Silhouettes::None)
}

/// What is seen, and the heights of it.
fn seen<'a>(frame: &Frame<'a>) -> [(&'static str, &'a Stream); 7] {
    let Frame { streams, work, .. } = frame;
    [
        ("fragments", &work.fragments),
        ("points", &work.points),
        ("instance_rows", &streams.instance_rows),
        ("positions", &streams.positions),
        ("uvs", &streams.uvs),
        ("reliefs", &streams.relief.reliefs),
        ("relief_levels", &streams.relief.levels),
    ]
}

fn record_levels(recorder: &mut Recorder<'_>, frame: &Frame<'_>, count: u64) -> Result<()> {
    let params = CourseParams { count: count as u32, uv_channels: frame.scene.uv_channels };
    let bound = [&seen(frame)[..], &[("courses", &frame.work.march.courses)]].concat();
    Ok(recorder.dispatch(&SHADERS.course_level, count, &params, &bound)?)
}

fn record_courses(recorder: &mut Recorder<'_>, frame: &Frame<'_>, count: u64) -> Result<()> {
    let Frame { scene, streams, work, .. } = frame;
    let shared = [&seen(frame)[..], &[("courses", &work.march.courses), ("course_nodes", &work.march.nodes)]].concat();
    let own = &streams.silhouettes;
    let directions = ("directions", &own.directions);
    let (shader, more) = match scene.relief.silhouettes {
        Silhouettes::None => return record_flat_courses(recorder, frame, count, &shared),
        Silhouettes::Shell => (&SHADERS.course_shell, vec![directions]),
        Silhouettes::Quadric => {
            (&SHADERS.course_quadric, vec![directions, ("bends", &own.bends), ("raises", &own.raises)])
        }
    };
    let params = CourseParams { count: count as u32, uv_channels: scene.uv_channels };
    Ok(recorder.dispatch(shader, count, &params, &[&shared[..], &more].concat())?)
}

fn record_flat_courses(
    recorder: &mut Recorder<'_>,
    frame: &Frame<'_>,
    count: u64,
    shared: &[(&'static str, &Stream)],
) -> Result<()> {
    let Frame { scene, streams, .. } = frame;
    let finds_depth = u32::from(scene.marcher().is_some_and(|marcher| marcher.finds_depth));
    let params = CourseFlatParams { count: count as u32, uv_channels: scene.uv_channels, finds_depth };
    let more =
        [("normals", &streams.normals), ("triangles", &streams.triangles), ("chart_sides", &streams.chart_sides)];
    Ok(recorder.dispatch(&SHADERS.course_flat, count, &params, &[shared, &more].concat())?)
}

fn record_marches(recorder: &mut Recorder<'_>, frame: &Frame<'_>, marcher: &Marcher, count: u64) -> Result<()> {
    let Frame { streams, work, .. } = frame;
    let params = MarchParams { count: count as u32, setting: marcher.setting };
    let bound = [
        ("reliefs", &streams.relief.reliefs),
        ("relief_levels", &streams.relief.levels),
        ("texels", &streams.relief.texels),
        ("courses", &work.march.courses),
        ("course_nodes", &work.march.nodes),
        ("marches", &work.march.marches),
    ];
    Ok(recorder.dispatch(marcher.shader, count, &params, &bound)?)
}

fn record_struck(
    recorder: &mut Recorder<'_>,
    frame: &Frame<'_>,
    marcher: &Marcher,
    count: u64,
    stage: Stage,
) -> Result<()> {
    let Frame { scene, streams, work, .. } = frame;
    let params = RelieveParams {
        count: count as u32,
        uv_channels: scene.uv_channels,
        finds_depth: u32::from(marcher.finds_depth),
        has_outlines: has_outlines(scene),
        tests: u32::from(stage.tests()),
        // What lights see has no steps.
        lifts: u32::from(scene.shadows == Shadows::Map),
    };
    let more =
        [("texels", &streams.relief.texels), ("courses", &work.march.courses), ("landings", &work.march.landings)];
    let shared = [&seen(frame)[..], &more].concat();
    let landing = [
        ("course_nodes", &work.march.nodes),
        ("marches", &work.march.marches),
        ("triangles", &streams.triangles),
        ("chart_sides", &streams.chart_sides),
    ];
    recorder.dispatch(&SHADERS.land, count, &params, &[&shared[..], &landing].concat())?;
    let bound = [&shared[..], &[("normals", &streams.normals)]].concat();
    Ok(recorder.dispatch(&SHADERS.relieve, count, &params, &bound)?)
}
