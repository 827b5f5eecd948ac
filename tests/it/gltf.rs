//! glTF in and out over the committed samples and, where `DISPLACE_CORPUS` names it, the whole corpus:
//! what must load loads and comes back unchanged, what must be refused is refused with a sentence.

use std::path::{Path, PathBuf};

use bytes::Bytes;
use displace_server::{
    domain::{
        Error, ErrorKind,
        gltf::{Limits, Packing, Written, load, write},
        mesh::Mesh,
        scene::Scene,
        surface::Surface,
    },
    oracle::invariants,
};
use displace_tests::{
    corpus::{Expect, corpus},
    data::sample,
    glb,
    subdivided::subdivided,
};
use glam::{Vec2, Vec3, Vec4};

fn open(path: &Path) -> Result<Scene, Error> {
    let bytes = std::fs::read(path).unwrap_or_else(|error| panic!("cannot read {}: {error}", path.display()));
    let beside = |uri: &str| std::fs::read(path.parent()?.join(uri)).ok().map(Bytes::from);
    load(&bytes.into(), &beside, &Limits::default())
}

fn reopen(written: &Written) -> Scene {
    let nothing = |uri: &str| panic!("the written file asks for {uri}");
    load(&written.bytes.clone().into(), &nothing, &Limits::default()).expect("a written file loads")
}

/// Subdivides every mesh; `waves` displaces it by up to a hundredth of the scene.
fn surfaces(scene: &Scene, level: u32, waves: bool) -> Vec<Surface> {
    let height = if waves { scene.diagonal as f32 * 0.01 } else { 0.0 };
    let of_mesh = |mesh: &Mesh| subdivided(mesh, level, |p| height * (20.0 * std::f32::consts::PI * p.x).sin());
    scene.meshes.iter().map(|mesh| of_mesh(&mesh.mesh)).collect()
}

/// Keeps a result for a look with other programs, where `DISPLACE_TEST_OUTPUT` names a folder.
fn keep(path: &Path, what: &str, bytes: &[u8]) {
    if let Some(folder) = std::env::var_os("DISPLACE_TEST_OUTPUT") {
        let stem = path.file_stem().and_then(|stem| stem.to_str()).unwrap_or("model");
        let file = PathBuf::from(folder).join(format!("{stem}-{what}.glb"));
        std::fs::write(&file, bytes).unwrap_or_else(|error| panic!("cannot write {}: {error}", file.display()));
    }
}

/// Geometry, attributes and everything the document says besides come back as they were.
fn assert_round_trip(path: &Path) {
    let name = path.display();
    let scene = open(path).unwrap_or_else(|error| panic!("{name}: {error}"));
    let written = write(&scene, &surfaces(&scene, 0, false), &Packing::default())
        .unwrap_or_else(|error| panic!("{name}: {error}"));
    keep(path, "0", &written.bytes);
    let again = reopen(&written);
    assert_eq!(scene.meshes.len(), again.meshes.len(), "{name}");
    for (a, b) in scene.meshes.iter().zip(&again.meshes) {
        assert_same_mesh(&name.to_string(), &a.mesh, &b.mesh);
    }
    assert_eq!(scene.instances, again.instances, "{name}");
    assert_eq!(scene.cameras, again.cameras, "{name}");
    assert_eq!((scene.bounds, scene.diagonal), (again.bounds, again.diagonal), "{name}");
    for key in ["animations", "nodes", "scenes", "materials", "textures", "samplers", "cameras", "extensions", "extras"]
    {
        let length = |scene: &Scene| scene.document.get(key).and_then(|v| v.as_array()).map(Vec::len);
        assert_eq!(length(&scene), length(&again), "{name}: {key}");
    }
    assert_eq!(scene.document.get("materials"), again.document.get("materials"), "{name}");
    assert_eq!(scene.images.len(), again.images.len(), "{name}");
}

fn assert_same_mesh(name: &str, a: &Mesh, b: &Mesh) {
    assert_eq!(a.gv_position, b.gv_position, "{name}: places");
    assert_eq!(a.ge_gv, b.ge_gv, "{name}: edges");
    let corners = |mesh: &Mesh| -> Vec<[u32; 3]> {
        mesh.triangles.iter().map(|t| t.av.map(|av| mesh.av_gv[av as usize])).collect()
    };
    assert_eq!(corners(a), corners(b), "{name}: triangles");
    for (t, (x, y)) in a.triangles.iter().zip(&b.triangles).enumerate() {
        for k in 0..3 {
            let (x, y) = (x.av[k] as usize, y.av[k] as usize);
            assert_eq!(a.av_normal[x], b.av_normal[y], "{name}: normal of corner {k} of triangle {t}");
            for attribute in a.attributes.iter().filter(|attribute| !is_blended(&attribute.semantic)) {
                let other = b
                    .attribute(&attribute.semantic)
                    .unwrap_or_else(|| panic!("{name}: {} is gone", attribute.semantic));
                let n = attribute.components;
                assert_eq!(
                    attribute.values[x * n..][..n],
                    other.values[y * n..][..n],
                    "{name}: {}",
                    attribute.semantic
                );
            }
        }
    }
}

/// Influences come back sorted and with weights that sum to 1.
fn is_blended(semantic: &str) -> bool {
    semantic.starts_with("JOINTS_") || semantic.starts_with("WEIGHTS_")
}

fn assert_displaces(path: &Path) {
    let name = path.display();
    let scene = open(path).unwrap_or_else(|error| panic!("{name}: {error}"));
    let surfaces = surfaces(&scene, 2, true);
    let written = write(&scene, &surfaces, &Packing::default()).unwrap_or_else(|error| panic!("{name}: {error}"));
    keep(path, "2", &written.bytes);
    let triangles: usize = scene.meshes.iter().map(|m| m.mesh.triangles.len() * 16).sum();
    let parts = glb::read(&written.bytes);
    let whole: usize = parts.iter().map(|part| part.triangles.len()).sum();
    assert!(whole >= triangles, "{name}: {whole} triangles of {triangles}");
    for part in &parts {
        assert_eq!(invariants::not_finite("positions_finite", &part.positions), None, "{name}");
    }
    reopen(&written);
}

fn samples() -> Vec<PathBuf> {
    let names = [
        "AnimatedMorphCube.glb",
        "AnimatedMorphCube-Quantized/AnimatedMorphCube.gltf",
        "BoxVertexColors.glb",
        "MeshPrimitiveModes.gltf",
        "SimpleMeshes.gltf",
        "Suzanne/Suzanne.gltf",
        "TextureTransformTest/TextureTransformTest.gltf",
        "TriangleWithoutIndices.gltf",
        "TwoSidedPlane/TwoSidedPlane.gltf",
        "craft_speederD/craft_speederD.gltf",
        "torus.gltf",
    ];
    names.iter().map(|name| sample(&format!("models/{name}"))).collect()
}

#[test]
fn the_samples_come_back_unchanged_at_level_0() {
    samples().iter().for_each(|path| assert_round_trip(path));
}

#[test]
fn the_samples_displace_to_files_that_load() {
    samples().iter().for_each(|path| assert_displaces(path));
}

#[test]
fn the_invalid_samples_are_refused_with_a_sentence() {
    for entry in std::fs::read_dir(sample("invalid")).expect("a folder") {
        assert_refused(&entry.expect("an entry").path());
    }
}

fn assert_refused(path: &Path) {
    let name = path.display();
    let error = open(path).expect_err(&format!("{name} must be refused"));
    assert!(matches!(error.kind, ErrorKind::InvalidInput | ErrorKind::Unsupported), "{name}: {error:?}");
    assert!(error.field.is_some() && error.message.len() > 10, "{name}: {error}");
}

#[test]
fn every_model_of_the_corpus_gets_the_answer_it_deserves() {
    let Some(corpus) = corpus("the round trip of every model") else { return };
    for model in corpus.models() {
        match model.expect {
            Expect::Accept => {
                assert_round_trip(&model.path);
                assert_displaces(&model.path);
            }
            Expect::Reject => assert_refused(&model.path),
            Expect::AcceptOrReject => match open(&model.path) {
                Ok(_) => assert_round_trip(&model.path),
                Err(error) => assert!(error.field.is_some(), "{}: {error}", model.path.display()),
            },
        }
    }
}

#[test]
fn tangents_made_for_a_normal_map_run_along_u_with_the_bitangent_up_the_image() {
    let scene = open(&sample("models/TwoSidedPlane/TwoSidedPlane.gltf")).expect("loads");
    let written = write(&scene, &surfaces(&scene, 2, false), &Packing::default()).expect("writes");
    let again = reopen(&written);
    let mesh = &again.meshes[0].mesh;
    let uvs = mesh.attribute("TEXCOORD_0").expect("has UVs");
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.av.map(|av| {
            let place = Vec3::from(mesh.gv_position[mesh.av_gv[av as usize] as usize]);
            (place, Vec2::from_slice(&uvs.values[2 * av as usize..]))
        });
        let (p, q, uv, st) = (b.0 - a.0, c.0 - a.0, b.1 - a.1, c.1 - a.1);
        let along_u = (p * st.y - q * uv.y) / uv.perp_dot(st);
        let along_v = (q * uv.x - p * st.x) / uv.perp_dot(st);
        for av in triangle.av {
            let tangent = Vec4::from(mesh.av_tangent[av as usize]);
            let bitangent = Vec3::from(mesh.av_normal[av as usize]).cross(tangent.truncate()) * tangent.w;
            assert!(tangent.truncate().dot(along_u.normalize()) > 0.999, "{tangent}");
            assert!(bitangent.dot(-along_v.normalize()) > 0.999, "{bitangent}");
        }
    }
}
