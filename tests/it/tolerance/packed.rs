//! Packed results, read back from the file as viewers read them: on the grid they keep the tolerance too, and no edge
//! opens. With seams without ramps, they keep what the report says.

use displace_server::{
    domain::gltf::{Limits, load},
    oracle::invariants::boundary_edges,
};
use displace_tests::{
    cli::Run,
    maps,
    meshes::{self, TestMesh},
    server,
};
use serde_json::Value;

/// A mesh and a map in a folder, and how the map is laid on.
struct Case {
    name: String,
    folder: tempfile::TempDir,
    flags: Vec<&'static str>,
}

impl Case {
    fn new(mesh: &TestMesh, map: &[u8], flags: &[&'static str]) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join("mesh.glb"), mesh.to_glb()).expect("it is written");
        std::fs::write(folder.path().join("map.png"), map).expect("it is written");
        Self { name: format!("{} {flags:?}", mesh.name), folder, flags: flags.to_vec() }
    }

    fn run(&self, command: &str, more: &[&str]) -> Run {
        let path = |name: &str| self.folder.path().join(name).to_str().expect("paths are UTF-8").to_owned();
        let files = ["mesh.glb", "map.png", "out.glb"].map(path);
        let args = [command, &files[0], "--height", &files[1], "--scale", "0.1", "--json", "--server"];
        let out: &[&str] = if command == "apply" { &["-o", &files[2]] } else { &[&files[2]] };
        server::displace(&[&args[..], &[server::reference()], &self.flags[..], out, more].concat())
    }

    fn apply(&self, compress: &str) -> Value {
        self.run("apply", &["--tolerance-world", TOLERANCE, "--compress", compress]).expect_success().json()
    }

    /// The Hausdorff distance of the file from the surface, at least; world units.
    fn distance(&self) -> f64 {
        let report = self.run("measure", &["--precision", "1e-2"]).expect_success().json();
        report["hausdorff"]["lo"].as_f64().expect("a length")
    }

    /// Of the file.
    fn borders(&self) -> u64 {
        let bytes = std::fs::read(self.folder.path().join("out.glb")).expect("it is there");
        let scene = load(&bytes.into(), &|_| None, &Limits::default()).expect("the result loads");
        let mesh = &scene.meshes[0].mesh;
        let corners = mesh.triangles.iter().map(|t| t.av.map(|av| mesh.av_gv[av as usize]));
        boundary_edges(&mesh.gv_position, &corners.collect::<Vec<_>>())
    }
}

const TOLERANCE: &str = "0.03";

fn figure(report: &Value, at: &str) -> f64 {
    report.pointer(at).and_then(Value::as_f64).unwrap_or_else(|| panic!("no {at} in {report}"))
}

/// Whether the tolerance is kept, or less as the report says. The files of these packings are measured as well.
fn check(case: &Case, measured: &[&str]) -> bool {
    case.apply("none");
    let borders = case.borders();
    let mut kept = true;
    for compress in ["quantize", "meshopt"] {
        let report = case.apply(compress);
        let what = format!("{} {compress}", case.name);
        let (bound, asked) = (figure(&report, "/accuracy/bound"), figure(&report, "/tolerance"));
        let sampled = figure(&report, "/accuracy/measured");
        assert!(sampled <= bound && sampled > 0.1 * asked, "{what}: {sampled} {report}");
        assert_eq!(case.borders(), borders, "{what}");
        if measured.contains(&compress) {
            let found = case.distance();
            assert!(found <= bound && found > 0.1 * asked, "{what}: {found} {report}");
        }
        assert!(!report["warnings"].to_string().contains("positions_not_quantized"), "{what}: {report}");
        kept &= bound <= asked;
    }
    kept
}

#[test]
fn packed_results_keep_their_tolerance_and_no_edge_opens() {
    for (mesh, map, flags, measured) in [
        (meshes::plane(1), maps::noise16(6, 1), &["--wrap", "mirror"][..], &["meshopt"][..]),
        (meshes::cube(), maps::noise16(4, 2), &["--sampling", "node"], &[]),
        (meshes::torus(8, 5), maps::noise16(9, 3), &["--seams", "dominant"], &[]),
        (meshes::moebius(8, 2), maps::noise16(8, 4), &["--feather", "1"], &[]),
    ] {
        let case = Case::new(&mesh, &map, flags);
        assert!(check(&case, measured), "{}", case.name);
    }
}

#[test]
fn seams_without_ramps_are_as_near_as_the_report_says() {
    let mut kept = Vec::new();
    for mesh in [meshes::plane(2), meshes::cube(), meshes::torus(8, 5)] {
        kept.push(check(&Case::new(&mesh, &maps::noise16(8, 5), &["--feather", "0"]), &[]));
    }
    // A plane of one chart has no seams to leave open; the sides of those of a cube differ.
    assert_eq!(kept[..2], [true, false]);
}
