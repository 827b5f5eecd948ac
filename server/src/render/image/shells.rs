//! What is drawn in place of a mesh whose relief changes its outline: around each triangle a hull of its prism, or the
//! triangle raised to the greatest height. What of it is seen, a ray through it decides.

use std::ops::Range;

use displace_glsl::reference::relief::shell::Prism;
use glam::DVec3;

use crate::domain::image::RenderMesh;

/// Of each hull.
pub(crate) const HULL_FACES: usize = 8;

/// How far hulls go beyond the sides of prisms, as a weight: more than a triangle of a quarter of a pixel loses when its
/// corners are snapped.
const HULL_INFLATION: f64 = 1.0 / 32.0;

/// Of heights, how far triangles are raised at most, so that a mesh's sharpest edge does not raise all of it.
const MOST_RAISE: f64 = 2.0;

/// Triangles with vertices of their own that stand for those of a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Proxies {
    /// Mesh-local.
    pub(crate) positions: Vec<[f32; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// So many for each triangle that is stood for, one after the other; where it has no prism they have no area.
    pub(crate) faces: usize,
}

/// Triangles of a mesh that have heights from `low` to `high`, mesh-local units.
#[derive(Clone, Debug)]
pub(crate) struct Raised<'a> {
    pub(crate) mesh: &'a RenderMesh,
    pub(crate) triangles: Range<usize>,
    pub(crate) heights: [f32; 2],
}

impl Raised<'_> {
    /// A closed hull around each prism. It looks inward: its far side is drawn, which covers a sample once, also when the
    /// viewer is within.
    pub(crate) fn hulls(&self) -> Proxies {
        let mut proxies = Proxies { faces: HULL_FACES, ..Proxies::default() };
        for t in self.triangles.clone() {
            let corners = self.corners(t, &self.mesh.positions);
            let prism = Prism::new(corners, self.corners(t, self.directions()), self.range());
            let hull = prism.map_or([corners[0]; 6], |prism| prism.hull(HULL_INFLATION));
            proxies.add(&hull, &hull_faces(&hull));
        }
        proxies
    }

    /// The triangles raised by `raise` along their directions: of a whole mesh by the same, so that it stays closed.
    pub(crate) fn raised(&self, raise: f64) -> Proxies {
        let mut proxies = Proxies { faces: 1, ..Proxies::default() };
        for t in self.triangles.clone() {
            let (corners, directions) = (self.corners(t, &self.mesh.positions), self.unit_directions(t));
            let raised = [0, 1, 2].map(|k| corners[k] + directions[k] * raise);
            let is_lost = Prism::new(corners, directions, self.range()).is_none();
            proxies.add(&if is_lost { [corners[0]; 3] } else { raised }, &[[0, 1, 2]]);
        }
        proxies
    }

    /// By how much they have to be raised to be above all heights.
    pub(crate) fn raise(&self) -> f64 {
        let of = |t: usize| {
            let prism = Prism::new(self.corners(t, &self.mesh.positions), self.unit_directions(t), self.range())?;
            let most = (MOST_RAISE * prism.heights.end).max(prism.heights.end);
            Some(prism.reach.end.min(most) * prism.side)
        };
        self.triangles.clone().filter_map(of).fold(0.0, f64::max)
    }

    fn range(&self) -> Range<f64> {
        f64::from(self.heights[0])..f64::from(self.heights[1])
    }

    fn directions(&self) -> &[[f32; 3]] {
        if self.mesh.directions.is_empty() { &self.mesh.normals } else { &self.mesh.directions }
    }

    fn unit_directions(&self, triangle: usize) -> [DVec3; 3] {
        self.corners(triangle, self.directions()).map(DVec3::normalize_or_zero)
    }

    fn corners(&self, triangle: usize, of: &[[f32; 3]]) -> [DVec3; 3] {
        self.mesh.triangles[triangle].map(|v| DVec3::from_array(of[v as usize].map(f64::from)))
    }
}

impl Proxies {
    fn add(&mut self, points: &[DVec3], faces: &[[u32; 3]]) {
        let first = self.positions.len() as u32;
        self.positions.extend(points.iter().map(|point| point.as_vec3().to_array()));
        self.triangles.extend(faces.iter().map(|face| face.map(|v| first + v)));
    }
}

/// Triangles around six points, three below and three above, looking inward. Each side is folded along the diagonal that
/// lies farther out.
fn hull_faces(hull: &[DVec3; 6]) -> [[u32; 3]; HULL_FACES] {
    let side = |i: u32| {
        let [low, next, next_high, high] = [i, (i + 1) % 3, (i + 1) % 3 + 3, i + 3];
        let [a, b, c, d] = [low, next, next_high, high].map(|v| hull[v as usize]);
        let outward = (b - a).cross(c - a);
        if outward.dot(d - a) <= 0.0 {
            [[low, next_high, next], [low, high, next_high]]
        } else {
            [[low, high, next], [next, high, next_high]]
        }
    };
    let ([s0, s1], [s2, s3], [s4, s5]) = (side(0), side(1), side(2));
    [[0, 1, 2], [3, 5, 4], s0, s1, s2, s3, s4, s5]
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    fn vector(v: [f32; 3]) -> DVec3 {
        DVec3::from_array(v.map(f64::from))
    }

    /// An octahedron with normals away from its middle, and a triangle without area.
    fn mesh(scale: f32) -> RenderMesh {
        let corners: Vec<[f32; 3]> =
            DVec3::AXES.iter().flat_map(|axis| [*axis, -*axis]).map(|p| p.as_vec3().to_array()).collect();
        let face = |[x, y, z]: [u32; 3]| {
            if (x + y + z) % 2 == 1 { [x, 4 + z, 2 + y] } else { [x, 2 + y, 4 + z] }
        };
        let mut triangles: Vec<_> = (0..8).map(|n| face([n & 1, n >> 1 & 1, n >> 2])).collect();
        triangles.push([1, 1, 2]);
        RenderMesh {
            positions: Arc::new(corners.iter().map(|p| p.map(|x| x * scale)).collect()),
            normals: Arc::new(corners),
            triangles: Arc::new(triangles),
            material_of_triangles: vec![(0, 0)],
            ..RenderMesh::default()
        }
    }

    #[test]
    fn a_hull_is_closed_and_convex_and_looks_inward() {
        let proxies = Raised { mesh: &mesh(1.0), triangles: 0..9, heights: [-0.2, 0.3] }.hulls();
        assert_eq!((proxies.positions.len(), proxies.triangles.len()), (54, 72));
        let point = |v: u32| vector(proxies.positions[v as usize]);
        for faces in proxies.triangles[..64].chunks(8) {
            for [a, b, c] in faces {
                let inward = (point(*b) - point(*a)).cross(point(*c) - point(*a)).normalize();
                for v in faces.iter().flatten() {
                    assert!((point(*v) - point(*a)).dot(inward) > -1e-6);
                }
                // Each side is that of one other face, the other way round.
                for [from, to] in [[a, b], [b, c], [c, a]] {
                    let is_met = |[a, b, c]: &&[u32; 3]| [[a, b], [b, c], [c, a]].contains(&[to, from]);
                    assert_eq!(faces.iter().filter(is_met).count(), 1);
                }
            }
        }
        assert!(proxies.positions[48..].iter().all(|p| *p == proxies.positions[48]));
    }

    #[test]
    fn raised_triangles_hold_all_places_under_them() {
        for scale in [1e-4f32, 1.0, 1e4] {
            let (mesh, heights) = (mesh(scale), [-0.2 * scale, 0.3 * scale]);
            let raised = Raised { mesh: &mesh, triangles: 0..9, heights };
            let proxies = raised.raised(raised.raise());
            assert_eq!((proxies.positions.len(), proxies.triangles.len()), (27, 9));
            for (raised, base) in proxies.triangles.iter().zip(mesh.triangles.iter()).take(8) {
                let [a, b, c] = raised.map(|v| vector(proxies.positions[v as usize]));
                let up = (b - a).cross(c - a).normalize();
                for weights in [DVec3::X, DVec3::splat(1.0 / 3.0), DVec3::new(0.0, 0.5, 0.5)] {
                    let blend =
                        |of: &[[f32; 3]]| -> DVec3 { (0..3).map(|k| vector(of[base[k] as usize]) * weights[k]).sum() };
                    let point = blend(&mesh.positions) + blend(&mesh.normals).normalize() * f64::from(heights[1]);
                    assert!((point - a).dot(up) < 0.0);
                }
            }
        }
    }
}
