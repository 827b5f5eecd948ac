//! `displace chart` on sample data: what the folder holds, what the figures say, and what is refused.

mod sweeps;

use std::{
    collections::HashMap,
    path::{Path, PathBuf},
    sync::OnceLock,
};

use displace_tests::{
    cli::Run,
    data::sample,
    meshes,
    server::{displace, reference, validated},
};
use serde_json::Value;

const COLUMNS: &str = "method,setting,triangles,fetches,ms,ms_spread,error,metric,predicted,pareto,chosen";
/// Small, and once each.
pub(crate) const QUICK: [&str; 6] = ["--size", "64x64", "--repeats", "1", "--truth-samples", "16"];

/// A chart of rock on a plane, seen from aside, on the device.
struct Rock {
    folder: PathBuf,
    told: Value,
    _home: tempfile::TempDir,
}

fn rock() -> &'static Rock {
    static ROCK: OnceLock<Rock> = OnceLock::new();
    ROCK.get_or_init(|| {
        let home = tempfile::tempdir().expect("a temporary folder");
        let (mesh, folder) = (home.path().join("plane.glb"), home.path().join("new/chart"));
        std::fs::write(&mesh, meshes::plane(2).to_glb()).expect("written");
        let height = sample("maps/rock_height.png");
        let detail = ["--height", path(&height), "--scale", "0.1", "--eye", "0,0.5,0.9", "--look-at", "0,0,0"];
        let words = [&["chart", path(&mesh)], &detail[..], &QUICK, &["-o", path(&folder)]].concat();
        let told = run(&words, validated()).expect_success().json();
        Rock { folder, told, _home: home }
    })
}

pub(crate) fn path(path: &Path) -> &str {
    path.to_str().expect("temporary folders are UTF-8")
}

pub(crate) fn run(words: &[&str], server: &str) -> Run {
    displace(&[words, &["--server", server, "--json"]].concat())
}

impl Rock {
    fn text(&self, name: &str) -> String {
        std::fs::read_to_string(self.folder.join(name)).expect(name)
    }

    fn points(&self) -> &Vec<Value> {
        self.told["points"].as_array().expect("points")
    }

    /// An error of a setting.
    fn error(&self, name: &str, metric: &str) -> f64 {
        let point = self.points().iter().find(|point| point["name"] == name).expect(name);
        point[metric].as_f64().expect(metric)
    }
}

#[test]
fn the_folder_of_a_chart_holds_every_file_of_every_point() {
    let rock = rock();
    let images = rock.points().iter().flat_map(|point| {
        let name = point["name"].as_str().expect("a name");
        [format!("{name}.png"), format!("{name}-difference.png")]
    });
    for name in images.chain(["truth.png".to_owned()]) {
        let image = image::open(rock.folder.join(&name)).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!((image.width(), image.height()), (64, 64), "{name}");
    }
    let methods =
        ["flat", "bump", "parallax", "parallax-limited", "parallax-iterative", "steep", "occlusion", "relief"];
    for method in methods.iter().chain(&["cone", "exact", "displacement"]) {
        assert!(rock.points().iter().any(|point| point["method"] == *method), "{method}");
    }
    let warnings = rock.told["warnings"].as_array().expect("warnings");
    let left_out: Vec<&str> = warnings.iter().filter_map(|warning| warning["message"].as_str()).collect();
    assert!(left_out.iter().any(|message| message.starts_with("normal is not charted")), "{left_out:?}");
}

#[test]
fn methods_that_find_the_surface_are_nearer_to_it_than_those_that_do_not() {
    let rock = rock();
    for metric in ["flip_mean", "hit_error_px"] {
        let [exact, parallax] = ["exact", "parallax"].map(|name| rock.error(name, metric));
        assert!(exact < parallax, "{metric}: exact {exact}, parallax {parallax}");
        let [fine, coarse] = ["displacement-0.25px", "displacement-4px"].map(|name| rock.error(name, metric));
        assert!(fine < coarse, "{metric}: 0.25 px {fine}, 4 px {coarse}");
    }
    // Its places are those of the truth's rays: what is left is what the march and the map's levels are off by.
    assert!(rock.error("exact-shell", "hit_error_px") < 0.5, "{}", rock.error("exact-shell", "hit_error_px"));
    // What is proven of the triangles is of distances to the surface; along a ray places may be farther apart.
    assert_eq!(rock.error("flat", "hit_error_px"), rock.error("bump", "hit_error_px"), "bump moves nothing");
}

#[test]
fn the_table_has_a_row_for_each_point_and_metric_and_agrees_with_the_report() {
    let rock = rock();
    let text = rock.text("chart.csv");
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some(COLUMNS));
    let rows: Vec<HashMap<&str, &str>> = lines.map(|line| COLUMNS.split(',').zip(line.split(',')).collect()).collect();
    assert_eq!(rows.len(), 3 * rock.points().len());
    for (rows, point) in rows.chunks(3).zip(rock.points()) {
        for (row, (metric, field)) in
            rows.iter().zip([("flip", "flip_mean"), ("hit_px", "hit_error_px"), ("silhouette_px", "silhouette_xor_px")])
        {
            assert_eq!((row["method"], row["metric"]), (point["method"].as_str().unwrap(), metric));
            assert!(is_same(row["error"], &point[field]), "{row:?}: {}", point[field]);
            assert!(is_same(row["ms"], &point["ms"]), "{row:?}: {}", point["ms"]);
            let on_front = point["fronts"].as_array().unwrap().iter().any(|front| front == metric);
            assert_eq!(row["pareto"], on_front.to_string());
            assert_eq!(row["ms_spread"], "", "run once");
            let predicted = if metric == "hit_px" { &point["predicted_px"] } else { &Value::Null };
            assert!(is_same(row["predicted"], predicted), "{row:?}: {predicted}");
            assert_eq!(row["chosen"], (point["chosen"] == true).to_string());
        }
    }
    assert!(rows.iter().any(|row| row["pareto"] == "true"));
    assert_eq!(rows.iter().filter(|row| row["chosen"] == "true").count(), 3, "one setting, by three errors");
    let json: Value = serde_json::from_str(&rock.text("chart.json")).expect("JSON");
    assert_eq!(json["points"].as_array().map(Vec::len), Some(rock.points().len()));
    assert_eq!((&json["width"], &json["truth_samples"]), (&64.into(), &16.into()));
}

/// The JSON library may read a number one off in its last bit.
fn is_same(text: &str, number: &Value) -> bool {
    match (text.parse::<f64>(), number.as_f64()) {
        (Ok(a), Some(b)) => (a - b).abs() <= f64::EPSILON * b.abs(),
        (text, number) => text.is_err() && number.is_none(),
    }
}

#[test]
fn the_drawing_is_xml_with_a_mark_for_each_point_and_error() {
    let rock = rock();
    let text = rock.text("chart.svg");
    let svg = roxmltree::Document::parse(&text).expect("well-formed XML");
    let links: Vec<&str> = svg.descendants().filter_map(|node| node.attribute("href")).collect();
    let errors = ["flip_mean", "hit_error_px", "silhouette_xor_px"];
    let known = |point: &Value| errors.iter().filter(|error| point.get(**error).is_some()).count();
    assert_eq!(links.len(), rock.points().iter().map(known).sum::<usize>());
    assert!(links.iter().all(|link| rock.folder.join(link).is_file()), "{links:?}");
}

#[test]
fn the_page_refers_to_files_beside_it_alone() {
    let rock = rock();
    let text = rock.text("index.html");
    let attributes = ["src=\"", "href=\""];
    let of = |attribute: &'static str| text.split(attribute).skip(1).filter_map(|rest| rest.split('"').next());
    let links: Vec<&str> = attributes.into_iter().flat_map(of).collect();
    assert!(links.len() > 2 * rock.points().len(), "{}", links.len());
    let lost: Vec<&&str> = links.iter().filter(|link| !rock.folder.join(link).is_file()).collect();
    assert!(lost.is_empty(), "{lost:?}");
}

#[test]
fn vectors_leave_out_what_shows_heights_and_say_why() {
    let home = tempfile::tempdir().expect("a temporary folder");
    let (mesh, folder) = (home.path().join("ball.glb"), home.path().join("chart"));
    std::fs::write(&mesh, meshes::uv_sphere(12, 6).to_glb()).expect("written");
    let map = sample("maps/scales_vector.exr");
    let detail = ["--vector", path(&map), "--scale", "0.05"];
    let words = [&["chart", path(&mesh)], &detail[..], &QUICK, &["-o", path(&folder)]].concat();
    let told = run(&words, reference()).expect_success().json();
    let methods: Vec<&str> = told["points"].as_array().unwrap().iter().map(|p| p["method"].as_str().unwrap()).collect();
    assert!(methods.iter().all(|method| ["flat", "vector"].contains(method)), "{methods:?}");
    assert!(methods.contains(&"vector") && methods.contains(&"flat"), "{methods:?}");
    let warnings = told["warnings"].as_array().unwrap();
    let why = |method: &str| {
        let begins = format!("{method} ");
        let told = warnings.iter().filter_map(|warning| warning["message"].as_str());
        told.into_iter()
            .find(|message| message.starts_with(&begins))
            .unwrap_or_else(|| panic!("{method}: {warnings:?}"))
    };
    for method in ["parallax", "steep", "occlusion", "relief", "cone", "exact"] {
        assert!(why(method).contains("choose method vector"), "{}", why(method));
    }
    assert!(why("bump").contains("is not charted"), "{}", why("bump"));
}

#[test]
fn what_is_no_chart_is_refused_by_name() {
    let home = tempfile::tempdir().expect("a temporary folder");
    let mesh = home.path().join("plane.glb");
    std::fs::write(&mesh, meshes::plane(1).to_glb()).expect("written");
    let (height, out) = (sample("maps/rock_height.png"), home.path().join("out"));
    let refused = |flags: &[&str], part: &str| {
        let words = [&["chart", path(&mesh), "-o", path(&out)], flags].concat();
        let run = run(&words, reference());
        assert_eq!(run.code, Some(2), "{flags:?}: {run:?}");
        assert!(run.stderr.contains(part), "{flags:?}: {}", run.stderr);
    };
    refused(&["--height", path(&height), "--repeats", "0"], "--repeats");
    refused(&["--height", path(&height), "--method", "relief"], "--method");
    refused(&["--height", "none.png"], "--height");
    refused(&[], "neither the request nor the mesh's materials have a detail");
    refused(&["--height", path(&height), "--camera", "none"], "no camera 'none'");
}
