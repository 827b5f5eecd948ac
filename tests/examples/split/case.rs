//! One mesh with a map, its surface, and the meshes that are held against it.

use std::path::{Path, PathBuf};

use displace_tests::{
    cli::Displace,
    corpus::Corpus,
    meshes::{self, TestMesh},
};
use serde_json::Value;

/// Height of a map's whole range, as a share of the diagonal.
const SCALE: f64 = 0.03;
/// Places of eyes and how far they are from the middle, diagonals: a view of 40 degrees shows all of the scene.
const ASIDE: [f64; 3] = [0.6, 0.5, 0.62];
const AWAY: f64 = 1.5;
/// Samples enough that edges of pixels say little.
const VIEW: [&str; 6] = ["--size", "256x256", "--supersample", "64", "--aov", "depth,position"];

pub(crate) struct Case {
    pub(crate) name: &'static str,
    displace: Displace,
    mesh: PathBuf,
    map: PathBuf,
    scale: String,
    eye: String,
    look_at: String,
    /// An image of the surface itself.
    truth: PathBuf,
}

/// One result.
pub(crate) struct Row {
    pub(crate) tolerance: String,
    pub(crate) triangles: u64,
    pub(crate) bytes: u64,
    pub(crate) flip: f64,
    pub(crate) silhouette_px: u64,
    /// No place is farther from the surface, share of the diagonal.
    pub(crate) bound: f64,
    /// Median and 99 % of the angles between the map's normals and the surface's, degrees.
    pub(crate) angles: Option<[f64; 2]>,
}

impl Case {
    /// Models without normal maps of their own.
    pub(crate) fn all(corpus: &Corpus) -> Vec<Self> {
        let of = |name, mesh: TestMesh, map: &str| Self::new(name, &mesh, corpus.path(map));
        vec![
            of("wall of bricks", meshes::plane(1), "heightfields/bricks_513.exr"),
            of("torus of rock", meshes::torus(24, 12), "maps/ambientcg_Rock020/Rock020_1K_Displacement.jpg"),
            of("globe", meshes::uv_sphere(24, 12), "maps/earth_three-globe/earth-topology.png"),
        ]
    }

    fn new(name: &'static str, mesh: &TestMesh, map: PathBuf) -> Self {
        let displace = Displace::default();
        let path = displace.file("mesh.glb", &mesh.to_glb());
        let found = displace.run(["describe", text(&path), "--json"]).expect_success().json();
        let diagonal = number(&found, "/diagonal");
        let middle = [0, 1, 2].map(|k| {
            let end = |which: &str| number(&found, &format!("/bounds/{which}/{k}"));
            0.5 * (end("min") + end("max"))
        });
        let eye = [0, 1, 2].map(|k| middle[k] + AWAY * diagonal * ASIDE[k]);
        let truth = displace.folder().join("truth.exr");
        let scale = (SCALE * diagonal).to_string();
        let case = Self { name, displace, mesh: path, map, scale, eye: list(eye), look_at: list(middle), truth };
        let detail = ["--height", text(&case.map), "--scale", &case.scale, "--exact", "--device", "reference"];
        case.render(&case.mesh, &detail, &case.truth);
        case
    }

    pub(crate) fn row(&self, tolerance: &str, is_split: bool) -> Row {
        let map: &[&str] = if is_split { &["--normals", "map"] } else { &[] };
        let (file, report) = self.apply(&[&["--tolerance", tolerance], map].concat());
        let image = self.displace.folder().join("image.exr");
        self.render(&file, &[], &image);
        let compared =
            self.displace.run(["compare", text(&self.truth), text(&image), "--json"]).expect_success().json();
        let angle = |which: &str| report["normal_maps"][0]["angle_deg"][which].as_f64();
        let row = Row {
            tolerance: tolerance.into(),
            triangles: report["triangles"].as_u64().expect("a count"),
            bytes: std::fs::metadata(&file).expect("it is written").len(),
            flip: number(&compared, "/flip_mean"),
            silhouette_px: compared["silhouette_xor_px"].as_u64().expect("both tell what they cover"),
            bound: number(&report, "/accuracy/bound"),
            angles: angle("p50").zip(angle("p99")).map(|(p50, p99)| [p50, p99]),
        };
        let kind = if is_split { "split" } else { "alone" };
        println!("{}, {kind} at {tolerance}: {} triangles, FLIP {:.5}", self.name, row.triangles, row.flip);
        row
    }

    fn apply(&self, flags: &[&str]) -> (PathBuf, Value) {
        let file = self.displace.folder().join("result.glb");
        let args = ["apply", text(&self.mesh), "--height", text(&self.map), "--scale", &self.scale];
        let run = self.displace.run([&args[..], &["-o", text(&file), "--json"], flags].concat());
        (file, run.expect_success().json())
    }

    fn render(&self, file: &Path, flags: &[&str], image: &Path) {
        let args = ["render", text(file), "--eye", &self.eye, "--look-at", &self.look_at, "-o", text(image)];
        self.displace.run([&args[..], &VIEW, flags].concat()).expect_success();
    }
}

fn list(point: [f64; 3]) -> String {
    point.map(|x| x.to_string()).join(",")
}

fn number(value: &Value, pointer: &str) -> f64 {
    value.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("no {pointer} in {value}"))
}

fn text(path: &Path) -> &str {
    path.to_str().expect("paths are UTF-8")
}
