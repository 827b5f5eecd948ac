//! MikkTSpace tangents of a displaced primitive. Vertices are doubled where the tangents of their triangles differ.

use std::collections::HashMap;

use super::{fine::Fine, listing::Listing};
use crate::domain::{Result, weld::mikk_tangents};

pub(super) struct Split {
    pub(super) listing: Listing,
    /// One for each vertex of the listing.
    pub(super) tangents: Vec<[f32; 4]>,
    /// Whether any vertex was doubled.
    pub(super) any: bool,
}

/// `uvs` are of the surface. The triangles are those of the surface, in its order.
pub(super) fn made(fine: &Fine<'_>, uvs: &[f32]) -> Result<Split> {
    let mut listing = Listing::of(fine);
    let surface = fine.surface;
    let of_corners = mikk_tangents(
        &listing.triangles,
        |v| surface.positions[fine.global(v as usize)],
        |v| surface.normals[fine.global(v as usize)],
        |v| [uvs[2 * fine.global(v as usize)], uvs[2 * fine.global(v as usize) + 1]],
    )?;
    let mut tangents = vec![[0.0f32; 4]; fine.vertices()];
    let mut copy_of = HashMap::new();
    for (vertex, tangent) in listing.triangles.as_flattened_mut().iter_mut().zip(of_corners) {
        let known = &mut tangents[*vertex as usize];
        if known[3] == 0.0 {
            *known = tangent;
        } else if *known != tangent {
            let next = listing.vertices.len() as u32;
            let copy = *copy_of.entry((*vertex, tangent.map(f32::to_bits))).or_insert(next);
            if copy == next {
                listing.vertices.push(*vertex);
                tangents.push(tangent);
            }
            *vertex = copy;
        }
    }
    Ok(Split { any: !copy_of.is_empty(), listing, tangents })
}
