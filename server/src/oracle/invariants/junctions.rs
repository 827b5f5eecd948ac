//! That no vertex lies within another triangle's side.

use glam::DVec3;

use super::Broken;
use crate::oracle::{
    bvh::{Bounds, Bvh},
    topology::Topology,
};

/// Vertices of the boundary that lie within a boundary edge they are not an end of: T-junctions, which open under
/// any displacement. Where there is no boundary there can be none. A vertex lies on an edge when it is no farther
/// from it than the rounding of its own coordinates to f32.
#[must_use]
pub fn t_junctions(positions: &[[f32; 3]], topology: &Topology) -> Option<Broken> {
    let at =
        |place: u32| DVec3::from_array(positions[topology.vertex_of_place[place as usize] as usize].map(f64::from));
    let edges: Vec<[u32; 2]> = topology.boundary().map(|edge| edge.places).collect();
    let slack = |p: DVec3| f64::from(f32::EPSILON) * p.abs().max_element();
    let boxed = |edge: &[u32; 2]| {
        let ends = edge.map(at);
        Bounds::of(&ends).inflated(slack(ends[0]).max(slack(ends[1])))
    };
    let bvh = Bvh::build(&edges.iter().map(boxed).collect::<Vec<_>>());
    let mut vertices: Vec<u32> = edges.as_flattened().to_vec();
    vertices.sort_unstable();
    vertices.dedup();
    let offences = vertices.into_iter().filter_map(|vertex| {
        let p = at(vertex);
        let mut on = None;
        bvh.touching(Bounds::of(&[p]), |edge| {
            let ends = edges[edge as usize];
            if !ends.contains(&vertex) && lies_within(p, ends.map(at), slack(p)) {
                on = on.or(Some(ends));
            }
        });
        on.map(|ends| (vertex, ends))
    });
    Broken::of("t_junctions", offences, |(vertex, ends)| {
        let [p, q, r] = [vertex, ends[0], ends[1]].map(at);
        format!("{p} on the edge from {q} to {r}")
    })
}

/// Nearer to the segment than `slack`, and farther from its ends.
fn lies_within(p: DVec3, [a, b]: [DVec3; 2], slack: f64) -> bool {
    let along = (p - a).dot(b - a) / (b - a).length_squared();
    let nearest = a + along * (b - a);
    (0.0..=1.0).contains(&along) && p.distance(nearest) <= slack && p.distance(a).min(p.distance(b)) > slack
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two quads side by side; the right one's left side is split at `middle`.
    fn split_beside(middle: [f32; 3]) -> Option<Broken> {
        let positions = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
            [2.0, 0.0, 0.0],
            [2.0, 1.0, 0.0],
            middle,
        ];
        let triangles = [[0, 1, 2], [0, 2, 3], [1, 4, 6], [4, 5, 6], [6, 5, 2]];
        t_junctions(&positions, &Topology::new(&positions, &triangles))
    }

    #[test]
    fn a_planted_t_junction_is_found_and_a_gap_is_none() {
        let broken = split_beside([1.0, 0.375, 0.0]).expect("it is planted");
        assert_eq!((broken.rule, broken.count), ("t_junctions", 1));
        assert!(broken.first.contains("0.375"), "{broken}");
        assert!(split_beside([1.0, 0.375, 1e-8]).is_some());
        assert_eq!(split_beside([1.0, 0.375, 1e-5]), None);
    }

    #[test]
    fn a_sheet_that_fits_has_none() {
        let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(t_junctions(&positions, &Topology::new(&positions, &[[0, 1, 2], [0, 2, 3]])), None);
    }
}
