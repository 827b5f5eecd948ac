//! Where methods fail, drawn: runs the stability suite over rock on the two-sided plane of the samples and writes table,
//! curves and README of `tests/charts/stability`. Fails where something that must hold anywhere does not.
//!
//! `cargo bench --profile dev -p displace-tests --bench stability`

use std::{fmt::Write as _, fs, path::Path};

use displace_tests::{
    cli::Displace,
    data::{repository, sample},
};
use serde_json::Value;

const HEAD: &str = "\
# Where methods fail

`cargo bench --profile dev -p displace-tests --bench stability` draws this page and what lies beside it anew, by `displace chart --stability` over
[`rock_height.png`](../../data/maps/rock_height.png) on the two-sided plane of the samples. Each scenario sweeps one parameter past the
point where a method fails; the dashed line is what still passes, and a method breaks where its curve crosses it first, between two
values by a straight line. All values: [`stability.csv`](stability.csv).
";

fn main() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (mesh, height) = (sample("models/TwoSidedPlane/TwoSidedPlane.gltf"), sample("maps/rock_height.png"));
    let words = ["chart", text(&mesh), "--height", text(&height), "--scale", "0.1", "--stability", "--json", "--fresh"];
    let run = Displace::default().run([&words[..], &["-o", text(folder.path())]].concat());
    let told = run.expect_success().json();
    let charts = repository().join("tests/charts/stability");
    fs::create_dir_all(&charts).expect("the folder can be made");
    let all = read(&folder.path().join("stability.json"));
    fs::copy(folder.path().join("stability.csv"), charts.join("stability.csv")).expect("the table can be copied");
    for name in all["scenarios"].as_array().expect("scenarios").iter().filter_map(|s| s["name"].as_str()) {
        let name = format!("{name}.svg");
        fs::copy(folder.path().join(&name), charts.join(&name)).expect("the curves can be copied");
    }
    fs::write(charts.join("README.md"), page(&all)).expect("the page can be written");
    let broken: Vec<&Value> = told["scenarios"]
        .as_array()
        .expect("scenarios")
        .iter()
        .filter(|scenario| scenario["violations"].as_array().is_none_or(|all| !all.is_empty()))
        .collect();
    assert!(broken.is_empty(), "{broken:#?}");
    println!("{} ms; written to {}", told["total_ms"], charts.display());
}

fn text(path: &Path) -> &str {
    path.to_str().expect("paths here are UTF-8")
}

fn read(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).expect("the suite is written")).expect("JSON")
}

fn page(all: &Value) -> String {
    let scenarios = all["scenarios"].as_array().expect("scenarios");
    let checks: u64 = scenarios.iter().filter_map(|scenario| scenario["checks"].as_u64()).sum();
    let mut page = HEAD.to_owned();
    let _ = writeln!(
        page,
        "\nDevice: {}; driver: {}. Of {checks} checks of what must hold anywhere (finite outputs, closed surfaces, bounded marches, tolerances \
         kept or told, the same bytes again) none failed.",
        word(&all["device"]),
        word(&all["driver"])
    );
    scenarios.iter().for_each(|scenario| section(&mut page, scenario));
    page
}

fn word(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

fn section(page: &mut String, scenario: &Value) {
    let unit = word(&scenario["unit"]);
    let _ = writeln!(
        page,
        "\n## {title}\n\n{}\n\n![{title}]({}.svg)\n\nOn {}; up to {} {} passes.\n\n| method | breaks at | published |\n|---|---|---|",
        word(&scenario["story"]),
        word(&scenario["name"]),
        word(&scenario["asset"]),
        scenario["line"],
        word(&scenario["metric_unit"]),
        title = word(&scenario["title"]),
    );
    for curve in scenario["curves"].as_array().expect("curves") {
        let line = scenario["line"].as_f64().expect("a line");
        let values = || curve["values"].as_array().expect("values").iter().filter_map(|pair| pair[1].as_f64());
        let at = match curve["breakdown"].as_f64() {
            None => "–".to_owned(),
            Some(_) if values().all(|value| value > line) => "throughout".to_owned(),
            Some(at) => format!("{at:.3} {unit}"),
        };
        let _ = writeln!(page, "| {} | {} | {} |", word(&curve["method"]), at.trim_end(), word(&curve["literature"]));
    }
}
