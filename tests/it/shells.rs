//! Courses of rays through the prisms of a mesh: the device's beside their f64 twins', and what is met on them.

use displace_glsl::{
    SHADERS,
    layout::{
        raster::{Fragment, SurfacePoint},
        relief::{COURSE_NODES, Course as DeviceCourse, CourseParams, Relief, ReliefLevel},
    },
    reference::relief::{Course, HeightLevel, ReliefMap, pixel_ray::pixel_ray, quadric::Bent, shell::Prism, steep},
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

#[derive(Clone, Copy, PartialEq)]
enum Geometry {
    Shell,
    Quadric,
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

    /// Twice the bends of a sphere of the mesh's size.
    fn bend(&self) -> f64 {
        -0.1 / f64::from(self.highest)
    }

    fn raise(&self) -> f64 {
        1.2 * f64::from(self.highest)
    }

    fn bent(&self, t: usize) -> Bent {
        let bend = [[self.bend(), 0.0, 0.0, self.bend(), 0.0, self.bend()]; 3];
        let (corners, directions) = (self.corners(t, &self.mesh.positions), self.corners(t, &self.mesh.normals));
        Bent::new(corners, directions, bend, 0.0..f64::from(self.highest), self.raise()).expect("has an area")
    }

    /// Of rays that come near a prism.
    fn candidates(&self, geometry: Geometry) -> Vec<Candidate> {
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
                let nodes = match geometry {
                    Geometry::Shell => prism.course(ray.origin, ray.direction, &texels, ray.least),
                    Geometry::Quadric => self.bent(triangle).course(ray.origin, ray.direction, &texels, ray.least),
                };
                Some(Candidate { pixel, triangle, nodes })
            };
            prisms.iter().enumerate().filter_map(candidate).collect::<Vec<_>>()
        };
        (0..PIXELS * PIXELS).into_par_iter().flat_map_iter(of).collect()
    }

    /// The device's nodes of each; none where it has no course.
    fn courses(&self, geometry: Geometry, candidates: &[Candidate]) -> Vec<Vec<DVec4>> {
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
        let courses = stream("courses", &vec![DeviceCourse::default(); candidates.len()]).1;
        let nodes = Stream::new(device, "course_nodes", 16, count * COURSE_NODES as u64).expect("fits");
        let bend = [self.bend() as f32, 0.0, 0.0, self.bend() as f32, 0.0, self.bend() as f32];
        let bends = vec![bend; self.mesh.positions.len()];
        let bends = bytemuck::cast_slice::<_, [f32; 3]>(&bends);
        let shader = if geometry == Geometry::Shell { &SHADERS.course_shell } else { &SHADERS.course_quadric };
        let mut inputs = vec![
            stream("fragments", &fragments),
            stream("points", &points),
            stream("instance_rows", &self.rows),
            stream("positions", &self.mesh.positions),
            stream("directions", &self.mesh.normals),
            stream("uvs", &self.mesh.uvs),
            stream("reliefs", &[relief]),
            stream("relief_levels", &[level]),
        ];
        if geometry == Geometry::Quadric {
            inputs.extend([stream("bends", bends), stream("raises", &[self.raise() as f32])]);
        }
        let mut bound: Vec<(&str, &Stream)> = inputs.iter().map(|(name, stream)| (*name, stream)).collect();
        bound.extend([("courses", &courses), ("course_nodes", &nodes)]);
        let (cancel, progress) = (Cancel::default(), NoProgress);
        let mut recorder = device.recorder(&cancel, &progress);
        let params = CourseParams { count: count as u32, uv_channels: 1 };
        recorder.dispatch(shader, count, &params, &bound).expect("records");
        recorder.finish().expect("runs");
        let (courses, nodes): (Vec<DeviceCourse>, Vec<[f32; 4]>) =
            (courses.read().expect("reads"), nodes.read().expect("reads"));
        let of = |(course, nodes): (&DeviceCourse, &[[f32; 4]])| {
            nodes[..course.nodes as usize].iter().map(|n| DVec4::from_array(n.map(f64::from))).collect()
        };
        courses.iter().zip(nodes.chunks(COURSE_NODES)).map(of).collect()
    }

    fn is_met(&self, nodes: &[DVec4]) -> bool {
        let course = Course { nodes: nodes.to_vec(), cosine: 1.0, is_open: [false; 2] };
        !nodes.is_empty() && steep::marched(&self.map, &course, 0.0).is_hit()
    }
}

fn stream<T: bytemuck::Pod>(name: &'static str, values: &[T]) -> (&'static str, Stream) {
    (name, Stream::from_slice(device(), name, values).expect("fits"))
}

/// Largest difference: of places in texels, of heights and times in sides of the triangle.
fn apart(a: &[DVec4], b: &[DVec4], side: f64) -> f64 {
    let of = |(a, b): (&DVec4, &DVec4)| ((*a - *b) * DVec4::new(1.0, 1.0, 1.0 / side, 1.0 / side)).abs().max_element();
    a.iter().zip(b).map(of).fold(0.0, f64::max)
}

fn length(nodes: &[DVec4]) -> f64 {
    if nodes.is_empty() { 0.0 } else { nodes[nodes.len() - 1].w - nodes[0].w }
}

/// Of the device and the twin.
struct Compared {
    courses: u32,
    worst: f64,
    /// The longest course that only one of them has, in sides.
    lost: f64,
    /// Pixels where only one of them meets the surface.
    differ: usize,
}

fn compared(scene: &Scene, geometry: Geometry) -> Compared {
    let (candidates, prisms) = (scene.candidates(geometry), scene.prisms());
    let found = scene.courses(geometry, &candidates);
    let mut seen = [vec![false; (PIXELS * PIXELS) as usize], vec![false; (PIXELS * PIXELS) as usize]];
    let mut compared = Compared { courses: 0, worst: 0.0, lost: 0.0, differ: 0 };
    for (candidate, nodes) in candidates.iter().zip(&found) {
        let side = prisms[candidate.triangle].side;
        if candidate.nodes.is_empty() != nodes.is_empty() {
            compared.lost = compared.lost.max(length(&candidate.nodes).max(length(nodes)) / side);
        } else if !nodes.is_empty() {
            compared.courses += 1;
            compared.worst = compared.worst.max(apart(&candidate.nodes, nodes, side));
        }
        seen[0][candidate.pixel as usize] |= scene.is_met(&candidate.nodes);
        seen[1][candidate.pixel as usize] |= scene.is_met(nodes);
    }
    compared.differ = (0..seen[0].len()).filter(|&i| seen[0][i] != seen[1][i]).count();
    compared
}

fn each_scene(geometry: Geometry, check: impl Fn(&Compared)) {
    for mesh in [meshes::icosphere(2), meshes::torus(32, 16)] {
        for scale in [1e-4, 1.0, 1e4] {
            let found = compared(&Scene::new(mesh.clone(), scale), geometry);
            let Compared { courses, worst, lost, differ } = found;
            println!("{} x {scale}: {courses} courses, {worst:.1e} apart, {lost:.1e} lost, {differ} pixels", mesh.name);
            check(&found);
        }
    }
    assert_eq!(device().validation_messages(), [""; 0]);
}

#[test]
fn courses_through_prisms_are_those_of_the_twin_and_leave_no_crack() {
    each_scene(Geometry::Shell, |found| {
        assert!(found.courses > 5_000 && found.worst < 2e-4 && found.lost < 1e-3 && found.differ == 0);
    });
}

#[test]
fn courses_over_quadrics_are_those_of_the_twin_and_leave_no_crack() {
    each_scene(Geometry::Quadric, |found| {
        assert!(found.courses > 2_000 && found.worst < 1e-3 && found.lost < 1e-3 && found.differ == 0);
    });
}
