//! Heights that are shown per pixel: the maps on the device, and the passes that find what a ray strikes.

use std::sync::Arc;

use displace_glsl::{
    ComputeShader, SHADERS,
    layout::relief::{
        COURSE_NODES, ConeMapParams, Course, CourseParams, March, MarchParams, Relief, ReliefLevel, RelieveParams,
    },
    methods::{Marcher, Needs},
    reference::relief::{HeightLevel, exact},
};

use crate::{
    domain::{
        Error, Result,
        image::{HeightMap, RenderMaterial, RenderRelief, RenderScene, Silhouettes},
    },
    vulkan::{Device, Recorder, Stream},
};

use super::Frame;

/// Of all materials, in their order; empty where none has relief.
#[derive(Debug, Default)]
pub(crate) struct ReliefTables {
    pub(crate) reliefs: Vec<Relief>,
    pub(crate) levels: Vec<ReliefLevel>,
    /// Heights, and what the method needs beside them.
    texels: Vec<f32>,
    cones: Vec<ConeMapParams>,
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

    fn add(&mut self, map: &HeightMap, needs: Needs) -> Result<Relief> {
        let size = [map.width, map.height];
        if map.heights.len() as u64 != u64::from(size[0]) * u64::from(size[1]) || map.heights.is_empty() {
            return Err(Error::internal("a height map has not as many heights as texels"));
        }
        let [low, high] = map.range();
        let mut level = ReliefLevel { size, height_first: self.texels.len() as u32, ..ReliefLevel::default() };
        self.texels.extend_from_slice(&map.heights);
        match needs {
            Needs::Heights => {}
            Needs::Bounds => {
                level.bound_first = self.texels.len() as u32;
                let of = HeightLevel { size, heights: map.heights.clone(), repeats: map.repeats };
                self.texels.extend(exact::bounds(&of));
            }
            Needs::Cones => {
                level.cone_first = self.texels.len() as u32;
                self.texels.resize(self.texels.len() + map.heights.len(), 0.0);
                let count = map.heights.len() as u32;
                self.cones.push(ConeMapParams { count, wrap: wrap(map), high, level });
            }
        }
        if u32::try_from(self.texels.len()).is_err() {
            return Err(Error::too_large("details", "the height maps have more than 2^32 values: scale them down"));
        }
        self.levels.push(level);
        let level_first = self.levels.len() as u32 - 1;
        let thinnest_texels = map.thinnest_texels;
        Ok(Relief { wrap: wrap(map), level_first, level_count: 1, low, high, thinnest_texels, ..Relief::default() })
    }
}

fn of_material(map: Relief, relief: &RenderRelief) -> Relief {
    let [map_u, map_v] = relief.map_from_uv;
    Relief { map_u, map_v, uv_channel: relief.uv_channel, steps: relief.steps, ..map }
}

/// As `tiled.glsl` has it.
fn wrap(map: &HeightMap) -> u32 {
    let [u, v] = map.repeats.map(|repeats| u32::from(!repeats) * 2);
    u | v << 2
}

/// The maps, for all of a render.
pub(crate) struct ReliefStreams {
    reliefs: Stream,
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

    /// Makes what methods need of maps.
    pub(crate) fn record_maps(&self, recorder: &mut Recorder<'_>, tables: &ReliefTables) -> Result<()> {
        for params in &tables.cones {
            recorder.dispatch(&SHADERS.cone_map, u64::from(params.count), params, &[("texels", &self.texels)])?;
        }
        Ok(())
    }
}

/// Of the fragments of a slab; empty where no material has relief.
pub(crate) struct MarchStreams {
    courses: Stream,
    nodes: Stream,
    pub(crate) marches: Stream,
}

impl MarchStreams {
    pub(crate) fn new(device: &Arc<Device>, tables: &ReliefTables, fragments: u64) -> Result<Self> {
        let len = if tables.reliefs.is_empty() { 0 } else { fragments };
        Ok(Self {
            courses: Stream::new(device, "courses", size_of::<Course>() as u32, len)?,
            nodes: Stream::new(device, "course nodes", 16, len * COURSE_NODES as u64)?,
            marches: Stream::new(device, "marches", size_of::<March>() as u32, len)?,
        })
    }
}

/// Moves the first `count` points to what is struck under them; nothing where no material has relief. `tests`: they are
/// samples whose depth decides what is seen.
pub(crate) fn record(recorder: &mut Recorder<'_>, frame: &Frame<'_>, count: u64, tests: bool) -> Result<()> {
    let Some(marcher) = frame.scene.marcher().filter(|_| count > 0) else { return Ok(()) };
    record_courses(recorder, frame, count)?;
    record_marches(recorder, frame, marcher, count)?;
    record_struck(recorder, frame, marcher, count, tests)
}

/// The shader that makes courses.
fn course_shader(silhouettes: Silhouettes) -> &'static ComputeShader {
    match silhouettes {
        Silhouettes::None => &SHADERS.course_flat,
        Silhouettes::Shell => &SHADERS.course_shell,
        Silhouettes::Quadric => &SHADERS.course_quadric,
    }
}

fn record_courses(recorder: &mut Recorder<'_>, frame: &Frame<'_>, count: u64) -> Result<()> {
    let Frame { scene, streams, work, .. } = frame;
    let params = CourseParams { count: count as u32, uv_channels: scene.uv_channels };
    let silhouettes = scene.relief.silhouettes;
    let mut bound = vec![
        ("fragments", &work.fragments),
        ("points", &work.points),
        ("instance_rows", &streams.instance_rows),
        ("positions", &streams.positions),
        ("uvs", &streams.uvs),
        ("reliefs", &streams.relief.reliefs),
        ("relief_levels", &streams.relief.levels),
        ("courses", &work.march.courses),
        ("course_nodes", &work.march.nodes),
    ];
    let of_meshes = &streams.silhouettes;
    match silhouettes {
        Silhouettes::None => bound.push(("normals", &streams.normals)),
        Silhouettes::Shell => bound.push(("directions", &of_meshes.directions)),
        Silhouettes::Quadric => bound.extend([
            ("directions", &of_meshes.directions),
            ("bends", &of_meshes.bends),
            ("raises", &of_meshes.raises),
        ]),
    }
    Ok(recorder.dispatch(course_shader(silhouettes), count, &params, &bound)?)
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
    tests: bool,
) -> Result<()> {
    let Frame { scene, streams, work, .. } = frame;
    let params = RelieveParams {
        count: count as u32,
        uv_channels: scene.uv_channels,
        finds_depth: u32::from(marcher.finds_depth),
        has_outlines: u32::from(scene.relief.silhouettes != Silhouettes::None),
        tests: u32::from(tests),
    };
    let bound = [
        ("fragments", &work.fragments),
        ("points", &work.points),
        ("instance_rows", &streams.instance_rows),
        ("positions", &streams.positions),
        ("normals", &streams.normals),
        ("uvs", &streams.uvs),
        ("reliefs", &streams.relief.reliefs),
        ("relief_levels", &streams.relief.levels),
        ("texels", &streams.relief.texels),
        ("courses", &work.march.courses),
        ("course_nodes", &work.march.nodes),
        ("marches", &work.march.marches),
    ];
    Ok(recorder.dispatch(&SHADERS.relieve, count, &params, &bound)?)
}
