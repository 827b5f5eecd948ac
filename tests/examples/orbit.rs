//! How far a surface jumps from frame to frame of an orbit: frozen, tessellated anew for each frame, and with hysteresis.
//! Writes `tests/charts/orbit.csv` and `orbit.md`.
//!
//! `cargo run -p displace-tests --example orbit`

use std::fmt::Write as _;

use displace_tests::{
    cli::Displace,
    data::{repository, sample},
};
use serde_json::Value;

const HOW: [&str; 3] = ["frozen", "per-frame", "hysteresis"];
/// Near enough that the far side of the torus is allowed three times what the near side is.
const ORBIT: [&str; 6] = ["--orbit", "0,15,3.5", "--orbit-frames", "60", "--size", "256x192"];
const TOLERANCE_PX: &str = "0.5";

fn main() {
    let displace = Displace::default();
    let reports = HOW.map(|how| report(&displace, how));
    let folder = repository().join("tests/charts");
    std::fs::write(folder.join("orbit.csv"), csv(&reports)).expect("the table can be written");
    std::fs::write(folder.join("orbit.md"), markdown(&reports)).expect("the page can be written");
}

fn report(displace: &Displace, how: &str) -> Value {
    let (mesh, height) = (sample("models/torus.gltf"), sample("maps/rock_height.png"));
    let [mesh, height] = [&mesh, &height].map(|path| path.to_str().expect("paths are UTF-8"));
    let out = displace.folder().join("frame.png");
    let args = ["render", mesh, "--height", height, "--scale", "0.1", "--tolerance-px", TOLERANCE_PX];
    let how = ["--tessellation", how, "--json", "-o", out.to_str().expect("paths are UTF-8")];
    displace.run([&args[..], &ORBIT, &how].concat()).expect_success().json()
}

fn frames(report: &Value) -> &Vec<Value> {
    report["frames"].as_array().expect("a sequence has frames")
}

fn csv(reports: &[Value]) -> String {
    let mut text = String::from("tessellation,view,triangles,pop_px,morph\n");
    for (how, report) in HOW.iter().zip(reports) {
        for frame in frames(report) {
            let pop = frame["pop_px"].as_f64().expect("a figure");
            let (view, triangles, morph) = (&frame["view"], &frame["triangles"], &frame["morph"]);
            let _ = writeln!(text, "{how},{view},{triangles},{pop:.4},{morph}");
        }
    }
    text
}

fn markdown(reports: &[Value]) -> String {
    let mut text = format!(
        "# How far a surface jumps from frame to frame

`cargo run -p displace-tests --example orbit` makes this page and [`orbit.csv`](orbit.csv): a torus of rock, 60 frames of one turn
around it, 256 x 192 pixels, within {TOLERANCE_PX} pixels of the surface in every frame. A jump is the largest distance in
pixels between what two frames show of the same place, both seen by the later one's camera, of all of the surface.

| `--tessellation` | worst jump | proven at most | tessellations | triangles, mean | most |
|---|---|---|---|---|---|
"
    );
    let proven = ["0 px", "0.5 px", "0.25 px"];
    for ((how, proven), report) in HOW.iter().zip(proven).zip(reports) {
        let counts: Vec<u64> = frames(report).iter().filter_map(|frame| frame["triangles"].as_u64()).collect();
        let (mean, most) = (counts.iter().sum::<u64>() / counts.len() as u64, counts.iter().max().unwrap_or(&0));
        let worst = report["worst_pop_px"].as_f64().expect("a figure");
        let made = &report["tessellations"];
        let _ = writeln!(text, "| `{how}` | {worst:.3} px | {proven} | {made} | {mean} | {most} |");
    }
    text
}
