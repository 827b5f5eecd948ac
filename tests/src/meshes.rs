//! Procedural meshes, each with one property worth a test. Coordinates of shared places are copied, never
//! computed twice, so that they are equal to the bit.

use std::f64::consts::{PI, TAU};

/// An indexed triangle mesh as a glTF primitive holds it.
#[derive(Clone, Debug)]
pub struct TestMesh {
    pub name: &'static str,
    pub positions: Vec<[f32; 3]>,
    pub normals: Vec<[f32; 3]>,
    pub uvs: Vec<[f32; 2]>,
    pub triangles: Vec<[u32; 3]>,
}

/// The unit square in xz, facing +y, of `segments`^2 quads.
#[must_use]
pub fn plane(segments: u32) -> TestMesh {
    let at = |i: u32| f64::from(i) / f64::from(segments);
    let mut mesh = TestMesh::grid("plane", segments, segments, |i, j| [at(i), at(j)]);
    mesh.positions = mesh.uvs.iter().map(|uv| [uv[0] - 0.5, 0.0, uv[1] - 0.5]).collect();
    mesh.normals = vec![[0.0, 1.0, 0.0]; mesh.positions.len()];
    mesh.flip();
    mesh
}

/// A cube of side 1 with four vertices per face: hard edges, and the whole map on each face.
#[must_use]
pub fn cube() -> TestMesh {
    let mut mesh = TestMesh::empty("cube");
    for axis in 0..3 {
        for sign in [-0.5f32, 0.5] {
            mesh.push_cube_face(axis, sign);
        }
    }
    mesh
}

/// A sphere of radius 1 on a longitude-latitude grid: a UV seam and two poles with degenerate UVs.
#[must_use]
pub fn uv_sphere(columns: u32, rows: u32) -> TestMesh {
    sphere_grid("uv_sphere", columns, rows, |i| f64::from(i) / f64::from(columns))
}

/// The same sphere with u running there and back: no jump anywhere, but the map's handedness flips.
#[must_use]
pub fn mirrored_uv_sphere(columns: u32, rows: u32) -> TestMesh {
    sphere_grid("mirrored_uv_sphere", columns, rows, |i| 1.0 - (2.0 * f64::from(i) / f64::from(columns) - 1.0).abs())
}

/// A torus of radii 1 and 0.4 with UV seams in both directions.
#[must_use]
pub fn torus(major: u32, minor: u32) -> TestMesh {
    let mut mesh = TestMesh::grid("torus", major, minor, |i, j| {
        [f64::from(i) / f64::from(major), f64::from(j) / f64::from(minor)]
    });
    mesh.fill(major, minor, |i, j| {
        let (a, b) = (TAU * f64::from(i % major) / f64::from(major), TAU * f64::from(j % minor) / f64::from(minor));
        let normal = [b.cos() * a.cos(), b.sin(), b.cos() * a.sin()];
        let ring = 1.0 + 0.4 * b.cos();
        ([ring * a.cos(), 0.4 * b.sin(), ring * a.sin()], normal)
    });
    mesh.flip();
    mesh
}

/// The inside of an open tube of radius 1 and length 2 round the y axis: it faces its axis.
#[must_use]
pub fn concave_cylinder(columns: u32, rows: u32) -> TestMesh {
    let mut mesh = TestMesh::grid("concave_cylinder", columns, rows, |i, j| {
        [f64::from(i) / f64::from(columns), f64::from(j) / f64::from(rows)]
    });
    mesh.fill(columns, rows, |i, j| {
        let (s, c) = (TAU * f64::from(i % columns) / f64::from(columns)).sin_cos();
        ([c, 2.0 * f64::from(j) / f64::from(rows) - 1.0, s], [-c, 0.0, -s])
    });
    mesh
}

/// A strip with a half twist: one side, one border, opposite windings where it closes.
#[must_use]
pub fn moebius(columns: u32, rows: u32) -> TestMesh {
    let mut mesh = TestMesh::grid("moebius", columns, rows, |i, j| {
        [f64::from(i) / f64::from(columns), f64::from(j) / f64::from(rows)]
    });
    mesh.fill(columns, rows, |i, j| {
        // The last column is the first one upside down.
        let (i, j, side) = if i == columns { (0, rows - j, -1.0) } else { (i, j, 1.0) };
        let (a, across) = (TAU * f64::from(i) / f64::from(columns), 0.4 * (2.0 * f64::from(j) / f64::from(rows) - 1.0));
        let half = a / 2.0;
        let ring = 1.0 + across * half.cos();
        let normal = [-half.sin() * a.cos(), half.cos(), -half.sin() * a.sin()];
        ([ring * a.cos(), across * half.sin(), ring * a.sin()], normal.map(|x| side * x))
    });
    mesh
}

/// A geodesic sphere of radius 1 with smooth normals; u and v are taken from x and y, so no seam.
#[must_use]
pub fn icosphere(level: u32) -> TestMesh {
    let (mut points, mut triangles) = icosahedron();
    for _ in 0..level {
        triangles = split_in_four(&mut points, &triangles);
    }
    let positions: Vec<[f32; 3]> = points.iter().map(|p| p.map(|x| x as f32)).collect();
    let normals = positions.clone();
    let uvs = positions.iter().map(|p| [0.5 + 0.5 * p[0], 0.5 - 0.5 * p[1]]).collect();
    TestMesh { name: "icosphere", positions, normals, uvs, triangles }
}

/// The meshes of the watertightness tests, with the number of boundary edges each starts with.
#[must_use]
pub fn all() -> Vec<TestMesh> {
    vec![plane(4), cube(), uv_sphere(24, 12), mirrored_uv_sphere(24, 12), torus(24, 12), moebius(32, 4), icosphere(2)]
}

impl TestMesh {
    fn empty(name: &'static str) -> Self {
        Self { name, positions: Vec::new(), normals: Vec::new(), uvs: Vec::new(), triangles: Vec::new() }
    }

    /// The UVs and triangles of a grid of `columns` x `rows` quads; vertex (i, j) is j * (columns + 1) + i.
    fn grid(name: &'static str, columns: u32, rows: u32, uv: impl Fn(u32, u32) -> [f64; 2]) -> Self {
        let mut mesh = Self::empty(name);
        for (j, i) in (0..=rows).flat_map(|j| (0..=columns).map(move |i| (j, i))) {
            mesh.uvs.push(uv(i, j).map(|x| x as f32));
        }
        for (j, i) in (0..rows).flat_map(|j| (0..columns).map(move |i| (j, i))) {
            let a = j * (columns + 1) + i;
            let (b, c, d) = (a + 1, a + columns + 2, a + columns + 1);
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
        mesh
    }

    fn fill(&mut self, columns: u32, rows: u32, point: impl Fn(u32, u32) -> ([f64; 3], [f64; 3])) {
        for (j, i) in (0..=rows).flat_map(|j| (0..=columns).map(move |i| (j, i))) {
            let (position, normal) = point(i, j);
            self.positions.push(position.map(|x| x as f32));
            self.normals.push(normal.map(|x| x as f32));
        }
    }

    fn flip(&mut self) {
        for triangle in &mut self.triangles {
            triangle.swap(1, 2);
        }
    }

    fn push_cube_face(&mut self, axis: usize, sign: f32) {
        let first = self.positions.len() as u32;
        for (u, v) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
            let mut position = [0.0; 3];
            position[axis] = sign;
            position[(axis + 1) % 3] = if sign > 0.0 { u - 0.5 } else { 0.5 - u };
            position[(axis + 2) % 3] = v - 0.5;
            let mut normal = [0.0; 3];
            normal[axis] = sign.signum();
            self.positions.push(position);
            self.normals.push(normal);
            self.uvs.push([u, 1.0 - v]);
        }
        self.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }

    /// The same mesh with its triangles and its vertices in another order; each triangle keeps its corners.
    #[must_use]
    pub fn permuted(&self, seed: u64) -> Self {
        use rand::{SeedableRng as _, seq::SliceRandom as _};
        let mut random = rand::rngs::StdRng::seed_from_u64(seed);
        let mut old_of_new: Vec<u32> = (0..self.positions.len() as u32).collect();
        old_of_new.shuffle(&mut random);
        let mut new_of_old = vec![0; old_of_new.len()];
        for (new, &old) in old_of_new.iter().enumerate() {
            new_of_old[old as usize] = new as u32;
        }
        let mut triangles: Vec<[u32; 3]> = self.triangles.iter().map(|t| t.map(|i| new_of_old[i as usize])).collect();
        triangles.shuffle(&mut random);
        Self {
            name: self.name,
            positions: old_of_new.iter().map(|&i| self.positions[i as usize]).collect(),
            normals: old_of_new.iter().map(|&i| self.normals[i as usize]).collect(),
            uvs: old_of_new.iter().map(|&i| self.uvs[i as usize]).collect(),
            triangles,
        }
    }
}

fn sphere_grid(name: &'static str, columns: u32, rows: u32, u: impl Fn(u32) -> f64) -> TestMesh {
    let mut mesh = TestMesh::grid(name, columns, rows, |i, j| [u(i), f64::from(j) / f64::from(rows)]);
    mesh.fill(columns, rows, |i, j| {
        let (a, b) = (TAU * f64::from(i % columns) / f64::from(columns), PI * f64::from(j) / f64::from(rows));
        // Poles lie on the axis exactly.
        let ring = if j == 0 || j == rows { 0.0 } else { b.sin() };
        let point = [ring * a.cos(), b.cos(), -ring * a.sin()];
        (point, point)
    });
    mesh.flip();
    mesh.triangles.retain(|t| {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        a != b && b != c && c != a
    });
    mesh
}

fn icosahedron() -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let g = (1.0 + 5f64.sqrt()) / 2.0;
    let mut points = Vec::new();
    for (a, b) in [(-1.0, -g), (1.0, -g), (-1.0, g), (1.0, g)] {
        points.extend([[0.0, a, b], [a, b, 0.0], [b, 0.0, a]]);
    }
    let points: Vec<[f64; 3]> = points.into_iter().map(unit).collect();
    let mut triangles = Vec::new();
    for a in 0..12u32 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                push_if_face(&points, [a, b, c], &mut triangles);
            }
        }
    }
    (points, triangles)
}

/// Three vertices of an icosahedron bound a face when they are one edge apart from each other.
fn push_if_face(points: &[[f64; 3]], [a, b, c]: [u32; 3], triangles: &mut Vec<[u32; 3]>) {
    let [p, q, r] = [a, b, c].map(|i| glam::DVec3::from(points[i as usize]));
    let edge = 1.06;
    if p.distance(q) < edge && q.distance(r) < edge && r.distance(p) < edge {
        let outward = (q - p).cross(r - p).dot(p) > 0.0;
        triangles.push(if outward { [a, b, c] } else { [a, c, b] });
    }
}

fn split_in_four(points: &mut Vec<[f64; 3]>, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut middles = std::collections::HashMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            let (p, q) = (points[a as usize], points[b as usize]);
            points.push(unit([p[0] + q[0], p[1] + q[1], p[2] + q[2]]));
            points.len() as u32 - 1
        })
    };
    let mut fine = Vec::with_capacity(4 * triangles.len());
    for &[a, b, c] in triangles {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        fine.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    fine
}

fn unit(p: [f64; 3]) -> [f64; 3] {
    glam::DVec3::from(p).normalize().into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_triangle_faces_the_way_of_its_normals() {
        // A Moebius strip has no outside; each of its triangles still agrees with its own corners.
        for mesh in all().into_iter().chain([concave_cylinder(12, 3)]) {
            for &triangle in &mesh.triangles {
                let [p, q, r] = triangle.map(|i| glam::Vec3::from(mesh.positions[i as usize]));
                let normal: glam::Vec3 = triangle.iter().map(|&i| glam::Vec3::from(mesh.normals[i as usize])).sum();
                assert!((q - p).cross(r - p).dot(normal) > 0.0, "{}: {triangle:?}", mesh.name);
            }
        }
    }

    #[test]
    fn an_icosphere_has_twenty_times_four_to_the_level_triangles() {
        assert_eq!(icosphere(0).triangles.len(), 20);
        assert_eq!(icosphere(2).triangles.len(), 320);
    }
}
