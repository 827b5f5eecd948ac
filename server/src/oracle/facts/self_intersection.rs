//! Triangles of one mesh that run through each other.

use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::meeting::{Corners, is_degenerate, meet};
use crate::oracle::bvh::{Bounds, Bvh};

/// Pairs of triangles that have a point in common besides the corner or the edge they share by position. Exact.
/// Triangles without area are not looked at. A corner that lies on another triangle counts, so a T-junction does too.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SelfIntersections {
    pub count: u64,
    /// The first of them in the order of the triangles, the lower index first.
    pub pairs: Vec<[u32; 2]>,
}

/// Counts all pairs and lists at most `most` of them. Positions of triangles are finite, indices in range.
#[must_use]
pub fn self_intersections(positions: &[[f32; 3]], triangles: &[[u32; 3]], most: usize) -> SelfIntersections {
    let corners = |t: &[u32; 3]| t.map(|v| positions[v as usize]);
    let with_area = |(t, ids): (usize, &[u32; 3])| (!is_degenerate(&corners(ids))).then_some(t as u32);
    let solid: Vec<u32> = triangles.par_iter().enumerate().filter_map(with_area).collect();
    let corners = |item: u32| corners(&triangles[solid[item as usize] as usize]);
    let boxes: Vec<Bounds> = (0..solid.len() as u32).into_par_iter().map(|item| bounds(&corners(item))).collect();
    let bvh = Bvh::build(&boxes);
    let of_item = |mut found: SelfIntersections, item: u32| {
        let t = corners(item);
        let mut others = Vec::new();
        bvh.touching(boxes[item as usize], |other| {
            if other > item && meet(&t, &corners(other)) {
                others.push(other);
            }
        });
        others.sort_unstable();
        let room = most.saturating_sub(found.pairs.len());
        found.count += others.len() as u64;
        found.pairs.extend(others.iter().take(room).map(|&o| [item, o].map(|i| solid[i as usize])));
        found
    };
    let joined = |mut a: SelfIntersections, b: SelfIntersections| {
        a.count += b.count;
        a.pairs.extend(b.pairs);
        a.pairs.truncate(most);
        a
    };
    (0..solid.len() as u32).into_par_iter().fold(SelfIntersections::default, of_item).reduce(Default::default, joined)
}

fn bounds(t: &Corners) -> Bounds {
    Bounds::of(&t.map(|p| DVec3::from_array(p.map(f64::from))))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid of quads with a fold planted: vertex (1, 1) at `moved`.
    fn grid(moved: [f32; 3]) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
        let mut positions: Vec<[f32; 3]> = (0..16).map(|i| [(i % 4) as f32, (i / 4) as f32, 0.0]).collect();
        positions[5] = moved;
        let quads = (0..9u32).map(|q| q / 3 * 4 + q % 3);
        (positions, quads.flat_map(|a| [[a, a + 1, a + 5], [a, a + 5, a + 4]]).collect())
    }

    #[test]
    fn a_flat_sheet_does_not_meet_itself() {
        let (positions, triangles) = grid([1.0, 1.0, 0.0]);
        assert_eq!(self_intersections(&positions, &triangles, 8), SelfIntersections::default());
        let (positions, triangles) = grid([1.0, 1.0, 3.0]);
        assert_eq!(self_intersections(&positions, &triangles, 8).count, 0);
    }

    #[test]
    fn a_vertex_moved_over_its_neighbours_folds_the_sheet() {
        let (positions, triangles) = grid([2.5, 1.2, 0.0]);
        let found = self_intersections(&positions, &triangles, 3);
        assert!(found.count > 3, "{found:?}");
        assert_eq!(found.pairs.len(), 3);
        assert!(found.pairs.is_sorted() && found.pairs.iter().all(|[a, b]| a < b));
    }

    #[test]
    fn two_crossing_triangles_are_a_pair_and_indices_are_those_of_the_list() {
        let positions =
            [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [2.0, 1.0, 1.0]];
        let found = self_intersections(&positions, &[[0, 0, 1], [0, 1, 2], [1, 1, 2], [3, 4, 5]], 9);
        assert_eq!(found, SelfIntersections { count: 1, pairs: vec![[1, 3]] });
        assert_eq!(self_intersections(&positions, &[[0, 1, 2], [3, 4, 5]], 0).count, 1);
    }
}
