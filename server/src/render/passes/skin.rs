//! Joints and weights of skinned meshes: indices cannot be interpolated, so the influences of a vertex's
//! base vertices are merged, and the strongest kept. On the host, for it is rare and made of sorting.

use rayon::prelude::*;

use crate::domain::{mesh::Mesh, surface::Layout};

/// Influences of one set: JOINTS_n and WEIGHTS_n have four components.
const PER_SET: usize = 4;

#[must_use]
pub fn is_skin(semantic: &str) -> bool {
    semantic.starts_with("JOINTS_") || semantic.starts_with("WEIGHTS_")
}

/// Fills the entries of `values` (parallel to the mesh's attributes) that hold joints and weights.
pub fn blend(layout: &Layout, mesh: &Mesh, values: &mut [Vec<f32>]) {
    let sets = sets(mesh);
    if sets.is_empty() {
        return;
    }
    let width = 2 * PER_SET * sets.len();
    let mut merged = vec![0.0f32; layout.vertices(mesh) * width];
    merged.par_chunks_mut(width).enumerate().for_each(|(vertex, out)| {
        let (av, b) = layout.place(mesh, vertex).site(mesh);
        strongest(&influences(mesh, &sets, av, b.map(|b| b as f32)), out);
    });
    for (k, &(joints, weights)) in sets.iter().enumerate() {
        let pick =
            |offset: usize| merged.chunks(width).flat_map(|v| v[offset..offset + PER_SET].iter().copied()).collect();
        values[joints] = pick(2 * PER_SET * k);
        values[weights] = pick(2 * PER_SET * k + PER_SET);
    }
}

/// Attribute indices of (JOINTS_n, WEIGHTS_n) with n from 0.
fn sets(mesh: &Mesh) -> Vec<(usize, usize)> {
    let find =
        |semantic: String| mesh.attributes.iter().position(|a| a.semantic == semantic && a.components == PER_SET);
    (0..).map_while(|n| Some((find(format!("JOINTS_{n}"))?, find(format!("WEIGHTS_{n}"))?))).collect()
}

/// (joint, weight) of all base vertices, merged by joint.
fn influences(mesh: &Mesh, sets: &[(usize, usize)], av: [u32; 3], b: [f32; 3]) -> Vec<(u32, f32)> {
    let mut all: Vec<(u32, f32)> = Vec::with_capacity(3 * PER_SET * sets.len());
    for (&av, b) in av.iter().zip(b).filter(|(_, b)| *b > 0.0) {
        for &(joints, weights) in sets {
            for k in 0..PER_SET {
                let at = av as usize * PER_SET + k;
                let (joint, weight) =
                    (mesh.attributes[joints].values[at] as u32, mesh.attributes[weights].values[at] * b);
                match all.iter_mut().find(|(known, _)| *known == joint) {
                    Some((_, sum)) => *sum += weight,
                    None if weight > 0.0 => all.push((joint, weight)),
                    None => {}
                }
            }
        }
    }
    all.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    all
}

/// Writes the strongest influences as sets of four joints and four weights, scaled to the full sum.
fn strongest(influences: &[(u32, f32)], out: &mut [f32]) {
    let kept = &influences[..influences.len().min(out.len() / 2)];
    let (total, held): (f32, f32) = (influences.iter().map(|i| i.1).sum(), kept.iter().map(|i| i.1).sum());
    for (k, (joint, weight)) in kept.iter().enumerate() {
        let at = 2 * PER_SET * (k / PER_SET) + k % PER_SET;
        out[at] = *joint as f32;
        out[at + PER_SET] = weight * total / held;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_strongest_influences_keep_the_sum() {
        let mut out = [0.0; 8];
        strongest(&[(7, 0.4), (2, 0.3), (9, 0.15), (1, 0.1), (3, 0.05)], &mut out);
        assert_eq!(out[..4], [7.0, 2.0, 9.0, 1.0]);
        assert!((out[4..].iter().sum::<f32>() - 1.0).abs() < 1e-6);
    }
}
