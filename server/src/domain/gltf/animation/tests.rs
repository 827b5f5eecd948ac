//! Cameras on arms that turn.

use bytes::Bytes;
use serde_json::{Value, json};

use super::*;
use crate::domain::gltf::load;

/// A camera at (0, 0, 2) of a node that turns by 90 degrees around y in a second, and rises by 1.
fn moving(edit: impl FnOnce(&mut Value)) -> Scene {
    let half = 0.5f32.sqrt();
    let floats: Vec<f32> =
        [&[0.0, 1.0][..], &[0.0, 0.0, 0.0, 1.0], &[0.0, half, 0.0, half], &[0.0; 3], &[0.0, 1.0, 0.0]].concat();
    let bytes: Vec<u8> = floats.iter().flat_map(|x| x.to_le_bytes()).collect();
    let accessor = |offset: u32, kind: &str| json!({ "bufferView": 0, "byteOffset": offset, "componentType": 5126, "count": 2, "type": kind });
    let mut document = json!({
        "asset": { "version": "2.0" },
        "scene": 0, "scenes": [{ "nodes": [0, 2] }],
        "nodes": [{ "name": "arm", "children": [1] }, { "camera": 0, "translation": [0, 0, 2] }, { "name": "lamp" }],
        "cameras": [{ "type": "perspective", "perspective": { "yfov": 0.7, "znear": 0.1 } }],
        "animations": [
            { "name": "turn", "samplers": [{ "input": 0, "output": 1 }], "channels": [{ "sampler": 0, "target": { "node": 0, "path": "rotation" } }] },
            { "name": "rise", "samplers": [{ "input": 0, "output": 2 }], "channels": [
                { "sampler": 0, "target": { "node": 1, "path": "translation" } },
                { "sampler": 0, "target": { "node": 2, "path": "translation" } }] },
            { "samplers": [{ "input": 0, "output": 2 }], "channels": [{ "sampler": 0, "target": { "node": 2, "path": "scale" } }] },
        ],
        "accessors": [accessor(0, "SCALAR"), accessor(8, "VEC4"), accessor(40, "VEC3")],
        "bufferViews": [{ "buffer": 0, "byteLength": 64 }],
        "buffers": [{ "byteLength": 64, "uri": "keys.bin" }],
    });
    edit(&mut document);
    let (text, keys) = (Bytes::from(document.to_string()), Bytes::from(bytes));
    load(&text, &|uri| (uri == "keys.bin").then(|| keys.clone()), &Limits::default()).expect("it is sound")
}

fn eye(scene: &Scene, animation: &str, seconds: f64) -> DVec3 {
    let (way, _) = camera_way(scene, 0, animation).unwrap_or_else(|error| panic!("{error}"));
    DMat4::from_cols_array(&way.world_from_camera(seconds).map(f64::from)).w_axis.truncate()
}

#[test]
fn a_camera_goes_where_its_nodes_take_it() {
    let scene = moving(|_| ());
    let half = 45f64.to_radians().sin_cos();
    for (seconds, place) in [(0.0, [0.0, 0.0, 2.0]), (0.5, [2.0 * half.0, 0.0, 2.0 * half.1]), (1.0, [2.0, 0.0, 0.0])] {
        let found = eye(&scene, "turn", seconds);
        assert!(found.distance(DVec3::from_array(place)) < 1e-6, "{seconds} s: {found}");
    }
    assert!(eye(&scene, "rise", 0.25).distance(DVec3::new(0.0, 0.25, 0.0)) < 1e-6, "its own translation is replaced");
    assert_eq!(camera_way(&scene, 0, "0").unwrap().0.seconds, [0.0, 1.0], "by number");
}

#[test]
fn what_moves_nothing_that_is_seen_is_told_or_refused() {
    let scene = moving(|_| ());
    let (_, warning) = camera_way(&scene, 0, "rise").unwrap();
    assert!(warning.is_some_and(|warning| warning.message.starts_with("1 channels of animation 'rise'")));
    let refused = |animation: &str, part: &str| {
        let error = camera_way(&scene, 0, animation).unwrap_err();
        assert_eq!(error.field.as_deref(), Some(FIELD));
        assert!(error.message.contains(part), "{error}");
    };
    refused("2", "does not move the camera");
    refused("none", "no animation 'none'; it has 'turn', 'rise', 2");
}

#[test]
fn what_moves_a_mesh_is_refused_by_its_name() {
    let scene = moving(|document| {
        document["meshes"] = json!([{ "primitives": [{ "mode": 0, "attributes": { "POSITION": 2 } }] }]);
        document["nodes"][2]["mesh"] = 0.into();
    });
    let error = camera_way(&scene, 0, "rise").unwrap_err();
    assert!(error.message.contains("moves the mesh of node 'lamp'"), "{error}");
    assert!(camera_way(&scene, 0, "turn").is_ok());
}
