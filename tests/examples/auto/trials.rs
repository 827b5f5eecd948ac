//! One scene: what auto makes of it, and what all others would have.

use std::{
    path::{Path, PathBuf},
    time::Instant,
};

use displace_server::domain::{
    cost::{CostModel, Work},
    image::ImageSet,
};
use displace_tests::{
    reprojected::{Displaced, layers, outline_px},
    server::{displace, reference, validated},
};
use serde_json::Value;

use super::scenes::Scene;

const SIZE: &str = "192x192";
/// Pixels.
const TOLERANCES: [f64; 3] = [0.5, 1.5, 5.0];
/// Azimuth, elevation, and the distance in diagonals.
const VIEWS: [(f32, f32, f32); 4] = [(25.0, 55.0, 1.2), (-40.0, 20.0, 1.0), (10.0, 80.0, 3.0), (70.0, 35.0, 8.0)];
/// What is tried beside auto: words of the command line.
const OTHERS: [&[&str]; 6] = [
    &["--method", "flat"],
    &["--method", "bump"],
    &["--method", "parallax"],
    &["--method", "parallax-iterative"],
    &["--method", "exact"],
    &["--method", "exact", "--silhouettes", "shell"],
];
const DISPLACED: [f64; 5] = [0.5, 1.0, 1.5, 2.5, 5.0];

pub(crate) struct Trials<'a> {
    scene: &'a Scene,
    folder: &'a Path,
    displaced: Displaced,
    scale: f32,
}

/// One image.
struct Shot {
    error_px: f64,
    /// Pixels apart for each of the outline.
    outline_px: f64,
    cost: f64,
    ms: f64,
    report: Value,
}

pub(crate) struct Case {
    name: String,
    view: usize,
    tolerance_px: f64,
    pub(crate) method: String,
    setting: String,
    predicted_px: f64,
    measured_px: f64,
    outline_px: f64,
    pub(crate) cost: f64,
    pub(crate) front_cost: f64,
    front: String,
    /// Of the cheapest that is within the tolerance, as is known once all were measured.
    enough_cost: f64,
    enough: String,
    predicted_triangles: f64,
    pub(crate) displaced_cost: f64,
    pub(crate) triangles: f64,
    pub(crate) displaced_triangles: f64,
    pub(crate) ms: f64,
    pub(crate) displaced_ms: f64,
}

impl<'a> Trials<'a> {
    pub(crate) fn new(scene: &'a Scene, folder: &'a Path) -> Self {
        // A share of the diagonal of the mesh as it is, which no scale changes.
        let diagonal = Displaced::load(&scene.mesh, &scene.map, 1.0).diagonal() as f32;
        let scale = scene.share * diagonal;
        Self { scene, folder, displaced: Displaced::load(&scene.mesh, &scene.map, scale), scale }
    }

    /// Words of the command line.
    pub(crate) fn cameras(&self) -> Vec<Vec<String>> {
        let (c, diagonal) = (self.displaced.centre(), self.displaced.diagonal() as f32);
        let camera = |(azimuth, elevation, distance): &(f32, f32, f32)| {
            let (a, e) = (azimuth.to_radians(), elevation.to_radians());
            let d = distance * diagonal;
            let eye = [c[0] + d * e.cos() * a.sin(), c[1] + d * e.sin(), c[2] + d * e.cos() * a.cos()];
            let place = |p: [f32; 3]| p.map(|x| x.to_string()).join(",");
            ["--eye", &place(eye), "--look-at", &place(c), "--fov", "40"].map(str::to_owned).to_vec()
        };
        VIEWS.iter().map(camera).collect()
    }

    pub(crate) fn run(&self, view: usize, camera: &[String]) -> Vec<Case> {
        let truth = self.image(&["--method", "displacement", "--exact", "--supersample", "4"], camera, reference());
        let truth = layers(&truth.0);
        let others: Vec<(String, Shot)> = OTHERS
            .iter()
            .map(|words| words.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>())
            .chain(DISPLACED.map(displacing))
            .filter_map(|words| Some((words[1..].join(" "), self.shot(&words, camera, &truth)?)))
            .collect();
        TOLERANCES.iter().filter_map(|tolerance_px| self.case(view, camera, *tolerance_px, &truth, &others)).collect()
    }

    fn case(
        &self,
        view: usize,
        camera: &[String],
        tolerance_px: f64,
        truth: &ImageSet,
        others: &[(String, Shot)],
    ) -> Option<Case> {
        let words = ["--tolerance-px", &tolerance_px.to_string()].map(str::to_owned);
        let auto = self.shot(&words, camera, truth)?;
        // What was measured, not what was asked for, is what others have to reach.
        let reaches =
            |shot: &Shot| shot.error_px <= auto.error_px.max(1e-3) && shot.outline_px <= auto.outline_px.max(1e-3);
        let cheapest = others.iter().filter(|(_, shot)| reaches(shot)).min_by(|a, b| a.1.cost.total_cmp(&b.1.cost));
        let (front, front_cost) = match cheapest {
            Some((name, shot)) if shot.cost < auto.cost => (name.clone(), shot.cost),
            _ => ("auto".to_owned(), auto.cost),
        };
        let is_enough = |shot: &Shot| shot.error_px <= tolerance_px && shot.outline_px <= tolerance_px;
        let enough = others.iter().filter(|(_, shot)| is_enough(shot)).min_by(|a, b| a.1.cost.total_cmp(&b.1.cost));
        let (enough, enough_cost) = match enough {
            Some((name, shot)) if shot.cost < auto.cost => (name.clone(), shot.cost),
            _ => ("auto".to_owned(), auto.cost),
        };
        let name = displacing(tolerance_px)[1..].join(" ");
        let displaced = &others.iter().find(|(other, _)| *other == name)?.1;
        let choice = &auto.report["choices"][0];
        Some(Case {
            name: self.scene.name.clone(),
            view,
            tolerance_px,
            method: text(&choice["method"]),
            setting: text(&choice["setting"]),
            predicted_px: choice["predicted"].as_f64().unwrap_or(f64::NAN),
            measured_px: auto.error_px,
            outline_px: auto.outline_px,
            cost: auto.cost,
            front_cost,
            front,
            enough_cost,
            enough,
            predicted_triangles: number(&choice["cost"]["triangles"]),
            displaced_cost: displaced.cost,
            triangles: number(&auto.report["triangles"]),
            displaced_triangles: number(&displaced.report["triangles"]),
            ms: auto.ms,
            displaced_ms: displaced.ms,
        })
    }

    /// None where the method does not go with the scene.
    fn shot(&self, words: &[String], camera: &[String], truth: &ImageSet) -> Option<Shot> {
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let start = Instant::now();
        let (path, report) = self.image(&words, camera, validated());
        if report.is_null() {
            return None;
        }
        let ms = passes_ms(&report).unwrap_or(start.elapsed().as_secs_f64() * 1e3);
        let image = layers(&path);
        let (apart, length) = outline_px(truth, &image);
        let covered = image.depth.iter().flatten().filter(|depth| depth.is_finite()).count() as f64;
        Some(Shot {
            error_px: self.displaced.p99_px(&image)?,
            outline_px: apart as f64 / (length.max(1)) as f64,
            cost: CostModel::default().ms(&work(&report, is_displaced(&words, &report), covered)),
            ms,
            report,
        })
    }

    fn image(&self, words: &[&str], camera: &[String], server: &str) -> (PathBuf, Value) {
        let out = self.folder.join("image.exr");
        let path = |path: &Path| path.to_str().expect("UTF-8").to_owned();
        let (mesh, map, out_word) = (path(&self.scene.mesh), path(&self.scene.map), path(&out));
        let scale = self.scale.to_string();
        let fixed =
            ["render", &mesh, "--height", &map, "--scale", &scale, "--size", SIZE, "--aov", "depth,position,uv"];
        let ends = ["--fresh", "--json", "--server", server, "-o", &out_word];
        let camera: Vec<&str> = camera.iter().map(String::as_str).collect();
        let run = displace(&[&fixed[..], words, &camera, &ends].concat());
        if run.code != Some(0) {
            eprintln!("{} {}: {}{}", self.scene.name, words.join(" "), run.stdout, run.stderr);
            return (out, Value::Null);
        }
        (out, run.json())
    }
}

fn displacing(tolerance_px: f64) -> Vec<String> {
    ["--method", "displacement", "--tolerance-px", &tolerance_px.to_string()].map(str::to_owned).to_vec()
}

/// Whether vertices move, of whatever was asked for.
fn is_displaced(words: &[&str], report: &Value) -> bool {
    let displacement = "displacement";
    words.contains(&displacement)
        || report["choices"].as_array().is_some_and(|all| all.iter().any(|c| c["method"] == displacement))
}

/// By what was counted, not by what was predicted: what is displaced has each of its vertices and triangles made.
fn work(report: &Value, is_displaced: bool, covered: f64) -> Work {
    let counters = &report["counters"];
    let of = |what: &str| if is_displaced { number(&report[what]) } else { 0.0 };
    Work {
        pixels: covered,
        rays: number(&counters["rays"]),
        fetches: number(&counters["fetches"]),
        vertices: of("vertices"),
        triangles: of("triangles"),
    }
}

/// Without what is once for a map or a device, or is told of the image.
fn passes_ms(report: &Value) -> Option<f64> {
    const ONCE: [&str; 13] = [
        "height_facts",
        "compile",
        "mip",
        "cone_map",
        "brdf_table",
        "brdf_averages",
        "encode",
        "read_gltf",
        "decode_bumps",
        "decode_maps",
        "decode_reliefs",
        "decode_images",
        "check_surface",
    ];
    let passes = report["passes"].as_array()?;
    let counts = |pass: &&Value| !ONCE.iter().any(|name| pass["name"] == *name);
    Some(passes.iter().filter(counts).map(|pass| number(&pass["ms"])).sum())
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_default()
}

fn text(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_owned()
}

impl Case {
    pub(crate) fn is_kept(&self) -> bool {
        self.measured_px <= self.tolerance_px && self.outline_px <= self.tolerance_px
    }

    pub(crate) fn row(&self) -> String {
        let Self { name, view, tolerance_px, method, setting, front, enough, .. } = self;
        format!(
            "{name},{view},{tolerance_px},{method},{setting},{:.4},{:.4},{:.4},{},{:.2},{:.2},{front},{:.2},{enough},{:.2},{:.0},{},{},{:.1},{:.1}",
            self.predicted_px,
            self.measured_px,
            self.outline_px,
            self.is_kept(),
            self.cost,
            self.front_cost,
            self.enough_cost,
            self.displaced_cost,
            self.predicted_triangles,
            self.triangles,
            self.displaced_triangles,
            self.ms,
            self.displaced_ms,
        )
    }
}
