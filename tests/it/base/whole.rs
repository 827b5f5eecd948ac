//! Whole surfaces over smooth bases.

use std::sync::Arc;

use displace_server::{
    domain::{
        detail::Detail,
        request::SeamRule,
        surface::{Place, Surface},
    },
    oracle::{
        invariants::{self, boundary_edges},
        surface as oracle,
    },
    render::Executor,
};
use displace_tests::{
    device,
    meshes::{self, TestMesh},
    surfaces::{detail, displace, expression, noise_height},
};
use glam::{DVec3, Vec3};

use super::*;

/// Three squares that meet in one edge, and a lone triangle that touches its end.
fn non_manifold() -> TestMesh {
    let mut mesh = meshes::plane(1);
    (mesh.name, mesh.positions) = ("non_manifold", Vec::new());
    (mesh.normals, mesh.uvs, mesh.triangles) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..3 {
        let (sin, cos) = (k as f32 * 2.1 + 0.3).sin_cos();
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([[0.0, 0.0, 0.0], [cos, 0.0, sin], [cos, 1.0, sin], [0.0, 1.0, 0.0]]);
        mesh.normals.extend([[-sin, 0.0, cos]; 4]);
        mesh.uvs.extend([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    let first = mesh.positions.len() as u32;
    mesh.positions.extend([[0.0, 1.0, 0.0], [0.5, 2.0, 0.0], [-0.5, 2.0, 0.25]]);
    mesh.normals.extend([[0.0, 0.0, 1.0]; 3]);
    mesh.uvs.extend([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]);
    mesh.triangles.push([first, first + 1, first + 2]);
    mesh
}

fn all_meshes() -> Vec<TestMesh> {
    meshes::all().into_iter().chain([non_manifold()]).collect()
}

fn check(executor: &dyn Executor, mesh: &TestMesh, detail: &Arc<Detail>, geometry: &Geometry) {
    let base = bent(mesh, geometry.base);
    let surface = displace(executor, &base, detail, geometry);
    let what = format!("{} on {}, {geometry:?}", mesh.name, executor.device_name());
    assert_eq!(invariants::largest_gap(&base, &surface), 0.0, "{what}");
    let expected = boundary_edges(&mesh.positions, &mesh.triangles) << 3;
    assert_eq!(boundary_edges(&surface.positions, &surface.triangles), expected, "{what}");
    let euler = invariants::euler_characteristic(&mesh.positions, &mesh.triangles);
    assert_eq!(invariants::euler_characteristic(&surface.positions, &surface.triangles), euler, "{what}");
}

fn check_all(executor: &dyn Executor) {
    let details = [detail(noise_height(64, 1), 0.07), detail(expression("0.0*x"), 1.0)];
    for mesh in all_meshes() {
        for base in SMOOTH {
            for (detail, feather_texels) in [(&details[0], 3.0), (&details[0], 0.0), (&details[1], 3.0)] {
                check(executor, &mesh, detail, &Geometry { feather_texels, ..geometry(3, base) });
            }
        }
    }
}

/// Distances of fine vertices from where the oracle has them, and of their normals from its, worst but for one in a hundred.
fn from_oracle(mesh: &Mesh, detail: &Arc<Detail>, geometry: &Geometry, surface: &Surface) -> [f64; 2] {
    let details = vec![Some(Arc::clone(detail)); mesh.primitives.len()];
    let truth = oracle::Surface::new(mesh, &details, oracle::SeamChoice::from(geometry));
    let (mut places, mut normals) = (Vec::new(), Vec::new());
    for t in 0..mesh.triangles.len() {
        for vertex in surface.triangles[surface.triangles_of(t)].iter().flatten() {
            let Place::Inside { b: [b1, b2], .. } = surface.layout.place(mesh, *vertex as usize) else { continue };
            let [b1, b2] = [b1, b2].map(|b| f64::from(b) / f64::from(1 << 24));
            let (place, normal) = truth.position_and_normal(t, DVec3::new(1.0 - b1 - b2, b1, b2));
            let own = |of: &[[f32; 3]]| DVec3::from_array(of[*vertex as usize].map(f64::from));
            places.push(own(&surface.positions).distance(place));
            normals.push(own(&surface.normals).distance(normal));
        }
    }
    let nearly_worst = |mut all: Vec<f64>| {
        all.sort_by(f64::total_cmp);
        all[(all.len() - 1) * 99 / 100]
    };
    [nearly_worst(places), nearly_worst(normals)]
}

#[test]
fn the_oracle_has_the_same_surface_and_normals() {
    let details = [detail(noise_height(16, 1), 0.05), detail(expression("0.1*sin(9*u+x)*ny"), 1.0)];
    let meshes = [meshes::cube(), meshes::torus(8, 5), meshes::moebius(8, 2), meshes::icosphere(1), non_manifold()];
    for (mesh, base) in meshes.iter().flat_map(|mesh| SMOOTH.map(|base| (mesh, base))) {
        let own = bent(mesh, base);
        for detail in &details {
            let surface = displace(&*device::reference(), &own, detail, &geometry(2, base));
            let [place, normal] = from_oracle(&own, detail, &geometry(2, base), &surface);
            assert!(place < 1e-6, "{} {base:?}: {place:e}", mesh.name);
            assert!(normal < 1e-5, "{} {base:?}: {normal:e}", mesh.name);
        }
    }
}

#[test]
fn no_base_opens_a_crack() {
    check_all(&*device::reference());
    if let Some(executor) = device::executor("watertightness of smooth bases") {
        check_all(&*executor);
    }
}

#[test]
fn devices_agree_on_every_base_with_the_reference() {
    let Some(executor) = device::executor("smooth bases") else { return };
    let details = [detail(noise_height(64, 1), 0.05), detail(expression("0.1*sin(9*u+x)*ny"), 1.0)];
    for (mesh, base) in all_meshes().iter().flat_map(|mesh| SMOOTH.map(|base| (mesh, base))) {
        let own = bent(mesh, base);
        for (detail, seams) in details.iter().zip([SeamRule::Mean, SeamRule::Dominant]) {
            let geometry = Geometry { seams, ..geometry(3, base) };
            let [found, twin] =
                [&*executor, &*device::reference()].map(|executor| displace(executor, &own, detail, &geometry));
            let apart = |a: &[[f32; 3]], b: &[[f32; 3]]| -> Vec<f32> {
                let mut all: Vec<f32> = a.iter().zip(b).map(|(a, b)| Vec3::from(*a).distance(Vec3::from(*b))).collect();
                all.sort_by(f32::total_cmp);
                all
            };
            let (places, normals) = (apart(&found.positions, &twin.positions), apart(&found.normals, &twin.normals));
            let what = format!("{} {base:?}", mesh.name);
            assert!(places[places.len() - 1] < 2e-5, "{what}: positions {}", places[places.len() - 1]);
            let nearly_all = normals[(normals.len() - 1) * 99 / 100];
            assert!(nearly_all < 2e-3, "{what}: normals {nearly_all}");
            assert_eq!(found.triangles, twin.triangles, "{what}");
            let again = displace(&*executor, &own, detail, &geometry);
            assert!(again.positions == found.positions && again.normals == found.normals, "{what}: not the same twice");
        }
    }
}
