//! Geometric vertices: equal position bits are one place, numbered by the rank of their bits.

use rayon::prelude::*;

use super::{PrimitiveInput, canonical_bits};

/// The distinct positions of a mesh and which of them each vertex of each primitive has.
pub(super) struct Places {
    pub(super) positions: Vec<[f32; 3]>,
    pub(super) gv_of_vertex: Vec<Vec<u32>>,
}

pub(super) fn rank(primitives: &[PrimitiveInput]) -> Places {
    let mut keys: Vec<u128> = Vec::with_capacity(primitives.iter().map(|p| p.positions.len()).sum());
    for position in primitives.iter().flat_map(|p| &p.positions) {
        keys.push(key(*position, keys.len() as u32));
    }
    keys.par_sort_unstable();
    let mut gv_of_all = vec![0u32; keys.len()];
    let mut positions: Vec<[f32; 3]> = Vec::new();
    let mut previous = None;
    for key in keys {
        let place = key >> 32;
        if previous != Some(place) {
            positions.push([place >> 64, place >> 32, place].map(|bits| f32::from_bits(bits as u32)));
            previous = Some(place);
        }
        gv_of_all[key as u32 as usize] = positions.len() as u32 - 1;
    }
    Places { positions, gv_of_vertex: split(gv_of_all, primitives) }
}

/// Position bits in front, the vertex behind: sorting ranks places and remembers who has them.
fn key(position: [f32; 3], vertex: u32) -> u128 {
    position.iter().fold(0u128, |key, &c| key << 32 | u128::from(canonical_bits(c))) << 32 | u128::from(vertex)
}

fn split(gv_of_all: Vec<u32>, primitives: &[PrimitiveInput]) -> Vec<Vec<u32>> {
    let mut rest = gv_of_all.as_slice();
    let mut parts = Vec::with_capacity(primitives.len());
    for primitive in primitives {
        let (part, tail) = rest.split_at(primitive.positions.len());
        parts.push(part.to_vec());
        rest = tail;
    }
    parts
}

impl Places {
    /// Forgets places that no triangle has; the others keep their order.
    pub(super) fn drop_unused(&mut self, triangles: &[Vec<[u32; 3]>]) {
        let mut used = vec![false; self.positions.len()];
        for (gv, triangles) in self.gv_of_vertex.iter().zip(triangles) {
            for &vertex in triangles.iter().flatten() {
                used[gv[vertex as usize] as usize] = true;
            }
        }
        let mut new_gv = vec![0; used.len()];
        let mut kept = 0;
        for (old, _) in used.iter().enumerate().filter(|(_, used)| **used) {
            new_gv[old] = kept as u32;
            self.positions[kept] = self.positions[old];
            kept += 1;
        }
        self.positions.truncate(kept);
        for gv in self.gv_of_vertex.iter_mut().flatten() {
            *gv = new_gv[*gv as usize];
        }
    }
}
