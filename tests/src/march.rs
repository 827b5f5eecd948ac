//! Courses over a height map, marched on the device by any method of the table.

use std::sync::Arc;

use displace_glsl::{
    ComputeShader, SHADERS,
    layout::relief::{COURSE_NODES, ConeMapParams, Course as DeviceCourse, March, MarchParams, Relief, ReliefLevel},
    reference::relief::{Course, HeightLevel, ReliefMap},
};
use displace_server::{
    domain::cancel::{Cancel, NoProgress},
    vulkan::{Device, Stream},
};
use glam::{DVec2, DVec3, DVec4};

/// The courses and their one map, as the passes read them.
pub struct Marches {
    device: Arc<Device>,
    count: u64,
    reliefs: Stream,
    levels: Stream,
    texels: Stream,
    courses: Stream,
    nodes: Stream,
}

impl Marches {
    /// Nodes are rounded to f32: courses that are compared with the twin are made by [`straight`].
    ///
    /// # Panics
    /// Where they do not fit the device.
    #[must_use]
    pub fn new(device: &Arc<Device>, map: &ReliefMap, courses: &[Course]) -> Self {
        let (level, texels) = level(map);
        let records: Vec<DeviceCourse> = courses.iter().map(record).collect();
        let nodes: Vec<[f32; 4]> = courses.iter().flat_map(padded).collect();
        Self {
            device: Arc::clone(device),
            count: courses.len() as u64,
            reliefs: Stream::from_slice(device, "reliefs", &[relief(map)]).expect("fits"),
            levels: Stream::from_slice(device, "relief_levels", &[level]).expect("fits"),
            texels: Stream::of_texels(device, &texels).expect("fits"),
            courses: Stream::from_slice(device, "courses", &records).expect("fits"),
            nodes: Stream::from_slice(device, "course_nodes", &nodes).expect("fits"),
        }
    }

    /// What the method finds, and the milliseconds that the device takes.
    ///
    /// # Panics
    /// Where the device refuses or fails.
    #[must_use]
    pub fn run(&self, shader: &'static ComputeShader, setting: f32) -> (Vec<March>, f64) {
        let marches = Stream::new(&self.device, "marches", size_of::<March>() as u32, self.count).expect("fits");
        let streams = [
            ("reliefs", &self.reliefs),
            ("relief_levels", &self.levels),
            ("texels", &self.texels),
            ("courses", &self.courses),
            ("course_nodes", &self.nodes),
            ("marches", &marches),
        ];
        let (cancel, progress) = (Cancel::default(), NoProgress);
        let mut recorder = self.device.recorder(&cancel, &progress);
        let params = MarchParams { count: self.count as u32, setting };
        recorder.dispatch(shader, self.count, &params, &streams).expect("records");
        let times = recorder.finish().expect("runs");
        let ms = times.iter().filter(|time| time.name == shader.name).map(|time| time.ms).sum();
        (marches.read().expect("reads"), ms)
    }
}

/// From one place to another, (x, y, z) each, rounded to f32; t is 0 and 1.
#[must_use]
pub fn straight(from: [f64; 3], to: [f64; 3]) -> Course {
    let node = |[x, y, z]: [f64; 3], t: f64| DVec4::new(x, y, z, t).as_vec4().as_dvec4();
    let way = DVec3::from_array(to) - DVec3::from_array(from);
    Course { nodes: vec![node(from, 0.0), node(to, 1.0)], cosine: (way.z / way.length()).abs(), is_open: [false; 2] }
}

/// A map without what only some methods need.
#[must_use]
pub fn map(level: HeightLevel) -> ReliefMap {
    ReliefMap { level, bounds: Vec::new(), cones: Vec::new(), thinnest_texels: 1.0, steps: 0 }
}

/// Where the march ended, for comparisons with the twin.
#[must_use]
pub fn place(march: &March) -> DVec2 {
    DVec2::from_array(march.place.map(f64::from))
}

fn relief(map: &ReliefMap) -> Relief {
    let range = map.level.heights.iter().fold([f32::INFINITY, f32::NEG_INFINITY], |[a, b], h| [a.min(*h), b.max(*h)]);
    let wrap = map.level.repeats.map(|repeats| u32::from(!repeats));
    Relief {
        map_u: [1.0, 0.0, 0.0],
        map_v: [0.0, 1.0, 0.0],
        uv_channel: 0,
        wrap: wrap[0] | wrap[1] << 2,
        level_first: 0,
        level_count: 1,
        low: range[0],
        high: range[1],
        thinnest_texels: map.thinnest_texels as f32,
        steps: map.steps,
    }
}

/// Heights, bounds and cones one after the other.
fn level(map: &ReliefMap) -> (ReliefLevel, Vec<f32>) {
    let texels = [map.level.heights.as_slice(), &map.bounds, &map.cones];
    let bound_first = texels[0].len() as u32;
    let cone_first = bound_first + texels[1].len() as u32;
    (ReliefLevel { size: map.level.size, height_first: 0, bound_first, cone_first }, texels.concat())
}

fn record(course: &Course) -> DeviceCourse {
    DeviceCourse { nodes: course.nodes.len() as u32, material: 0, level: 0, cosine: course.cosine as f32, ends: 0 }
}

fn padded(course: &Course) -> Vec<[f32; 4]> {
    assert!(course.nodes.len() <= COURSE_NODES, "a course has room for {COURSE_NODES} nodes");
    let mut nodes: Vec<[f32; 4]> = course.nodes.iter().map(|node| node.as_vec4().to_array()).collect();
    nodes.resize(COURSE_NODES, [0.0; 4]);
    nodes
}

/// Of every texel of a map, as the device makes them.
///
/// # Panics
/// Where the device refuses or fails.
#[must_use]
pub fn cones(device: &Arc<Device>, level: &HeightLevel) -> Vec<f32> {
    let mut texels = level.heights.clone();
    let count = texels.len() as u32;
    texels.resize(2 * texels.len(), 0.0);
    let texels = Stream::of_texels(device, &texels).expect("fits");
    let Relief { wrap, high, .. } = relief(&map(level.clone()));
    let level = ReliefLevel { size: level.size, height_first: 0, bound_first: 0, cone_first: count };
    let (cancel, progress) = (Cancel::default(), NoProgress);
    let mut recorder = device.recorder(&cancel, &progress);
    let params = ConeMapParams { count, wrap, high, level };
    recorder.dispatch(&SHADERS.cone_map, count.into(), &params, &[("texels", &texels)]).expect("records");
    recorder.finish().expect("runs");
    texels.read_range(count.into()..2 * u64::from(count)).expect("reads")
}
