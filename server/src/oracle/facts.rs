//! Facts of one triangle mesh, measured in f64.
//!
//! | file | measures |
//! |---|---|
//! | `strain.rs` | how much a displacement stretches its base, and what it turns over |
//! | `self_intersection.rs`, `meeting.rs` | triangles that run through each other |

mod meeting;
mod self_intersection;
mod strain;

use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

pub use self_intersection::{SelfIntersections, self_intersections};
pub use strain::{LONG, Spot, Strain};

use super::{invariants, topology::Topology};
use crate::domain::{mesh::Mesh, report::Stretch, surface::Surface};

/// What can be said of a mesh alone, and of a displaced surface against its base. Lengths in the units of the
/// positions. Places are positions of equal bits.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MeshFacts {
    pub vertices: u64,
    pub triangles: u64,
    pub area: f64,
    /// Enclosed volume, positive where triangles run counter-clockwise seen from outside; none of a mesh that is
    /// not closed and of one winding. Parts that overlap count twice.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub volume: Option<f64>,
    /// Edges with one triangle.
    pub boundary_edges: u64,
    /// Edges with more than two triangles.
    pub non_manifold_edges: u64,
    /// Edges whose two triangles run the same way.
    pub badly_wound_edges: u64,
    /// Triangles without area.
    pub degenerate_triangles: u64,
    /// Pieces that share no place.
    pub components: u64,
    /// Places − edges + triangles.
    pub euler_characteristic: i64,
    /// Triangles with area by their smallest angle: below 5 degrees, below 10, and so on to 60.
    pub smallest_angles: [u64; 12],
    /// Of a displaced surface: the largest distance between vertices that share a place of the base.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seam_gap: Option<f64>,
    /// Of a displaced surface: triangles that face against their base triangle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flipped: Option<u64>,
    /// Of a displaced surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stretch: Option<Stretch>,
    /// Where they were asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub self_intersections: Option<SelfIntersections>,
}

/// Triangles whose measures are added one after the other, so that sums do not depend on the threads.
const LOT: usize = 1 << 12;

impl MeshFacts {
    /// Positions of triangles are finite, indices in range.
    #[must_use]
    pub fn of(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Self {
        let topology = Topology::new(positions, triangles);
        let shapes = Shapes::of(positions, triangles);
        Self {
            vertices: positions.len() as u64,
            triangles: triangles.len() as u64,
            area: shapes.area,
            volume: topology.is_closed().then_some(shapes.volume),
            boundary_edges: topology.boundary().count() as u64,
            non_manifold_edges: topology.non_manifold().count() as u64,
            badly_wound_edges: topology.badly_wound().count() as u64,
            degenerate_triangles: shapes.degenerate,
            components: topology.components(),
            euler_characteristic: topology.euler_characteristic(),
            smallest_angles: shapes.smallest_angles,
            ..Self::default()
        }
    }

    /// Of `surface`, displaced from `mesh`.
    #[must_use]
    pub fn of_surface(mesh: &Mesh, surface: &Surface) -> Self {
        let strain = Strain::of(mesh, surface);
        Self {
            seam_gap: Some(invariants::largest_gap(mesh, surface)),
            flipped: Some(strain.flipped),
            stretch: strain.stretch(),
            ..Self::of(&surface.positions, &surface.triangles)
        }
    }
}

#[derive(Clone, Debug, Default)]
struct Shapes {
    area: f64,
    volume: f64,
    degenerate: u64,
    smallest_angles: [u64; 12],
}

impl Shapes {
    fn of(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Self {
        let at = |v: u32| DVec3::from_array(positions[v as usize].map(f64::from));
        // Volumes are measured from a corner of the mesh, so that a mesh far off keeps its digits.
        let origin = triangles.first().map_or(DVec3::ZERO, |t| at(t[0]));
        let of_lot = |lot: &[[u32; 3]]| {
            let mut shapes = Self::default();
            for t in lot {
                shapes.degenerate += u64::from(meeting::is_degenerate(&t.map(|v| positions[v as usize])));
                shapes.add(t.map(|v| at(v) - origin));
            }
            shapes
        };
        let lots: Vec<Self> = triangles.par_chunks(LOT).map(of_lot).collect();
        lots.iter().fold(Self::default(), Self::joined)
    }

    fn add(&mut self, [a, b, c]: [DVec3; 3]) {
        let double_area = (b - a).cross(c - a).length();
        self.area += 0.5 * double_area;
        self.volume += a.dot(b.cross(c)) / 6.0;
        if double_area > 0.0 {
            let angle = smallest_angle([a, b, c], double_area).to_degrees();
            self.smallest_angles[((angle / 5.0) as usize).min(11)] += 1;
        }
    }

    fn joined(mut self, other: &Self) -> Self {
        self.area += other.area;
        self.volume += other.volume;
        self.degenerate += other.degenerate;
        self.smallest_angles.iter_mut().zip(other.smallest_angles).for_each(|(own, others)| *own += others);
        self
    }
}

/// Radians.
fn smallest_angle(corners: [DVec3; 3], double_area: f64) -> f64 {
    let at = |k: usize| {
        let [p, q, r] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
        double_area.atan2((q - p).dot(r - p))
    };
    at(0).min(at(1)).min(at(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn right_and_equilateral_triangles_fall_into_their_buckets() {
        let positions =
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.866, 0.0], [1.0, 0.01, 0.0], [2.0, 0.0, 0.0]];
        let facts = MeshFacts::of(&positions, &[[0, 1, 2], [0, 1, 3], [0, 1, 4], [0, 1, 5]]);
        let mut expected = [0; 12];
        (expected[0], expected[9 - 1], expected[11]) = (1, 0, 1);
        expected[9] = 1;
        assert_eq!((facts.smallest_angles, facts.degenerate_triangles), (expected, 1));
        assert_eq!(facts.volume, None);
    }

    #[test]
    fn a_mesh_far_off_keeps_its_volume_and_its_sign() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0f32]];
        let far = corners.map(|p| p.map(|x| x + 1024.0));
        let outward = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let volume = MeshFacts::of(&far, &outward).volume.expect("it is closed");
        assert!((volume - 1.0 / 6.0).abs() < 1e-12, "{volume}");
        let inward = outward.map(|[a, b, c]| [a, c, b]);
        assert_eq!(MeshFacts::of(&far, &inward).volume, Some(-volume));
    }

    #[test]
    fn facts_survive_json_and_leave_out_what_they_do_not_know() {
        let facts = MeshFacts::of(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]);
        let text = serde_json::to_string(&facts).expect("facts are JSON");
        assert!(!text.contains("null") && !text.contains("volume"), "{text}");
        assert_eq!(serde_json::from_str::<MeshFacts>(&text).expect("and back"), facts);
    }
}
