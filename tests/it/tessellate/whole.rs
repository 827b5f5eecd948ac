//! Tessellation on the device as a whole: what the twins promise, with as many triangles.

use std::collections::HashMap;

use displace_glsl::{
    layout::refine::UNIT,
    reference::{collapse::Facet, refine::barycentrics},
};
use displace_server::{
    domain::{
        cancel::{Cancel, NoProgress},
        detail::{Sampling, Wrap},
        plan::TolerancePlan,
        request::{ErrorAt, Quality},
    },
    render::{
        JobContext,
        tessellate::{self, Tessellated, device},
    },
    vulkan::{Device, DeviceOptions, Testing},
};
use displace_tests::meshes;

use super::*;
use crate::raster::device as vulkan;

const IDENTITY: [[f32; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

fn plan(tolerance_local: f64, error_at: ErrorAt) -> TolerancePlan {
    TolerancePlan {
        tolerance_local,
        unit_per_local: 1.0,
        views: Vec::new(),
        error_at,
        quality: Quality::Normal,
        max_triangles: 1 << 20,
        spans_base: false,
        reserve: None,
    }
}

fn on_device(subject: &Subject, plan: &TolerancePlan) -> Tessellated {
    on(vulkan(), subject, plan)
}

fn on(device: &Arc<Device>, subject: &Subject, plan: &TolerancePlan) -> Tessellated {
    let job = JobContext { cancel: &Cancel::default(), progress: &NoProgress };
    device::tessellate(device, &job, plan, &subject.tables, &subject.mesh).expect("runs")
}

fn on_host(subject: &Subject, plan: &TolerancePlan) -> Tessellated {
    let job = JobContext { cancel: &Cancel::default(), progress: &NoProgress };
    tessellate::tessellate(&job, plan, &subject.tables, &subject.mesh).expect("runs")
}

/// As whole as the base mesh: each base triangle is covered once, and no vertex hangs on a side.
fn check_whole(what: &str, subject: &Subject, found: &Tessellated) {
    let mut areas = vec![0i128; subject.base.triangles.len()];
    let mut sides: HashMap<(u32, [u32; 2]), i32> = HashMap::new();
    for Facet { gv, base } in &found.mesh.triangles {
        let owner = &subject.base.triangles[*base as usize];
        let b = gv.map(|gv| barycentrics(&found.mesh.vertices[gv as usize], owner).map(i128::from));
        let [u, v] = [1, 2].map(|k| [b[k][1] - b[0][1], b[k][2] - b[0][2]]);
        let area = u[0] * v[1] - u[1] * v[0];
        assert!(area > 0, "{what}: {gv:?} is flat or turned over");
        areas[*base as usize] += area;
        for k in 0..3 {
            let (a, b) = (gv[k], gv[(k + 1) % 3]);
            *sides.entry((*base, [a.min(b), a.max(b)])).or_default() += if a < b { 1 } else { -1 };
        }
    }
    assert!(areas.iter().all(|area| *area == i128::from(UNIT) * i128::from(UNIT)), "{what}: areas");
    // What is left over runs along base edges, the same pieces on all sheets.
    let mut pieces: HashMap<u32, Vec<Vec<[u32; 2]>>> = HashMap::new();
    for (t, base) in (0..).zip(&subject.base.triangles) {
        for ge in base.ge {
            let on_edge = |gv: &u32| barycentrics(&found.mesh.vertices[*gv as usize], base);
            let side = base.ge.iter().position(|other| *other == ge).expect("it is there");
            let along = sides.iter().filter(|((owner, _), left)| *owner == t && **left != 0);
            let along = along.map(|((_, ends), _)| *ends);
            let mut own: Vec<[u32; 2]> =
                along.filter(|ends| ends.iter().all(|gv| on_edge(gv)[(side + 2) % 3] == 0)).collect();
            own.sort_unstable();
            pieces.entry(ge).or_default().push(own);
        }
    }
    for (ge, sheets) in pieces {
        assert!(sheets.iter().all(|sheet| *sheet == sheets[0] && !sheet.is_empty()), "{what}: base edge {ge}");
    }
}

fn check(what: &str, subject: &Subject, plan: &TolerancePlan) {
    let (found, twin) = (on_device(subject, plan), on_host(subject, plan));
    check_whole(what, subject, &found);
    assert!(found.fit.bound_local <= plan.tolerance_local && !found.fit.budget_reached, "{what}: {:?}", found.fit);
    assert_eq!(found.fit.certified, twin.fit.certified, "{what}");
    let (count, twin_count) = (found.mesh.triangles.len() as f64, twin.mesh.triangles.len() as f64);
    assert!((count / twin_count - 1.0).abs() < 0.03, "{what}: {count} triangles, the twin has {twin_count}");
}

#[test]
fn tessellation_on_the_device_is_whole_within_the_tolerance_and_as_frugal() {
    for (mesh, at) in [
        (meshes::plane(2), noise as fn(u32, u32) -> f32),
        (meshes::cube(), bricks),
        (meshes::moebius(12, 2), smooth),
        (meshes::torus(6, 4), noise),
    ] {
        let layers = vec![layer(map([17, 17], Wrap::Repeat, Sampling::Center, at), 0.05, IDENTITY)];
        check(mesh.name, &Subject::new(&mesh, 3.0, layers), &plan(0.012, ErrorAt::Surface));
    }
}

#[test]
fn tessellation_at_texels_and_of_several_layers_is_as_frugal() {
    let at = |at: fn(u32, u32) -> f32| layer(map([33, 33], Wrap::Clamp, Sampling::Node, at), 0.05, IDENTITY);
    let subject = Subject::new(&meshes::plane(2), 3.0, vec![at(smooth), at(noise)]);
    check("two layers", &subject, &plan(0.01, ErrorAt::Surface));
    check("two layers at texels", &subject, &plan(0.01, ErrorAt::Texels));
}

#[test]
fn tessellation_on_the_device_is_the_same_every_time_and_in_small_pages() {
    let layers = vec![layer(map([17, 17], Wrap::Repeat, Sampling::Center, noise), 0.05, IDENTITY)];
    let cube = (Subject::new(&meshes::cube(), 3.0, layers), plan(0.012, ErrorAt::Surface));
    // Three pages of texels, of 2^17 each.
    let layers = vec![layer(map([600, 500], Wrap::Clamp, Sampling::Node, |x, y| hill([x, y], 250.0)), 0.2, IDENTITY)];
    let plane = (Subject::new(&meshes::plane(1), 3.0, layers), plan(0.004, ErrorAt::Surface));
    let testing = Testing { page_shift: Some(14), batch: Some(1), ..Testing::default() };
    let paged = Device::open(&DeviceOptions { validation: true, testing, ..DeviceOptions::default() }).expect("opens");
    for (subject, plan) in [cube, plane] {
        let once = on_device(&subject, &plan).mesh.triangles;
        assert!(once.len() > 12 && on_device(&subject, &plan).mesh.triangles == once);
        assert!(on(&paged, &subject, &plan).mesh.triangles == once);
    }
    assert_eq!(paged.validation_messages(), Vec::<String>::new());
}

/// A hill on a plain: large regions are flat.
fn hill(at: [u32; 2], middle: f32) -> f32 {
    let [dx, dy] = at.map(|x| (x as f32 - middle) / 150.0);
    0.25 + 0.5 * (-dx * dx - dy * dy).exp()
}

#[test]
fn what_a_device_has_no_room_for_is_done_on_the_host_and_told() {
    let layers = vec![layer(map([600, 600], Wrap::Repeat, Sampling::Center, smooth), 0.05, IDENTITY)];
    let (subject, plan) = (Subject::new(&meshes::plane(1), 3.0, layers), plan(0.012, ErrorAt::Surface));
    let twin = on_host(&subject, &plan);
    let names = |found: &Tessellated| found.times.iter().map(|time| time.name.clone()).collect::<Vec<_>>();
    assert_eq!(names(&twin), ["refine", "collapse"]);
    // Enough for the self-test, and less than the map.
    let small = DeviceOptions { budget_bytes: 5 << 18, ..DeviceOptions::default() };
    let found = on(&Device::open(&small).expect("opens"), &subject, &plan);
    assert!(found.mesh.triangles == twin.mesh.triangles);
    assert_eq!(names(&found), ["refine (host)", "collapse (host)"]);
}

#[test]
fn two_triangles_under_a_large_map_become_as_few_as_with_the_twin() {
    let hill = map([2048, 2048], Wrap::Clamp, Sampling::Node, |x, y| hill([x, y], 1400.0));
    let layers = vec![layer(hill, 0.2, IDENTITY)];
    check("hill", &Subject::new(&meshes::plane(1), 3.0, layers), &plan(0.004, ErrorAt::Surface));
}
