//! What is drawn in place of a mesh whose relief changes its outline: around each triangle a hull of its prism, or the
//! triangle raised to the greatest height. What of it is seen, a ray through it decides.

use displace_glsl::reference::relief::shell::Prism;
use glam::DVec3;

use crate::domain::image::{RenderMesh, Silhouettes};

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

/// Of triangles `range` of a mesh, which have heights from `low` to `high`, mesh-local units.
///
/// Hulls look inward: of each, its far side is drawn, which covers a sample once, also when the viewer is within.
pub(crate) fn proxies(
    mesh: &RenderMesh,
    range: std::ops::Range<usize>,
    [low, high]: [f32; 2],
    silhouettes: Silhouettes,
) -> Proxies {
    let corners_of = |t: usize| mesh.triangles[t].map(|v| v as usize);
    let prism = |t: usize, is_unit: bool| {
        let directions = if mesh.directions.is_empty() { &mesh.normals } else { &mesh.directions };
        let corners = corners_of(t).map(|v| vector(mesh.positions[v]));
        let directions = corners_of(t).map(|v| vector(directions[v]));
        let directions = if is_unit { directions.map(DVec3::normalize_or_zero) } else { directions };
        Prism::new(corners, directions, f64::from(low)..f64::from(high))
    };
    let most = |most: f64, prism: Prism| {
        most.max(prism.heights.end.max(prism.reach.end.min(MOST_RAISE * prism.heights.end)) * prism.side)
    };
    let raise = if silhouettes == Silhouettes::Quadric {
        range.clone().filter_map(|t| prism(t, true)).fold(0.0, most)
    } else {
        0.0
    };
    let faces = faces_per_triangle(silhouettes);
    let mut proxies = Proxies { faces, ..Proxies::default() };
    for t in range {
        let lost = mesh.positions[corners_of(t)[0]];
        match silhouettes {
            Silhouettes::None => {}
            Silhouettes::Shell => proxies.add_hull(prism(t, false).as_ref(), lost),
            Silhouettes::Quadric => proxies.add_raised(prism(t, true).as_ref(), raise, lost),
        }
    }
    proxies
}

/// Of proxies, for each triangle that they stand for.
pub(crate) fn faces_per_triangle(silhouettes: Silhouettes) -> usize {
    match silhouettes {
        Silhouettes::None => 0,
        Silhouettes::Shell => 8,
        Silhouettes::Quadric => 1,
    }
}

impl Proxies {
    fn add(&mut self, points: impl IntoIterator<Item = [f32; 3]>, faces: &[[u32; 3]]) {
        let first = self.positions.len() as u32;
        self.positions.extend(points);
        self.triangles.extend(faces.iter().map(|face| face.map(|v| first + v)));
    }

    fn add_hull(&mut self, prism: Option<&Prism>, lost: [f32; 3]) {
        let Some(prism) = prism else { return self.add([lost; 6], &hull_faces(&[DVec3::ZERO; 6])) };
        let hull = prism.hull(HULL_INFLATION);
        self.add(hull.map(|point| point.as_vec3().to_array()), &hull_faces(&hull));
    }

    fn add_raised(&mut self, prism: Option<&Prism>, raise: f64, lost: [f32; 3]) {
        let Some(prism) = prism else { return self.add([lost; 3], &[[0, 1, 2]]) };
        let raised = prism.raised(raise / prism.side);
        self.add(raised.map(|point| prism.global(point).as_vec3().to_array()), &[[0, 1, 2]]);
    }
}

/// Triangles around six points, three below and three above, looking inward. Each side is folded along the diagonal that
/// lies farther out.
fn hull_faces(hull: &[DVec3; 6]) -> [[u32; 3]; 8] {
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

fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    /// A tetrahedron with normals away from its middle, and a triangle without area.
    fn mesh(scale: f32) -> RenderMesh {
        let corners = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
        RenderMesh {
            positions: Arc::new(corners.map(|p| p.map(|x: f32| x * scale)).to_vec()),
            normals: Arc::new(corners.to_vec()),
            triangles: Arc::new(vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2], [1, 1, 2]]),
            material_of_triangles: vec![(0, 0)],
            ..RenderMesh::default()
        }
    }

    #[test]
    fn a_hull_is_closed_and_convex_and_looks_inward() {
        let proxies = proxies(&mesh(1.0), 0..5, [-0.2, 0.3], Silhouettes::Shell);
        assert_eq!((proxies.positions.len(), proxies.triangles.len()), (30, 40));
        let point = |v: u32| vector(proxies.positions[v as usize]);
        for faces in proxies.triangles[..32].chunks(8) {
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
        assert!(proxies.positions[24..].iter().all(|p| *p == proxies.positions[24]));
    }

    #[test]
    fn raised_triangles_hold_all_places_under_them() {
        for scale in [1e-4f32, 1.0, 1e4] {
            let (mesh, heights) = (mesh(scale), [-0.2 * scale, 0.3 * scale]);
            let proxies = proxies(&mesh, 0..5, heights, Silhouettes::Quadric);
            assert_eq!((proxies.positions.len(), proxies.triangles.len()), (15, 5));
            for (raised, base) in proxies.triangles.iter().zip(mesh.triangles.iter()).take(4) {
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
