//! Numbers of vertices and triangles by where they lie: rounds of splitting leave neighbours far apart in memory.

use rayon::prelude::*;

use super::Simplified;
use crate::layout::refine::{RefinedVertex, kind};

/// Renumbers vertices along a curve of each base triangle (Morton 1966), and sorts triangles by their lowest vertex.
pub(super) fn sort(mesh: &mut Simplified) {
    let mut order: Vec<((u32, u32, u64), u32)> = mesh.vertices.iter().map(place).zip(0..).collect();
    order.par_sort_unstable();
    let mut number = vec![0; order.len()];
    order.iter().zip(0..).for_each(|((_, old), new)| number[*old as usize] = new);
    mesh.vertices = order.iter().map(|(_, old)| mesh.vertices[*old as usize]).collect();
    mesh.positions = order.iter().map(|(_, old)| mesh.positions[*old as usize]).collect();
    mesh.triangles.iter_mut().for_each(|facet| facet.gv = facet.gv.map(|gv| number[gv as usize]));
    mesh.triangles.par_sort_unstable_by_key(|facet| (facet.base, facet.gv.into_iter().max(), facet.gv));
}

/// Corners first, as they were; then edges, and insides.
fn place(vertex: &RefinedVertex) -> (u32, u32, u64) {
    let [b, c] = vertex.param;
    match vertex.kind {
        kind::INTERIOR => (vertex.kind, vertex.owner, spread(b) << 1 | spread(c)),
        _ => (vertex.kind, vertex.owner, u64::from(b)),
    }
}

/// Bits with a zero between each two.
fn spread(x: u32) -> u64 {
    let masks = [(16, 0x0000_FFFF_0000_FFFF), (8, 0x00FF_00FF_00FF_00FF), (4, 0x0F0F_0F0F_0F0F_0F0F)];
    let masks = masks.into_iter().chain([(2, 0x3333_3333_3333_3333), (1, 0x5555_5555_5555_5555)]);
    masks.fold(u64::from(x), |x, (by, mask)| (x | x << by) & mask)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_spread_with_zeros_between() {
        assert_eq!(spread(0b1011), 0b100_0101);
        assert_eq!(spread(u32::MAX), 0x5555_5555_5555_5555);
    }
}
