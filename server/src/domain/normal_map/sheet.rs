//! The triangles of one primitive of a result as readers see them.

use displace_glsl::layout::refine::UNIT;
use glam::{DMat3, DVec2, DVec3, Vec3, Vec4};

use crate::domain::surface::Place;

/// One primitive of a result. Vertices are those of its file: they split where tangents do.
#[derive(Clone, Debug, Default)]
pub struct Sheet {
    pub triangles: Vec<[u32; 3]>,
    /// Mesh-local units.
    pub positions: Vec<[f32; 3]>,
    /// Unit length.
    pub normals: Vec<[f32; 3]>,
    /// MikkTSpace's; the handedness is the fourth.
    pub tangents: Vec<[f32; 4]>,
    /// v points down.
    pub uvs: Vec<[f32; 2]>,
    /// The base triangle of each triangle.
    pub bases: Vec<u32>,
    /// Where the corners of each triangle lie in it: weights of its three corners, in units of 2^-24.
    pub places: Vec<[[u32; 3]; 3]>,
}

/// What a reader interpolates at a place: as MikkTSpace has it, tangent and normal are not made unit vectors, and the
/// bitangent is their product.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    pub tangent: DVec3,
    pub bitangent: DVec3,
    pub normal: DVec3,
}

impl Sheet {
    /// Texel coordinates of the corners of a triangle in a map of that size.
    #[must_use]
    pub fn on_map(&self, triangle: usize, size: [u32; 2]) -> [DVec2; 3] {
        let size = DVec2::from_array(size.map(f64::from));
        self.triangles[triangle].map(|v| DVec2::from_array(self.uvs[v as usize].map(f64::from)) * size)
    }

    #[must_use]
    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|v| Vec3::from(self.positions[v as usize]).as_dvec3())
    }

    /// The texture coordinates at barycentrics b of a triangle.
    #[must_use]
    pub fn uv(&self, triangle: usize, b: DVec3) -> DVec2 {
        let uvs = self.triangles[triangle].map(|v| DVec2::from_array(self.uvs[v as usize].map(f64::from)));
        b.x * uvs[0] + b.y * uvs[1] + b.z * uvs[2]
    }

    #[must_use]
    pub fn frame(&self, triangle: usize, b: DVec3) -> Frame {
        let vertices = self.triangles[triangle].map(|v| v as usize);
        let blend = |of: &dyn Fn(usize) -> DVec3| b.x * of(vertices[0]) + b.y * of(vertices[1]) + b.z * of(vertices[2]);
        let normal = blend(&|v| Vec3::from(self.normals[v]).as_dvec3());
        let tangent = blend(&|v| Vec4::from(self.tangents[v]).truncate().as_dvec3());
        let handedness = f64::from(self.tangents[vertices[0]][3]);
        Frame { tangent, bitangent: handedness * normal.cross(tangent), normal }
    }

    /// The place on the base mesh, just inside its triangle where it is on the border.
    #[must_use]
    pub fn place(&self, triangle: usize, b: DVec3) -> Place {
        let corners = self.places[triangle].map(|corner| DVec3::from_array(corner.map(f64::from)));
        let units = b.x * corners[0] + b.y * corners[1] + b.z * corners[2];
        let most = f64::from(UNIT - 2);
        let b1 = units.y.round().clamp(1.0, most) as u32;
        let b2 = units.z.round().clamp(1.0, f64::from(UNIT - 1 - b1)) as u32;
        Place::Inside { triangle: self.bases[triangle], b: [b1, b2] }
    }
}

impl Frame {
    /// The direction in the frame, of unit length, that a reader takes for `normal`; whether it had to be laid into the
    /// surface, since maps hold none that point into it. None where the frame spans nothing.
    #[must_use]
    pub fn encode(&self, normal: DVec3) -> Option<(DVec3, bool)> {
        let columns = DMat3::from_cols(self.tangent, self.bitangent, self.normal);
        if columns.determinant().abs() < 1e-9 {
            return None;
        }
        let inside = (columns.inverse() * normal).try_normalize()?;
        if inside.z >= 0.0 {
            return Some((inside, false));
        }
        Some((inside.with_z(0.0).try_normalize()?, true))
    }

    /// The unit normal that a reader takes a direction in the frame for.
    #[must_use]
    pub fn decode(&self, direction: DVec3) -> DVec3 {
        let sum = direction.x * self.tangent + direction.y * self.bitangent + direction.z * self.normal;
        sum.try_normalize().unwrap_or(self.normal.normalize_or_zero())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_encoded_is_decoded_in_a_frame_that_is_not_orthonormal() {
        let (normal, tangent) = (DVec3::new(0.1, 0.2, 0.8), DVec3::new(0.7, 0.1, -0.2));
        let frame = Frame { tangent, bitangent: -normal.cross(tangent), normal };
        for direction in [DVec3::Z, DVec3::new(0.5, -0.3, 0.8).normalize(), DVec3::new(-0.6, 0.1, 0.5).normalize()] {
            let (inside, clamped) = frame.encode(direction).unwrap();
            assert!(!clamped && frame.decode(inside).distance(direction) < 1e-12, "{direction} {inside}");
        }
    }

    #[test]
    fn a_normal_that_points_into_the_triangle_is_laid_into_it() {
        let frame = Frame { tangent: DVec3::X, bitangent: DVec3::Y, normal: DVec3::Z };
        let (inside, clamped) = frame.encode(DVec3::new(0.6, 0.0, -0.8)).unwrap();
        assert!(clamped && inside == DVec3::X);
        assert_eq!(Frame { tangent: DVec3::Z, ..frame }.encode(DVec3::X), None);
    }

    #[test]
    fn places_on_the_border_of_a_base_triangle_move_just_inside() {
        let sheet = Sheet {
            triangles: vec![[0, 1, 2]],
            bases: vec![7],
            places: vec![[[UNIT, 0, 0], [0, UNIT, 0], [0, 0, UNIT]]],
            ..Sheet::default()
        };
        for b in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.0, 0.5, 0.5), DVec3::splat(1.0 / 3.0)] {
            let Place::Inside { triangle: 7, b: [b1, b2] } = sheet.place(0, b) else { panic!("{b}") };
            assert!(b1 > 0 && b2 > 0 && b1 + b2 < UNIT, "{b}: {b1} {b2}");
            let found = [b1, b2].map(|units| f64::from(units) / f64::from(UNIT));
            assert!((found[0] - b.y).abs() < 3e-7 && (found[1] - b.z).abs() < 3e-7, "{b}: {found:?}");
        }
    }
}
