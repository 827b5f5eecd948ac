//! Wedges: the vertices of a primitive with a normal each. With normals in the file they are the file's
//! vertices; without, every corner of a triangle is a wedge of its own with the flat normal.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::PrimitiveInput;

pub(super) struct Wedges {
    pub(super) gv: Vec<u32>,
    /// The file's vertex of each wedge; `None` when they are the same.
    source: Option<Vec<u32>>,
    pub(super) normals: Vec<[f32; 3]>,
    /// Corners as wedges, degenerate triangles left out.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Normals of the file that were zero, not finite or far from unit length.
    pub(super) repaired: u32,
}

impl Wedges {
    pub(super) fn new(input: &PrimitiveInput, gv: &[u32], triangles: Vec<[u32; 3]>, gv_position: &[[f32; 3]]) -> Self {
        let flat = flat_normals(gv, &triangles, gv_position);
        match &input.normals {
            Some(normals) => Self::from_file(normals, gv, triangles, &flat),
            None => Self::flat(gv, &triangles, &flat),
        }
    }

    /// The vertex in the file that `wedge` came from.
    pub(super) fn source(&self, wedge: u32) -> usize {
        self.source.as_ref().map_or(wedge, |source| source[wedge as usize]) as usize
    }

    fn from_file(normals: &[[f32; 3]], gv: &[u32], triangles: Vec<[u32; 3]>, flat: &[DVec3]) -> Self {
        let mut normals = normals.to_vec();
        let mut used = vec![false; normals.len()];
        triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
        let states: Vec<State> = normals.par_iter_mut().map(repair).collect();
        let lost: Vec<u32> =
            (0..states.len() as u32).filter(|&v| used[v as usize] && states[v as usize] == State::Lost).collect();
        for (vertex, normal) in lost.iter().zip(replacements(&lost, &triangles, flat)) {
            normals[*vertex as usize] = normal;
        }
        let repaired = states.iter().zip(&used).filter(|(state, used)| **used && **state != State::Fine).count() as u32;
        Self { gv: gv.to_vec(), source: None, normals, triangles, repaired }
    }

    fn flat(gv: &[u32], triangles: &[[u32; 3]], flat: &[DVec3]) -> Self {
        let source = triangles.as_flattened().to_vec();
        Self {
            gv: source.iter().map(|&v| gv[v as usize]).collect(),
            normals: flat.iter().flat_map(|n| [unit_f32(*n); 3]).collect(),
            triangles: (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
            source: Some(source),
            repaired: 0,
        }
    }
}

#[derive(Clone, Copy, PartialEq)]
enum State {
    Fine,
    /// Rescaled by more than quantised normals need.
    Rescaled,
    /// Zero or not finite.
    Lost,
}

/// Makes `normal` unit length, leaving alone what already is to within rounding.
fn repair(normal: &mut [f32; 3]) -> State {
    let n = Vec3::from(*normal).as_dvec3();
    let length = n.length();
    if !length.is_finite() || length < 1e-30 {
        return State::Lost;
    }
    if (length - 1.0).abs() > 1e-6 {
        *normal = unit_f32(n);
    }
    if (length - 1.0).abs() > 0.02 { State::Rescaled } else { State::Fine }
}

fn unit_f32(n: DVec3) -> [f32; 3] {
    n.normalize_or(DVec3::Z).as_vec3().to_array()
}

/// For each lost vertex the mean of the flat normals of its triangles, summed in the order of their bits.
fn replacements(lost: &[u32], triangles: &[[u32; 3]], flat: &[DVec3]) -> Vec<[f32; 3]> {
    let mut around: Vec<Vec<DVec3>> = vec![Vec::new(); lost.len()];
    if !lost.is_empty() {
        for (triangle, normal) in triangles.iter().zip(flat) {
            for corner in triangle {
                if let Ok(i) = lost.binary_search(corner) {
                    around[i].push(*normal);
                }
            }
        }
    }
    around.into_iter().map(|normals| unit_f32(ordered_sum(normals))).collect()
}

fn ordered_sum(mut normals: Vec<DVec3>) -> DVec3 {
    normals.sort_unstable_by_key(|n| n.to_array().map(f64::to_bits));
    normals.into_iter().sum()
}

/// Unit normals of the triangles; triangles without area borrow one from a neighbour.
fn flat_normals(gv: &[u32], triangles: &[[u32; 3]], gv_position: &[[f32; 3]]) -> Vec<DVec3> {
    let corners = |t: &[u32; 3]| t.map(|v| gv[v as usize]);
    let mut normals: Vec<DVec3> = triangles.par_iter().map(|t| flat_normal(corners(t), gv_position)).collect();
    if normals.contains(&DVec3::ZERO) {
        borrow_normals(&mut normals, &triangles.iter().map(corners).collect::<Vec<_>>());
    }
    normals
}

/// Zero where the three places are on a line. Starts at the lowest gv so that the corner a file begins
/// with does not change the last bits.
fn flat_normal(mut gv: [u32; 3], gv_position: &[[f32; 3]]) -> DVec3 {
    let lowest = (0..3).min_by_key(|&k| gv[k]).unwrap_or(0);
    gv.rotate_left(lowest);
    let [a, b, c] = gv.map(|v| Vec3::from(gv_position[v as usize]).as_dvec3());
    (b - a).cross(c - a).normalize_or_zero()
}

fn borrow_normals(normals: &mut [DVec3], triangles: &[[u32; 3]]) {
    let mut best_of_gv = std::collections::HashMap::<u32, DVec3>::new();
    let bits = |n: &DVec3| n.to_array().map(f64::to_bits);
    for (triangle, normal) in triangles.iter().zip(normals.iter()).filter(|(_, n)| **n != DVec3::ZERO) {
        for gv in triangle {
            let best = best_of_gv.entry(*gv).or_insert(*normal);
            if bits(normal) > bits(best) {
                *best = *normal;
            }
        }
    }
    for (triangle, normal) in triangles.iter().zip(normals).filter(|(_, n)| **n == DVec3::ZERO) {
        let neighbours = triangle.iter().filter_map(|gv| best_of_gv.get(gv));
        *normal = neighbours.max_by_key(|n| bits(n)).copied().unwrap_or(DVec3::Z);
    }
}
