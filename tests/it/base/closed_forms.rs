//! What each base makes of meshes whose smooth surface is known.

use displace_tests::{
    device, meshes,
    surfaces::{detail, displace, expression},
};
use glam::Vec3;

use super::*;

/// The undisplaced base after `level` subdivisions, on the reference device.
fn places(mesh: &TestMesh, base: Base, level: u32) -> (Vec<Vec3>, Vec<Vec3>) {
    let nothing = detail(expression("0.0*x"), 1.0);
    let surface = displace(&*device::reference(), &bent(mesh, base), &nothing, &geometry(level, base));
    let vectors = |of: &[[f32; 3]]| of.iter().map(|p| Vec3::from(*p)).collect();
    (vectors(&surface.positions), vectors(&surface.normals))
}

/// Positions of corners, then of the middles of edges.
fn radii(base: Base) -> [f32; 2] {
    let mesh = meshes::icosphere(0);
    let (all, _) = places(&mesh, base, 1);
    [all[0].length(), all[mesh.to_mesh().av_gv.len()].length()]
}

#[test]
fn a_plane_stays_that_plane() {
    for base in SMOOTH {
        let (all, normals) = places(&meshes::plane(4), base, 3);
        assert!(all.iter().all(|p| p.y == 0.0 && p.x.abs() <= 0.5 && p.z.abs() <= 0.5), "{base:?}");
        assert!(normals.iter().all(|n| n.distance(Vec3::Y) < 1e-6), "{base:?}");
    }
    let [flat, pn, phong] = [Base::Flat, Base::Pn, Base::Phong].map(|base| places(&meshes::plane(4), base, 3).0);
    for other in [pn, phong] {
        assert!(flat.iter().zip(&other).all(|(a, b)| a.distance(*b) < 1e-6));
    }
}

#[test]
fn a_cube_with_hard_edges_stays_that_cube_where_normals_decide() {
    for base in [Base::Pn, Base::Phong] {
        let (all, _) = places(&meshes::cube(), base, 3);
        for p in all {
            assert!((p.abs().max_element() - 0.5).abs() < 1e-6, "{base:?}: {p}");
        }
    }
    let (all, normals) = places(&meshes::cube(), Base::Loop, 3);
    assert!(all.iter().all(|p| p.abs().max_element() < 0.45), "the limit of a cube lies within it");
    assert!(all.iter().zip(&normals).all(|(p, n)| n.dot(p.normalize()) > 0.8), "and is smooth");
}

#[test]
fn an_icosahedron_comes_as_near_to_its_sphere_as_the_formulas_say() {
    // Between neighbouring corners of the icosahedron.
    let cosine = 0.2f64.sqrt();
    let middle = (2.0 + 2.0 * cosine).sqrt();
    let beta = (0.625 - (0.375 + 0.25 * (std::f64::consts::TAU / 5.0).cos()).powi(2)) / 5.0;
    let near = |found: f32, wanted: f64, what: &str| {
        assert!((f64::from(found) - wanted).abs() < 1e-6, "{what}: {found} not {wanted}")
    };
    let [corner, edge] = radii(Base::Pn);
    near(corner, 1.0, "pn corner");
    near(edge, middle * (5.0 - cosine) / 8.0, "pn edge");
    let [corner, edge] = radii(Base::Phong);
    near(corner, 1.0, "phong corner");
    near(edge, middle * (2.0 + 0.75 * (1.0 - cosine)) / 4.0, "phong edge");
    let [corner, _] = radii(Base::Loop);
    near(corner, (3.0 + 40.0 * beta * cosine) / (3.0 + 40.0 * beta), "loop corner");
}

#[test]
fn normals_of_a_smooth_base_are_those_of_its_sphere_nearly() {
    for (base, most) in [(Base::Pn, 0.02), (Base::Phong, 0.02), (Base::Loop, 0.04)] {
        let (all, normals) = places(&meshes::icosphere(1), base, 3);
        let worst = all.iter().zip(&normals).map(|(p, n)| n.distance(p.normalize())).fold(0.0, f32::max);
        assert!(worst < most, "{base:?}: {worst}");
    }
}
