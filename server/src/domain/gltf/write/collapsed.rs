//! Triangles that quantising leaves without area: two of their corners have become one place.
//!
//! Such a triangle covers a segment, once there and once back. Left out, it opens nothing: the triangles on its two
//! longer sides meet each other then. But what it covers must be covered by others, or a place of the surface would be
//! farther from the result than quantising moved it.

use std::collections::HashSet;

use rayon::prelude::*;

use super::primitive::Part;
use crate::domain::grid::Grid;

type Place = [u16; 3];
/// From the lower place to the higher; twice the same where nothing but a place is left.
type Segment = [Place; 2];

/// Takes them out of the parts of one mesh, as far as others cover their segments. A part keeps all where it has no
/// others.
pub(super) fn remove(parts: &mut [Part<'_>], grid: &Grid) {
    let collapsed: Vec<Vec<Option<Segment>>> = parts.par_iter().map(|part| segments(part, grid)).collect();
    let wanted: HashSet<Segment> = collapsed.par_iter().flatten().copied().flatten().collect();
    if wanted.is_empty() {
        return;
    }
    let covered: HashSet<Segment> =
        parts.par_iter().zip(&collapsed).flat_map(|(part, known)| covered(part, grid, known, &wanted)).collect();
    for (part, known) in parts.iter_mut().zip(collapsed) {
        let goes: Vec<bool> = known.into_iter().map(|segment| segment.is_some_and(|s| covered.contains(&s))).collect();
        if goes.contains(&true) && goes.contains(&false) {
            part.leave_out(&goes);
        }
    }
}

/// What each triangle has become, if that is no triangle.
fn segments(part: &Part<'_>, grid: &Grid) -> Vec<Option<Segment>> {
    let of = |triangle: usize| {
        let mut corners = part.corners(triangle).map(|p| grid.place(p));
        corners.sort_unstable();
        let [low, middle, high] = corners;
        (low == middle || middle == high).then_some([low, high])
    };
    (0..part.triangles()).into_par_iter().map(of).collect()
}

/// Those of `wanted` that triangles with an area have for a side, or a corner.
fn covered(part: &Part<'_>, grid: &Grid, known: &[Option<Segment>], wanted: &HashSet<Segment>) -> HashSet<Segment> {
    let of = |triangle: usize| {
        let [a, b, c] = part.corners(triangle).map(|p| grid.place(p));
        let sides = [[a, b], [b, c], [c, a]].map(|[p, q]| [p.min(q), p.max(q)]);
        sides.into_iter().chain([[a, a], [b, b], [c, c]])
    };
    let whole = (0..part.triangles()).into_par_iter().filter(|&triangle| known[triangle].is_none());
    whole.flat_map_iter(of).filter(|segment| wanted.contains(segment)).collect()
}
