//! The vertices and triangles of one primitive in the order of the file.

use ::meshopt::optimize_vertex_cache;
use rayon::prelude::*;

use super::fine::Fine;

/// What differs from the order of the surface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Listing {
    /// The fine vertex, numbered within the primitive, whose values each vertex of the file has.
    pub(super) vertices: Vec<u32>,
    /// Of vertices of the file.
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Listing {
    /// As the surface has them.
    pub(super) fn of(fine: &Fine<'_>) -> Self {
        Self {
            vertices: (0..fine.vertices() as u32).collect(),
            triangles: fine.triangles().par_iter().map(|t| t.map(|v| fine.local(v))).collect(),
        }
    }

    /// Orders triangles so that those near each other share vertices that are still in a cache, and vertices by their
    /// first use; those of no triangle are left out. Tells the number that each vertex had.
    pub(super) fn optimize(&mut self) -> Vec<u32> {
        let indices = optimize_vertex_cache(self.triangles.as_flattened(), self.vertices.len());
        self.triangles = indices.as_chunks().0.to_vec();
        let former = by_first_use(&mut self.triangles, self.vertices.len());
        self.vertices = former.iter().map(|&vertex| self.vertices[vertex as usize]).collect();
        former
    }
}

/// Renumbers vertices in the order in which triangles name them; the former number of each.
fn by_first_use(triangles: &mut [[u32; 3]], vertices: usize) -> Vec<u32> {
    const UNUSED: u32 = u32::MAX;
    let mut new = vec![UNUSED; vertices];
    let mut former = Vec::new();
    for vertex in triangles.as_flattened_mut() {
        let number = &mut new[*vertex as usize];
        if *number == UNUSED {
            *number = former.len() as u32;
            former.push(*vertex);
        }
        *vertex = *number;
    }
    former
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of `count` triangles in an order that jumps about, with a vertex that none names.
    fn scattered(count: u32) -> Listing {
        let vertices = (100..100 + count + 3).collect();
        let triangles = (0..count).map(|i| i * 7 % count).map(|i| [i, i + 1, i + 2]).collect();
        Listing { vertices, triangles }
    }

    /// Triangles as the fine vertices that they join, each from its least on.
    fn joined(listing: &Listing) -> Vec<[u32; 3]> {
        let mut all: Vec<[u32; 3]> =
            listing.triangles.iter().map(|t| from_least(t.map(|v| listing.vertices[v as usize]))).collect();
        all.sort_unstable();
        all
    }

    fn from_least(mut triangle: [u32; 3]) -> [u32; 3] {
        let least = (0..3).min_by_key(|&k| triangle[k]).unwrap_or(0);
        triangle.rotate_left(least);
        triangle
    }

    #[test]
    fn optimizing_keeps_the_triangles_and_leaves_out_what_none_names() {
        let mut listing = scattered(50);
        let before = listing.clone();
        let former = listing.optimize();
        assert_eq!(joined(&listing), joined(&before));
        assert_eq!(listing.vertices.len(), 52);
        assert!(former.iter().zip(&listing.vertices).all(|(f, v)| before.vertices[*f as usize] == *v));
    }

    #[test]
    fn vertices_come_in_the_order_of_their_use() {
        let mut listing = scattered(50);
        let _ = listing.optimize();
        let mut seen = 0;
        for &vertex in listing.triangles.as_flattened() {
            assert!(vertex <= seen, "{vertex} before {seen}");
            seen = seen.max(vertex + 1);
        }
    }
}
