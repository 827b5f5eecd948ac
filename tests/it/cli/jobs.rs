//! Jobs through the command line: reports, outputs, details per material.

use displace_tests::{data::sample, glb, maps, meshes};

use super::{Folder, keys, remote, report};

fn torus() -> String {
    sample("models/torus.gltf").to_string_lossy().into_owned()
}

#[test]
fn apply_reports_what_the_contract_says() {
    let folder = Folder::new();
    let output = folder.path("out.glb");
    let height = folder.file("noise.png", maps::noise16(32, 1));
    let value = report(&["apply", &torus(), "--height", &height, "--scale", "0.1", "--uniform", "1", "-o", &output]);
    for key in [
        "method",
        "triangles_in",
        "triangles",
        "vertices",
        "seams",
        "flipped",
        "stretch",
        "warnings",
        "passes",
        "total_ms",
        "outputs",
        "device",
        "cached",
    ] {
        assert!(keys(&value).contains(&key), "{key} is not in {value}");
    }
    assert_eq!((value["method"].as_str(), value["device"].as_str()), (Some("displacement"), Some("reference")));
    assert_eq!((&value["triangles_in"], &value["triangles"]), (&3072.into(), &(4 * 3072).into()));
    let written = std::fs::read(&output).unwrap();
    assert_eq!(value["outputs"][0]["bytes"], written.len());
    assert_eq!(value["outputs"][0]["media_type"], "model/gltf-binary");
    assert_eq!(glb::joined(&glb::read(&written)).triangles.len(), 4 * 3072);
    assert!(!value.to_string().contains("null"), "absent fields are absent: {value}");
}

#[test]
fn the_same_request_is_answered_from_the_store_unless_fresh() {
    let folder = Folder::new();
    let output = folder.path("out.glb");
    let args = ["apply", &torus(), "--expr", "0.01*sin(31*x)", "--uniform", "1", "-o", &output];
    let first = report(&args);
    let bytes = std::fs::read(&output).unwrap();
    assert_eq!(report(&args)["cached"], true);
    let fresh = report(&[&args[..], &["--fresh"]].concat());
    assert_eq!((&first["cached"], &fresh["cached"]), (&false.into(), &false.into()));
    assert_eq!(bytes, std::fs::read(&output).unwrap());
}

#[test]
fn a_failed_job_leaves_the_old_file_and_no_other() {
    let folder = Folder::new();
    let output = folder.file("out.glb", "old");
    for bad in [
        "glb__only_header.glb",
        "glb__truncated_chunk_header.glb",
        "mesh__unresolved_positions.gltf",
        "json__empty_file.gltf",
    ] {
        let mesh = sample(&format!("invalid/validator__{bad}"));
        let run = remote(&["apply", mesh.to_str().unwrap(), "--uniform", "1", "-o", &output, "--json"]);
        assert_eq!(run.code, Some(2), "{bad}: {run:?}");
        assert_eq!(keys(&run.json()), ["error"], "{bad}");
    }
    assert_eq!(std::fs::read_to_string(&output).unwrap(), "old");
    assert_eq!(folder.names(), ["out.glb"]);
}

#[test]
fn a_dry_run_says_sizes_and_writes_nothing() {
    let folder = Folder::new();
    let value = report(&["apply", &torus(), "--expr", "u", "--uniform", "3", "--dry-run"]);
    assert_eq!(value["triangles"], 64 * 3072);
    for key in ["triangles_in", "vertices", "device_bytes", "output_bytes", "cached", "warnings"] {
        assert!(keys(&value).contains(&key), "{key} is not in {value}");
    }
    assert!(folder.names().is_empty());
}

#[test]
fn a_dry_run_of_a_tolerance_says_only_what_is_known() {
    let value = report(&["apply", &torus(), "--expr", "u", "--tolerance-world", "1e-12", "--dry-run"]);
    for key in ["triangles", "vertices", "device_bytes", "output_bytes"] {
        assert!(!keys(&value).contains(&key), "{key} is in {value}");
    }
    let clamped = |w: &serde_json::Value| w["code"] == "tolerance_clamped";
    assert!(value["warnings"].as_array().unwrap().iter().any(clamped), "{value}");
    // A thousandth of the diagonal is what `apply` does unless told otherwise.
    let value = report(&["apply", &torus(), "--expr", "u", "--dry-run"]);
    assert_eq!(value["triangles_in"], 3072);
}

#[test]
fn a_tolerance_holds_with_the_positions_that_a_packed_file_has() {
    let folder = Folder::new();
    let (output, height) = (folder.path("out.glb"), folder.file("noise.png", maps::noise16(16, 1)));
    let args = |extra: &[&str]| -> Vec<String> {
        let base = ["apply", &torus(), "--height", &height, "--scale", "0.05", "--tolerance", "5e-3", "-o", &output];
        base.iter().chain(extra).map(|arg| (*arg).to_owned()).collect()
    };
    let plain = report(&args(&[]));
    for kind in ["quantize", "meshopt"] {
        let packed = report(&args(&["--compress", kind]));
        let warned = packed["warnings"].as_array().unwrap().iter().any(|w| w["code"] == "positions_not_quantized");
        assert!(!warned, "{packed}");
        let (bound, kept) = (&packed["accuracy"]["bound"], &packed["achieved_tolerance"]);
        assert!(bound.as_f64().unwrap() <= 5e-3 * (1.0 + 1e-9), "{packed}");
        assert!((kept.as_f64().unwrap() - 5e-3).abs() < 1e-9, "{packed}");
        assert!(packed["outputs"][0]["bytes"].as_u64() < plain["outputs"][0]["bytes"].as_u64(), "{packed}");
        let described = report(&["describe", &output]);
        assert_eq!(described["meshes"][0]["triangles"], packed["triangles"], "{described}");
    }
}

#[test]
fn a_base_mesh_of_more_than_max_triangles_is_refused() {
    let run = remote(&["apply", &torus(), "--expr", "u", "--max-triangles", "3071", "--dry-run"]);
    assert_eq!(run.code, Some(2), "{run:?}");
    assert!(run.stderr.contains("3072 triangles before any is split, more than the 3071"), "{}", run.stderr);
}

#[test]
fn a_plan_above_max_triangles_is_refused() {
    let folder = Folder::new();
    let output = folder.path("out.glb");
    let args = |limit: &'static str| {
        ["apply", &torus(), "--expr", "0.01*u", "--uniform", "1", "--max-triangles", limit, "-o", &output]
            .map(str::to_owned)
    };
    let run = remote(&args("12287"));
    assert_eq!(run.code, Some(2), "{run:?}");
    assert!(run.stderr.contains("12288") && run.stderr.contains("12287"), "{}", run.stderr);
    assert!(folder.names().is_empty());
    remote(&args("12288")).expect_success();
}

#[test]
fn an_expression_that_does_not_parse_is_shown_with_a_caret() {
    let run = remote(&["apply", &torus(), "--expr", "sin(20*pi*", "--uniform", "1", "-o", "unused.glb"]);
    assert_eq!(run.code, Some(2), "{run:?}");
    assert!(run.stderr.contains('^'), "{}", run.stderr);
}

/// Two squares side by side, each of its own material.
const HOUSE: &str = "\
v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 3 0 0\nv 3 1 0\nv 2 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
usemtl Wall\nf 1/1 2/2 3/3 4/4\nusemtl Roof\nf 5/1 6/2 7/3 8/4\n";

fn heights(path: &str) -> [f32; 2] {
    let all = glb::joined(&glb::read(&std::fs::read(path).unwrap()));
    let highest = |inside: fn(f32) -> bool| {
        all.positions.iter().filter(|p| inside(p[0])).map(|p| p[2]).fold(f32::NEG_INFINITY, f32::max)
    };
    [highest(|x| x < 1.5), highest(|x| x > 1.5)]
}

#[test]
fn a_group_reaches_its_material_and_the_first_group_the_others() {
    let folder = Folder::new();
    let (mesh, output) = (folder.file("house.obj", HOUSE), folder.path("out.glb"));
    let apply = |flags: &[&str]| {
        report(&[&["apply", mesh.as_str()][..], flags, &["--uniform", "1", "-o", &output]].concat());
        heights(&output)
    };
    assert_eq!(
        apply(&["--expr", "0.25", "--material", "Roof", "--expr", "0.25", "--scale", "2", "--expr", "1"]),
        [0.25, 1.5]
    );
    assert_eq!(apply(&["--material", "Wall", "--expr", "0.5"]), [0.5, 0.0]);
}

#[test]
fn a_material_the_mesh_does_not_have_is_named() {
    let folder = Folder::new();
    let mesh = folder.file("house.obj", HOUSE);
    let run =
        remote(&["apply", &mesh, "--material", "Cellar", "--expr", "1", "--uniform", "1", "-o", &folder.path("o.glb")]);
    assert_eq!(run.code, Some(2), "{run:?}");
    assert!(run.stderr.contains("Cellar"), "{}", run.stderr);
}

#[test]
fn render_writes_the_image_and_its_aovs() {
    let folder = Folder::new();
    let mesh = folder.file("cube.glb", meshes::cube().to_glb());
    let output = folder.path("out.png");
    let value =
        report(&["render", &mesh, "--orbit", "30,20", "--size", "48x32", "--aov", "depth,normal", "-o", &output]);
    assert_eq!(value["method"], "flat");
    assert_eq!(folder.names(), ["cube.glb", "out.depth.png", "out.normal.png", "out.png"]);
    let image = image::open(&output).unwrap();
    assert_eq!((image.width(), image.height()), (48, 32));
    report(&["render", &mesh, "--size", "16x16", "--aov", "uv", "-o", &folder.path("out.exr")]);
    assert_eq!(folder.names().len(), 5);
}
