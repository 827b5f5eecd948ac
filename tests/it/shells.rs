//! Courses of rays through the prisms of a mesh: the device's beside their f64 twins', and what is met on them.

use displace_glsl::{
    SHADERS,
    layout::{
        raster::{Fragment, SurfacePoint},
        relief::{COURSE_NODES, Course as DeviceCourse, CourseParams, Relief, ReliefLevel},
    },
    reference::relief::{Course, HeightLevel, ReliefMap, pixel_ray::pixel_ray, shell::Prism, steep},
};
use displace_server::{
    domain::cancel::{Cancel, NoProgress},
    vulkan::Stream,
};
use displace_tests::meshes::{self, TestMesh};
use glam::{DMat4, DQuat, DVec2, DVec3, DVec4};
use rayon::prelude::*;

use crate::raster::device;

const PIXELS: u32 = 80;
const TEXELS: u32 = 24;

/// A mesh at a scale, with heights of a tenth of it, seen in perspective.
struct Scene {
    mesh: TestMesh,
    map: ReliefMap,
    highest: f32,
    rows: Vec<[f32; 4]>,
}

/// What one ray and one triangle come to.
struct Candidate {
    pixel: u32,
    triangle: usize,
    nodes: Vec<DVec4>,
}

impl Scene {
    fn new(mut mesh: TestMesh, scale: f64) -> Self {
        mesh.positions.iter_mut().flatten().for_each(|x| *x = (f64::from(*x) * scale) as f32);
        let highest = (0.1 * scale) as f32;
        let noise = |i: u32| (i.wrapping_mul(2_654_435_761) >> 24) as f32 / 255.0;
        let heights = (0..TEXELS * TEXELS).map(|i| noise(i) * highest).collect();
        let level = HeightLevel { size: [TEXELS; 2], heights, repeats: [true; 2] };
        let map = ReliefMap { level, bounds: Vec::new(), cones: Vec::new(), thinnest_texels: 1.0, steps: 200 };
        let half = 0.5 * f64::from(PIXELS);
        let viewport = DMat4::from_cols(DVec4::X * half, DVec4::Y * -half, DVec4::Z, DVec4::new(half, half, 0.0, 1.0));
        let clip = DMat4::from_cols(DVec4::X * 2.4, DVec4::Y * 2.4, -DVec4::W, DVec4::Z * (0.1 * scale));
        let turn = DQuat::from_rotation_x(0.5) * DQuat::from_rotation_y(0.7);
        let view = DMat4::from_rotation_translation(turn, DVec3::NEG_Z * (4.0 * scale));
        let pixel_from_mesh = viewport * clip * view;
        let rows = (0..10).map(|row| pixel_from_mesh.row(row.min(3)).as_vec4().to_array()).collect();
        Self { mesh, map, highest, rows }
    }

    fn corners(&self, triangle: usize, of: &[[f32; 3]]) -> [DVec3; 3] {
        self.mesh.triangles[triangle].map(|v| DVec3::from_array(of[v as usize].map(f64::from)))
    }

    fn prisms(&self) -> Vec<Prism> {
        let heights = 0.0..f64::from(self.highest);
        let prism = |t: usize| {
            Prism::new(self.corners(t, &self.mesh.positions), self.corners(t, &self.mesh.normals), heights.clone())
        };
        (0..self.mesh.triangles.len()).map(|t| prism(t).expect("has an area")).collect()
    }

    fn at_px(pixel: u32) -> DVec2 {
        DVec2::new(f64::from(pixel % PIXELS) + 0.5, f64::from(pixel / PIXELS) + 0.5)
    }

    /// Of rays that come near a prism.
    fn candidates(&self) -> Vec<Candidate> {
        let prisms = self.prisms();
        let of = |pixel: u32| {
            let candidate = |(triangle, prism): (usize, &Prism)| {
                let first = self.corners(triangle, &self.mesh.positions)[0];
                let ray = pixel_ray(&self.rows, Self::at_px(pixel), first);
                if ray.origin.distance(first) > 2.0 * prism.side + f64::from(self.highest) {
                    return None;
                }
                let texels = self.mesh.triangles[triangle]
                    .map(|v| DVec2::from_array(self.mesh.uvs[v as usize].map(f64::from)) * f64::from(TEXELS) - 0.5);
                let nodes = prism.course(ray.origin, ray.direction, &texels, ray.least);
                Some(Candidate { pixel, triangle, nodes })
            };
            prisms.iter().enumerate().filter_map(candidate).collect::<Vec<_>>()
        };
        (0..PIXELS * PIXELS).into_par_iter().flat_map_iter(of).collect()
    }

    /// The device's nodes of each; none where it has no course.
    fn courses(&self, candidates: &[Candidate]) -> Vec<Vec<DVec4>> {
        let fragments: Vec<Fragment> = candidates
            .iter()
            .map(|c| Fragment { at_px: Self::at_px(c.pixel).as_vec2().to_array(), ..Fragment::default() })
            .collect();
        let points: Vec<SurfacePoint> = candidates
            .iter()
            .map(|c| SurfacePoint { vertices: self.mesh.triangles[c.triangle], ..SurfacePoint::default() })
            .collect();
        let relief = Relief {
            map_u: [1.0, 0.0, 0.0],
            map_v: [0.0, 1.0, 0.0],
            level_count: 1,
            high: self.highest,
            ..Relief::default()
        };
        let level = ReliefLevel { size: [TEXELS; 2], ..ReliefLevel::default() };
        let count = candidates.len() as u64;
        let device = device();
        let courses = Stream::new(device, "courses", size_of::<DeviceCourse>() as u32, count).expect("fits");
        let nodes = Stream::new(device, "course_nodes", 16, count * COURSE_NODES as u64).expect("fits");
        let bound = [
            ("fragments", &Stream::from_slice(device, "fragments", &fragments).expect("fits")),
            ("points", &Stream::from_slice(device, "points", &points).expect("fits")),
            ("instance_rows", &Stream::from_slice(device, "instance_rows", &self.rows).expect("fits")),
            ("positions", &Stream::from_slice(device, "positions", &self.mesh.positions).expect("fits")),
            ("directions", &Stream::from_slice(device, "directions", &self.mesh.normals).expect("fits")),
            ("uvs", &Stream::from_slice(device, "uvs", &self.mesh.uvs).expect("fits")),
            ("reliefs", &Stream::from_slice(device, "reliefs", &[relief]).expect("fits")),
            ("relief_levels", &Stream::from_slice(device, "relief_levels", &[level]).expect("fits")),
            ("courses", &courses),
            ("course_nodes", &nodes),
        ];
        let (cancel, progress) = (Cancel::default(), NoProgress);
        let mut recorder = device.recorder(&cancel, &progress);
        let params = CourseParams { count: count as u32, uv_channels: 1 };
        recorder.dispatch(&SHADERS.course_shell, count, &params, &bound).expect("records");
        recorder.finish().expect("runs");
        let (courses, nodes): (Vec<DeviceCourse>, Vec<[f32; 4]>) =
            (courses.read().expect("reads"), nodes.read().expect("reads"));
        let of = |(course, nodes): (&DeviceCourse, &[[f32; 4]])| {
            nodes[..course.nodes as usize].iter().map(|n| DVec4::from_array(n.map(f64::from))).collect()
        };
        courses.iter().zip(nodes.chunks(COURSE_NODES)).map(of).collect()
    }

    fn is_met(&self, nodes: &[DVec4]) -> bool {
        let course = Course { nodes: nodes.to_vec(), cosine: 1.0 };
        !nodes.is_empty() && steep::marched(&self.map, &course, 0.0).is_hit()
    }
}

/// Largest difference: of places in texels, of heights and times in sides of the triangle.
fn apart(a: &[DVec4], b: &[DVec4], side: f64) -> f64 {
    let of = |(a, b): (&DVec4, &DVec4)| ((*a - *b) * DVec4::new(1.0, 1.0, 1.0 / side, 1.0 / side)).abs().max_element();
    a.iter().zip(b).map(of).fold(0.0, f64::max)
}

fn length(nodes: &[DVec4]) -> f64 {
    if nodes.is_empty() { 0.0 } else { nodes[nodes.len() - 1].w - nodes[0].w }
}

#[test]
fn courses_through_prisms_are_those_of_the_twin_and_leave_no_crack() {
    for mesh in [meshes::icosphere(2), meshes::torus(32, 16)] {
        for scale in [1e-4, 1.0, 1e4] {
            let scene = Scene::new(mesh.clone(), scale);
            let (candidates, prisms) = (scene.candidates(), scene.prisms());
            let found = scene.courses(&candidates);
            let mut seen = [vec![false; (PIXELS * PIXELS) as usize], vec![false; (PIXELS * PIXELS) as usize]];
            let (mut worst, mut lost, mut both): (f64, f64, u32) = (0.0, 0.0, 0);
            for (candidate, nodes) in candidates.iter().zip(&found) {
                let side = prisms[candidate.triangle].side;
                if candidate.nodes.is_empty() != nodes.is_empty() {
                    lost = lost.max(length(&candidate.nodes).max(length(nodes)) / side);
                } else if !nodes.is_empty() {
                    both += 1;
                    worst = worst.max(apart(&candidate.nodes, nodes, side));
                }
                seen[0][candidate.pixel as usize] |= scene.is_met(&candidate.nodes);
                seen[1][candidate.pixel as usize] |= scene.is_met(nodes);
            }
            let differ = (0..seen[0].len()).filter(|&i| seen[0][i] != seen[1][i]).count();
            println!("{} x {scale}: {both} courses, {worst:.1e} apart, {lost:.1e} lost, {differ} pixels", mesh.name);
            assert!(both > 5_000 && worst < 2e-4 && lost < 1e-3 && differ == 0);
        }
    }
    assert_eq!(device().validation_messages(), [""; 0]);
}
