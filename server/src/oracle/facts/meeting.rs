//! Whether two triangles meet where they should not. Exact.

use crate::oracle::predicates::{orient_2d, orient_3d};

pub(super) type Corners = [[f32; 3]; 3];

/// No area, exactly.
pub(super) fn is_degenerate(t: &Corners) -> bool {
    (0..3).all(|axis| turn(t, axis) == 0)
}

/// Do the closed triangles have a point in common besides the corner or the edge that they share by position?
/// Triangles with three common corners do. Both have area.
pub(super) fn meet(t: &Corners, u: &Corners) -> bool {
    let shared_t = t.map(|p| u.contains(&p));
    let shared_u = u.map(|p| t.contains(&p));
    match shared_t.iter().filter(|shared| **shared).count() {
        0 => !apart(t, u) && !apart(u, t) && (edges(t).any(|e| crosses(e, u)) || edges(u).any(|e| crosses(e, t))),
        1 => {
            let (t, u) = (shared_first(t, shared_t), shared_first(u, shared_u));
            // What begins at the common corner and goes on leaves one of the two by the opposite side, within the other.
            !leaves(&t, &u) && !leaves(&u, &t) && (crosses([t[1], t[2]], &u) || crosses([u[1], u[2]], &t))
        }
        2 => folded(t, u, shared_t, shared_u),
        _ => true,
    }
}

/// All of `u` on one side of the plane of `t`.
fn apart(t: &Corners, u: &Corners) -> bool {
    let sides = u.map(|p| orient_3d(t[0], t[1], t[2], p));
    sides == [1; 3] || sides == [-1; 3]
}

/// All of `u` but its first corner on one side of the plane of `t`.
fn leaves(t: &Corners, u: &Corners) -> bool {
    let sides = [u[1], u[2]].map(|p| orient_3d(t[0], t[1], t[2], p));
    sides == [1; 2] || sides == [-1; 2]
}

fn shared_first(t: &Corners, shared: [bool; 3]) -> Corners {
    let first = shared.iter().position(|shared| *shared).unwrap_or(0);
    [t[first], t[(first + 1) % 3], t[(first + 2) % 3]]
}

fn edges(t: &Corners) -> impl Iterator<Item = [[f32; 3]; 2]> {
    [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]].into_iter()
}

/// On one plane and on the same side of the common edge.
fn folded(t: &Corners, u: &Corners, shared_t: [bool; 3], shared_u: [bool; 3]) -> bool {
    let apex = |t: &Corners, shared: [bool; 3]| t[shared.iter().position(|shared| !shared).unwrap_or(0)];
    let (c, d) = (apex(t, shared_t), apex(u, shared_u));
    if orient_3d(t[0], t[1], t[2], d) != 0 {
        return false;
    }
    let laid_over = t.map(|p| if p == c { d } else { p });
    let axis = seen_along(t);
    turn(t, axis) == turn(&laid_over, axis)
}

/// Do the closed segment and the closed triangle meet?
fn crosses([p, q]: [[f32; 3]; 2], t: &Corners) -> bool {
    let sides = [p, q].map(|end| orient_3d(t[0], t[1], t[2], end));
    if sides == [0, 0] {
        return crosses_flat([p, q], t);
    }
    let turns = [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]].map(|[a, b]| orient_3d(p, q, a, b));
    sides[0] != sides[1] && !(turns.contains(&1) && turns.contains(&-1))
}

/// The same on one plane, seen along an axis that is not in it.
fn crosses_flat(segment: [[f32; 3]; 2], t: &Corners) -> bool {
    let axis = seen_along(t);
    let (segment, t) = (segment.map(|p| flat(p, axis)), t.map(|p| flat(p, axis)));
    let inside = |p: [f32; 2]| {
        let turns = [0, 1, 2].map(|k| orient_2d(t[k], t[(k + 1) % 3], p));
        !(turns.contains(&1) && turns.contains(&-1))
    };
    segment.into_iter().any(inside) || (0..3).any(|k| cross_flat(segment, [t[k], t[(k + 1) % 3]]))
}

/// Do two closed segments meet that have no end within the other's triangle?
fn cross_flat([p, q]: [[f32; 2]; 2], [a, b]: [[f32; 2]; 2]) -> bool {
    let parted = |p, q, a, b| orient_2d(p, q, a) * orient_2d(p, q, b) <= 0;
    let on_a_line = orient_2d(p, q, a) == 0 && orient_2d(p, q, b) == 0;
    !on_a_line && parted(p, q, a, b) && parted(a, b, p, q)
}

/// An axis along which a triangle with area shows it.
fn seen_along(t: &Corners) -> usize {
    (0..3).find(|&axis| turn(t, axis) != 0).unwrap_or(0)
}

fn turn(t: &Corners, axis: usize) -> i8 {
    orient_2d(flat(t[0], axis), flat(t[1], axis), flat(t[2], axis))
}

fn flat(p: [f32; 3], axis: usize) -> [f32; 2] {
    [p[(axis + 1) % 3], p[(axis + 2) % 3]]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const FLOOR: Corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

    /// Both ways round and from every corner, `u` meets `FLOOR` or not.
    fn agreed(u: Corners) -> bool {
        let expected = meet(&FLOOR, &u);
        for k in 0..3 {
            let turned = [u[k], u[(k + 1) % 3], u[(k + 2) % 3]];
            let back = [turned[2], turned[1], turned[0]];
            let all = [meet(&FLOOR, &turned), meet(&turned, &FLOOR), meet(&FLOOR, &back), meet(&back, &FLOOR)];
            assert_eq!(all, [expected; 4], "{u:?}");
        }
        expected
    }

    #[test]
    fn triangles_without_a_common_corner_meet_where_they_touch() {
        assert!(agreed([[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [2.0, 1.0, 1.0]]), "through the middle");
        assert!(agreed([[1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [2.0, 1.0, 1.0]]), "a corner on the floor");
        assert!(agreed([[1.0, 1.0, 0.0], [2.0, 1.0, 0.0], [1.0, 2.0, 0.0]]), "lying on it");
        assert!(agreed([[-9.0, -9.0, 0.0], [20.0, -9.0, 0.0], [-9.0, 20.0, 0.0]]), "lying around it");
        assert!(agreed([[2.0, -1.0, 0.0], [2.0, 5.0, 0.0], [3.0, 5.0, 0.0]]), "lying across it");
        assert!(!agreed([[1.0, 1.0, 0.0f32.next_up()], [1.0, 1.0, 1.0], [2.0, 1.0, 1.0]]), "just above it");
        assert!(
            !agreed([[2.0, 2.0f32.next_up(), -1.0], [2.0, 2.0f32.next_up(), 1.0], [3.0, 3.0, 0.0]]),
            "just beside it"
        );
        assert!(!agreed([[3.0, 3.0, 0.0], [4.0, 3.0, 0.0], [3.0, 4.0, 0.0]]), "beside it on its plane");
        assert!(!agreed([[-1.0, 0.0, 0.0], [-2.0, 0.0, 0.0], [-1.0, 1.0, 0.0]]), "in line with a side");
    }

    #[test]
    fn neighbours_across_an_edge_meet_only_folded_flat() {
        assert!(!agreed([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, -4.0, 0.0]]));
        assert!(!agreed([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 1.0, 1e-30]]));
        assert!(agreed([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [9.0, 1.0, 0.0]]));
        assert!(agreed(FLOOR), "the same triangle again");
    }

    #[test]
    fn neighbours_at_a_corner_meet_when_they_go_on_together() {
        assert!(!agreed([[0.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]));
        assert!(!agreed([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [2.0, 1.0, 1.0]]));
        assert!(agreed([[0.0, 0.0, 0.0], [1.0, 2.0, 1.0], [2.0, 1.0, -1.0]]), "its far side pierces the floor");
        assert!(agreed([[0.0, 0.0, 0.0], [9.0, 9.0, 1.0], [9.0, 9.0, -1.0]]), "it cuts the floor in two");
        assert!(agreed([[0.0, 0.0, 0.0], [9.0, 9.0, 0.0], [9.0, 10.0, 0.0]]), "it lies on the floor");
        assert!(!agreed([[0.0, 0.0, 0.0], [-9.0, -9.0, 1.0], [-9.0, -9.0, -1.0]]), "it leads away");
    }

    #[test]
    fn area_is_missed_exactly() {
        assert!(is_degenerate(&[[0.0; 3], [1.0, 1.0, 1.0], [3.0, 3.0, 3.0]]));
        assert!(!is_degenerate(&[[0.0; 3], [1.0, 1.0, 1.0], [3.0, 3.0, 3.0f32.next_up()]]));
    }

    /// Points of two triangles at which both are, on a lattice fine enough for small whole corners, by arithmetic
    /// on sampled barycentrics.
    fn closest_samples(t: &Corners, u: &Corners) -> f64 {
        let samples = |t: &Corners| {
            let t = t.map(|p| glam::DVec3::from(p.map(f64::from)));
            let n = 24;
            (0..=n).flat_map(move |i| (0..=n - i).map(move |j| (i, j))).map(move |(i, j)| {
                let (x, y) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
                t[0] * (1.0 - x - y) + t[1] * x + t[2] * y
            })
        };
        let of_u: Vec<glam::DVec3> = samples(u).collect();
        samples(t)
            .flat_map(|p| of_u.iter().map(move |q| p.distance_squared(*q)).collect::<Vec<_>>())
            .fold(f64::INFINITY, f64::min)
    }

    fn corner() -> impl Strategy<Value = [f32; 3]> {
        prop::array::uniform3(-3i8..4).prop_map(|p| p.map(f32::from))
    }

    proptest! {
        #[test]
        fn triangles_that_meet_have_near_points_and_the_rest_do_not_touch(
            t in prop::array::uniform3(corner()),
            u in prop::array::uniform3(corner()),
        ) {
            prop_assume!(!is_degenerate(&t) && !is_degenerate(&u));
            let shares = t.iter().any(|p| u.contains(p));
            let distance = closest_samples(&t, &u).sqrt();
            prop_assert_eq!(meet(&t, &u), meet(&u, &t));
            // Samples are at most 0.36 from any point of a triangle this small.
            prop_assert!(!meet(&t, &u) || distance < 0.72, "{}", distance);
            prop_assert!(shares || meet(&t, &u) || distance > 0.0);
        }
    }
}
