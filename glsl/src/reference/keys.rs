//! Numbers of places that follow from where they are, not from the order of a file: what is alike otherwise is told apart
//! by them, so that the same mesh in another order gives the same result. Twin of `keys.glsl`.

use super::refine::{Base, barycentrics};
use crate::layout::refine::{RefineBase, RefinedVertex, UNIT, kind};

/// Spread over all bits (the finish of Appleby's MurmurHash3).
#[must_use]
pub fn mixed(x: u32) -> u32 {
    let x = (x ^ x >> 16).wrapping_mul(0x85EB_CA6B);
    let x = (x ^ x >> 13).wrapping_mul(0xC2B2_AE35);
    x ^ x >> 16
}

/// Of a base gv.
#[must_use]
pub fn corner(position: [f32; 3]) -> u32 {
    position.iter().fold(1, |key, x| mixed(key.wrapping_mul(3) ^ x.to_bits()))
}

/// Of a base ge between corners with these keys.
#[must_use]
pub fn edge(corners: [u32; 2]) -> u32 {
    mixed(corners[0].wrapping_add(corners[1]))
}

/// Of edges that come of splitting: the halves of a side, the one from its middle to the corner across, and the one
/// from the middle of another side to that middle. Those of one key never meet in a triangle.
pub mod step {
    pub const HALF: u32 = 1;
    pub const ACROSS: u32 = 2;
    pub const BETWEEN: u32 = 3;
}

/// Of an edge that comes of splitting a side with this key.
#[must_use]
pub fn next(side: u32, step: u32) -> u32 {
    mixed(side.wrapping_add(step))
}

/// Of a vertex in a base triangle that has it; `corners` are the keys of all gvs.
#[must_use]
fn vertex(vertex: &RefinedVertex, base: &RefineBase, corners: &[u32]) -> u32 {
    let shares = barycentrics(vertex, base).into_iter().zip(base.gv).filter(|(units, _)| *units > 0);
    mixed(shares.fold(0, |sum, (units, gv)| sum.wrapping_add(mixed(corners[gv as usize] ^ mixed(units)))))
}

/// Of any vertex.
#[must_use]
pub fn of(refined: &RefinedVertex, base: &Base) -> u32 {
    let triangle = match refined.kind {
        kind::CORNER => return mixed(mixed(base.keys[refined.owner as usize] ^ mixed(UNIT))),
        kind::EDGE => base.edge_side[refined.owner as usize][0],
        _ => refined.owner,
    };
    vertex(refined, &base.triangles[triangle as usize], &base.keys)
}
