//! Uniform subdivision by plain interpolation: a surface for tests of what comes after the passes.

use displace_glsl::lattice::{edge_points, interior_points, interior_rank};
use displace_server::domain::{
    mesh::Mesh,
    surface::{Layout, Surface},
};
use glam::Vec3;

/// Subdivides `mesh`, moving every fine vertex along its normal by `height` of its place. Seams may open:
/// nothing is reconciled.
#[must_use]
pub fn subdivided(mesh: &Mesh, level: u32, height: impl Fn(Vec3) -> f32) -> Surface {
    let stencils = stencils(mesh, level);
    let blend = |values: &[f32], n: usize| -> Vec<f32> {
        let one = |(avs, parts): &([u32; 3], [f32; 3])| -> Vec<f32> {
            (0..n).map(|c| (0..3).map(|k| values[avs[k] as usize * n + c] * parts[k]).sum()).collect()
        };
        stencils.iter().flat_map(one).collect()
    };
    let places: Vec<f32> = mesh.av_gv.iter().flat_map(|&gv| mesh.gv_position[gv as usize]).collect();
    let normals: Vec<Vec3> = blend(mesh.av_normal.as_flattened(), 3)
        .as_chunks::<3>()
        .0
        .iter()
        .map(|n| Vec3::from(*n).normalize_or(Vec3::Z))
        .collect();
    let positions = blend(&places, 3);
    let moved = positions.as_chunks::<3>().0.iter().zip(&normals).map(|(p, n)| {
        let p = Vec3::from(*p);
        (p + *n * height(p)).to_array()
    });
    Surface {
        layout: Layout::Uniform { level },
        positions: moved.collect(),
        normals: if level == 0 { mesh.av_normal.clone() } else { normals.iter().map(|n| n.to_array()).collect() },
        attributes: mesh.attributes.iter().map(|a| blend(&a.values, a.components)).collect(),
        triangles: triangles(mesh, level),
        ..Surface::default()
    }
}

/// Corner avs and weights of every fine vertex, in the order of `Surface`.
fn stencils(mesh: &Mesh, level: u32) -> Vec<([u32; 3], [f32; 3])> {
    let n = 1u32 << level;
    let part = |k: u32| k as f32 / n as f32;
    let mut stencils: Vec<_> = (0..mesh.av_gv.len() as u32).map(|av| ([av; 3], [1.0, 0.0, 0.0])).collect();
    for &[a, b] in &mesh.ae_av {
        stencils.extend((1..n).map(|k| ([a, b, b], [part(n - k), part(k), 0.0])));
    }
    for triangle in &mesh.triangles {
        for j in 1..n {
            stencils.extend((1..n - j).map(|i| (triangle.av, [part(n - i - j), part(i), part(j)])));
        }
    }
    stencils
}

fn triangles(mesh: &Mesh, level: u32) -> Vec<[u32; 3]> {
    let n = 1u32 << level;
    let mut triangles = Vec::new();
    for t in 0..mesh.triangles.len() {
        let at = |i: u32, j: u32| vertex(mesh, level, t, i, j);
        for j in 0..n {
            for i in 0..n - j {
                triangles.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
                if i + j + 1 < n {
                    triangles.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
    }
    triangles
}

/// The fine vertex at lattice point (i, j) of base triangle `t`.
fn vertex(mesh: &Mesh, level: u32, t: usize, i: u32, j: u32) -> u32 {
    let n = 1u32 << level;
    let triangle = &mesh.triangles[t];
    let corner = [(0, 0), (n, 0), (0, n)].iter().position(|corner| *corner == (i, j));
    if let Some(corner) = corner {
        return triangle.av[corner];
    }
    // Steps from the start of each side; a side runs from corner k to corner k + 1.
    let sides = [(j == 0, i), (i + j == n, j), (i == 0, n - j)];
    let first_edge = mesh.av_gv.len() as u64;
    let edges = edge_points(level);
    let place = match sides.iter().position(|(on, _)| *on) {
        Some(side) => {
            let ae = triangle.ae[side];
            let along = mesh.ae_av[ae as usize][0] == triangle.av[side];
            let step = if along { sides[side].1 } else { n - sides[side].1 };
            first_edge + u64::from(ae) * edges + u64::from(step) - 1
        }
        None => {
            let first = first_edge + mesh.ae_av.len() as u64 * edges;
            first + t as u64 * interior_points(level) + interior_rank(level, i.into(), j.into())
        }
    };
    place as u32
}
