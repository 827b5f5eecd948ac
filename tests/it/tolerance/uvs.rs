//! What texture coordinates may do to the count: charts that do not match, turn, overlap, vanish or lie far out.

use std::sync::Arc;

use displace_server::domain::{
    detail::{Detail, LayerSource, Map, Sampling, Wrap},
    request::{Allowed, ErrorAt, Geometry, Quality, Refinement, Tolerance},
    surface::Surface,
};
use displace_tests::{
    device,
    meshes::{self, TestMesh},
    surfaces::{detail, displace, uniform},
};

fn within(tolerance: f64, max_triangles: Option<u64>) -> Geometry {
    let tolerance =
        Tolerance { allowed: Allowed::World(tolerance), error_at: ErrorAt::Surface, quality: Quality::Normal };
    Geometry { refinement: Refinement::Tolerance(tolerance), max_triangles, ..uniform(0) }
}

/// Hills that repeat with the unit square.
fn hills(size: u32, scale: f32) -> Arc<Detail> {
    let turn = |k: u32, times: f32| (std::f32::consts::TAU * times * k as f32 / size as f32).sin();
    let texels: Vec<f32> = (0..size * size).map(|k| turn(k % size, 2.0) * turn(k / size, 3.0)).collect();
    let map = Map {
        width: size,
        height: size,
        channels: 1,
        texels: texels.into(),
        wrap: [Wrap::Repeat; 2],
        sampling: Sampling::Center,
        source_bits: 32,
    };
    detail(LayerSource::Height(Arc::new(map)), scale)
}

fn made(mesh: &TestMesh, detail: &Arc<Detail>, geometry: &Geometry) -> Surface {
    displace(&*device::reference(), &mesh.to_mesh(), detail, geometry)
}

/// A plane of two charts that meet at x = 0; the right one has these texture coordinates instead of its own.
fn two_charts(right: impl Fn([f32; 2]) -> [f32; 2]) -> TestMesh {
    let mut mesh = meshes::plane(4);
    let count = mesh.positions.len() as u32;
    mesh.positions.extend_from_within(..);
    mesh.normals.extend_from_within(..);
    let uvs: Vec<[f32; 2]> = mesh.uvs.iter().map(|uv| right(*uv)).collect();
    mesh.uvs.extend(uvs);
    let positions = mesh.positions.clone();
    for triangle in &mut mesh.triangles {
        let x: f32 = triangle.iter().map(|gv| positions[*gv as usize][0]).sum();
        if x > 0.0 {
            *triangle = triangle.map(|gv| gv + count);
        }
    }
    mesh
}

#[test]
fn charts_that_do_not_match_take_at_most_twice_the_triangles() {
    let (detail, geometry) = (hills(64, 0.05), within(1e-3, Some(100_000)));
    let matched = made(&two_charts(|uv| uv), &detail, &geometry).triangles.len();
    type Change = fn([f32; 2]) -> [f32; 2];
    let changes: [(&str, Change); 6] = [
        ("shifted", |[u, v]| [u + 0.37, v + 0.21]),
        ("mirrored", |[u, v]| [1.0 - u, v]),
        ("turned", |[u, v]| [v, 1.0 - u]),
        ("overlapping", |[u, v]| [u - 0.5, v]),
        ("of one point", |_| [0.3, 0.3]),
        ("far out", |[u, v]| [u + 1000.0, v - 2000.0]),
    ];
    for (name, change) in changes {
        let surface = made(&two_charts(change), &detail, &geometry);
        let fit = surface.fit.expect("a tolerance was asked for");
        let count = surface.triangles.len();
        eprintln!("{name}: {count} triangles, {matched} where charts match");
        assert!(count <= 2 * matched && !fit.budget_reached && fit.certified, "{name}: {count} of {matched}, {fit:?}");
    }
}

#[test]
fn a_map_repeated_a_hundred_times_is_bounded_without_looking_at_every_texel() {
    let mut mesh = meshes::plane(1);
    mesh.uvs.iter_mut().flatten().for_each(|x| *x *= 100.0);
    // 51 200 texels along a side: what they differ by is within the tolerance, or beyond every budget.
    let detail = hills(512, 0.01);
    assert_eq!(made(&mesh, &detail, &within(0.03, None)).triangles.len(), 2);
    let surface = made(&mesh, &detail, &within(1e-3, Some(2000)));
    let fit = surface.fit.expect("a tolerance was asked for");
    assert!(fit.budget_reached && fit.certified && surface.triangles.len() <= 2000, "{fit:?}");
    assert!(fit.bound_local <= 0.021, "{fit:?}");
}
