//! OBJ and PLY become what the same mesh is as GLB; files named by a .gltf come along.

use displace_tests::{data::sample, glb};

use super::{Folder, remote, report};

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";
const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                   property float s\nproperty float t\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
                   0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n4 0 1 2 3\n";

#[test]
fn obj_and_ply_of_the_same_quad_give_the_same_surface() {
    let folder = Folder::new();
    let [obj, ply] = [("q.obj", OBJ), ("q.ply", PLY)].map(|(name, text)| {
        let (mesh, output) = (folder.file(name, text), folder.path("out.glb"));
        let value = report(&["apply", &mesh, "--expr", "0.1*sin(6*u)+v", "--uniform", "2", "-o", &output]);
        assert_eq!(value["triangles_in"], 2, "{name}");
        glb::joined(&glb::read(&std::fs::read(&output).unwrap()))
    });
    assert_eq!(obj.positions, ply.positions);
    assert_eq!(obj.triangles, ply.triangles);
}

#[test]
fn bad_files_are_told_with_the_place_of_the_fault() {
    let folder = Folder::new();
    for (name, text, parts) in [
        ("a.obj", "v 0 0 0\nf 1 2 3\n", ["a.obj", "line 2"]),
        ("b.obj", "# nothing\n", ["b.obj", "no faces"]),
        ("c.ply", "ply\nformat ascii 1.0\nelement vertex 0\nend_header\n", ["c.ply", "'vertex'"]),
        ("d.ply", "ply\nformat none 1.0\nend_header\n", ["d.ply", "format"]),
        ("e.txt", "hello", ["e.txt", ".obj"]),
    ] {
        let mesh = folder.file(name, text);
        let run = remote(&["describe", &mesh, "--json"]);
        assert_eq!(run.code, Some(2), "{name}: {run:?}");
        assert_eq!(run.json()["error"]["kind"], "invalid_input", "{name}");
        assert!(parts.iter().all(|part| run.stderr.contains(part)), "{name}: {}", run.stderr);
    }
}

#[test]
fn what_a_conversion_leaves_out_is_a_warning() {
    let folder = Folder::new();
    let mesh = folder.file("a.obj", format!("mtllib none.mtl\n{OBJ}l 1 2\n"));
    let warnings = report(&["describe", &mesh])["problems"].to_string();
    assert!(warnings.contains("none.mtl") && warnings.contains("\"conversion\""), "{warnings}");
}

#[test]
fn files_beside_a_gltf_come_along() {
    let mesh = sample("models/TwoSidedPlane/TwoSidedPlane.gltf");
    let value = report(&["describe", mesh.to_str().unwrap()]);
    assert_eq!(value["triangles"], 2);
    let images = value["images"].as_array().unwrap();
    assert!(!images.is_empty() && images.iter().all(|image| image["bytes"].is_u64()), "{value}");
}

#[test]
fn a_gltf_reaches_no_file_outside_its_folder() {
    let folder = Folder::new();
    folder.file("secret.bin", "secret");
    for (uri, part) in [
        ("../secret.bin", "outside"),
        ("%2e%2e/secret.bin", "outside"),
        ("none.bin", "none.bin"),
        ("http://h/x", "http"),
    ] {
        let document = format!(r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":6,"uri":"{uri}"}}]}}"#);
        let mesh = folder.file("inside/m.gltf", document);
        let run = remote(&["describe", &mesh, "--json"]);
        assert_eq!(run.code, Some(2), "{uri}: {run:?}");
        assert_eq!(run.json()["error"]["field"], "buffers[0].uri", "{uri}");
        assert!(run.stderr.contains(part), "{uri}: {}", run.stderr);
    }
}
