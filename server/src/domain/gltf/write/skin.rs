//! Values that must not be interpolated linearly: joints with their weights, identifiers, tangents.

use glam::{Vec3, Vec4};
use rayon::prelude::*;

use super::fine::Fine;
use crate::domain::mesh::Attribute;

/// Joints and weights of one primitive's fine vertices, `influences` each.
pub(super) struct Skin {
    pub(super) sets: usize,
    pub(super) joints: Vec<u16>,
    pub(super) weights: Vec<f32>,
}

/// Blends the influences of the corners and keeps the strongest four for each set the file has.
pub(super) fn blend(fine: &Fine<'_>) -> Option<Skin> {
    let attribute = |name: &str, set: usize| {
        fine.mesh.attribute(&format!("{name}_{set}")).filter(|a| a.primitives[fine.index] && a.components == 4)
    };
    let sets: Vec<(&Attribute, &Attribute)> =
        (0..).map_while(|set| Some((attribute("JOINTS", set)?, attribute("WEIGHTS", set)?))).collect();
    if sets.is_empty() {
        return None;
    }
    let width = 4 * sets.len();
    let mut joints = vec![0; fine.vertices() * width];
    let mut weights = vec![0.0; fine.vertices() * width];
    joints.par_chunks_mut(width).zip(weights.par_chunks_mut(width)).enumerate().for_each_init(
        Vec::new,
        |influences, (local, (joints, weights))| {
            influences.clear();
            let (avs, parts) = fine.site(local);
            for (av, part) in avs.into_iter().zip(parts).filter(|(_, part)| *part > 0.0) {
                gather(&sets, av as usize, part, influences);
            }
            strongest(influences, joints, weights);
        },
    );
    Some(Skin { sets: sets.len(), joints, weights })
}

fn gather(sets: &[(&Attribute, &Attribute)], av: usize, part: f32, influences: &mut Vec<(u16, f32)>) {
    for (joints, weights) in sets {
        for k in 4 * av..4 * av + 4 {
            let (joint, weight) = (joints.values[k] as u16, weights.values[k].max(0.0) * part);
            if weight > 0.0 {
                match influences.iter_mut().find(|(known, _)| *known == joint) {
                    Some((_, sum)) => *sum += weight,
                    None => influences.push((joint, weight)),
                }
            }
        }
    }
}

/// Fills the slots with the strongest influences, their weights summing to 1; unused slots are joint 0.
fn strongest(influences: &mut [(u16, f32)], joints: &mut [u16], weights: &mut [f32]) {
    influences.sort_unstable_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let used = &influences[..influences.len().min(joints.len())];
    let total: f64 = used.iter().map(|(_, weight)| f64::from(*weight)).sum();
    for ((joint, weight), (slot, out)) in used.iter().zip(joints.iter_mut().zip(weights.iter_mut())) {
        *slot = *joint;
        *out = (f64::from(*weight) / total) as f32;
    }
    // The strongest takes what rounding left over; a vertex without weights follows joint 0.
    weights[0] = 1.0 - weights[1..].iter().sum::<f32>();
}

/// Whether an attribute numbers things: custom and whole everywhere.
pub(super) fn is_identifier(attribute: &Attribute) -> bool {
    attribute.semantic.starts_with('_') && attribute.values.par_iter().all(|v| v.fract() == 0.0)
}

/// Each fine vertex takes the values of its nearest corner; of equally near ones the first.
pub(super) fn nearest(fine: &Fine<'_>, attribute: &Attribute) -> Vec<f32> {
    let n = attribute.components;
    let mut values = vec![0.0; fine.vertices() * n];
    values.par_chunks_mut(n).enumerate().for_each(|(local, out)| {
        let (avs, parts) = fine.site(local);
        let best = (1..3).fold(0, |best, k| if parts[k] > parts[best] { k } else { best });
        out.copy_from_slice(&attribute.values[avs[best] as usize * n..][..n]);
    });
    values
}

/// The base mesh's tangents carried over and turned into the plane of the new normals.
pub(super) fn carried_tangents(fine: &Fine<'_>) -> Vec<[f32; 4]> {
    let tangent = |local: usize| {
        let (avs, parts) = fine.site(local);
        let corner = |k: usize| Vec4::from(fine.mesh.av_tangent[avs[k] as usize]);
        let sum = corner(0) * parts[0] + corner(1) * parts[1] + corner(2) * parts[2];
        let normal = Vec3::from(fine.surface.normals[fine.global(local)]);
        let across = sum.truncate() - normal * normal.dot(sum.truncate());
        let axis = across.try_normalize().unwrap_or_else(|| normal.any_orthonormal_vector());
        axis.extend(if sum.w < 0.0 { -1.0 } else { 1.0 }).to_array()
    };
    (0..fine.vertices()).into_par_iter().map(tangent).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_four_strongest_influences_are_kept_and_sum_to_one() {
        let mut influences = vec![(7, 0.1), (3, 0.4), (9, 0.2), (1, 0.2), (5, 0.1)];
        let (mut joints, mut weights) = ([0; 4], [0.0; 4]);
        strongest(&mut influences, &mut joints, &mut weights);
        assert_eq!(joints, [3, 1, 9, 5]);
        assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-7 && weights.is_sorted_by(|a, b| a >= b));
    }

    #[test]
    fn a_vertex_without_weights_follows_joint_0() {
        let (mut joints, mut weights) = ([0; 4], [0.0; 4]);
        strongest(&mut [], &mut joints, &mut weights);
        assert_eq!((joints, weights), ([0; 4], [1.0, 0.0, 0.0, 0.0]));
    }
}
