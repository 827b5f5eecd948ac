//! Budgets and counts of several meshes.

use super::*;
use crate::domain::{
    request::{Allowed, Base, ErrorAt, Normals, Quality, SeamRule},
    scene::SceneMesh,
    weld::{PrimitiveInput, weld},
};

const LIMITS: JobLimits = JobLimits { host_bytes: 1 << 30, device_bytes: 1 << 30, max_image_pixels: 16384 };

/// `count` triangles in a row.
fn mesh(count: u32) -> SceneMesh {
    let at = |k: u32| [k as f32 * 0.5, (k % 2) as f32, 0.0];
    let input = PrimitiveInput {
        normals: Some(vec![[0.0, 0.0, 1.0]; count as usize + 2]),
        positions: (0..count + 2).map(at).collect(),
        triangles: (0..count).map(|k| [k, k + 1, k + 2]).collect(),
        ..PrimitiveInput::default()
    };
    SceneMesh { gltf_mesh: 0, mesh: weld("strip", &[input]).unwrap() }
}

fn scene() -> Scene {
    Scene { meshes: vec![mesh(4), mesh(10), mesh(6)], diagonal: 5.0, ..Scene::default() }
}

fn geometry(refinement: Refinement, max_triangles: Option<u64>) -> Geometry {
    Geometry {
        refinement,
        max_triangles,
        normals: Normals::Analytic,
        seams: SeamRule::Mean,
        feather_texels: 0.0,
        base: Base::Flat,
    }
}

fn tolerance(max_triangles: Option<u64>) -> Geometry {
    let allowed = Allowed::Diagonal(1e-3);
    let tolerance = Tolerance { allowed, error_at: ErrorAt::Surface, quality: Quality::Normal };
    geometry(Refinement::Tolerance(tolerance), max_triangles)
}

fn surface(triangles: usize) -> Surface {
    Surface { positions: vec![[0.0; 3]; 3], triangles: vec![[0, 1, 2]; triangles], ..Surface::default() }
}

fn allowed(plan: &SurfacePlan) -> u64 {
    match &plan.tessellation {
        TessellationPlan::Tolerance(tolerance) => tolerance.max_triangles,
        TessellationPlan::Uniform { .. } => panic!("a tolerance was planned"),
    }
}

#[test]
fn each_mesh_gets_what_those_before_it_left_and_leaves_the_base_of_those_after() {
    let mut plans = Plans::make(&mut scene(), &tolerance(Some(100)), &LIMITS).unwrap();
    assert_eq!(allowed(plans.next(0)), 100 - 10 - 6);
    plans.made(0, &surface(50));
    assert_eq!(allowed(plans.next(1)), 100 - 50 - 6);
    plans.made(1, &surface(44));
    assert_eq!(allowed(plans.next(2)), 6);
    plans.made(2, &surface(6));
    assert_eq!((plans.triangles(), plans.vertices()), (100, 9));
}

#[test]
fn without_a_limit_the_memory_of_a_job_is_one() {
    let scarce = JobLimits { device_bytes: 300 * 400_000, ..LIMITS };
    let mut plans = Plans::make(&mut scene(), &tolerance(None), &scarce).unwrap();
    assert_eq!(allowed(plans.next(0)), 400_000);
    let scarce = JobLimits { host_bytes: 36 * 1000, ..LIMITS };
    let mut plans = Plans::make(&mut scene(), &tolerance(Some(u64::MAX)), &scarce).unwrap();
    assert_eq!(allowed(plans.next(0)), 1000 - 16);
}

#[test]
fn what_a_tolerance_takes_is_not_known_before() {
    let tolerance = Plans::make(&mut scene(), &tolerance(None), &LIMITS).unwrap();
    assert!(!tolerance.are_counted());
    assert_eq!(tolerance.triangles(), 20, "the least");
    let uniform = Plans::make(&mut scene(), &geometry(Refinement::Uniform(1), None), &LIMITS).unwrap();
    assert!(uniform.are_counted());
    assert_eq!(uniform.triangles(), 80);
}

#[test]
fn more_base_triangles_than_allowed_are_refused_by_name() {
    let refused = |geometry: Geometry, limits: &JobLimits| Plans::make(&mut scene(), &geometry, limits).err().unwrap();
    let error = refused(tolerance(Some(19)), &LIMITS);
    assert_eq!(error.field.as_deref(), Some("geometry.max_triangles"));
    assert!(error.message.contains("20 triangles before any is split, more than the 19"), "{error}");
    let error = refused(geometry(Refinement::Uniform(1), Some(79)), &LIMITS);
    assert!(error.message.contains("level 1 makes 80 triangles, more than the 79"), "{error}");
    let error = refused(tolerance(None), &JobLimits { device_bytes: 1000, ..LIMITS });
    assert_eq!(error.field.as_deref(), Some("geometry.tolerance"));
}
