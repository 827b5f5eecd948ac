//! What uniform subdivision costs and how exact it is: distance to the surface itself, and image error against
//! images of that surface, for levels 0 to 7 up to a million triangles, on three meshes and three maps of the
//! corpus. Writes `tests/charts/accuracy.csv`.
//!
//! `DISPLACE_CORPUS=... cargo bench --profile dev --workspace --bench accuracy`

use std::{fmt::Write as _, path::Path};

use displace_tests::{
    cli::Displace,
    corpus::{Corpus, corpus},
    data::repository,
};
use serde_json::Value;

const MESHES: [&str; 3] =
    ["models/TwoSidedPlane/TwoSidedPlane.gltf", "models/BoxTextured.glb", "models/Avocado/Avocado.gltf"];
const MAPS: [&str; 3] =
    ["heightfields/bricks_513.exr", "heightfields/fbm_513.exr", "maps/bevy_parallax_cube/cube_depth.png"];
const LEVELS: u32 = 7;
const MOST_TRIANGLES: u64 = 1 << 20;
/// Height of a map's whole range, as a share of the diagonal.
const SCALE: f64 = 0.03;
/// Widths of the interval, as shares of the diagonal: as many are asked for as it takes to be [`NARROW`].
const PRECISIONS: [&str; 3] = ["4e-3", "1e-3", "2.5e-4"];
/// Width of an interval that tells the distance, as a share of its upper end.
const NARROW: f64 = 0.25;
/// The shortest of so many runs is the time.
const RUNS: usize = 3;
const VIEW: [&str; 4] = ["--size", "192x192", "--aov", "depth,position"];

fn main() {
    let Some(corpus) = corpus("the accuracy table") else { return };
    let displace = Displace::default();
    let mut table = String::from(
        "mesh,map,level,triangles,error_lo,error_hi,rms,normal_p99_deg,volume_change,flip_mean,silhouette_xor_px,hit_error_px,passes_ms\n",
    );
    for mesh in MESHES {
        for map in MAPS {
            let case = Case::new(&displace, &corpus, mesh, map);
            for level in (0..=LEVELS).take_while(|&level| case.triangles << (2 * level) <= MOST_TRIANGLES) {
                let row = case.row(level);
                print!("{row}");
                table.push_str(&row);
            }
        }
    }
    let chart = repository().join("tests/charts/accuracy.csv");
    std::fs::write(&chart, table).expect("the chart can be written");
    println!("lengths are shares of the diagonal; written to {}", chart.display());
}

/// A mesh with a map, and the image of its surface.
struct Case<'d> {
    displace: &'d Displace,
    mesh: std::path::PathBuf,
    map: std::path::PathBuf,
    scale: String,
    triangles: u64,
    truth: std::path::PathBuf,
}

impl<'d> Case<'d> {
    fn new(displace: &'d Displace, corpus: &Corpus, mesh: &str, map: &str) -> Self {
        let (mesh, map) = (corpus.root.join(mesh), corpus.root.join(map));
        let found = displace.run(["describe", text(&mesh), "--json"]).expect_success().json();
        let scale = (SCALE * number(&found, "/diagonal")).to_string();
        let triangles = found["meshes"][0]["triangles"].as_u64().expect("a mesh has triangles");
        let truth = displace.folder().join("truth.exr");
        let case = Self { displace, mesh, map, scale, triangles, truth };
        let mut render = case.command("render");
        render.extend(["--exact", "--device", "reference", "--supersample", "64", "-o", text(&case.truth)]);
        render.extend(VIEW);
        displace.run(render).expect_success();
        case
    }

    /// A command on the mesh with its detail.
    fn command<'s>(&'s self, command: &'s str) -> Vec<&'s str> {
        vec![command, text(&self.mesh), "--height", text(&self.map), "--scale", &self.scale, "--json"]
    }

    fn row(&self, level: u32) -> String {
        let (level_text, glb) = (level.to_string(), self.displace.folder().join("result.glb"));
        let mut apply = self.command("apply");
        apply.extend(["--uniform", &level_text, "--fresh", "-o", text(&glb)]);
        let made: Vec<Value> = (0..RUNS).map(|_| self.displace.run(apply.clone()).expect_success().json()).collect();
        let distance = self.distance(&glb);
        let image = self.displace.folder().join("result.exr");
        let mut render = self.command("render");
        render.extend(["--uniform", &level_text, "-o", text(&image)]);
        render.extend(VIEW);
        self.displace.run(render).expect_success();
        let compare = ["compare", text(&self.truth), text(&image), "--json"];
        let apart = self.displace.run(compare).expect_success().json();
        self.csv(level, &made, &distance, &apart)
    }

    fn distance(&self, glb: &Path) -> Value {
        let mut found = Value::Null;
        for precision in PRECISIONS {
            let mut measure = self.command("measure");
            measure.insert(2, text(glb));
            measure.extend(["--precision", precision]);
            found = self.displace.run(measure).expect_success().json();
            let [lo, hi] = ["/hausdorff/lo", "/hausdorff/hi"].map(|end| number(&found, end));
            if hi - lo <= NARROW * hi {
                break;
            }
        }
        found
    }

    fn csv(&self, level: u32, made: &[Value], distance: &Value, apart: &Value) -> String {
        let diagonal = number(distance, "/diagonal");
        let share = |path: &str| number(distance, path) / diagonal;
        let volumes = (distance["volume"]["a"].as_f64(), distance["volume"]["b"].as_f64());
        let change = if let (Some(a), Some(b)) = volumes { format!("{:.3e}", (b - a) / a) } else { String::new() };
        let sum = |run: &Value| run["passes"].as_array().into_iter().flatten().filter_map(|p| p["ms"].as_f64()).sum();
        let passes: f64 = made.iter().map(sum).fold(f64::INFINITY, f64::min);
        let mut row = format!("{},{},{level},", stem(&self.mesh), stem(&self.map));
        let _ = write!(row, "{},{:.3e},", made[0]["triangles"], share("/hausdorff/lo"));
        let _ = write!(row, "{:.3e},{:.3e},", share("/hausdorff/hi"), share("/rms"));
        let _ = write!(row, "{:.2},{change},", number(distance, "/normal_deg/p99"));
        let _ = write!(row, "{:.4},{},", number(apart, "/flip_mean"), apart["silhouette_xor_px"]);
        let _ = writeln!(row, "{:.3},{passes:.1}", apart["hit_error_px"].as_f64().unwrap_or_default());
        row
    }
}

fn number(value: &Value, path: &str) -> f64 {
    value.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path} is missing in {value}"))
}

fn text(path: &Path) -> &str {
    path.to_str().expect("paths of the corpus are UTF-8")
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}
