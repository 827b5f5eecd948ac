//! Directions of vertices against where displacement moves them.

use super::*;
use crate::{
    domain::{
        cancel::{Cancel, NoProgress},
        detail::{Detail, Layer, LayerSource},
        expression::Program,
        plan::SurfacePlan,
        request::{Base, Geometry, Normals, Refinement, SeamRule},
        weld::{PrimitiveInput, weld},
    },
    render::{Executor, JobContext, reference::ReferenceExecutor},
};

/// Two walls that meet at a right angle along y, each with normals of its own, and a third, bent one beside them.
fn walls() -> Mesh {
    let wall = |across: [[f32; 3]; 4], normals: [[f32; 3]; 2]| PrimitiveInput {
        positions: across.to_vec(),
        normals: Some(vec![normals[0], normals[1], normals[1], normals[0]]),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..PrimitiveInput::default()
    };
    let floor = wall([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]], [[0.0, 0.0, 1.0]; 2]);
    let side = wall([[1.0, 0.0, 0.0], [1.0, 0.0, -1.0], [1.0, 1.0, -1.0], [1.0, 1.0, 0.0]], [[1.0, 0.0, 0.0]; 2]);
    let bent = [[0.0, 0.0, 1.0], [-0.6, 0.0, 0.8]];
    let ramp = wall([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 1.0, -0.5], [-1.0, 0.0, -0.5]], [bent[0], bent[1]]);
    let ramp = PrimitiveInput { normals: Some(vec![bent[0], bent[0], bent[1], bent[1]]), ..ramp };
    weld("walls", &[floor, side, ramp]).expect("a mesh")
}

fn surface(mesh: &Mesh, level: u32, formula: Option<&str>) -> Surface {
    let geometry = Geometry {
        refinement: Refinement::Uniform(level),
        max_triangles: None,
        normals: Normals::Analytic,
        seams: SeamRule::Mean,
        feather_texels: 0.0,
        base: Base::Flat,
    };
    let plan = SurfacePlan::uniform(0, mesh, level, &geometry).expect("a plan");
    let detail = formula.map(|formula| {
        let source = LayerSource::Expression(Arc::new(Program::parse(formula).expect("a formula")));
        let layer = Layer { source, scale: 1.0, midlevel: 0.0, map_from_uv: Layer::map_from_uv(false) };
        Arc::new(Detail { layers: vec![layer], uv_set: 0 })
    });
    let job = JobContext { cancel: &Cancel::default(), progress: &NoProgress };
    let details = vec![detail; mesh.primitives.len()];
    ReferenceExecutor.displace(&job, &plan, mesh, &details).expect("a surface").0
}

#[test]
fn a_vertex_has_the_direction_that_a_height_of_one_moves_it_along() {
    let mesh = walls();
    let shell = ReliefSettings { silhouettes: Silhouettes::Shell, ..ReliefSettings::default() };
    for level in [0, 3] {
        let (base, moved) = (surface(&mesh, level, None), surface(&mesh, level, Some("1")));
        let directions = directions(&mesh, &base, shell);
        assert_eq!(directions.len(), base.positions.len());
        for (v, direction) in directions.iter().enumerate() {
            let way = [0, 1, 2].map(|k| moved.positions[v][k] - base.positions[v][k]);
            // Two roundings of places up to 2.
            let apart = way.iter().zip(direction).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(apart <= 4.0 * f32::EPSILON, "level {level}, vertex {v}: {way:?} {direction:?}");
        }
        let longest = directions.iter().map(|d| glam::Vec3::from(*d).length()).fold(0.0, f32::max);
        assert!((longest - 2.0f32.sqrt()).abs() < 1e-3, "the mitre of the right angle: {longest}");
    }
}

#[test]
fn outlines_that_stay_need_no_directions() {
    let mesh = walls();
    assert!(directions(&mesh, &surface(&mesh, 0, None), ReliefSettings::default()).is_empty());
}
