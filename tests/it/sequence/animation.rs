//! Cameras that the file's animations move.

use base64::Engine as _;
use displace_tests::{
    cli::Run,
    glb, meshes,
    server::{displace, reference},
};
use serde_json::{Value, json};

/// A wall with a camera in front of it that comes to a third as far, `fly`, and an animation that moves the wall, `fall`.
fn wall() -> Vec<u8> {
    let plain = meshes::plane(2).to_glb();
    let length = u32::from_le_bytes(plain[12..16].try_into().expect("four bytes")) as usize;
    let mut document: Value = serde_json::from_slice(&plain[20..20 + length]).expect("a document");
    let keys: Vec<u8> = [0f32, 2.0, 0.0, 3.0, 0.0, 0.2, 1.0, 0.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    let uri = format!("data:;base64,{}", base64::engine::general_purpose::STANDARD.encode(keys));
    let push = |document: &mut Value, list: &str, value: Value| {
        let list = document[list].as_array_mut().expect("a list");
        list.push(value);
        list.len() - 1
    };
    let buffer = push(&mut document, "buffers", json!({ "byteLength": 32, "uri": uri }));
    let view = push(&mut document, "bufferViews", json!({ "buffer": buffer, "byteLength": 32 }));
    let accessor = |offset: u32, kind: &str| json!({ "bufferView": view, "byteOffset": offset, "componentType": 5126, "count": 2, "type": kind });
    let times = push(&mut document, "accessors", accessor(0, "SCALAR"));
    let places = push(&mut document, "accessors", accessor(8, "VEC3"));
    // Looks down at the wall, which lies in the plane of x and z.
    let down = json!([-(0.5f64.sqrt()), 0, 0, 0.5f64.sqrt()]);
    let camera =
        push(&mut document, "nodes", json!({ "name": "Eye", "camera": 0, "translation": [0, 3, 0], "rotation": down }));
    document["scenes"][0]["nodes"].as_array_mut().expect("roots").push(camera.into());
    document["cameras"] =
        json!([{ "name": "Eye", "type": "perspective", "perspective": { "yfov": 0.7, "znear": 0.1 } }]);
    let animation = |name: &str, node: usize| {
        let channel = json!({ "sampler": 0, "target": { "node": node, "path": "translation" } });
        json!({ "name": name, "samplers": [{ "input": times, "output": places }], "channels": [channel] })
    };
    document["animations"] = json!([animation("fly", camera), animation("fall", 0)]);
    glb::pack(&document, &plain[28 + length..])
}

fn render(folder: &tempfile::TempDir, out: &str, flags: &[&str]) -> Run {
    let path = |name: &str| folder.path().join(name).to_str().expect("temporary folders are UTF-8").to_owned();
    std::fs::write(path("wall.glb"), wall()).expect("written");
    let (mesh, out) = (path("wall.glb"), path(out));
    let args = ["render", &mesh, "-o", &out, "--size", "48x32", "--json", "--server", reference()];
    displace(&[&args[..], flags].concat())
}

#[test]
fn a_camera_of_the_file_goes_its_way() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let bytes = |name: &str| std::fs::read(folder.path().join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
    let frames = |report: &Value| report["frames"].as_array().map(Vec::len);
    let report = render(&folder, "out.png", &["--animation", "fly", "--frames", "3"]).expect_success().json();
    assert_eq!(frames(&report), Some(3));
    render(&folder, "still.png", &["--camera", "Eye"]).expect_success();
    assert!(bytes("out-0000.png") == bytes("still.png"), "it begins where the camera stands");
    assert!(bytes("out-0001.png") != bytes("out-0000.png") && bytes("out-0002.png") != bytes("out-0001.png"));
    let middle = bytes("out-0001.png");
    let report = render(&folder, "out.png", &["--animation", "0", "--fps", "2", "--camera", "Eye"]).expect_success();
    assert_eq!(frames(&report.json()), Some(5), "two seconds");
    assert!(bytes("out-0002.png") == middle, "after one second");
}

#[test]
fn the_tolerance_is_kept_along_the_way() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let surface = ["--expr", "0.1*sin(30*u)*sin(30*v)", "--tolerance-px", "0.5", "--tessellation", "hysteresis"];
    let flags = [&surface[..], &["--animation", "fly", "--frames", "24"]].concat();
    let report = render(&folder, "out.png", &flags).expect_success().json();
    assert!(report["tessellations"].as_u64() > Some(1), "a third as far in the end: {report}");
    let pop = report["worst_pop_px"].as_f64().expect("a figure");
    assert!(pop > 0.0 && pop <= 0.5, "{pop}");
}

#[test]
fn what_moves_no_camera_is_refused_by_name() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let refused = |flags: &[&str], parts: &[&str]| {
        let run = render(&folder, "out.png", flags);
        assert!(run.code != Some(0), "{flags:?}: {run:?}");
        assert!(parts.iter().all(|part| run.stderr.contains(part)), "{flags:?}: {}", run.stderr);
    };
    refused(&["--animation", "fall", "--frames", "3"], &["'fall' moves the mesh of node"]);
    refused(&["--animation", "none", "--frames", "3"], &["no animation 'none'", "'fly', 'fall'"]);
    refused(
        &["--animation", "fly", "--fps", "900"],
        &["sequence.animation.fps", "more than 1000 frames of 2.000 seconds"],
    );
    refused(&["--animation", "fly", "--fps", "0"], &["sequence.animation.fps", "0.001 to 1000"]);
    refused(&["--animation", "fly"], &["--frames"]);
}
