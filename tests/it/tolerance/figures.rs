//! What a tolerance costs in triangles where that is known.

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

/// World units at the surface, unless said otherwise.
fn within(tolerance: f64) -> Geometry {
    let tolerance =
        Tolerance { allowed: Allowed::World(tolerance), error_at: ErrorAt::Surface, quality: Quality::Normal };
    Geometry { refinement: Refinement::Tolerance(tolerance), ..uniform(0) }
}

fn height(size: u32, at: impl Fn(u32, u32) -> f32) -> Arc<Detail> {
    let texels: Vec<f32> = (0..size * size).map(|i| at(i % size, i / size)).collect();
    let map = Map {
        width: size,
        height: size,
        channels: 1,
        texels: texels.into(),
        wrap: [Wrap::Clamp; 2],
        sampling: Sampling::Node,
        source_bits: 32,
    };
    detail(LayerSource::Height(Arc::new(map)), 1.0)
}

fn made(mesh: &TestMesh, detail: &Arc<Detail>, geometry: &Geometry) -> Surface {
    displace(&*device::reference(), &mesh.to_mesh(), detail, geometry)
}

#[test]
fn what_is_flat_or_a_ramp_needs_no_further_triangle() {
    for slope in [0.0, 1.0 / 64.0] {
        let ramp = height(65, |x, _| x as f32 * slope);
        assert_eq!(made(&meshes::plane(1), &ramp, &within(1e-4)).triangles.len(), 2, "slope {slope}");
    }
}

#[test]
fn a_spike_of_one_texel_is_kept() {
    let spike = height(257, |x, y| if (x, y) == (101, 57) { 0.2 } else { 0.0 });
    let surface = made(&meshes::plane(1), &spike, &within(0.01));
    let highest = surface.positions.iter().flatten().fold(0f32, |most, x| most.max(*x));
    assert!(surface.positions.iter().flatten().any(|x| (x - 0.2).abs() < 0.01), "the tip of {highest}");
    assert!(surface.triangles.len() < 200, "{} triangles", surface.triangles.len());
}

#[test]
fn a_parabola_takes_what_theory_says() {
    // Along x alone, h = x^2: pieces of width 2 sqrt(tolerance), two triangles each.
    let parabola = height(257, |x, _| (x as f32 / 256.0).powi(2));
    let surface = made(&meshes::plane(1), &parabola, &within(1e-3));
    let pieces = 1.0 / (2.0 * 1e-3f64.sqrt());
    let triangles = surface.triangles.len() as f64;
    assert!(
        triangles >= 2.0 * pieces.floor() && triangles <= 6.0 * pieces,
        "{triangles} triangles for {pieces} pieces"
    );
}

#[test]
fn more_is_allowed_less_is_made() {
    let hills = height(65, |x, y| 0.05 * ((x as f32 * 0.3).sin() + (y as f32 * 0.2).cos()));
    let counts: Vec<usize> =
        [1e-3, 2e-3, 4e-3, 8e-3].map(|t| made(&meshes::plane(1), &hills, &within(t)).triangles.len()).to_vec();
    assert!(counts.is_sorted_by(|a, b| a > b), "{counts:?}");
}

#[test]
fn high_quality_takes_fewer_triangles() {
    let hills = height(65, |x, y| 0.05 * ((x as f32 * 0.3).sin() + (y as f32 * 0.2).cos()));
    let count = |quality: Quality| {
        let tolerance = Tolerance { allowed: Allowed::World(5e-4), error_at: ErrorAt::Surface, quality };
        let geometry = Geometry { refinement: Refinement::Tolerance(tolerance), ..uniform(0) };
        made(&meshes::plane(1), &hills, &geometry).triangles.len()
    };
    let (normal, high) = (count(Quality::Normal), count(Quality::High));
    assert!(high < normal, "{high} instead of {normal}");
}

#[test]
fn a_budget_is_kept_and_told_of() {
    let hills = height(65, |x, y| 0.05 * ((x as f32 * 0.3).sin() + (y as f32 * 0.2).cos()));
    for most in [1, 2, 50, 500] {
        let geometry = Geometry { max_triangles: Some(most), ..within(1e-5) };
        let surface = made(&meshes::plane(1), &hills, &geometry);
        let fit = surface.fit.expect("a tolerance was asked for");
        assert!(surface.triangles.len() as u64 <= most.max(2), "{most}: {}", surface.triangles.len());
        assert!(fit.budget_reached && fit.tolerance_local == fit.bound_local && fit.bound_local > 1e-5, "{fit:?}");
        assert!(most < 50 || surface.triangles.len() as u64 > most / 2, "{most}: {}", surface.triangles.len());
    }
}
