//! Meshes and details that are made for scenarios. Lengths are mesh-local units.

use std::{
    f64::consts::{PI, TAU},
    sync::Arc,
};

use crate::domain::{
    Result,
    detail::{Detail, Layer, LayerSource, Map, Sampling, Wrap},
    mesh::Mesh,
    request::{Base, Geometry, Normals, Refinement, SeamRule},
    weld::{PrimitiveInput, VertexAttribute, weld},
};

/// A sheet of vertices before it is welded.
#[derive(Clone, Debug, Default)]
pub(super) struct Sheet {
    pub(super) positions: Vec<[f32; 3]>,
    pub(super) normals: Vec<[f32; 3]>,
    pub(super) uvs: Vec<[f32; 2]>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// Position, normal and texture coordinates at (u, v).
type Point = ([f64; 3], [f64; 3], [f64; 2]);

impl Sheet {
    /// Over the unit square; triangles run counter-clockwise where u, v and the normal are right-handed. Those without
    /// area are left out.
    pub(super) fn grid([columns, rows]: [u32; 2], point: impl Fn(f64, f64) -> Point) -> Self {
        let mut sheet = Self::default();
        for (j, i) in (0..=rows).flat_map(|j| (0..=columns).map(move |i| (j, i))) {
            let (position, normal, uv) = point(f64::from(i) / f64::from(columns), f64::from(j) / f64::from(rows));
            sheet.positions.push(position.map(|x| x as f32));
            sheet.normals.push(normal.map(|x| x as f32));
            sheet.uvs.push(uv.map(|x| x as f32));
        }
        for (j, i) in (0..rows).flat_map(|j| (0..columns).map(move |i| (j, i))) {
            let a = j * (columns + 1) + i;
            let (b, c, d) = (a + 1, a + columns + 2, a + columns + 1);
            sheet.triangles.extend([[a, b, c], [a, c, d]]);
        }
        let Self { positions, triangles, .. } = &mut sheet;
        triangles.retain(|t| {
            let [a, b, c] = t.map(|v| positions[v as usize]);
            a != b && b != c && c != a
        });
        sheet
    }

    /// Adds another beside it.
    pub(super) fn with(mut self, other: &Self) -> Self {
        let first = self.positions.len() as u32;
        self.positions.extend(&other.positions);
        self.normals.extend(&other.normals);
        self.uvs.extend(&other.uvs);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
        self
    }

    pub(super) fn welded(&self, name: &str) -> Result<Mesh> {
        let values = self.uvs.iter().flatten().copied().collect();
        let primitive = PrimitiveInput {
            positions: self.positions.clone(),
            normals: Some(self.normals.clone()),
            attributes: vec![VertexAttribute { semantic: "TEXCOORD_0".into(), components: 2, values }],
            triangles: self.triangles.clone(),
            ..PrimitiveInput::default()
        };
        weld(name, &[primitive])
    }
}

/// A unit square that faces up, from (-1/2, -1/2) to (1/2, 1/2).
pub(super) fn plane(segments: u32) -> Sheet {
    Sheet::grid([segments; 2], |u, v| ([u - 0.5, 0.0, 0.5 - v], [0.0, 1.0, 0.0], [u, 1.0 - v]))
}

/// The faces of a cube of side 1, each with the whole map.
pub(super) fn cube_faces() -> Vec<Sheet> {
    let face = |axis: usize, side: f64| {
        Sheet::grid([1; 2], move |u, v| {
            let (mut position, mut normal) = ([0.0; 3], [0.0; 3]);
            (position[axis], normal[axis]) = (0.5 * side, side);
            position[(axis + 1) % 3] = side * (u - 0.5);
            position[(axis + 2) % 3] = v - 0.5;
            (position, normal, [u, 1.0 - v])
        })
    };
    (0..3).flat_map(|axis| [-1.0, 1.0].map(|side| face(axis, side))).collect()
}

pub(super) fn cube() -> Sheet {
    cube_faces().iter().fold(Sheet::default(), Sheet::with)
}

/// Radius 1, by longitude and latitude: a seam and two poles. `mirrored`: u runs there and back.
pub(super) fn sphere([columns, rows]: [u32; 2], mirrored: bool) -> Sheet {
    Sheet::grid([columns, rows], move |u, v| {
        let ring = if v == 0.0 || v == 1.0 { 0.0 } else { (PI * v).sin() };
        // Once round is where it began, to the bit.
        let (sin, cos) = (TAU * (u % 1.0)).sin_cos();
        let point = [ring * cos, -(PI * v).cos(), -ring * sin];
        (point, point, [if mirrored { 1.0 - (2.0 * u - 1.0).abs() } else { u }, 1.0 - v])
    })
}

/// Radii 1 and 0.4, with seams both ways.
pub(super) fn torus([major, minor]: [u32; 2]) -> Sheet {
    Sheet::grid([major, minor], |u, v| {
        let ((a, b), (c, d)) = ((TAU * (u % 1.0)).sin_cos(), (TAU * (v % 1.0)).sin_cos());
        let ring = 1.0 + 0.4 * d;
        ([ring * b, 0.4 * c, -ring * a], [d * b, c, -d * a], [u, 1.0 - v])
    })
}

/// The inside of a tube of radius 1 and length 2 around y: it faces its axis.
pub(super) fn tube([columns, rows]: [u32; 2]) -> Sheet {
    Sheet::grid([columns, rows], |u, v| {
        let (sin, cos) = (TAU * (u % 1.0)).sin_cos();
        ([cos, 2.0 * v - 1.0, sin], [-cos, 0.0, -sin], [u, 1.0 - v])
    })
}

/// Uniform subdivision, all else by default.
pub(super) fn uniform(level: u32) -> Geometry {
    Geometry {
        refinement: Refinement::Uniform(level),
        max_triangles: None,
        normals: Normals::Analytic,
        seams: SeamRule::Mean,
        feather_texels: 3.0,
        base: Base::Flat,
    }
}

/// A map of one channel.
pub(super) fn height_map([width, height]: [u32; 2], wrap: Wrap, value: impl Fn(u32, u32) -> f32) -> Arc<Map> {
    let texels: Vec<f32> = (0..width * height).map(|k| value(k % width, k / width)).collect();
    let (wrap, sampling) = ([wrap; 2], Sampling::Center);
    Arc::new(Map { width, height, channels: 1, texels: texels.into(), wrap, sampling, source_bits: 32 })
}

/// No two neighbours agree; 0 to 1.
pub(super) fn noise(side: u32, seed: u64) -> Arc<Map> {
    let mut random = super::rays::Random::new(seed);
    let values: Vec<f32> = (0..side * side).map(|_| random.next() as f32).collect();
    height_map([side; 2], Wrap::Repeat, |x, y| values[(y * side + x) as usize])
}

/// Of one layer.
pub(super) fn detail(source: LayerSource, scale: f32) -> Arc<Detail> {
    let layer = Layer { source, scale, midlevel: 0.0, map_from_uv: Layer::map_from_uv(false) };
    Arc::new(Detail { layers: vec![layer], uv_set: 0 })
}

pub(super) fn heights(map: &Arc<Map>, scale: f32) -> Arc<Detail> {
    detail(LayerSource::Height(Arc::clone(map)), scale)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::invariants::boundary_edges;

    #[test]
    fn sheets_face_the_way_of_their_normals_and_are_closed_where_they_should_be() {
        let sheets =
            [(plane(3), 12), (cube(), 0), (sphere([12, 6], false), 0), (torus([12, 6]), 0), (tube([12, 3]), 24)];
        for (sheet, boundary) in sheets {
            for triangle in &sheet.triangles {
                let [a, b, c] = triangle.map(|v| glam::Vec3::from(sheet.positions[v as usize]));
                let normal: glam::Vec3 = triangle.iter().map(|v| glam::Vec3::from(sheet.normals[*v as usize])).sum();
                assert!((b - a).cross(c - a).dot(normal) > 0.0, "{triangle:?} of {boundary}");
            }
            assert_eq!(boundary_edges(&sheet.positions, &sheet.triangles), boundary);
        }
    }
}
