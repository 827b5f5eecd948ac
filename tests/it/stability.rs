//! `displace chart --stability` on sample data: every row of the failure matrix is swept, methods break where the mathematics
//! says, and nothing that must hold anywhere fails.

use std::{
    path::{Path, PathBuf},
    sync::OnceLock,
};

use displace_tests::{
    data::sample,
    meshes,
    server::{displace, reference, validated},
};
use serde_json::Value;

const COLUMNS: &str = "scenario,method,parameter,unit,metric,value,line,breakdown";
/// The failure matrix, row by row, and the scenarios of each.
const MATRIX: [(&str, &[&str]); 17] = [
    ("grazing sweep", &["grazing", "grazing-images"]),
    ("step count sweep", &["steps", "stairs"]),
    ("thin posts and slots", &["posts", "slots", "outlines"]),
    ("swimming", &["drift", "shimmer"]),
    ("view-dependent dicing pops", &["pops", "pop-images"]),
    ("seam cracks", &["cracks"]),
    ("mirrored UV, zero-area UV, pole, NaN tangents", &["tangents"]),
    ("foldover", &["foldover", "self-intersection"]),
    ("bit depth", &["terraces", "terrace-normals"]),
    ("mip: far camera, noise normals", &["highlights"]),
    ("scale", &["stretched"]),
    ("huge and small units", &["units"]),
    ("edge factors", &["edge-factors"]),
    ("non-manifold, T-junction, duplicated vertices", &["junctions"]),
    ("black or undefined RGB direction", &["directions"]),
    ("tiling wrap", &["tiling"]),
    ("displaced bounds culling", &["bounds"]),
];

/// The suite over rock on a plane, on the device.
struct Suite {
    folder: PathBuf,
    told: Value,
    _home: tempfile::TempDir,
}

fn suite() -> &'static Suite {
    static SUITE: OnceLock<Suite> = OnceLock::new();
    SUITE.get_or_init(|| {
        let home = tempfile::tempdir().expect("a temporary folder");
        let (mesh, folder) = (home.path().join("plane.glb"), home.path().join("new/stability"));
        std::fs::write(&mesh, meshes::plane(2).to_glb()).expect("written");
        let height = sample("maps/rock_height.png");
        let words = ["chart", path(&mesh), "--height", path(&height), "--scale", "0.1", "--stability"];
        let words = [&words[..], &["-o", path(&folder), "--server", validated(), "--json"]].concat();
        let told = displace(&words).expect_success().json();
        Suite { folder, told, _home: home }
    })
}

fn path(path: &Path) -> &str {
    path.to_str().expect("temporary folders are UTF-8")
}

impl Suite {
    fn scenarios(&self) -> &[Value] {
        self.told["scenarios"].as_array().expect("scenarios")
    }

    fn curve(&self, scenario: &str, method: &str) -> &Value {
        let scenario = self.scenarios().iter().find(|s| s["name"] == scenario).expect(scenario);
        let curves = scenario["breakdowns"].as_array().expect("breakdowns");
        curves.iter().find(|curve| curve["method"] == method).expect(method)
    }

    fn breaks_at(&self, scenario: &str, method: &str) -> Option<f64> {
        self.curve(scenario, method)["at"].as_f64()
    }

    /// At a parameter that was swept.
    fn value(&self, scenario: &str, method: &str, parameter: f64) -> f64 {
        let values = self.curve(scenario, method)["values"].as_array().expect("values");
        let found = values.iter().find(|pair| pair[0].as_f64() == Some(parameter)).expect("it was swept");
        found[1].as_f64().expect("a number")
    }

    fn json(&self) -> Value {
        let text = std::fs::read_to_string(self.folder.join("stability.json")).expect("stability.json");
        serde_json::from_str(&text).expect("JSON")
    }
}

#[test]
fn every_row_of_the_failure_matrix_is_swept() {
    let all = suite().json()["scenarios"].as_array().expect("scenarios").clone();
    let mut swept = 0;
    for (family, names) in MATRIX {
        let found: Vec<&str> =
            all.iter().filter(|s| s["family"] == family).filter_map(|s| s["name"].as_str()).collect();
        assert_eq!(found, names, "{family}");
        swept += found.len();
    }
    assert_eq!(swept, all.len());
    for scenario in &all {
        let curves = scenario["curves"].as_array().expect("curves");
        assert!(scenario.get("left_out").is_none() && !curves.is_empty(), "{scenario}");
        for curve in curves {
            assert!(curve["values"].as_array().is_some_and(|values| values.len() >= 4), "{curve}");
            assert!(curve["literature"].as_str().is_some_and(|text| !text.is_empty()), "{curve}");
        }
    }
}

#[test]
fn what_must_hold_anywhere_holds_in_every_scenario() {
    for scenario in suite().scenarios() {
        assert_eq!(scenario["violations"], Value::Array(Vec::new()), "{}", scenario["name"]);
        assert!(scenario["checks"].as_u64().is_some_and(|checks| checks > 0), "{}", scenario["name"]);
    }
    assert_eq!(suite().told["warnings"], Value::Array(Vec::new()));
}

#[test]
fn exact_breaks_nowhere_and_every_other_method_somewhere_as_rays_graze() {
    let suite = suite();
    for scenario in ["grazing", "steps", "stairs", "posts", "slots", "drift", "shimmer"] {
        assert_eq!(suite.breaks_at(scenario, "exact"), None, "{scenario}");
    }
    for method in ["flat", "parallax", "parallax-limited", "parallax-iterative", "steep", "occlusion", "relief", "cone"]
    {
        let at = suite.breaks_at("grazing", method);
        assert!(at.is_some_and(|at| (0.1..89.0).contains(&at)), "{method}: {at:?}");
    }
    // A shift by the height found helps, and turns of it more.
    let at = |method: &str| suite.breaks_at("grazing", method).expect(method);
    assert!(at("flat") < at("parallax") && at("parallax") < at("parallax-iterative"));
    assert!(at("parallax-iterative") < at("occlusion"));
}

/// range sin θ / (π N) at 60 degrees over 8 texels, and none where the last step is interpolated or halved.
#[test]
fn stairs_have_the_amplitude_of_a_saw() {
    for steps in [8.0, 16.0, 32.0, 64.0] {
        let expected = 8.02 * 60f64.to_radians().sin() / (std::f64::consts::PI * steps);
        let [steep, occlusion, relief] =
            ["steep", "occlusion", "relief"].map(|method| suite().value("stairs", method, steps));
        assert!((steep / expected - 1.0).abs() < 0.1, "{steps} steps: {steep}, not {expected}");
        assert!(occlusion < 0.01 * expected && relief < 0.06 * expected, "{steps} steps: {occlusion} {relief}");
    }
}

/// 16 steps at 80 degrees over 8 texels are 2.84 texels long.
#[test]
fn steps_miss_posts_that_are_narrower_than_they_are_long() {
    for method in ["steep", "occlusion", "relief", "cone"] {
        let at = suite().breaks_at("posts", method).expect(method);
        assert!((1.0..=4.0).contains(&at), "{method}: {at}");
        assert!(suite().value("posts", method, 0.5) > 10.0, "{method}");
        assert!(suite().value("posts", method, 4.0) == 0.0, "{method}");
    }
}

/// Offsets are singular where height and radius of curvature are equal.
#[test]
fn a_bend_folds_over_where_heights_reach_its_axis() {
    let suite = suite();
    for scenario in ["foldover", "self-intersection"] {
        let at = suite.breaks_at(scenario, "displacement").expect(scenario);
        assert!((0.97..1.1).contains(&at), "{scenario}: {at}");
        assert_eq!(suite.breaks_at(scenario, "displacement, clamped"), None, "{scenario}");
    }
}

/// A 510th of the range.
#[test]
fn terraces_are_half_a_level_high() {
    for height in [8.0, 32.0, 128.0] {
        let value = suite().value("terraces", "8 bits", height);
        assert!((0.9..1.01).contains(&(value * 510.0 / height)), "{height}: {value}");
    }
    let at = suite().breaks_at("terraces", "8 bits").expect("it breaks");
    assert!((at / (0.05 * 510.0) - 1.0).abs() < 0.1, "{at}");
    for scenario in ["terraces", "terrace-normals"] {
        assert_eq!(suite().breaks_at(scenario, "float"), None, "{scenario}");
        assert_eq!(suite().breaks_at(scenario, "16 bits"), None, "{scenario}");
    }
}

/// Both frames are within the tolerance of the surface; a pixel is not as long everywhere on a triangle.
#[test]
fn what_is_diced_anew_jumps_by_twice_the_tolerance_at_most() {
    for tolerance in [0.5, 1.0, 2.0, 4.0] {
        let jump = suite().value("pops", "diced anew", tolerance);
        assert!(jump > 0.0 && jump < 2.2 * tolerance, "{tolerance} px: {jump}");
    }
}

/// Under a stretch s along z normals by the matrix lean up to atan s - atan 1/s too far.
#[test]
fn normals_go_by_the_inverse_transpose() {
    let suite = suite();
    let naive = "normals by the matrix itself";
    for scale in [1.25, 2.0, 8.0f64] {
        let most = (scale.atan() - scale.recip().atan()).to_degrees();
        let off = suite.value("stretched", naive, scale);
        assert!(off > 0.2 * most && off < most + 0.1, "{scale}: {off} of {most}");
        let right = suite.value("stretched", "displacement", scale);
        assert!(right < 0.01, "{scale}: {right}, and {off} by the matrix");
    }
}

#[test]
fn what_is_shared_stays_closed_and_what_is_not_opens() {
    let suite = suite();
    for (scenario, method) in [
        ("cracks", "displacement, mean of sides"),
        ("cracks", "displacement, dominant side"),
        ("edge-factors", "displacement"),
        ("junctions", "repeated vertices"),
        ("junctions", "more sheets in the edge"),
        ("tiling", "displacement, mean of sides"),
        ("directions", "vector, black"),
        ("directions", "vector, grey"),
        ("units", "displacement"),
        ("bounds", "displacement"),
    ] {
        assert_eq!(suite.breaks_at(scenario, method), None, "{scenario}, {method}");
    }
    for (scenario, method) in [
        ("cracks", "each face by its own normals"),
        ("edge-factors", "each half by itself"),
        ("junctions", "T-junctions"),
        ("directions", "made unit length without a guard"),
        ("bounds", "exact, base outline"),
    ] {
        assert!(suite.breaks_at(scenario, method).is_some(), "{scenario}, {method}");
    }
    // Left alone a seam opens by the disagreement of its sides, but for the texels at its ends.
    let gap = suite.value("tiling", "each side by itself", 0.5);
    assert!((gap - 50.0).abs() < 1.0, "{gap} %");
}

#[test]
fn the_folder_holds_every_file_and_the_page_refers_to_these_alone() {
    let suite = suite();
    for scenario in suite.scenarios() {
        let name = scenario["name"].as_str().expect("a name");
        let text = std::fs::read_to_string(suite.folder.join(format!("{name}.svg"))).expect(name);
        let svg = roxmltree::Document::parse(&text).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(svg.descendants().filter(|node| node.has_tag_name("path")).count() > 10, "{name}");
    }
    let page = std::fs::read_to_string(suite.folder.join("index.html")).expect("a page");
    assert!(!page.contains("src=\"http") && !page.contains("href=\"http"));
    let links = page.split("href=\"").skip(1).filter_map(|rest| rest.split('"').next());
    for link in links {
        let is_there = match link.strip_prefix('#') {
            Some(id) => page.contains(&format!("id=\"{id}\"")),
            None => suite.folder.join(link).is_file(),
        };
        assert!(is_there, "{link}");
    }
}

#[test]
fn the_table_has_a_row_for_each_value() {
    let suite = suite();
    let text = std::fs::read_to_string(suite.folder.join("stability.csv")).expect("a table");
    assert_eq!(text.lines().next(), Some(COLUMNS));
    let values = |scenario: &Value| -> usize {
        let curves = scenario["breakdowns"].as_array().expect("curves");
        curves.iter().map(|curve| curve["values"].as_array().map_or(0, Vec::len)).sum()
    };
    assert_eq!(text.lines().count() - 1, suite.scenarios().iter().map(values).sum::<usize>());
}

#[test]
fn stability_is_refused_beside_what_only_charts_take() {
    let home = tempfile::tempdir().expect("a temporary folder");
    let mesh = home.path().join("plane.glb");
    std::fs::write(&mesh, meshes::plane(1).to_glb()).expect("written");
    let (height, out) = (sample("maps/rock_height.png"), home.path().join("out"));
    let words = ["chart", path(&mesh), "--height", path(&height), "-o", path(&out), "--stability", "--repeats", "2"];
    let run = displace(&[&words[..], &["--server", reference()]].concat());
    assert_eq!(run.code, Some(2), "{run:?}");
    assert!(run.stderr.contains("--repeats"), "{}", run.stderr);
}
