//! The same request on the same device gives the same bytes: run after run, with one driver thread or two,
//! and whatever the order of the input.

use std::{collections::BTreeMap, sync::Arc};

use displace_server::domain::{
    detail::Detail,
    mesh::Mesh,
    request::{Allowed, ErrorAt, Geometry, Quality, Refinement, Tolerance},
    surface::Surface,
};
use displace_tests::{
    cli::Displace,
    data::sample,
    device,
    meshes::{self, TestMesh},
    surfaces::{detail, displace, noise_height, uniform},
};

#[test]
fn repeated_runs_give_the_same_bits() {
    let Some(executor) = device::executor("determinism") else { return };
    let noise = detail(noise_height(64, 5), 0.1);
    for mesh in meshes::all() {
        let base = mesh.to_mesh();
        let first = displace(&*executor, &base, &noise, &uniform(4));
        for _ in 0..3 {
            assert!(bits(&first) == bits(&displace(&*executor, &base, &noise, &uniform(4))), "{}", mesh.name);
        }
    }
}

/// Everything of a surface that is floating-point, as bits.
fn bits(surface: &Surface) -> Vec<u32> {
    let vectors = surface.positions.iter().chain(&surface.normals).flatten();
    vectors.chain(surface.attributes.iter().flatten()).map(|x| x.to_bits()).collect()
}

/// One fine triangle by what its corners hold, from its least corner on, so that numbering does not show.
type Corner = Vec<u32>;
type Shape = [Corner; 3];

/// How often each triangle occurs.
fn shapes(base: &Mesh, surface: &Surface) -> BTreeMap<Shape, u32> {
    let corner = |vertex: u32| {
        let vertex = vertex as usize;
        let mut corner: Vec<u32> =
            surface.positions[vertex].iter().chain(&surface.normals[vertex]).map(|x| x.to_bits()).collect();
        for (attribute, values) in base.attributes.iter().zip(&surface.attributes) {
            let width = attribute.components;
            corner.extend(values[vertex * width..(vertex + 1) * width].iter().map(|x| x.to_bits()));
        }
        corner
    };
    let mut counts = BTreeMap::new();
    for triangle in &surface.triangles {
        let mut shape = triangle.map(corner);
        let least = (0..3).min_by_key(|&k| shape[k].clone()).unwrap_or(0);
        shape.rotate_left(least);
        *counts.entry(shape).or_insert(0) += 1;
    }
    counts
}

fn within_a_hundredth() -> Geometry {
    let allowed = Allowed::Diagonal(0.01);
    let tolerance = Tolerance { allowed, error_at: ErrorAt::Surface, quality: Quality::Normal };
    Geometry { refinement: Refinement::Tolerance(tolerance), ..uniform(0) }
}

/// Heights need no tangents. Where a detail does, MikkTSpace sums over triangles in their order, and its last bits
/// follow it.
fn check_permuted(mesh: &TestMesh, noise: &Arc<Detail>, geometry: &Geometry) {
    let Some(executor) = device::executor("determinism") else { return };
    let base = mesh.to_mesh_without_tangents();
    let expected = shapes(&base, &displace(&*executor, &base, noise, geometry));
    for seed in 0..3 {
        let permuted = mesh.permuted(seed).to_mesh_without_tangents();
        let found = shapes(&permuted, &displace(&*executor, &permuted, noise, geometry));
        let changed = expected.keys().filter(|shape| !found.contains_key(*shape)).count();
        assert!(found == expected, "{}, seed {seed}: {changed} of {} triangles changed", mesh.name, expected.len());
    }
}

#[test]
fn the_order_of_the_input_does_not_matter() {
    let noise = detail(noise_height(64, 6), 0.1);
    for mesh in meshes::all() {
        check_permuted(&mesh, &noise, &uniform(3));
    }
}

#[test]
fn the_order_of_the_input_does_not_matter_to_a_tolerance() {
    let noise = detail(noise_height(16, 6), 0.05);
    for mesh in meshes::all() {
        check_permuted(&mesh, &noise, &within_a_hundredth());
    }
}

/// The bytes that the real command writes with this many driver threads, everything computed anew.
fn outputs(threads: &str) -> Vec<Vec<u8>> {
    let displace = Displace::default();
    let (mesh, map) = (sample("models/Suzanne/Suzanne.gltf"), sample("maps/abstract_height.png"));
    let run = |args: &[&str]| {
        let mut command = displace.command();
        command
            .env("LP_NUM_THREADS", threads)
            .arg(args[0])
            .arg(&mesh)
            .arg("--height")
            .arg(&map)
            .args(["--scale", "0.1"]);
        let output = command.args(&args[1..]).output().expect("displace can be started");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    };
    run(&["apply", "--uniform", "3", "-o", "out.glb"]);
    run(&["render", "--uniform", "3", "--size", "320x240", "-o", "out.png"]);
    ["out.glb", "out.png"]
        .map(|name| std::fs::read(displace.folder().join(name)).expect("the result was written"))
        .into()
}

#[test]
fn one_driver_thread_and_two_write_the_same_files() {
    if device::without_gpu("determinism over driver threads") {
        return;
    }
    let one = outputs("1");
    assert!(one == outputs("2"), "LP_NUM_THREADS=1 and 2 differ");
    assert!(one == outputs("1"), "two runs differ");
}
