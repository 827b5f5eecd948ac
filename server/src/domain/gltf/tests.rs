//! Loading and writing of small files made here, sound and damaged.

use bytes::Bytes;
use proptest::prelude::*;
use serde_json::{Value, json};

use super::*;
use crate::domain::{ErrorKind, surface::Surface};

fn glb(document: &Value, bin: &[u8]) -> Bytes {
    let mut json = document.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bin = bin.to_vec();
    bin.resize(bin.len().next_multiple_of(4), 0);
    let mut glb = b"glTF".to_vec();
    for word in [2, (28 + json.len() + bin.len()) as u32, json.len() as u32, 0x4e4f_534a] {
        glb.extend(word.to_le_bytes());
    }
    glb.extend(json);
    glb.extend((bin.len() as u32).to_le_bytes());
    glb.extend(b"BIN\0");
    glb.extend(bin);
    glb.into()
}

/// Two triangles of a unit square with normals and UVs, u16 indices, and a material with a normal map.
fn quad() -> (Value, Vec<u8>) {
    let mut bin = Vec::new();
    let positions = [[0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    bin.extend(bytemuck::cast_slice::<_, u8>(&positions));
    bin.extend(bytemuck::cast_slice::<_, u8>(&[[0f32, 0.0, 1.0]; 4]));
    bin.extend(bytemuck::cast_slice::<_, u8>(&[[0f32, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]));
    bin.extend(bytemuck::cast_slice::<_, u8>(&[0u16, 1, 2, 0, 2, 3]));
    let document = json!({
        "asset": { "version": "2.0", "copyright": "us" },
        "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0, "scale": [2, 2, 2] }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2 }, "indices": 3, "material": 0 }] }],
        "materials": [{ "name": "wall", "normalTexture": { "index": 0 }, "extras": { "kept": true } }],
        "textures": [{ "source": 0 }], "images": [{ "uri": "normal.png" }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0] },
            { "bufferView": 0, "byteOffset": 48, "componentType": 5126, "count": 4, "type": "VEC3" },
            { "bufferView": 0, "byteOffset": 96, "componentType": 5126, "count": 4, "type": "VEC2" },
            { "bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 128 },
            { "buffer": 0, "byteOffset": 128, "byteLength": 12 },
        ],
        "buffers": [{ "byteLength": 140 }],
    });
    (document, bin)
}

fn load_quad(edit: impl FnOnce(&mut Value)) -> Result<Scene> {
    let (mut document, bin) = quad();
    edit(&mut document);
    load(&glb(&document, &bin), &|_| None, &Limits::default())
}

fn refusal(edit: impl FnOnce(&mut Value)) -> String {
    load_quad(edit).expect_err("refused").to_string()
}

/// The undisplaced surface at level 0.
fn flat(mesh: &Mesh) -> Surface {
    Surface {
        positions: mesh.av_gv.iter().map(|&gv| mesh.gv_position[gv as usize]).collect(),
        normals: mesh.av_normal.clone(),
        attributes: mesh.attributes.iter().map(|a| a.values.clone()).collect(),
        triangles: mesh.triangles.iter().map(|t| t.av).collect(),
        ..Surface::default()
    }
}

fn rewritten(scene: &Scene) -> Written {
    let surfaces: Vec<Surface> = scene.meshes.iter().map(|m| flat(&m.mesh)).collect();
    write(scene, &surfaces, &Packing::default()).expect("writes")
}

#[test]
fn a_quad_loads_with_its_material_instance_and_a_warning_for_the_missing_image() {
    let scene = load_quad(|_| ()).expect("loads");
    let mesh = &scene.meshes[0].mesh;
    assert_eq!((mesh.triangles.len(), mesh.av_gv.len(), mesh.attributes.len()), (2, 4, 1));
    assert!(scene.materials[0].has_normal_map && scene.images[0].bytes.is_none());
    assert_eq!(scene.warnings.iter().map(|w| w.code.as_str()).collect::<Vec<_>>(), ["image_missing"]);
    assert_eq!(scene.bounds, [[0.0; 3], [2.0, 2.0, 0.0]]);
    assert!((scene.diagonal - 8f64.sqrt()).abs() < 1e-12);
}

#[test]
fn errors_name_the_json_path() {
    let at =
        |path: &'static str, value: Value| refusal(move |document| *document.pointer_mut(path).expect("there") = value);
    assert!(
        at("/meshes/0/primitives/0/attributes/POSITION", json!(9))
            .starts_with("meshes[0].primitives[0].attributes.POSITION: accessors[9]")
    );
    assert!(at("/accessors/3/count", json!(7)).starts_with("accessors[3]: 7 elements from byte 0 need 14 bytes"));
    assert!(at("/accessors/1/byteOffset", json!(50)).starts_with("accessors[1]: byteOffset 50 is not a multiple"));
    assert!(at("/accessors/1/count", json!(3)).contains("has 3 elements and POSITION 4"));
    assert!(at("/bufferViews/1/byteLength", json!(13)).starts_with("bufferViews[1]: bytes 128 + 13"));
    assert!(at("/buffers/0/byteLength", json!(4000)).starts_with("buffers[0]: byteLength is 4000"));
    assert!(at("/nodes/0/mesh", json!(1)).starts_with("nodes[0].mesh: meshes[1] does not exist"));
    assert!(at("/asset/version", json!("3.0")).contains("glTF version 3"));
    assert!(
        at("/materials/0/normalTexture/index", json!(5)).starts_with("materials[0].normalTexture.index: textures[5]")
    );
    assert!(
        at("/accessors/0/count", json!(4_000_000_000u32)).contains("need 48000000000 bytes")
            || cfg!(not(target_pointer_width = "64"))
    );
}

#[test]
fn an_index_out_of_range_and_a_coordinate_that_is_not_finite_are_refused() {
    let (document, mut bin) = quad();
    bin[130] = 77;
    let error = load(&glb(&document, &bin), &|_| None, &Limits::default()).expect_err("refused");
    assert_eq!(
        error.to_string(),
        "meshes[0].primitives[0].indices: index 77 (number 1) is out of range; the primitive has 4 vertices"
    );
    let (document, mut bin) = quad();
    bin[12..16].copy_from_slice(&f32::NAN.to_le_bytes());
    let error = load(&glb(&document, &bin), &|_| None, &Limits::default()).expect_err("refused");
    assert!(error.to_string().starts_with("meshes[0].primitives[0].attributes.POSITION: vertex 1 is [NaN"), "{error}");
}

#[test]
fn a_mesh_placed_beyond_f32_is_refused_with_its_node() {
    let far = refusal(|d| {
        d["nodes"] = json!([{ "children": [1], "scale": [1e30, 1, 1] }, { "mesh": 0, "scale": [1e30, 1, 1] }]);
        d["scenes"] = json!([{ "nodes": [0] }]);
    });
    assert!(far.starts_with("nodes[1]: puts its mesh beyond what f32 holds"), "{far}");
}

#[test]
fn a_file_compressed_by_meshopt_is_read_as_the_plain_one_and_written_plain() {
    let (mut document, bin) = quad();
    let words: Vec<u32> = bin[..128].chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
    let vertices = meshopt::encode_vertex_buffer(&words).expect("encodes");
    let indices = meshopt::encode_index_sequence(&[0, 1, 2, 0, 2, 3], 4).expect("encodes");
    let packed = |offset: usize, bytes: usize, stride: u32, count: u32, mode: &str| {
        json!({ "EXT_meshopt_compression": {
            "buffer": 0, "byteOffset": offset, "byteLength": bytes, "byteStride": stride, "count": count, "mode": mode,
        } })
    };
    for view in 0..2 {
        document["bufferViews"][view]["buffer"] = 1.into();
    }
    document["bufferViews"][0]["extensions"] = packed(0, vertices.len(), 4, 32, "ATTRIBUTES");
    document["bufferViews"][1]["extensions"] = packed(vertices.len(), indices.len(), 2, 6, "INDICES");
    let fallback = json!({ "byteLength": 140, "extensions": { "EXT_meshopt_compression": { "fallback": true } } });
    document["buffers"] = json!([{ "byteLength": vertices.len() + indices.len() }, fallback]);
    document["extensionsUsed"] = json!(["EXT_meshopt_compression"]);
    document["extensionsRequired"] = json!(["EXT_meshopt_compression"]);
    let read = |document: &Value, bin: &[u8]| load(&glb(document, bin), &|_| None, &Limits::default());
    let bytes = [vertices, indices].concat();
    let (plain, scene) = (load_quad(|_| ()).expect("loads"), read(&document, &bytes).expect("loads"));
    assert_eq!(scene.meshes[0].mesh.gv_position, plain.meshes[0].mesh.gv_position);
    assert_eq!(scene.meshes[0].mesh.triangles, plain.meshes[0].mesh.triangles);
    assert_eq!(scene.warnings[0].code, "compression_dropped");
    let again = load(&rewritten(&scene).bytes.into(), &|_| None, &Limits::default()).expect("loads again");
    assert!(again.document.get("extensionsRequired").is_none() && again.warnings.is_empty(), "{:?}", again.warnings);
    let refused = |path: &str, value: Value| {
        let mut document = document.clone();
        *document.pointer_mut(path).expect("there") = value;
        read(&document, &bytes).expect_err("refused").to_string()
    };
    let packed = "bufferViews/1/extensions/EXT_meshopt_compression";
    let error = refused(&format!("/{packed}/count"), json!(4));
    assert!(error.starts_with("bufferViews[1]: byteLength is 12 and 4 elements of 2 bytes"), "{error}");
    let error = refused(&format!("/{packed}/count"), json!(4_000_000_000u32));
    assert!(error.contains("bytes are too few for 4000000000 elements"), "{error}");
    // A plain view may not lie in a buffer that only stands in.
    let error = refused("/bufferViews/1/extensions", json!({}));
    assert!(error.starts_with("buffers[1]: has no uri"), "{error}");
    document["buffers"][1]["uri"] = "never_uploaded.bin".into();
    assert!(read(&document, &bytes).is_ok(), "what stands in is not asked for");
}

#[test]
fn required_extensions_are_refused_by_name_and_optional_ones_kept() {
    let require = |name: &'static str| load_quad(|d| d["extensionsRequired"] = json!([name]));
    for name in ["KHR_draco_mesh_compression", "FAKE_unknown"] {
        let error = require(name).expect_err("refused");
        assert!(error.kind == ErrorKind::Unsupported && error.message.contains(name), "{error}");
    }
    assert!(require("KHR_texture_transform").is_ok());
    assert!(require("EXT_meshopt_compression").is_ok(), "required, and nothing is compressed");
    let scene = load_quad(|d| {
        d["extensionsUsed"] = json!(["FAKE_unknown"]);
        d["extensions"] = json!({ "FAKE_unknown": { "accessor": 1 } });
    });
    let written = rewritten(&scene.expect("loads"));
    let again = load(&written.bytes.into(), &|_| None, &Limits::default()).expect("loads again");
    assert_eq!(again.document["extensions"]["FAKE_unknown"]["accessor"], 1);
    assert_eq!(again.document["accessors"].as_array().map(Vec::len), Some(4 + 5), "nothing was dropped or renumbered");
}

#[test]
fn nodes_in_a_circle_or_with_two_parents_are_refused() {
    let circle = refusal(|d| d["nodes"] = json!([{ "children": [1] }, { "children": [0] }]));
    assert_eq!(circle, "nodes[0]: is its own ancestor: nodes must form a tree");
    let shared = refusal(|d| d["nodes"] = json!([{ "children": [2] }, { "children": [2] }, {}]));
    assert!(shared.starts_with("nodes[2]: is a child of nodes[0] and of nodes[1]"));
}

#[test]
fn a_long_chain_of_nodes_is_no_trouble() {
    let n = 200_000;
    let scene = load_quad(|d| {
        let mut nodes: Vec<Value> = (1..n).map(|i| json!({ "children": [i] })).collect();
        nodes.push(json!({ "mesh": 0 }));
        d["nodes"] = nodes.into();
        d["scenes"][0]["nodes"] = (0..n).collect();
    });
    let scene = scene.expect("loads");
    assert_eq!(scene.instances.len(), 1);
    assert_eq!(scene.document["scenes"][0]["nodes"], json!([0]));
}

#[test]
fn what_claims_more_than_the_limits_is_refused_before_it_is_allocated() {
    let error = load_quad(|d| {
        d["accessors"][0] = json!({ "componentType": 5126, "count": 4_000_000_000u32, "type": "VEC3" });
        d["meshes"][0]["primitives"][0] = json!({ "attributes": { "POSITION": 0 } });
    });
    assert_eq!(error.expect_err("refused").kind, ErrorKind::TooLarge);
    let (document, bin) = quad();
    let limits = Limits { json_values: 20, ..Limits::default() };
    assert_eq!(load(&glb(&document, &bin), &|_| None, &limits).expect_err("refused").kind, ErrorKind::TooLarge);
}

#[test]
fn strips_fans_and_sparse_accessors_are_unrolled() {
    let with = |mode: u32, indices: [u16; 6]| {
        let (mut document, mut bin) = quad();
        bin[128..140].copy_from_slice(bytemuck::cast_slice(&indices));
        document["meshes"][0]["primitives"][0]["mode"] = mode.into();
        document["accessors"][3]["count"] = 4.into();
        let scene = load(&glb(&document, &bin), &|_| None, &Limits::default()).expect("loads");
        let mesh = &scene.meshes[0].mesh;
        assert_eq!((mesh.triangles.len(), mesh.health.opposite_winding_edges), (2, 0), "mode {mode}");
        assert!(mesh.triangles.iter().all(|t| {
            let [a, b, c] = t.av.map(|v| glam::Vec3::from(mesh.gv_position[mesh.av_gv[v as usize] as usize]));
            (b - a).cross(c - a).z > 0.0
        }));
    };
    with(5, [0, 1, 3, 2, 0, 0]);
    with(6, [0, 1, 2, 3, 0, 0]);
    let scene = load_quad(|d| {
        d["accessors"][0]["sparse"] = json!({
            "count": 1,
            "indices": { "bufferView": 1, "byteOffset": 2, "componentType": 5123 },
            "values": { "bufferView": 0, "byteOffset": 48 },
        });
    });
    // Vertex 1 is replaced by the first normal.
    assert!(scene.expect("loads").meshes[0].mesh.gv_position.contains(&[0.0, 0.0, 1.0]));
}

#[test]
fn a_document_that_validators_mind_is_mended_with_warnings() {
    let scene = load_quad(|d| {
        d["nodes"] = json!([{ "mesh": 0, "rotation": [0, 0, 2, 0] }, { "children": [2] }, { "children": [] }]);
        d["scenes"] = json!([{ "nodes": [0, 2] }, { "nodes": [] }]);
        d["animations"] = json!([]);
    });
    let scene = scene.expect("loads");
    assert_eq!(scene.document["nodes"][0]["rotation"], json!([0.0, 0.0, 1.0, 0.0]));
    assert_eq!(scene.document["nodes"][1], json!({}));
    assert_eq!(scene.document["scenes"], json!([{ "nodes": [0, 2] }, {}]));
    assert!(scene.document.get("animations").is_none());
    assert!(scene.warnings.iter().filter(|w| w.code == "document_mended").count() >= 4);
}

#[test]
fn a_round_trip_at_level_0_keeps_geometry_material_and_extras() {
    let scene = load_quad(|_| ()).expect("loads");
    let written = rewritten(&scene);
    let again = load(&written.bytes.clone().into(), &|_| None, &Limits::default()).expect("loads again");
    let (a, b) = (&scene.meshes[0].mesh, &again.meshes[0].mesh);
    assert_eq!((&a.gv_position, &a.av_normal, &a.attributes), (&b.gv_position, &b.av_normal, &b.attributes));
    assert_eq!(a.triangles, b.triangles);
    assert_eq!(b.av_tangent, vec![[1.0, 0.0, 0.0, 1.0]; 4], "MikkTSpace for the normal map");
    assert_eq!(again.document["materials"][0]["extras"]["kept"], true);
    assert_eq!(again.document["asset"]["copyright"], "us");
    assert_eq!(again.document["accessors"].as_array().map(Vec::len), Some(5), "the old accessors are gone");
    // The missing normal map has become one flat pixel inside the file.
    let image =
        crate::domain::maps::decode("image", again.images[0].bytes.as_ref().expect("embedded")).expect("decodes");
    assert_eq!((image.width, image.texels([0, 1, 2], |_, v| (v * 255.0).round())), (1, vec![128.0, 128.0, 255.0]));
    assert_eq!(rewritten(&scene).bytes, written.bytes, "the same bytes again");
}

#[test]
fn points_beside_triangles_pass_through() {
    let scene = load_quad(|d| {
        let points = json!({ "attributes": { "POSITION": 0 }, "mode": 0 });
        d["meshes"][0]["primitives"].as_array_mut().expect("list").insert(0, points);
    });
    let written = rewritten(&scene.expect("loads"));
    let again = load(&written.bytes.into(), &|_| None, &Limits::default()).expect("loads again");
    let points = &again.document["meshes"][0]["primitives"][0];
    assert_eq!((points["mode"].as_u64(), points["attributes"]["POSITION"].as_u64()), (Some(0), Some(0)));
    assert_eq!(again.document["accessors"][0]["count"], 4);
    assert_eq!(again.document["bufferViews"][0]["byteLength"], 128);
}

#[test]
fn bounds_of_what_passes_through_are_made_right() {
    let scene = load_quad(|document| {
        let points = json!({ "attributes": { "POSITION": 4 }, "mode": 0 });
        document["meshes"][0]["primitives"].as_array_mut().unwrap().push(points);
        let mut positions = document["accessors"][0].clone();
        positions["max"] = json!([1, 7, 0]);
        document["accessors"].as_array_mut().unwrap().push(positions);
    });
    let written = rewritten(&scene.unwrap());
    assert_eq!(written.warnings.len(), 1);
    let mended = &container::split(&written.bytes.into(), &Limits::default()).unwrap().document["accessors"][0];
    assert_eq!((&mended["min"], &mended["max"]), (&json!([0.0, 0.0, 0.0]), &json!([1.0, 1.0, 0.0])));
}

#[test]
fn morph_targets_of_the_wrong_shape_are_refused_and_unknown_ones_left_out() {
    let target =
        |target: Value| load_quad(move |document| document["meshes"][0]["primitives"][0]["targets"] = json!([target]));
    for wrong in ["POSITION", "NORMAL", "TANGENT"] {
        let error = target(json!({ wrong: 2 })).expect_err("VEC2");
        assert!(error.to_string().contains(&format!("meshes[0].primitives[0].targets[0].{wrong}")), "{error}");
    }
    let scene = target(json!({ "POSITION": 0, "FOO": 1 })).expect("loads");
    assert!(scene.warnings.iter().any(|w| w.code == "attribute_dropped" && w.message.contains("FOO")));
    rewritten(&scene);
}

#[test]
fn what_is_displaced_is_not_displaced_again() {
    let extension = json!({ "KHR_materials_displacement": { "displacementGeometryTexture": { "index": 0 } } });
    let mut scene = load_quad(|document| {
        document["extensionsUsed"] = json!(["KHR_materials_displacement"]);
        document["materials"][0]["extensions"] = extension.clone();
        document["materials"].as_array_mut().unwrap().push(json!({ "extensions": extension }));
    })
    .unwrap();
    forget_displacement(&mut scene, &[0].into());
    assert!(scene.document["materials"][0].get("extensions").is_none() && scene.materials[0].displacement.is_none());
    assert!(scene.document.get("extensionsUsed").is_some() && scene.materials[1].displacement.is_some());
    forget_displacement(&mut scene, &[1].into());
    assert!(scene.document.get("extensionsUsed").is_none());
}

#[test]
fn a_pose_and_morph_weights_that_are_not_shown_are_told_of() {
    let codes = |scene: Scene| scene.warnings.iter().map(|w| w.code.clone()).collect::<Vec<_>>();
    let bound = load_quad(|document| {
        document["skins"] = json!([{ "joints": [1, 2] }]);
        document["nodes"] = json!([{ "mesh": 0, "skin": 0, "children": [1, 2] }, {}, {}]);
    });
    assert!(!codes(bound.unwrap()).contains(&"posed_skin".into()));
    let posed = load_quad(|document| {
        document["skins"] = json!([{ "joints": [1, 2] }]);
        document["nodes"] = json!([{ "mesh": 0, "skin": 0, "children": [1, 2] }, {}, { "translation": [0, 1, 0] }]);
        document["meshes"][0]["weights"] = json!([0.5]);
    });
    let posed = codes(posed.unwrap());
    assert!(posed.contains(&"posed_skin".into()) && posed.contains(&"morph_weights".into()), "{posed:?}");
}

#[test]
fn tangents_split_vertices_where_uvs_are_mirrored() {
    let (document, mut bin) = quad();
    // The second triangle's u runs back: vertex 3 gets u = 2.
    bin[120..124].copy_from_slice(&2f32.to_le_bytes());
    let scene = load(&glb(&document, &bin), &|_| None, &Limits::default()).expect("loads");
    let written = rewritten(&scene);
    let again = load(&written.bytes.into(), &|_| None, &Limits::default()).expect("loads again");
    let mesh = &again.meshes[0].mesh;
    assert_eq!((mesh.triangles.len(), mesh.gv_position.len(), mesh.av_gv.len()), (2, 4, 6));
    let handedness: Vec<f32> = mesh.triangles.iter().map(|t| mesh.av_tangent[t.av[0] as usize][3]).collect();
    assert_eq!(handedness, [1.0, -1.0]);
}

#[test]
fn every_truncation_and_every_byte_changed_is_answered_without_a_panic() {
    let (document, bin) = quad();
    let bytes = glb(&document, &bin);
    for length in 0..bytes.len() {
        assert!(load(&bytes.slice(..length), &|_| None, &Limits::default()).is_err(), "{length}");
    }
    for at in 0..bytes.len() {
        for flip in [1u8, 0x10, 0x80] {
            let mut changed = bytes.to_vec();
            changed[at] ^= flip;
            if let Ok(scene) = load(&changed.into(), &|_| None, &Limits::default()) {
                rewritten(&scene);
            }
        }
    }
}

proptest! {
    #[test]
    fn random_damage_is_answered_without_a_panic(damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8)) {
        let (document, bin) = quad();
        let mut bytes = glb(&document, &bin).to_vec();
        for (at, value) in damage {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        if let Ok(scene) = load(&bytes.into(), &|_| None, &Limits::default()) {
            rewritten(&scene);
        }
    }

    /// Numbers of the document replaced by numbers that files should not have.
    #[test]
    fn wild_numbers_are_answered_without_a_panic(which in any::<prop::sample::Index>(), value in prop_oneof![Just(json!(-1)), Just(json!(4294967295u32)), Just(json!(1e300)), Just(json!(0)), Just(json!(1.5)), Just(json!("x")), Just(Value::Null), Just(json!([]))]) {
        let (mut document, bin) = quad();
        let mut paths = Vec::new();
        collect_paths(&document, String::new(), &mut paths);
        *document.pointer_mut(&paths[which.index(paths.len())]).expect("there") = value;
        if let Ok(scene) = load(&glb(&document, &bin), &|_| None, &Limits::default()) {
            rewritten(&scene);
        }
    }
}

fn collect_paths(value: &Value, path: String, paths: &mut Vec<String>) {
    match value {
        Value::Object(object) => {
            object.iter().for_each(|(key, value)| collect_paths(value, format!("{path}/{key}"), paths))
        }
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(i, value)| collect_paths(value, format!("{path}/{i}"), paths))
        }
        _ => paths.push(path.clone()),
    }
    if !path.is_empty() {
        paths.push(path);
    }
}
