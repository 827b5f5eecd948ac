//! Levels of detail in a document: nodes, meshes, animations, scenes.

use super::*;
use crate::domain::scene::SceneMesh;

/// A chain of two lower levels for the one mesh of a document.
fn inserted(mut document: Value) -> Value {
    document["meshes"] = json!([{ "name": "wall", "primitives": [{ "attributes": { "POSITION": 0 } }] }]);
    let scene = Scene { meshes: vec![SceneMesh::default()], ..Scene::default() };
    let level = Level { surface: Surface::default(), grid: None, normal_maps: Vec::new() };
    let chain = Chain { mesh: 0, levels: vec![level; 2], coverages: vec![0.5, 0.1, 0.0] };
    let chains = [chain];
    let shown = insert(&mut document, &scene, &chains);
    assert_eq!(shown.iter().map(|s| s.gltf_mesh).collect::<Vec<_>>(), [1, 2]);
    document
}

#[test]
fn a_node_keeps_all_but_what_shows_its_mesh() {
    let node = json!({ "name": "a", "mesh": 0, "camera": 0, "children": [1], "translation": [1, 2, 3] });
    let document = inserted(json!({ "nodes": [node, {}], "scenes": [{ "nodes": [0] }] }));
    let nodes = document["nodes"].as_array().unwrap();
    assert_eq!(nodes.len(), 5);
    assert_eq!(nodes[0], json!({ "name": "a", "camera": 0, "children": [1, 2], "translation": [1, 2, 3] }));
    assert_eq!(nodes[2]["mesh"], 0);
    assert_eq!(nodes[2]["extensions"]["MSFT_lod"]["ids"], json!([3, 4]));
    assert_eq!(nodes[2]["extras"]["MSFT_screencoverage"], json!([0.5, 0.1, 0.0]));
    assert_eq!(nodes[3..], [json!({ "mesh": 1 }), json!({ "mesh": 2 })]);
    assert_eq!(document["scenes"], json!([{ "nodes": [0] }]));
    assert_eq!(document["extensionsUsed"], json!(["MSFT_lod"]));
    assert_eq!(document.get("extensionsRequired"), None);
}

#[test]
fn every_node_that_shows_the_mesh_has_nodes_of_its_own() {
    let document = inserted(json!({ "nodes": [{ "mesh": 0 }, { "mesh": 0 }], "scenes": [{ "nodes": [0, 1] }] }));
    let ids = |node: usize| document["nodes"][node]["extensions"]["MSFT_lod"]["ids"].clone();
    assert_eq!([ids(2), ids(5)], [json!([3, 4]), json!([6, 7])]);
    assert_eq!(document["meshes"].as_array().unwrap().len(), 3);
}

#[test]
fn a_skin_goes_with_every_level_and_animated_weights_move_all() {
    let channel = |node: usize, path: &str| json!({ "sampler": 0, "target": { "node": node, "path": path } });
    let document = inserted(json!({
        "nodes": [{ "mesh": 0, "skin": 3, "weights": [0.5] }],
        "scenes": [{ "nodes": [0] }],
        "animations": [{ "channels": [channel(0, "weights"), channel(0, "rotation")] }],
    }));
    for node in 1..4 {
        assert_eq!((&document["nodes"][node]["skin"], &document["nodes"][node]["weights"]), (&json!(3), &json!([0.5])));
    }
    let wanted = [channel(1, "weights"), channel(0, "rotation"), channel(2, "weights"), channel(3, "weights")];
    assert_eq!(document["animations"][0]["channels"], json!(wanted));
}

#[test]
fn a_file_without_a_scene_gets_one_of_its_roots() {
    let document = inserted(json!({ "nodes": [{ "children": [1] }, { "mesh": 0 }, {}] }));
    assert_eq!((&document["scenes"], &document["scene"]), (&json!([{ "nodes": [0, 2] }]), &json!(0)));
}
