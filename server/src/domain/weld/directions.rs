//! Mitred welded directions: one displacement direction D per geometric vertex with n·D = 1 for its
//! wedge normals n, so that a constant height offsets every face exactly and corners stay closed.

use glam::{DMat3, DVec3, Vec3};
use rayon::prelude::*;

use crate::domain::mesh::Mesh;

/// Longest direction; sharper mitres are cut.
const MITRE_LIMIT: f64 = 2.0;
/// Eigenvalues below this part of the largest say nothing certain about D.
const EIGENVALUE_DROP: f64 = 1e-4;
/// A mitre that leaves some face this little offset is no mitre.
const LEAST_OFFSET: f64 = 0.2;

pub(super) fn mitred(mesh: &Mesh) -> Vec<[f32; 3]> {
    (0..mesh.gv_position.len()).into_par_iter().map(|gv| direction(&distinct_normals(mesh, gv))).collect()
}

/// The distinct wedge normals at a gv with their angle weights, in the order of their bits: nothing here
/// depends on the order of the triangles.
fn distinct_normals(mesh: &Mesh, gv: usize) -> Vec<(DVec3, f64)> {
    let mut corners: Vec<([u32; 3], u64)> = mesh.gv_corner.list(gv).iter().map(|&corner| wedge(mesh, corner)).collect();
    corners.sort_unstable();
    let mut normals: Vec<(DVec3, f64)> = Vec::new();
    let mut previous = None;
    for (bits, weight) in corners {
        if previous != Some(bits) {
            normals.push((Vec3::from(bits.map(f32::from_bits)).as_dvec3(), 0.0));
            previous = Some(bits);
        }
        if let Some(last) = normals.last_mut() {
            last.1 += f64::from_bits(weight);
        }
    }
    normals
}

/// Bits of the wedge normal and of the angle weight (not negative, so that bits order as values).
fn wedge(mesh: &Mesh, corner: u32) -> ([u32; 3], u64) {
    let triangle = &mesh.triangles[corner as usize / 3];
    let k = corner as usize % 3;
    let position = |k: usize| {
        let gv = mesh.av_gv[triangle.av[k % 3] as usize];
        Vec3::from(mesh.gv_position[gv as usize]).as_dvec3()
    };
    let (p, q, r) = (position(k), position(k + 1), position(k + 2));
    (mesh.av_normal[triangle.av[k] as usize].map(f32::to_bits), angle(q - p, r - p).to_bits())
}

/// Zero for triangles without area, whose normal is borrowed.
fn angle(a: DVec3, b: DVec3) -> f64 {
    let sine = a.cross(b).length();
    if sine > 0.0 { sine.atan2(a.dot(b)) } else { 0.0 }
}

fn direction(normals: &[(DVec3, f64)]) -> [f32; 3] {
    let total: f64 = normals.iter().map(|(_, weight)| weight).sum();
    match normals {
        [] => [0.0; 3],
        [(normal, _)] => normal.as_vec3().to_array(),
        // Nothing but triangles without area: every normal counts the same.
        _ if total <= 0.0 => mean(&normals.iter().map(|(n, _)| (*n, 1.0)).collect::<Vec<_>>()).as_vec3().to_array(),
        _ => mitre(normals, total).as_vec3().to_array(),
    }
}

/// Least squares of w (n·D − 1)², minimum norm, clamped; the mean normal where that serves no face.
fn mitre(normals: &[(DVec3, f64)], total: f64) -> DVec3 {
    let mut matrix = DMat3::ZERO;
    let mut right = DVec3::ZERO;
    for (n, weight) in normals {
        let weighted = *n * (*weight / total);
        matrix += DMat3::from_cols(weighted * n.x, weighted * n.y, weighted * n.z);
        right += weighted;
    }
    let solution = solve_minimum_norm(matrix, right);
    let least = normals.iter().filter(|(_, w)| *w > 0.0).map(|(n, _)| n.dot(solution)).fold(f64::INFINITY, f64::min);
    // A least that is not a number takes the mean too.
    if least > LEAST_OFFSET { solution.clamp_length_max(MITRE_LIMIT) } else { mean(normals) }
}

fn mean(normals: &[(DVec3, f64)]) -> DVec3 {
    let sum: DVec3 = normals.iter().map(|(n, weight)| *n * *weight).sum();
    // Two sheets back to back have no mean: the first normal in bit order decides.
    let total: f64 = normals.iter().map(|(_, weight)| weight).sum();
    if sum.length() > 1e-6 * total { sum.normalize() } else { normals[0].0 }
}

fn solve_minimum_norm(matrix: DMat3, right: DVec3) -> DVec3 {
    let (values, vectors) = eigen(matrix);
    let largest = values.max_element();
    let mut solution = DVec3::ZERO;
    for k in 0..3 {
        if values[k] >= EIGENVALUE_DROP * largest {
            solution += vectors.col(k) * (vectors.col(k).dot(right) / values[k]);
        }
    }
    solution
}

/// Eigenvalues and unit eigenvectors of a symmetric matrix by cyclic Jacobi rotations.
fn eigen(mut a: DMat3) -> (DVec3, DMat3) {
    let mut vectors = DMat3::IDENTITY;
    for _sweep in 0..12 {
        let off = a.y_axis.x.abs() + a.z_axis.x.abs() + a.z_axis.y.abs();
        if off < 1e-15 {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let rotation = jacobi_rotation(&a, p, q);
            a = rotation.transpose() * a * rotation;
            vectors *= rotation;
        }
    }
    (DVec3::new(a.x_axis.x, a.y_axis.y, a.z_axis.z), vectors)
}

/// The rotation in the (p, q) plane that makes a[p][q] zero.
fn jacobi_rotation(a: &DMat3, p: usize, q: usize) -> DMat3 {
    let apq = a.col(q)[p];
    let mut rotation = DMat3::IDENTITY;
    if apq == 0.0 {
        return rotation;
    }
    let theta = (a.col(q)[q] - a.col(p)[p]) / (2.0 * apq);
    let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
    let cosine = 1.0 / (t * t + 1.0).sqrt();
    rotation.col_mut(p)[p] = cosine;
    rotation.col_mut(q)[q] = cosine;
    rotation.col_mut(q)[p] = t * cosine;
    rotation.col_mut(p)[q] = -t * cosine;
    rotation
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_walls_of_a_corner_meet_at_the_exact_mitre() {
        let d = direction(&[(DVec3::X, 1.5), (DVec3::Y, 0.7), (DVec3::Z, 1.6)]);
        // Longer than nothing: |(1, 1, 1)| = 1.73 is below the limit.
        assert_eq!(d, [1.0, 1.0, 1.0]);
    }

    #[test]
    fn two_walls_give_the_shortest_mitre() {
        let d = Vec3::from(direction(&[(DVec3::X, 1.0), (DVec3::Y, 3.0)]));
        assert!((d - Vec3::new(1.0, 1.0, 0.0)).length() < 1e-6, "{d}");
    }

    #[test]
    fn back_to_back_sheets_still_have_a_finite_direction() {
        let d = Vec3::from(direction(&[(DVec3::Z, 1.0), (DVec3::NEG_Z, 1.0)]));
        assert_eq!(d.length(), 1.0);
    }

    #[test]
    fn eigenvectors_diagonalise_a_symmetric_matrix() {
        let a = DMat3::from_cols_array(&[2.0, -1.0, 0.3, -1.0, 1.5, 0.2, 0.3, 0.2, 0.9]);
        let (values, vectors) = eigen(a);
        for k in 0..3 {
            let residual = a * vectors.col(k) - vectors.col(k) * values[k];
            assert!(residual.length() < 1e-12, "{residual}");
        }
    }
}
