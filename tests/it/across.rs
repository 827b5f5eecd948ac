//! Bases that are denser than their tolerance asks for: results with fewer triangles than the base, which keep the
//! tolerance, close where it is closed, and are the same whenever they are made.

use std::sync::Arc;

use displace_server::{
    domain::{
        detail::Detail,
        request::{Allowed, ErrorAt, Geometry, Quality, Refinement, Tolerance},
        surface::Surface,
    },
    oracle::invariants,
};
use displace_tests::{
    cli::Run,
    device, glb, maps,
    meshes::{self, TestMesh},
    server,
    surfaces::{constant_height, detail, displace, expression, uniform},
};

/// World units.
fn within(tolerance: f64, quality: Quality) -> Geometry {
    let tolerance = Tolerance { allowed: Allowed::World(tolerance), error_at: ErrorAt::Surface, quality };
    Geometry { refinement: Refinement::Tolerance(tolerance), max_triangles: Some(1 << 20), ..uniform(0) }
}

fn flat() -> Arc<Detail> {
    detail(constant_height(0.0), 0.0)
}

fn waves() -> Arc<Detail> {
    detail(expression("sin(5*x)*cos(4*y+z)"), 0.03)
}

fn made(mesh: &TestMesh, detail: &Arc<Detail>, tolerance: f64) -> Surface {
    made_at(mesh, detail, tolerance, Quality::Normal)
}

fn made_at(mesh: &TestMesh, detail: &Arc<Detail>, tolerance: f64, quality: Quality) -> Surface {
    displace(&*device::reference(), &mesh.to_mesh_without_tangents(), detail, &within(tolerance, quality))
}

#[test]
fn dense_bases_get_far_fewer_triangles_than_they_have_and_nothing_opens() {
    let cases = [(meshes::torus(72, 36), flat()), (meshes::torus(72, 36), waves()), (meshes::icosphere(4), flat())];
    let at = |quality, share| cases.iter().map(move |case| (case, quality, share));
    for ((mesh, detail), quality, share) in at(Quality::Normal, 2).chain(at(Quality::High, 4)) {
        let surface = made_at(mesh, detail, 0.03, quality);
        let fit = surface.fit.expect("a tolerance was asked for");
        let (base, found) = (mesh.triangles.len(), surface.triangles.len());
        assert!(found * share < base, "{} at {quality:?}: {found} of {base}", mesh.name);
        assert!(fit.certified && fit.bound_local <= 0.03 && !fit.budget_reached, "{}: {fit:?}", mesh.name);
        assert_eq!(invariants::of_surface(&mesh.to_mesh_without_tangents(), &surface), [], "{}", mesh.name);
        assert_eq!(surface.flipped, 0, "{}", mesh.name);
        assert!(surface.layout.is_spanning() && surface.vertices_used() < surface.positions.len() as u64);
    }
}

#[test]
fn borders_stay_as_they_are() {
    let plane = meshes::plane(32);
    let surface = made(&plane, &flat(), 0.01);
    assert!(surface.triangles.len() < 200, "{} triangles", surface.triangles.len());
    assert_eq!(invariants::boundary_edges(&surface.positions, &surface.triangles), 4 * 32);
}

#[test]
fn detail_that_needs_more_triangles_than_the_base_is_tessellated_as_before() {
    let surface = made(&meshes::torus(36, 18), &waves(), 2e-3);
    assert!(!surface.layout.is_spanning());
}

#[test]
fn the_same_comes_out_again_on_one_thread_and_of_another_order() {
    let torus = meshes::torus(60, 30);
    let triangles = |surface: &Surface| {
        let corners = |t: &[u32; 3]| t.map(|v| surface.positions[v as usize].map(f32::to_bits));
        let mut all: Vec<_> = surface.triangles.iter().map(corners).collect();
        all.iter_mut().for_each(|t| t.sort_unstable());
        all.sort_unstable();
        all
    };
    let first = made(&torus, &waves(), 0.03);
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    assert_eq!(alone.install(|| made(&torus, &waves(), 0.03)), first);
    assert!(triangles(&made(&torus.permuted(7), &waves(), 0.03)) == triangles(&first));
}

/// A torus of 5000 triangles and noise in a folder.
struct Case {
    folder: tempfile::TempDir,
}

impl Case {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join("torus.glb"), meshes::torus(72, 36).to_glb()).expect("it is written");
        std::fs::write(folder.path().join("noise.png"), maps::noise16(12, 3)).expect("it is written");
        Self { folder }
    }

    fn path(&self, name: &str) -> String {
        self.folder.path().join(name).to_str().expect("temporary folders are UTF-8").to_owned()
    }

    fn run(&self, command: &str, more: &[&str]) -> Run {
        let [mesh, map] = ["torus.glb", "noise.png"].map(|name| self.path(name));
        let first = [command, &mesh, "--height", &map, "--scale", "0.02"];
        let more = more.iter().map(|word| if word.ends_with(".glb") { self.path(word) } else { (*word).to_owned() });
        let last = ["--json", "--server", server::reference()].map(str::to_owned);
        let words: Vec<String> = first.map(str::to_owned).into_iter().chain(more).chain(last).collect();
        server::displace(&words.iter().map(String::as_str).collect::<Vec<_>>())
    }
}

#[test]
fn the_oracle_measures_no_more_than_was_allowed_in_the_file() {
    let case = Case::new();
    let report = case.run("apply", &["--tolerance", "0.015", "-o", "out.glb"]).expect_success().json();
    let count = |name: &str| report[name].as_u64().expect("a count");
    assert!(count("triangles") * 4 < count("triangles_in"), "{report}");
    let passes = report["passes"].as_array().expect("passes");
    assert!(passes.iter().any(|pass| pass["name"] == "simplify_across"), "{report}");
    let file = glb::joined(&glb::read(&std::fs::read(case.path("out.glb")).expect("it is there")));
    assert_eq!([file.positions.len() as u64, file.triangles.len() as u64], [count("vertices"), count("triangles")]);
    let measured = case.run("measure", &["out.glb", "--precision", "0.001"]).expect_success().json();
    let length = |value: &serde_json::Value| value.as_f64().expect("a length");
    let share = length(&measured["hausdorff"]["hi"]) / length(&measured["diagonal"]);
    assert!(share <= 0.016, "{share}");
    assert!(length(&measured["hausdorff"]["lo"]) / length(&measured["diagonal"]) <= 0.015, "{measured}");
}

#[test]
fn maps_of_normals_and_views_keep_base_triangles() {
    let case = Case::new();
    let spared: [&[&str]; 2] =
        [&["--tolerance", "0.015", "--normals", "map"], &["--tolerance-px", "8", "--view", "3,2,3;0,0,0;40;320x240"]];
    for flags in spared {
        let report = case.run("apply", &[flags, &["-o", "out.glb"]].concat()).expect_success().json();
        assert!(report["triangles"].as_u64() >= report["triangles_in"].as_u64(), "{flags:?}: {report}");
    }
}
