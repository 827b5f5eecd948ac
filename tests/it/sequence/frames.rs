//! `displace render` of sequences: what frames show, how far they jump, and what is refused.

use std::path::{Path, PathBuf};

use displace_tests::{
    cli::Run,
    data::sample,
    maps, meshes,
    server::{displace, reference},
};
use serde_json::Value;

const TOLERANCE_PX: f64 = 0.5;

/// A rough ball in a folder.
struct Ball {
    folder: tempfile::TempDir,
}

impl Ball {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join("ball.glb"), meshes::uv_sphere(12, 6).to_glb()).expect("written");
        std::fs::write(folder.path().join("noise.png"), maps::noise16(16, 3)).expect("written");
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn render(&self, out: &str, flags: &[&str]) -> Run {
        let paths = ["ball.glb", "noise.png", out].map(|name| self.path(name));
        let [mesh, noise, out] = paths.each_ref().map(|path| path.to_str().expect("temporary folders are UTF-8"));
        let args = ["render", mesh, "-o", out, "--height", noise, "--scale", "0.1", "--json", "--server", reference()];
        displace(&[&args[..], flags].concat())
    }

    /// A turn close around it.
    fn turn(&self, out: &str, tessellation: &str) -> Value {
        let flags = ["--orbit", "0,10,2.2", "--orbit-frames", "20", "--size", "48x32", "--tolerance-px", "0.5"];
        let flags = [&flags[..], &["--tessellation", tessellation]].concat();
        self.render(out, &flags).expect_success().json()
    }

    fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }
}

fn frames(report: &Value) -> &Vec<Value> {
    report["frames"].as_array().expect("frames")
}

fn figures(report: &Value, of: &str) -> Vec<f64> {
    frames(report).iter().map(|frame| frame[of].as_f64().unwrap_or_else(|| panic!("{of} in {frame}"))).collect()
}

fn largest(figures: &[f64]) -> f64 {
    figures.iter().copied().fold(0.0, f64::max)
}

#[test]
fn frames_of_one_mesh_are_the_images_that_renders_of_each_make() {
    let ball = Ball::new();
    let look = ["--uniform", "3", "--size", "64x48", "--aov", "depth"];
    let report = ball.render("out.png", &[&look[..], &["--orbit", "30,20", "--orbit-frames", "3"]].concat());
    let report = report.expect_success().json();
    assert_eq!(figures(&report, "pop_px"), [0.0; 3]);
    assert_eq!(report["outputs"].as_array().map(Vec::len), Some(6));
    for (number, azimuth) in ["30", "150", "270"].into_iter().enumerate() {
        let orbit = format!("{azimuth},20");
        ball.render("still.png", &[&look[..], &["--orbit", &orbit]].concat()).expect_success();
        assert!(ball.bytes(&format!("out-{number:04}.png")) == ball.bytes("still.png"), "frame {number}");
        assert!(ball.bytes(&format!("out-{number:04}.depth.png")) == ball.bytes("still.depth.png"), "frame {number}");
    }
}

#[test]
fn what_is_frozen_stands_still_what_is_made_anew_jumps_and_what_is_led_over_jumps_by_half_the_tolerance_at_most() {
    let ball = Ball::new();
    let [frozen, anew, kept] = ["frozen", "per-frame", "hysteresis"].map(|how| ball.turn("out.png", how));
    for report in [&frozen, &anew, &kept] {
        assert_eq!(frames(report).len(), 20);
        // Of two that have nothing in common each keeps half.
        let share = if report["tessellations"] == 20 { 0.5 } else { 1.0 };
        assert!(figures(report, "tolerance_px").iter().all(|px| *px == share * TOLERANCE_PX), "{report}");
        assert_eq!(report["worst_pop_px"].as_f64(), Some(largest(&figures(report, "pop_px"))));
    }
    assert_eq!((frozen["worst_pop_px"].as_f64(), &frozen["tessellations"]), (Some(0.0), &1.into()));
    assert_eq!(anew["tessellations"], 20);
    let pops = figures(&anew, "pop_px");
    assert!(pops[0] == 0.0 && pops[1..].iter().all(|px| *px > 0.0 && *px <= TOLERANCE_PX), "{pops:?}");
    let (pops, morphs) = (figures(&kept, "pop_px"), figures(&kept, "morph"));
    assert!(largest(&pops) > 0.0 && largest(&pops) <= 0.5 * TOLERANCE_PX, "{pops:?}");
    assert!(largest(&pops) < anew["worst_pop_px"].as_f64().unwrap(), "{pops:?} {}", anew["worst_pop_px"]);
    let made = kept["tessellations"].as_u64().unwrap();
    assert!(made > 1 && made < 10, "{made}");
    assert_eq!(morphs.iter().filter(|morph| **morph == 0.25).count() as u64, made - 1, "{morphs:?}");
    // Kept tessellations are made for fewer cameras than frozen ones, so none has more triangles.
    let alone = |report: &Value| {
        let whole = frames(report).iter().filter(|frame| frame["morph"] == 0.0);
        whole.map(|frame| frame["triangles"].as_u64().unwrap()).max().unwrap()
    };
    assert!(alone(&kept) <= alone(&frozen), "{} {}", alone(&kept), alone(&frozen));
}

#[test]
fn a_sequence_run_again_is_the_same_to_the_byte() {
    let ball = Ball::new();
    let flags = ["--orbit", "0,10,2.2", "--orbit-frames", "14", "--size", "48x32", "--tolerance-px", "1", "--fresh"];
    let flags = [&flags[..], &["--tessellation", "hysteresis"]].concat();
    let [once, again] =
        ["a.exr", "b.exr"].map(|out| ball.render(out, &flags).expect_success().json()["outputs"].clone());
    let digests = |outputs: &Value| -> Vec<String> {
        outputs.as_array().unwrap().iter().map(|output| output["digest"].to_string()).collect()
    };
    assert_eq!(digests(&once), digests(&again));
    assert_eq!(digests(&once).len(), 14);
}

#[test]
fn methods_that_move_nothing_have_frames_too() {
    let ball = Ball::new();
    let flags = ["--orbit", "0,10", "--orbit-frames", "2", "--size", "48x32", "--method", "bump"];
    let report = ball.render("out.png", &flags).expect_success().json();
    assert_eq!((frames(&report).len(), report["worst_pop_px"].as_f64()), (2, Some(0.0)));
    assert!(ball.bytes("out-0000.png") != ball.bytes("out-0001.png"));
}

#[test]
fn what_makes_no_frames_is_refused_with_what_would() {
    let ball = Ball::new();
    let refused = |flags: &[&str], field: &str, part: &str| {
        let run = ball.render("out.png", flags);
        assert_eq!(run.code, Some(2), "{flags:?}: {run:?}");
        let error = &run.json()["error"];
        assert_eq!(error["field"], field, "{flags:?}: {error}");
        assert!(error["message"].as_str().is_some_and(|message| message.contains(part)), "{flags:?}: {error}");
    };
    let orbit = ["--orbit", "0,0", "--orbit-frames", "4"];
    refused(&["--uniform", "1", "--orbit-frames", "4"], "--orbit", "--orbit");
    refused(&["--uniform", "1", "--orbit", "0,0", "--orbit-frames", "1001"], "--orbit-frames", "1..=1000");
    refused(&[&orbit[..], &["--method", "auto"]].concat(), "surface.method", "name a method");
    for how in ["per-frame", "hysteresis"] {
        let flags = [&orbit[..], &["--uniform", "1", "--tessellation", how]].concat();
        refused(&flags, "sequence.tessellation", "--tolerance-px");
    }
    refused(&[&orbit[..], &["--uniform", "1", "--preimage", "1,1"]].concat(), "preimage", "leave it out");
    refused(&[&orbit[..], &["--exact"]].concat(), "surface.geometry.exact", "tolerance");
    let run =
        ball.render("out.png", &["--uniform", "1", "--orbit", "0,0", "--orbit-frames", "1000", "--size", "8192x8192"]);
    assert_eq!(run.code, Some(2), "{run:?}");
    for part in ["views: 1000 frames of 8192 x 8192 pixels", "ask for up to"] {
        assert!(run.stderr.contains(part), "{part}: {run:?}");
    }
}

#[test]
fn a_textured_sample_turns() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (mesh, height, out) =
        (sample("models/torus.gltf"), sample("maps/rock_height.png"), folder.path().join("frame.png"));
    let path = |path: &Path| path.to_str().expect("UTF-8").to_owned();
    let args = ["render", &path(&mesh), "--height", &path(&height), "--scale", "0.1", "--tolerance-px", "1"];
    let more = ["--orbit", "0,20", "--orbit-frames", "8", "--size", "96x64", "--tessellation", "hysteresis"];
    let told = ["-o", &path(&out), "--server", reference()];
    let run = displace(&[&args[..], &more, &told].concat()).expect_success();
    assert!(run.stdout.contains("8 frames of") && run.stdout.contains("nothing jumps by more than"), "{}", run.stdout);
    assert!(folder.path().join("frame-0007.png").is_file());
}
