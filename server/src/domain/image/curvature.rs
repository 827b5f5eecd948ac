//! How a mesh bends at its vertices: the quadric of Oliveira and Policarpo (2005), z = a x² + b xy + c y², that fits the
//! vertices around each best.

use std::collections::HashMap;

use glam::{DMat3, DVec3};

/// What keeps a fit finite where its neighbours lie in one or two directions: bends it leaves open are small.
const RIDGE: f64 = 1e-6;

/// Of vertices the symmetric tensor S of half the normal curvature, negative where the mesh is convex: the surface leaves
/// the plane at the vertex by r·S r, r in that plane. Rows xx, xy, xz, yy, yz, zz, per mesh-local unit. What shares a
/// position is one vertex; `directions` are its normals, of any length.
#[must_use]
pub fn curvatures(positions: &[[f32; 3]], directions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<[f32; 6]> {
    let mut number = HashMap::new();
    let places: Vec<usize> = positions
        .iter()
        .map(|p| {
            let next = number.len();
            *number.entry(p.map(|x| (x + 0.0).to_bits())).or_insert(next)
        })
        .collect();
    let mut fits = vec![Fit::NOTHING; number.len()];
    for (vertex, &place) in places.iter().enumerate() {
        fits[place].position = vector(positions[vertex]);
        fits[place].upright += vector(directions[vertex]).normalize_or_zero();
    }
    fits.iter_mut().for_each(|fit| fit.upright = fit.upright.normalize_or_zero());
    for corners in triangles {
        let [a, b, c] = corners.map(|v| places[v as usize]);
        for [from, to] in [[a, b], [b, a], [b, c], [c, b], [c, a], [a, c]] {
            let neighbour = fits[to].position;
            fits[from].add(neighbour);
        }
    }
    let bends: Vec<[f32; 6]> = fits.iter().map(Fit::tensor).collect();
    places.into_iter().map(|place| bends[place]).collect()
}

/// Least squares for (a, b, c) over neighbours, each as the bend in its direction: z/r² = a cos² + b cos sin + c sin².
#[derive(Clone, Copy, Debug)]
struct Fit {
    position: DVec3,
    upright: DVec3,
    products: DMat3,
    values: DVec3,
}

impl Fit {
    const NOTHING: Self =
        Self { position: DVec3::ZERO, upright: DVec3::ZERO, products: DMat3::ZERO, values: DVec3::ZERO };

    fn add(&mut self, neighbour: DVec3) {
        let (along, across) = self.frame();
        let offset = neighbour - self.position;
        let (x, y) = (offset.dot(along), offset.dot(across));
        let squared = x * x + y * y;
        let bend = offset.dot(self.upright) / squared;
        if bend.is_finite() {
            let row = DVec3::new(x * x, x * y, y * y) / squared;
            self.products += DMat3::from_cols(row * row.x, row * row.y, row * row.z);
            self.values += row * bend;
        }
    }

    fn frame(&self) -> (DVec3, DVec3) {
        if self.upright == DVec3::ZERO { (DVec3::ZERO, DVec3::ZERO) } else { self.upright.any_orthonormal_pair() }
    }

    fn tensor(&self) -> [f32; 6] {
        let (along, across) = self.frame();
        let [a, b, c] = ((self.products + DMat3::IDENTITY * RIDGE).inverse() * self.values).to_array();
        let outer = |u: DVec3, v: DVec3| DMat3::from_cols(u * v.x, u * v.y, u * v.z);
        let s = outer(along, along) * a
            + (outer(along, across) + outer(across, along)) * (0.5 * b)
            + outer(across, across) * c;
        [s.x_axis.x, s.x_axis.y, s.x_axis.z, s.y_axis.y, s.y_axis.z, s.z_axis.z].map(|entry| entry as f32)
    }
}

fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use glam::Vec3Swizzles;

    use super::*;

    /// A closed grid of n x n places of (u, v) in [0, 1)², its last row and column joined to the first.
    /// Positions, directions and triangles.
    type Grid = (Vec<[f32; 3]>, Vec<[f32; 3]>, Vec<[u32; 3]>);

    fn grid(n: u32, at: impl Fn(f64, f64) -> (DVec3, DVec3)) -> Grid {
        let places = (0..n * n).map(|i| at(f64::from(i % n) / f64::from(n), f64::from(i / n) / f64::from(n)));
        let (positions, normals) = places.map(|(p, n)| (p.as_vec3().to_array(), n.as_vec3().to_array())).unzip();
        let vertex = |x: u32, y: u32| y % n * n + x % n;
        let square = |i: u32| {
            let (x, y) = (i % n, i / n);
            [
                [vertex(x, y), vertex(x + 1, y), vertex(x + 1, y + 1)],
                [vertex(x, y), vertex(x + 1, y + 1), vertex(x, y + 1)],
            ]
        };
        (positions, normals, (0..n * n).flat_map(square).collect())
    }

    fn bend(s: [f32; 6], r: DVec3) -> f64 {
        let [xx, xy, xz, yy, yz, zz] = s.map(f64::from);
        r.dot(DMat3::from_cols(DVec3::new(xx, xy, xz), DVec3::new(xy, yy, yz), DVec3::new(xz, yz, zz)) * r)
    }

    #[test]
    fn a_torus_bends_as_it_is_known_to() {
        let (major, minor) = (3.0, 1.0);
        let at = |u: f64, v: f64| {
            let (around, over) = (DVec3::new((u * TAU).cos(), (u * TAU).sin(), 0.0), v * TAU);
            let normal = around * over.cos() + DVec3::Z * over.sin();
            (around * major + normal * minor, normal)
        };
        let (positions, normals, triangles) = grid(96, at);
        let bends = curvatures(&positions, &normals, &triangles);
        for (i, s) in bends.iter().enumerate() {
            let (u, v) = (f64::from(i as u32 % 96) / 96.0 * TAU, f64::from(i as u32 / 96) / 96.0 * TAU);
            let along = DVec3::new(-u.sin(), u.cos(), 0.0);
            let over = vector(normals[i]).cross(along);
            // Of the circle around the axis as the surface sees it, and of the tube.
            let expected = [-0.5 * v.cos() / (major + minor * v.cos()), -0.5 / minor];
            assert!((bend(*s, along) - expected[0]).abs() < 0.02 * 0.5 / minor, "{i}");
            assert!((bend(*s, over) - expected[1]).abs() < 0.02 * 0.5 / minor, "{i}");
            assert!(bend(*s, vector(normals[i])).abs() < 1e-6);
        }
    }

    #[test]
    fn a_sphere_bends_alike_everywhere_whatever_its_size_and_its_seams() {
        for radius in [1e-4, 1.0, 1e4] {
            // Six faces of a cube, blown up: their borders are seams.
            let (mut positions, mut normals, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
            for face in 0..6 {
                let n = 24;
                let base = positions.len() as u32;
                for i in 0..=n * (n + 2) {
                    let (x, y) = (f64::from(i % (n + 1)) / f64::from(n), f64::from(i / (n + 1)) / f64::from(n));
                    let flat = DVec3::new(1.0, (x - 0.5) * 2.0, (y - 0.5) * 2.0);
                    let turned = [flat, flat.yxz(), flat.yzx(), -flat, -flat.yxz(), -flat.yzx()][face];
                    positions.push((turned.normalize() * radius).as_vec3().to_array());
                    normals.push(turned.normalize().as_vec3().to_array());
                }
                for i in 0..n * n {
                    let v = base + i / n * (n + 1) + i % n;
                    triangles.extend([[v, v + 1, v + n + 2], [v, v + n + 2, v + n + 1]]);
                }
            }
            for (s, normal) in curvatures(&positions, &normals, &triangles).into_iter().zip(&normals) {
                let (along, across) = vector(*normal).any_orthonormal_pair();
                for r in [along, across, (along + across) * 0.5f64.sqrt()] {
                    assert!((bend(s, r) * radius + 0.5).abs() < 0.02, "{} {radius}", bend(s, r) * radius);
                }
            }
        }
    }

    #[test]
    fn flat_and_degenerate_meshes_do_not_bend() {
        let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3], [2.0, 2.0, 0.0]];
        let triangles = [[0, 1, 2], [3, 3, 3], [1, 4, 2]];
        for direction in [[0.0, 0.0, 2.0], [0.0; 3]] {
            for s in curvatures(&positions, &[direction; 5], &triangles) {
                assert_eq!(s.map(f32::abs), [0.0; 6]);
            }
        }
    }
}
