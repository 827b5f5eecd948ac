//! How far one fine triangle is stretched against its base triangle.

use displace_glsl::layout::refine::UNIT;
use glam::DVec3;

use super::exact;
use crate::domain::mesh::Mesh;

/// A base triangle with area, prepared for fine triangles on 2^level segments a side.
pub(super) struct Frame {
    /// From the sides of a fine triangle to derivatives along two unit vectors across each other.
    inverse: [f64; 3],
    normal: DVec3,
}

impl Frame {
    pub(super) fn of(mesh: &Mesh, base: usize, level: u32) -> Option<Self> {
        let place = |av: u32| exact(mesh.gv_position[mesh.av_gv[av as usize] as usize]);
        Self::between(mesh.triangles[base].av.map(place), level)
    }

    /// Of the triangle between three places.
    pub(super) fn between([p, q, r]: [DVec3; 3], level: u32) -> Option<Self> {
        let normal = (q - p).cross(r - p);
        let along = (q - p).length();
        let (across, skew) = (normal.length() / along, (q - p).dot(r - p) / along);
        let segments = (1u64 << level) as f64;
        let inverse = [segments / along, -segments * skew / (along * across), segments / across];
        (inverse[0] + inverse[1] + inverse[2]).is_finite().then_some(Self { inverse, normal })
    }

    /// The square of the stretch, and whether it is flipped. Fine triangles have the corners (i, j), (i + 1, j),
    /// (i, j + 1) when upright, else (i + 1, j), (i + 1, j + 1), (i, j + 1).
    #[inline]
    pub(super) fn of_fine(&self, [a, b, c]: [DVec3; 3], upright: bool) -> (f64, bool) {
        let (i, j) = if upright { (b - a, c - a) } else { (b - c, b - a) };
        self.of_sides(i, j)
    }

    /// The same of any fine triangle of a frame without segments, its corners' weights in the base triangle given in
    /// units of 2^-24.
    pub(super) fn of_piece(&self, [a, b, c]: [DVec3; 3], weights: [[u32; 3]; 3]) -> (f64, bool) {
        let part =
            |corner: usize, k: usize| (f64::from(weights[corner][k]) - f64::from(weights[0][k])) / f64::from(UNIT);
        let ([b1, b2], [c1, c2]) = ([part(1, 1), part(1, 2)], [part(2, 1), part(2, 2)]);
        let area = b1 * c2 - b2 * c1;
        self.of_sides(((b - a) * c2 - (c - a) * b2) / area, ((c - a) * b1 - (b - a) * c1) / area)
    }

    /// Of the sides that a lattice triangle would have: from (i, j) to (i + 1, j) and to (i, j + 1).
    #[inline]
    fn of_sides(&self, i: DVec3, j: DVec3) -> (f64, bool) {
        let (s, t) = (i * self.inverse[0], i * self.inverse[1] + j * self.inverse[2]);
        let (ss, st, tt) = (s.dot(s), s.dot(t), t.dot(t));
        let square = 0.5 * (ss + tt) + (0.25 * (ss - tt) * (ss - tt) + st * st).sqrt();
        (square, i.cross(j).dot(self.normal) < 0.0)
    }
}
