//! The meshes of the pictures, as GLBs in the scratch folder.

use std::{f64::consts::TAU, fs, path::Path};

use displace_tests::{
    data::sample,
    meshes::{self, TestMesh},
};
use serde_json::{Value, json};

use crate::{Result, arrows};

/// Writes all meshes, and the samples beside them.
pub(crate) fn write(folder: &Path) -> Result<()> {
    let (clay, white) = (material([0.85, 0.6, 0.3], 0.5), material([1.0; 3], 0.5));
    for (name, mesh, look) in [
        ("ball", meshes::uv_sphere(64, 32), &clay),
        ("globe", meshes::uv_sphere(64, 32), &white),
        ("coarse", meshes::uv_sphere(24, 12), &clay),
        ("torus", meshes::torus(64, 32), &clay),
        ("printed", printed_sphere(), &json!({})),
        ("wall", sheet(32, 32, standing, |u, v| [u, v]), &white),
        ("sheet", sheet(8, 8, lying, |u, v| [u, v]), &white),
        ("domes", sheet(8, 8, lying, mirrored), &clay),
        ("mirrored", sheet(8, 8, lying, mirrored), &white),
        ("floor", floor(), &white),
        ("cube", meshes::cube(), &white),
    ] {
        fs::write(folder.join(format!("{name}.glb")), mesh.to_glb_with_material(look))?;
    }
    for kind in arrows::KINDS {
        let dull = material([1.0; 3], 1.0);
        fs::write(folder.join(format!("arrows-{kind}.glb")), arrows::mesh(kind).to_glb_with_material(&dull))?;
    }
    fs::write(folder.join("mirror.glb"), meshes::uv_sphere(64, 32).to_glb_with_material(&polished()))?;
    fs::write(folder.join("sunk.glb"), sunk()?)?;
    for name in ["rock_height.png", "abstract_height.png"] {
        fs::copy(sample(&format!("maps/{name}")), folder.join(name))?;
    }
    Ok(())
}

fn material(color: [f64; 3], roughness: f64) -> Value {
    let [r, g, b] = color;
    let look = json!({ "baseColorFactor": [r, g, b, 1], "metallicFactor": 0, "roughnessFactor": roughness });
    json!({ "name": "surface", "pbrMetallicRoughness": look, "doubleSided": true })
}

fn polished() -> Value {
    json!({ "name": "mirror", "pbrMetallicRoughness": { "metallicFactor": 1, "roughnessFactor": 0 } })
}

/// A place of the unit square as position and normal.
type Placed = ([f64; 3], [f64; 3]);

/// A square of side 2 in xz that faces up; v runs towards the viewer.
pub(crate) fn lying(u: f64, v: f64) -> Placed {
    ([2.0 * u - 1.0, 0.0, 2.0 * v - 1.0], [0.0, 1.0, 0.0])
}

/// A square of side 2 in xy that faces the viewer.
fn standing(u: f64, v: f64) -> Placed {
    ([2.0 * u - 1.0, 1.0 - 2.0 * v, 0.0], [0.0, 0.0, 1.0])
}

/// Texture coordinates there and back.
fn mirrored(u: f64, v: f64) -> [f64; 2] {
    [1.0 - (2.0 * u - 1.0).abs(), v]
}

/// A floor of 3 x 4 that runs away from the viewer; a map covers 2 units of it.
fn floor() -> TestMesh {
    sheet(24, 32, |u, v| ([3.0 * u - 1.5, 0.0, 4.0 * v - 3.0], [0.0, 1.0, 0.0]), |u, v| [1.5 * u, 2.0 * v])
}

/// A grid over the unit square, v down, with its front where u turned to v is seen clockwise.
pub(crate) fn sheet(
    columns: u32,
    rows: u32,
    place: impl Fn(f64, f64) -> Placed,
    texture: impl Fn(f64, f64) -> [f64; 2],
) -> TestMesh {
    let mut mesh = TestMesh { name: "sheet", positions: vec![], normals: vec![], uvs: vec![], triangles: vec![] };
    for (j, i) in (0..=rows).flat_map(|j| (0..=columns).map(move |i| (j, i))) {
        let (u, v) = (f64::from(i) / f64::from(columns), f64::from(j) / f64::from(rows));
        let (position, normal) = place(u, v);
        mesh.positions.push(position.map(|x| x as f32));
        mesh.normals.push(normal.map(|x| x as f32));
        mesh.uvs.push(texture(u, v).map(|x| x as f32));
    }
    for (j, i) in (0..rows).flat_map(|j| (0..columns).map(move |i| (j, i))) {
        let a = j * (columns + 1) + i;
        let (b, c, d) = (a + 1, a + columns + 2, a + columns + 1);
        mesh.triangles.extend([[a, d, c], [a, c, b]]);
    }
    mesh
}

/// Everson's sphere as printed: y = R sin(theta) cos(phi), as x is.
fn printed_sphere() -> TestMesh {
    sheet(
        64,
        32,
        |u, v| {
            let (theta, phi) = (0.5 * TAU * v, TAU * u);
            let across = theta.sin() * phi.cos();
            // The notes' z is up.
            ([across, theta.cos(), -across], [0.5f64.sqrt(), 0.0, 0.5f64.sqrt()])
        },
        |u, v| [u, v],
    )
}

/// The floor with a ball half sunk into it, of a material of its own: its heights are those of the floor alone.
fn sunk() -> Result<Vec<u8>> {
    let mut ball = meshes::uv_sphere(48, 24);
    for position in &mut ball.positions {
        *position = position.map(|x| 0.2 * x);
    }
    both(&floor(), &material([0.85, 0.6, 0.3], 0.5), &ball, &material([0.15, 0.35, 0.7], 0.5))
}

/// Two meshes in one file: the document of the one, and the parts of the other behind it.
fn both(first: &TestMesh, look: &Value, second: &TestMesh, other: &Value) -> Result<Vec<u8>> {
    let mut documents = Vec::new();
    for bytes in [first.to_glb_with_material(look), second.to_glb_with_material(other)] {
        let gltf = gltf::Gltf::from_slice_without_validation(&bytes)?;
        documents.push((serde_json::to_value(gltf.document.into_json())?, gltf.blob.unwrap_or_default()));
    }
    let (mut scene, mut blob) = documents.remove(0);
    let (added, more) = documents.remove(0);
    let start = blob.len();
    blob.extend(more);
    let list = |value: &Value, key: &str| value[key].as_array().cloned().unwrap_or_default();
    for mut view in list(&added, "bufferViews") {
        view["byteOffset"] = (view["byteOffset"].as_u64().unwrap_or(0) + start as u64).into();
        push(&mut scene, "bufferViews", view);
    }
    for mut accessor in list(&added, "accessors") {
        accessor["bufferView"] = (accessor["bufferView"].as_u64().unwrap_or(0) + 4).into();
        push(&mut scene, "accessors", accessor);
    }
    push(&mut scene, "materials", json!({ "name": "ball", "pbrMetallicRoughness": other["pbrMetallicRoughness"] }));
    let attributes = json!({ "POSITION": 4, "NORMAL": 5, "TEXCOORD_0": 6 });
    push(
        &mut scene,
        "meshes",
        json!({ "name": "ball", "primitives": [{ "attributes": attributes, "indices": 7, "material": 1 }] }),
    );
    push(&mut scene, "nodes", json!({ "mesh": 1, "name": "ball" }));
    scene["scenes"][0]["nodes"] = json!([0, 1]);
    scene["buffers"] = json!([{ "byteLength": blob.len() }]);
    Ok(displace_tests::glb::pack(&scene, &blob))
}

fn push(document: &mut Value, list: &str, value: Value) {
    if let Some(values) = document[list].as_array_mut() {
        values.push(value);
    }
}
