//! The demo's inputs: committed samples (licences in `deploy/licenses`), and three meshes made here.

use std::f64::consts::{PI, TAU};

use crate::{
    convert::{Primitive, glb},
    error::{Error, Result},
};

macro_rules! sample {
    ($path:literal) => {
        include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/data/", $path)).as_slice()
    };
}

const SAMPLES: [(&str, &[u8]); 8] = [
    ("rock_height.png", sample!("maps/rock_height.png")),
    ("rock_color.jpg", sample!("maps/rock_color.jpg")),
    ("abstract_height.png", sample!("maps/abstract_height.png")),
    ("scales_vector.exr", sample!("maps/scales_vector.exr")),
    ("Suzanne.gltf", sample!("models/Suzanne/Suzanne.gltf")),
    ("Suzanne.bin", sample!("models/Suzanne/Suzanne.bin")),
    ("Suzanne_BaseColor.png", sample!("models/Suzanne/Suzanne_BaseColor.png")),
    ("Suzanne_MetallicRoughness.png", sample!("models/Suzanne/Suzanne_MetallicRoughness.png")),
];

/// Names and contents.
pub(super) fn files() -> Result<Vec<(&'static str, Vec<u8>)>> {
    let mut files: Vec<_> = SAMPLES.iter().map(|&(name, bytes)| (name, bytes.to_vec())).collect();
    for (name, mesh, color) in [
        ("ground.glb", ground(8), [1.0; 3]),
        ("torus.glb", torus(48, 20), [0.62, 0.25, 0.12]),
        ("sphere.glb", sphere(32, 16), [0.2, 0.42, 0.3]),
    ] {
        let stem = name.trim_end_matches(".glb");
        files.push((name, glb(stem, mesh, color).map_err(Error::internal)?));
    }
    Ok(files)
}

/// A square of side 2 that faces up, of `n` x `n` quads.
fn ground(n: u32) -> Primitive {
    let mut mesh = Primitive { normals: Some(Vec::new()), uvs: Some(Vec::new()), ..Primitive::default() };
    for (i, j) in corners(n, n) {
        let uv = [f64::from(i) / f64::from(n), f64::from(j) / f64::from(n)];
        push(&mut mesh, [2.0 * uv[0] - 1.0, 0.0, 2.0 * uv[1] - 1.0], [0.0, 1.0, 0.0], uv);
    }
    mesh.triangles = quads(n, n).flatten().collect();
    mesh
}

/// A sphere of radius 1. The seam's places and the poles are equal to the bit, so that it is closed.
fn sphere(columns: u32, rows: u32) -> Primitive {
    let mut mesh = Primitive { normals: Some(Vec::new()), uvs: Some(Vec::new()), ..Primitive::default() };
    for (i, j) in corners(columns, rows) {
        let azimuth = TAU * f64::from(i % columns) / f64::from(columns);
        let polar = PI * f64::from(j) / f64::from(rows);
        let ring = if j == 0 || j == rows { 0.0 } else { polar.sin() };
        let place = [ring * azimuth.sin(), polar.cos(), ring * azimuth.cos()];
        push(&mut mesh, place, place, [f64::from(i) / f64::from(columns), f64::from(j) / f64::from(rows)]);
    }
    let is_pole = |[a, b]: [u32; 2]| mesh.positions[a as usize] == mesh.positions[b as usize];
    mesh.triangles = quads(columns, rows)
        .flatten()
        .filter(|&[a, b, c]| !is_pole([a, b]) && !is_pole([b, c]) && !is_pole([c, a]))
        .collect();
    mesh
}

/// A torus of radii 1 and 0.4 that lies flat; the map repeats 8 times around and 3 times across.
fn torus(columns: u32, rows: u32) -> Primitive {
    let mut mesh = Primitive { normals: Some(Vec::new()), uvs: Some(Vec::new()), ..Primitive::default() };
    for (i, j) in corners(columns, rows) {
        let around = TAU * f64::from(i % columns) / f64::from(columns);
        let across = TAU * f64::from(j % rows) / f64::from(rows);
        let normal = [across.cos() * around.sin(), -across.sin(), across.cos() * around.cos()];
        let ring = 1.0 + 0.4 * across.cos();
        let place = [ring * around.sin(), -0.4 * across.sin(), ring * around.cos()];
        let uv = [8.0 * f64::from(i) / f64::from(columns), 3.0 * f64::from(j) / f64::from(rows)];
        push(&mut mesh, place, normal, uv);
    }
    mesh.triangles = quads(columns, rows).flatten().collect();
    mesh
}

fn push(mesh: &mut Primitive, position: [f64; 3], normal: [f64; 3], uv: [f64; 2]) {
    mesh.positions.push(position.map(|c| c as f32));
    mesh.normals.get_or_insert_default().push(normal.map(|c| c as f32));
    mesh.uvs.get_or_insert_default().push(uv.map(|c| c as f32));
}

fn corners(columns: u32, rows: u32) -> impl Iterator<Item = (u32, u32)> {
    (0..=rows).flat_map(move |j| (0..=columns).map(move |i| (i, j)))
}

/// Two triangles for each quad, facing where u x v turned down faces.
fn quads(columns: u32, rows: u32) -> impl Iterator<Item = [[u32; 3]; 2]> {
    (0..rows).flat_map(move |j| {
        (0..columns).map(move |i| {
            let a = j * (columns + 1) + i;
            let (b, c, d) = (a + 1, a + columns + 1, a + columns + 2);
            [[a, c, b], [b, c, d]]
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_meshes_face_outwards_and_have_no_empty_triangle() {
        for (mesh, triangles) in [(ground(8), 128), (torus(48, 20), 1920), (sphere(32, 16), 2 * 32 * 15)] {
            assert_eq!(mesh.triangles.len(), triangles);
            for triangle in &mesh.triangles {
                let [a, b, c] = triangle.map(|i| mesh.positions[i as usize].map(f64::from));
                let edge = |p: [f64; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
                let (e, f) = (edge(b), edge(c));
                let cross = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
                let normal = mesh.normals.as_ref().unwrap()[triangle[0] as usize].map(f64::from);
                assert!(cross.iter().zip(normal).map(|(x, y)| x * y).sum::<f64>() > 1e-6, "{triangle:?}");
            }
        }
    }
}
