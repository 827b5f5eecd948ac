//! No crack, whatever the map: after displacement by white noise the boundary edges by exact position are
//! the input's, and vertices of one place share every bit of their position. Closed forms are exact.

use std::sync::Arc;

use displace_server::{
    domain::{
        detail::Detail,
        request::{Geometry, SeamRule},
        surface::Surface,
    },
    oracle::invariants::{self, boundary_edges},
    render::Executor,
};
use displace_tests::{
    data::sample,
    device,
    glb::{self, Part},
    maps,
    meshes::{self, TestMesh},
    server,
    surfaces::{constant_height, detail, displace, noise_height, plan, uniform},
};

const LEVEL: u32 = 3;

/// Displaces `mesh` and checks what every result must keep.
fn check(executor: &dyn Executor, mesh: &TestMesh, detail: &Arc<Detail>, geometry: &Geometry) -> Surface {
    let base = mesh.to_mesh();
    let surface = displace(executor, &base, detail, geometry);
    let what = format!("{} on {}, {geometry:?}", mesh.name, executor.device_name());
    assert_eq!(invariants::of_surface(&base, &surface), [], "{what}");
    assert_eq!(invariants::largest_gap(&base, &surface), 0.0, "{what}");
    // Against the test mesh itself, whatever welding made of it.
    let level = plan(&base, geometry).expect("a test's plan fits").tessellation.lattice_level();
    let expected = boundary_edges(&mesh.positions, &mesh.triangles) << level;
    assert_eq!(boundary_edges(&surface.positions, &surface.triangles), expected, "{what}");
    let euler = invariants::euler_characteristic(&mesh.positions, &mesh.triangles);
    assert_eq!(invariants::euler_characteristic(&surface.positions, &surface.triangles), euler, "{what}");
    surface
}

fn check_all(executor: &dyn Executor) {
    let noise = detail(noise_height(64, 1), 0.07);
    for mesh in meshes::all() {
        for (seams, feather_texels) in [(SeamRule::Mean, 3.0), (SeamRule::Mean, 0.0), (SeamRule::Dominant, 3.0)] {
            check(executor, &mesh, &noise, &Geometry { seams, feather_texels, ..uniform(LEVEL) });
        }
    }
}

#[test]
fn noise_opens_no_crack_in_any_mesh() {
    if let Some(executor) = device::executor("watertightness") {
        check_all(&*executor);
    }
}

#[test]
fn noise_opens_no_crack_on_the_reference_device() {
    check_all(&*device::reference());
}

#[test]
fn every_level_is_watertight_from_none_to_deep() {
    let Some(executor) = device::executor("watertightness by level") else { return };
    let noise = detail(noise_height(64, 2), 0.05);
    for level in 0..=6 {
        check(&*executor, &meshes::cube(), &noise, &uniform(level));
        check(&*executor, &meshes::moebius(8, 2), &noise, &uniform(level));
    }
}

#[test]
fn a_cube_of_constant_height_keeps_its_sharp_corners_exactly() {
    let Some(executor) = device::executor("the cube's closed form") else { return };
    for executor in [executor, device::reference()] {
        let surface = check(&*executor, &meshes::cube(), &detail(constant_height(1.0), 0.25), &uniform(4));
        for position in &surface.positions {
            let outermost = position.iter().fold(0f32, |most, x| most.max(x.abs()));
            assert_eq!(outermost, 0.75, "{position:?} is not on the cube of side 1.5");
        }
        let corners = surface.positions.iter().filter(|p| p.iter().all(|x| x.abs() == 0.75)).count();
        assert_eq!(corners, 24, "eight corners with three looks each");
    }
}

#[test]
fn a_smooth_sphere_of_constant_height_offsets_to_a_sphere() {
    let Some(executor) = device::executor("the sphere's closed form") else { return };
    let sphere = meshes::icosphere(2);
    let flat = displace(&*executor, &sphere.to_mesh(), &detail(constant_height(0.0), 1.0), &uniform(LEVEL));
    let offset = displace(&*executor, &sphere.to_mesh(), &detail(constant_height(1.0), 0.25), &uniform(LEVEL));
    // Corners lie on the sphere; between them the base is flat, and the offset is along the radius.
    for (vertex, (base, moved)) in flat.positions.iter().zip(&offset.positions).enumerate() {
        let (base, moved) = (glam::Vec3::from(*base), glam::Vec3::from(*moved));
        assert!((moved.length() - base.length() - 0.25).abs() < 1e-6, "vertex {vertex}: {base} to {moved}");
        assert!(moved.normalize().distance(base.normalize()) < 1e-6, "vertex {vertex} leaves its radius");
    }
    for corner in &offset.positions[..sphere.to_mesh().av_gv.len()] {
        assert!((glam::Vec3::from(*corner).length() - 1.25).abs() < 1e-6);
    }
}

/// Displaces a file by a 16-bit noise PNG with the command line; the triangles before and after.
fn apply(name: &str, input: &std::path::Path, before: &Part) -> Part {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (map, out) = (folder.path().join("noise.png"), folder.path().join("out.glb"));
    std::fs::write(&map, maps::noise16(64, 3)).expect("the map can be written");
    let (input, map, out_text) = (input.to_string_lossy(), map.to_string_lossy(), out.to_string_lossy());
    let args = ["apply", &*input, "--height", &*map, "--scale", "0.05", "--uniform", "3", "-o", &*out_text];
    let _ = server::displace(&[&args[..], &["--server", server::validated()]].concat()).expect_success();
    let after = glb::joined(&glb::read(&std::fs::read(&out).expect("the result was written")));
    assert_eq!(after.triangles.len(), before.triangles.len() << 6, "{name}");
    after
}

fn check_file(name: &str, input: &std::path::Path, before: &Part) {
    let after = apply(name, input, before);
    assert_eq!(invariants::not_finite("positions_finite", &after.positions), None, "{name}");
    assert_eq!(invariants::not_finite("normals_finite", &after.normals), None, "{name}");
    let expected = boundary_edges(&before.positions, &before.triangles) << 3;
    assert_eq!(boundary_edges(&after.positions, &after.triangles), expected, "{name}");
}

#[test]
fn written_files_are_watertight() {
    if device::without_gpu("watertightness of files") {
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    for mesh in meshes::all() {
        let input = folder.path().join(format!("{}.glb", mesh.name));
        let bytes = mesh.to_glb();
        std::fs::write(&input, &bytes).expect("the mesh can be written");
        check_file(mesh.name, &input, &glb::joined(&glb::read(&bytes)));
    }
    for name in ["models/Suzanne/Suzanne.gltf", "models/torus.gltf"] {
        check_file(name, &sample(name), &glb::joined(&glb::read_gltf(&sample(name))));
    }
}
