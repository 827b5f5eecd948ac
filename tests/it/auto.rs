//! `--method auto`: what is chosen is near enough, and all that is said of it is so.

use std::path::{Path, PathBuf};

use displace_server::domain::image::ImageSet;
use displace_tests::{
    cli::Run,
    data::sample,
    maps, meshes,
    reprojected::{Displaced, layers},
    server::{displace, reference, validated},
};
use serde_json::Value;

const SCALE: f32 = 0.1;
/// Eyes above a plane of side 1: so near that heights are many pixels, and so far that they are less than one.
const NEAR: &str = "0,0.7,0.9";
const FAR: &str = "0,21,27";

/// A plane and heights on it.
struct Bench {
    folder: tempfile::TempDir,
    map: PathBuf,
}

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join("plane.glb"), meshes::plane(2).to_glb()).expect("written");
        Self { folder, map: sample("maps/rock_height.png") }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// An image of the plane, 96 pixels wide.
    fn run(&self, flags: &str, eye: &str, out: &str, server: &str) -> Run {
        let text = |path: &Path| path.to_str().expect("UTF-8").to_owned();
        let (mesh, map, out) = (text(&self.path("plane.glb")), text(&self.map), text(&self.path(out)));
        let scale = SCALE.to_string();
        let fixed = ["render", &mesh, "--height", &map, "--scale", &scale, "--size", "96x96", "--eye", eye];
        let ends = ["--look-at", "0,0,0", "-o", &out, "--json", "--server", server];
        let flags: Vec<&str> = flags.split_whitespace().collect();
        displace(&[&fixed[..], &flags, &ends].concat())
    }

    fn report(&self, flags: &str, eye: &str, out: &str) -> Value {
        self.run(flags, eye, out, validated()).expect_success().json()
    }

    fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).expect(name)
    }
}

fn px(choice: &Value, what: &str) -> f64 {
    choice[what].as_f64().unwrap_or_else(|| panic!("{what} is not in {choice}"))
}

#[test]
fn what_is_chosen_is_off_by_no_more_than_predicted_nor_that_by_more_than_allowed() {
    let bench = Bench::new();
    let surface = Displaced::load(&bench.path("plane.glb"), &bench.map, SCALE);
    for (eye, tolerance_px) in [(NEAR, 0.5), (NEAR, 4.0), (NEAR, 30.0), (FAR, 0.5), (FAR, 2.0)] {
        let flags = format!("--tolerance-px {tolerance_px} --aov depth,position,uv");
        let report = bench.report(&flags, eye, "out.exr");
        let choice = &report["choices"][0];
        let error_px = surface.p99_px(&layers(&bench.path("out.exr"))).expect("something is seen");
        assert!(px(choice, "predicted") <= tolerance_px && px(choice, "predicted_outline") <= tolerance_px, "{choice}");
        assert!(error_px <= px(choice, "predicted"), "{eye}: measured {error_px}, {choice}");
        assert_eq!(px(choice, "tolerance_px"), tolerance_px);
    }
}

#[test]
fn heights_that_are_far_away_only_bend_normals_and_those_near_by_do_more() {
    let bench = Bench::new();
    let far = bench.report("", FAR, "far.png");
    assert_eq!((&far["method"], &far["choices"][0]["method"]), (&"bump".into(), &"bump".into()), "{far}");
    assert_eq!(far["triangles"], far["triangles_in"]);
    assert!(px(&far["choices"][0], "measured") <= px(&far["choices"][0], "predicted"), "{far}");
    let near = bench.report("", NEAR, "near.png");
    let choice = &near["choices"][0];
    assert_ne!(choice["method"], "bump", "{near}");
    let cheaper = &choice["next_cheaper"];
    assert!(px(&cheaper["cost"], "ms") < px(&choice["cost"], "ms"), "{choice}");
    let worst = cheaper["predicted"].as_f64().unwrap_or(f64::INFINITY);
    assert!(
        worst.max(cheaper["predicted_outline"].as_f64().unwrap_or(f64::INFINITY)) > 0.5,
        "else it would do: {choice}"
    );
}

#[test]
fn an_image_by_auto_is_the_image_by_what_it_chose() {
    let bench = Bench::new();
    for (eye, tolerance_px) in [(FAR, 0.5), (NEAR, 0.5)] {
        let tolerance = format!("--tolerance-px {tolerance_px}");
        let auto = bench.report(&tolerance, eye, "auto.png");
        let choice = auto["choices"][0].clone();
        let setting = match choice["setting"].as_str() {
            Some("") => String::new(),
            Some("shell") => "--silhouettes shell".into(),
            _ => tolerance,
        };
        let flags = format!("--method {} {setting}", choice["method"].as_str().expect("a method"));
        let named = bench.report(&flags, eye, "named.png");
        assert_eq!(auto["triangles"], named["triangles"], "{flags}");
        // What is finer than triangles only auto shades.
        let is_same = bench.bytes("auto.png") == bench.bytes("named.png");
        assert_eq!(is_same, choice["shades_rest"] != true, "{flags}");
    }
}

/// Of the surface itself, by 16 rays a pixel.
#[test]
fn few_triangles_are_shaded_by_all_of_their_heights() {
    let bench = Bench::new();
    let truth = bench.run("--method displacement --exact --supersample 16", NEAR, "truth.png", reference());
    truth.expect_success();
    let flip = |out: &str| {
        let [truth, out] = ["truth.png", out].map(|name| bench.path(name).to_str().expect("UTF-8").to_owned());
        let report = displace(&["compare", &truth, &out, "--json", "--server", validated()]).expect_success().json();
        report["flip_mean"].as_f64().expect("a figure")
    };
    let mut displaced = 0;
    for tolerance_px in [2, 4, 6, 8] {
        let tolerance = format!("--tolerance-px {tolerance_px}");
        let auto = bench.report(&tolerance, NEAR, "auto.png");
        let choice = &auto["choices"][0];
        // What costs less is the device's to say.
        if choice["method"] != "displacement" {
            continue;
        }
        displaced += 1;
        assert_eq!(choice["shades_rest"], true, "{auto}");
        let bare = bench.report(&format!("--method displacement {tolerance}"), NEAR, "bare.png");
        assert_eq!(bare["triangles"], auto["triangles"]);
        let (shaded, bare) = (flip("auto.png"), flip("bare.png"));
        println!("{tolerance_px} px: FLIP {shaded} shaded, {bare} without");
        assert!(shaded < 0.7 * bare, "{tolerance_px}: {shaded} shaded, {bare} without");
    }
    assert!(displaced > 1, "of four tolerances {displaced} ask for triangles");
}

#[test]
fn normals_that_were_asked_for_are_not_bent() {
    let bench = Bench::new();
    let flags = "--tolerance-px 6 --normals geometric";
    let auto = bench.report(flags, NEAR, "auto.png");
    assert_eq!((&auto["choices"][0]["method"], auto["choices"][0].get("shades_rest")), (&"displacement".into(), None));
    bench.report(&format!("--method displacement {flags}"), NEAR, "named.png");
    assert!(bench.bytes("auto.png") == bench.bytes("named.png"));
}

#[test]
fn pixels_without_a_view_are_those_of_the_image() {
    let bench = Bench::new();
    let own = bench.report("--method displacement --tolerance-px 1", NEAR, "own.png");
    let view = format!("--method displacement --tolerance-px 1 --view {NEAR};0,0,0;40;96x96");
    let told = bench.report(&view, NEAR, "told.png");
    assert_eq!((&own["triangles"], &own["accuracy"]["unit"]), (&told["triangles"], &told["accuracy"]["unit"]));
    // A camera is what is left of a view after matrices in f32.
    let [a, b] = [&own, &told].map(|report| px(&report["accuracy"], "bound"));
    assert!((a - b).abs() < 1e-6, "{a} {b}");
    let silent = bench.report("--method displacement", NEAR, "silent.png");
    assert_eq!(silent["tolerance"], 0.5, "half a pixel where nothing is said");
}

#[test]
fn what_cannot_be_shown_per_pixel_is_displaced_and_the_reason_is_told() {
    let bench = Bench::new();
    let shadows = bench.report("--shadows ray", NEAR, "shadows.png");
    assert_eq!(shadows["choices"][0]["method"], "displacement", "{shadows}");
    let base = bench.report("--base pn", FAR, "base.png");
    assert_eq!(base["choices"][0]["method"], "displacement");
    assert!(base["choices"][0]["reason"].as_str().is_some_and(|reason| reason.contains("curved")), "{base}");
    let rays = bench.run("--supersample 2", FAR, "rays.png", reference()).expect_success().json();
    assert!(rays["choices"][0]["reason"].as_str().is_some_and(|reason| reason.contains("rays")), "{rays}");
    let map = bench.map.to_str().expect("UTF-8").to_owned();
    let two = bench.report(&format!("--height {map} --scale 0.01"), FAR, "two.png");
    assert!(two["choices"][0]["reason"].as_str().is_some_and(|reason| reason.contains("not one height map")), "{two}");
    assert_eq!(two["choices"][0]["shades_rest"], true, "both bend normals");
    // More than a material has places for.
    let five = bench.report(&format!("--height {map} --scale 0.01 ").repeat(4), FAR, "five.png");
    assert_eq!(five["choices"][0]["method"], "displacement", "{five}");
    assert!(five["choices"][0].get("shades_rest").is_none(), "{five}");
}

#[test]
fn nothing_is_chosen_where_there_is_nothing_to_show() {
    let bench = Bench::new();
    let mesh = bench.path("plane.glb");
    let out = bench.path("flat.png");
    let words = ["render", mesh.to_str().expect("UTF-8"), "-o", out.to_str().expect("UTF-8"), "--size", "32x32"];
    let report = displace(&[&words[..], &["--json", "--server", validated()]].concat()).expect_success().json();
    assert_eq!((&report["method"], report.get("choices")), (&"flat".into(), None));
}

#[test]
fn what_leaves_nothing_to_choose_is_refused_with_what_to_do() {
    let bench = Bench::new();
    for (flags, field, part) in [
        ("--method auto --uniform 2", "surface.geometry.refinement", "name a method"),
        ("--method auto --tolerance 1e-3", "surface.geometry.refinement", "--tolerance-px without --view"),
        ("--method auto --preimage 4,4", "preimage", "--method displacement"),
        ("--method auto --steps 8", "lighting.relief.steps", "auto takes none"),
        ("--aov cost", "aovs[0]", "may choose another"),
    ] {
        let run = bench.run(flags, FAR, "out.png", validated());
        let error = &run.json()["error"];
        assert_eq!((run.code, &error["field"]), (Some(2), &field.into()), "{flags}: {error}");
        assert!(error["message"].as_str().is_some_and(|message| message.contains(part)), "{flags}: {error}");
    }
    let mesh = bench.path("plane.glb");
    let words = ["apply", mesh.to_str().expect("UTF-8"), "--expr", "0.1*u", "--method", "auto", "-o", "o.glb"];
    let run = displace(&[&words[..], &["--json", "--server", validated()]].concat());
    assert_eq!((run.code, &run.json()["error"]["field"]), (Some(2), &"method".into()), "{}", run.stdout);
}

/// Seen along z, 5 pixels for each world unit.
fn looked_at(uv: [f32; 2], position: [f32; 3]) -> ImageSet {
    ImageSet {
        width: 10,
        height: 10,
        depth: Some(vec![1.0]),
        position: Some(vec![position]),
        uv: Some(vec![uv]),
        clip_from_world: Some([1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]),
        ..ImageSet::default()
    }
}

#[test]
fn a_pixel_is_off_by_as_far_as_the_surface_has_elsewhere_what_it_shows() {
    let bench = Bench::new();
    let map = bench.path("high.png");
    std::fs::write(&map, maps::constant16(u16::MAX)).expect("written");
    // A plane across y that is raised by a fifth.
    let surface = Displaced::load(&bench.path("plane.glb"), &map, 0.2);
    let error_px = |uv: [f32; 2], position: [f32; 3]| surface.p99_px(&looked_at(uv, position)).expect("a pixel");
    assert!((error_px([0.5; 2], [0.0, 0.0, 0.0]) - 1.0).abs() < 1e-5, "as high as it is left flat");
    assert!(error_px([0.5; 2], [0.0, 0.2, 0.0]) < 1e-5, "as high as it is");
    assert!((error_px([0.5; 2], [0.3, 0.2, 0.0]) - 1.5).abs() < 1e-5, "another place");
    assert_eq!(error_px([1.5; 2], [0.0, 0.2, 0.0]), f64::INFINITY, "a place that no triangle has");
}
