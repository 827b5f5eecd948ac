//! Normal maps, read back from the files as a viewer reads them and held against the oracle's surface.

mod reader;

use displace_tests::{
    cli::Run,
    data::sample,
    device::without_gpu,
    glb,
    meshes::{self, TestMesh},
    server,
    surfaces::{detail, expression},
};
use reader::{Reader, quantile};
use serde_json::{Value, json};

/// Repeats over the seams of a torus.
const WAVES: &str = "0.03*sin(14*pi*u)*cos(10*pi*v)";

/// A mesh in a folder.
struct Case {
    folder: tempfile::TempDir,
}

impl Case {
    fn new(bytes: &[u8]) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join("mesh.glb"), bytes).expect("it is written");
        Self { folder }
    }

    fn path(&self, name: &str) -> String {
        self.folder.path().join(name).to_str().expect("temporary folders are UTF-8").to_owned()
    }

    fn run_at(&self, url: &str, flags: &[&str]) -> Run {
        let (mesh, out) = (self.path("mesh.glb"), self.path("out.glb"));
        let args = ["apply", &mesh, "-o", &out, "--json", "--server", url, "--normals", "map"];
        server::displace(&[&args, flags].concat())
    }

    fn run(&self, flags: &[&str]) -> Run {
        self.run_at(server::reference(), flags)
    }

    /// The report, and the file.
    fn apply(&self, flags: &[&str]) -> (Value, Vec<u8>) {
        let report = self.run(flags).expect_success().json();
        (report, std::fs::read(self.path("out.glb")).expect("it is there"))
    }
}

/// Median and 99 % of the angles between the oracle's normals and those seen with the map and without.
fn angles(mesh: &TestMesh, file: &[u8], level: usize) -> [[f64; 2]; 2] {
    let reader = Reader::open(file, level);
    let found = reader.angles_degrees(&mesh.to_mesh_without_tangents(), &detail(expression(WAVES), 1.0));
    found.map(|angles| [quantile(&angles, 0.5), quantile(&angles, 0.99)])
}

fn angle_of(report: &Value, map: usize, which: &str) -> f64 {
    report["normal_maps"][map]["angle_deg"][which].as_f64().expect("an angle")
}

#[test]
fn shading_comes_nearer_to_the_surface_with_every_doubling_of_the_map() {
    for mesh in [meshes::plane(3), meshes::torus(24, 12), meshes::concave_cylinder(24, 6)] {
        let case = Case::new(&mesh.to_glb());
        let mut before = [f64::INFINITY; 2];
        for size in ["64", "128", "256", "512"] {
            let flags = ["--expr", WAVES, "--tolerance", "3e-2", "--normal-map-size", size];
            let (report, file) = case.apply(&flags);
            let [seen, plain] = angles(&mesh, &file, 0);
            let what = format!("{} {size}: {seen:?} plain {plain:?}", mesh.name);
            // 8 bits take two tenths of a degree.
            assert!(seen[0] < (0.6 * before[0]).max(0.25) && seen[1] < 0.9 * before[1], "{what} after {before:?}");
            assert!((angle_of(&report, 0, "p50") - seen[0]).abs() < 0.1 + 0.1 * seen[0], "{what} {report}");
            before = seen;
            if size == "512" {
                assert!(seen[0] < 0.25 && plain[0] > 20.0 * seen[0] && plain[1] > 5.0 * seen[1], "{what}");
            }
        }
    }
}

#[test]
fn a_packed_file_shows_the_same() {
    let mesh = meshes::torus(24, 12);
    let case = Case::new(&mesh.to_glb());
    for compress in ["quantize", "meshopt"] {
        let flags = ["--expr", WAVES, "--tolerance", "8e-3", "--normal-map-size", "256", "--compress", compress];
        let [seen, _] = angles(&mesh, &case.apply(&flags).1, 0);
        assert!(seen[0] < 0.5 && seen[1] < 4.0, "{compress}: {seen:?}");
    }
}

#[test]
fn every_level_of_detail_has_a_map_of_its_own_half_as_large() {
    let mesh = meshes::torus(24, 12);
    let case = Case::new(&mesh.to_glb());
    let flags = ["--expr", WAVES, "--tolerance", "2e-3", "--normal-map-size", "512", "--lods", "2"];
    let (report, file) = case.apply(&flags);
    let maps = report["normal_maps"].as_array().expect("maps");
    let figures = |map: &Value| (map["lod"].as_u64(), map["width"].as_u64(), map["height"].as_u64());
    assert_eq!(maps.iter().map(figures).collect::<Vec<_>>(), [0, 1].map(|k| (Some(k), Some(512 >> k), Some(512 >> k))));
    for level in 0..2 {
        let [seen, plain] = angles(&mesh, &file, level);
        assert!(seen[0] < 0.6 && plain[0] > 3.0 * seen[0], "{level}: {seen:?} plain {plain:?}");
    }
}

#[test]
fn the_device_makes_the_map_that_its_twin_makes() {
    if without_gpu("a normal map") {
        return;
    }
    let case = Case::new(&meshes::torus(24, 12).to_glb());
    let flags = ["--expr", WAVES, "--uniform", "1", "--normal-map-size", "128"];
    let device = case.run_at(server::validated(), &flags).expect_success().json();
    let twin = case.apply(&flags).0;
    for which in ["p50", "p99"] {
        assert!((angle_of(&device, 0, which) - angle_of(&twin, 0, which)).abs() < 0.02, "{device} {twin}");
    }
}

#[test]
fn a_displaced_primitive_gets_a_material_of_its_own() {
    let path = sample("models/TwoSidedPlane/TwoSidedPlane.gltf").to_string_lossy().into_owned();
    let case = Case::new(&[]);
    let out = case.path("out.glb");
    let args =
        ["apply", &path, "--expr", "0.1*sin(9*u)", "--uniform", "2", "--normals", "map", "--normal-map-size", "16"];
    let tail = ["-o", &out, "--json", "--server", server::reference()];
    let report = server::displace(&[&args[..], &tail].concat()).expect_success().json();
    let codes: Vec<&Value> = report["warnings"].as_array().expect("warnings").iter().map(|w| &w["code"]).collect();
    assert!(codes.contains(&&json!("normal_map_replaced")), "{report}");
    let document = reader::document(&std::fs::read(&out).expect("it is there"));
    let materials = document["materials"].as_array().expect("materials");
    assert_eq!((materials.len(), &document["meshes"][0]["primitives"][0]["material"]), (2, &json!(1)));
    assert_ne!(materials[0]["normalTexture"]["index"], materials[1]["normalTexture"]["index"]);
    assert_eq!(materials[0]["pbrMetallicRoughness"], materials[1]["pbrMetallicRoughness"]);
}

#[test]
fn places_that_share_texels_are_refused_where_they_differ_and_taken_where_they_agree() {
    let mut mesh = meshes::plane(2);
    let copy = mesh.triangles.iter().map(|t| t.map(|v| v + mesh.positions.len() as u32)).collect::<Vec<_>>();
    mesh.positions.extend(mesh.positions.clone().iter().map(|[x, y, z]| [x + 5.0, *y, *z]));
    (mesh.normals, mesh.uvs) = (mesh.normals.repeat(2), mesh.uvs.repeat(2));
    mesh.triangles.extend(copy);
    let case = Case::new(&mesh.to_glb());
    // Triangles as fine as the surface leave nothing to differ by.
    let flags = |expression: &'static str| ["--expr", expression, "--uniform", "0", "--normal-map-size", "64"];
    let run = case.run(&flags("0.1*sin(9*x)"));
    let error = &run.json()["error"];
    assert_eq!((run.code, error["field"].as_str()), (Some(2), Some("geometry.normals")), "{run:?}");
    for part in ["TEXCOORD_0", "5 degrees", "unwrap", "analytic"] {
        assert!(error["message"].as_str().expect("a message").contains(part), "{part}: {error}");
    }
    let (report, _) = case.apply(&flags("0.1*sin(9*u)*v"));
    assert_eq!(report["normal_maps"][0]["coverage"], 1.0);
}

#[test]
fn a_mesh_without_coordinates_and_sizes_without_maps_are_refused() {
    let (mut document, bin) = reader::split(&meshes::plane(1).to_glb());
    document["meshes"][0]["primitives"][0]["attributes"].as_object_mut().expect("attributes").remove("TEXCOORD_0");
    let case = Case::new(&glb::pack(&document, &bin));
    let run = case.run(&["--expr", "0.1*x", "--uniform", "1"]);
    assert_eq!((run.code, run.json()["error"]["field"].as_str()), (Some(2), Some("geometry.normals")), "{run:?}");
    let refused = |args: &[&str]| {
        let (mesh, out) = (case.path("mesh.glb"), case.path("out.png"));
        let all =
            [&args[..1], &[&mesh, "-o", &out, "--expr", "0.1*x", "--uniform", "1", "--json"], &args[1..]].concat();
        let run = server::displace(&[&all[..], &["--server", server::reference()]].concat());
        assert_eq!(run.code, Some(2), "{run:?}");
        run.json()["error"]["field"].as_str().map(str::to_owned)
    };
    assert_eq!(refused(&["apply", "--normal-map-size", "64"]).as_deref(), Some("geometry.normal_map_size"));
    assert_eq!(refused(&["render", "--normals", "map"]).as_deref(), Some("surface.geometry.normals"));
}
