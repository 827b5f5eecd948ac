//! Refinement by the bound: device against twin.

use displace_glsl::reference::{
    bound::{Asked, bound},
    place::{Places, share_of},
    refine::{Base, Refined, barycentrics, marks},
};
use displace_server::{
    domain::{
        cancel::{Cancel, NoProgress},
        detail::{Sampling, Wrap},
    },
    render::{
        JobContext,
        tessellate::device::{self, bounds::Bounds},
    },
};
use displace_tests::meshes;
use rayon::prelude::*;

use super::*;
use crate::raster::device;

const ALL: Asked = Asked { at_texels: false };
const LIMIT: u64 = 1 << 18;
const IDENTITY: [[f32; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

fn on_device(subject: &Subject, allowed: f64, limit: u64) -> Option<(Refined, u32)> {
    let cancel = Cancel::default();
    let job = JobContext { cancel: &cancel, progress: &NoProgress };
    let places = Places::new(&subject.tables, &subject.base);
    let bounds = Bounds::new(&job, device(), &places, ALL).expect("fits");
    device::refine(&job, device(), &bounds, &subject.base, allowed, limit).expect("runs")
}

fn by_twin(subject: &Subject, allowed: f64) -> (Refined, u32) {
    let mut refined = Refined::of(&subject.base);
    let mut rounds = 0;
    loop {
        let wanted: Vec<u32> = errors(subject, &refined, allowed).iter().map(|e| u32::from(*e > allowed)).collect();
        let marks = marks(&refined, &wanted);
        if !marks.contains(&1) {
            return (refined, rounds);
        }
        refined = refined.split(&subject.base, &marks);
        rounds += 1;
    }
}

fn errors(subject: &Subject, refined: &Refined, cap: f64) -> Vec<f64> {
    let places = Places::new(&subject.tables, &subject.base);
    let base: &Base = &subject.base;
    let error = |t: &displace_glsl::layout::refine::RefinedTriangle| {
        let owner = &base.triangles[t.base as usize];
        let corners = t.gv.map(|gv| share_of(barycentrics(&refined.vertices[gv as usize], owner)));
        bound(&places, ALL, t.base, corners, 1.0, cap)
    };
    refined.triangles.par_iter().map(error).collect()
}

fn check(what: &str, subject: &Subject, allowed: f64) {
    let (found, rounds) = on_device(subject, allowed, LIMIT).expect("within the limit");
    let (expected, twin_rounds) = by_twin(subject, allowed);
    let worst = errors(subject, &found, f64::INFINITY).into_iter().fold(0.0, f64::max);
    assert!(worst <= allowed * (1.0 + 1e-4), "{what}: {worst} is allowed to be {allowed}");
    let (count, twin_count) = (found.triangles.len() as f64, expected.triangles.len() as f64);
    assert!((count / twin_count - 1.0).abs() < 0.01, "{what}: {count} triangles, the twin has {twin_count}");
    assert!(rounds.abs_diff(twin_rounds) <= 1, "{what}: {rounds} rounds, the twin takes {twin_rounds}");
}

#[test]
fn refinement_on_the_device_keeps_the_tolerance_with_the_triangles_of_the_twin() {
    for (mesh, at) in [
        (meshes::plane(2), bricks as fn(u32, u32) -> f32),
        (meshes::plane(2), noise),
        (meshes::cube(), smooth),
        (meshes::torus(6, 4), noise),
    ] {
        let layers = vec![layer(map([17, 17], Wrap::Repeat, Sampling::Center, at), 0.05, IDENTITY)];
        check(mesh.name, &Subject::new(&mesh, 3.0, layers), 0.012);
    }
}

#[test]
fn a_map_without_relief_needs_no_round() {
    let flat = map([8, 8], Wrap::Repeat, Sampling::Center, |_, _| 0.5);
    let subject = Subject::new(&meshes::plane(3), 3.0, vec![layer(flat, 1.0, IDENTITY)]);
    let (refined, rounds) = on_device(&subject, 1e-6, LIMIT).expect("within the limit");
    assert_eq!((refined.triangles, rounds), (Refined::of(&subject.base).triangles, 0));
}

#[test]
fn refinement_beyond_the_limit_is_given_up() {
    let rough = map([64, 64], Wrap::Repeat, Sampling::Center, noise);
    let subject = Subject::new(&meshes::cube(), 3.0, vec![layer(rough, 0.3, IDENTITY)]);
    assert!(on_device(&subject, 1e-3, 1000).is_none());
}
