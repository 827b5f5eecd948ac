//! The surface whose triangles span several base triangles.

use std::{collections::HashMap, sync::Arc};

use rayon::prelude::*;

use super::patch::from_least;
use crate::domain::{
    mesh::Mesh,
    surface::{Layout, Pieces, Surface},
};

/// `surface` with `triangles` of its vertices instead of its own; vertices stay as they are, also those that no
/// triangle has any more. A triangle belongs to the base triangle that had it, or to one that has its lowest corner.
pub(super) fn surface(mesh: &Mesh, surface: &Surface, triangles: Vec<[u32; 3]>) -> Surface {
    let Layout::Pieces(pieces) = &surface.layout else { return surface.clone() };
    let owners = Owners::of(mesh, surface);
    let mut owned: Vec<(u32, [u32; 3])> = triangles.into_iter().map(|t| owners.owned(t)).collect();
    owned.par_sort_unstable();
    let mut triangle_first = vec![0u32; mesh.triangles.len() + 1];
    owned.iter().for_each(|(base, _)| triangle_first[*base as usize + 1] += 1);
    for base in 1..triangle_first.len() {
        triangle_first[base] += triangle_first[base - 1];
    }
    let layout = Layout::Pieces(Arc::new(Pieces { triangle_first, is_spanning: true, ..Pieces::clone(pieces) }));
    let triangles = owned.into_iter().map(|(_, triangle)| triangle).collect();
    let simpler = Surface { layout, triangles, ..surface.clone() };
    let flipped = simpler.triangles.par_iter().filter(|ids| simpler.faces_back(mesh, **ids)).count() as u64;
    Surface { flipped, ..simpler }
}

struct Owners {
    of_triangle: HashMap<[u32; 3], u32>,
    /// A base triangle of each fine vertex that has any.
    of_vertex: Vec<u32>,
}

impl Owners {
    fn of(mesh: &Mesh, surface: &Surface) -> Self {
        let mut owners = Self { of_triangle: HashMap::new(), of_vertex: vec![0; surface.positions.len()] };
        for base in (0..mesh.triangles.len()).rev() {
            for ids in &surface.triangles[surface.triangles_of(base)] {
                owners.of_triangle.insert(from_least(*ids), base as u32);
                ids.iter().for_each(|v| owners.of_vertex[*v as usize] = base as u32);
            }
        }
        owners
    }

    /// With its owner, and from its lowest corner on.
    fn owned(&self, triangle: [u32; 3]) -> (u32, [u32; 3]) {
        let triangle = from_least(triangle);
        let owner = self.of_triangle.get(&triangle).copied();
        (owner.unwrap_or(self.of_vertex[triangle[0] as usize]), triangle)
    }
}
