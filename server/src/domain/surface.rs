//! The result of displacing one base mesh, in host memory.

use std::ops::Range;

use displace_glsl::lattice;

use super::{
    fit::Fit,
    mesh::{Mesh, Primitive},
};

/// Fine vertices are attribute vertices in a closed-form order: with n = 2^level segments per edge,
/// first the base avs; then, for each ae, its n − 1 inner vertices from the ae's first av to its second;
/// then, for each base triangle, its (n − 1)(n − 2) / 2 inner vertices (see `displace_glsl::lattice`).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    pub level: u32,
    /// Mesh-local units. Fine avs of one geometric vertex have bit-equal positions.
    pub positions: Vec<[f32; 3]>,
    /// Unit length.
    pub normals: Vec<[f32; 3]>,
    /// Parallel to `Mesh::attributes`: `components` values for each fine vertex.
    pub attributes: Vec<Vec<f32>>,
    /// Fine vertex ids; base triangle t owns `triangles[t << (2 * level)..(t + 1) << (2 * level)]`.
    pub triangles: Vec<[u32; 3]>,
    /// Largest disagreement of the sides of a seam before reconciling, mesh-local units.
    pub mismatch_max: f32,
    /// Triangles that face against their base triangle.
    pub flipped: u64,
    /// Where a tolerance decided.
    pub fit: Option<Fit>,
}

impl Surface {
    /// The three ranges of fine vertices of one primitive: corners, edges, interiors.
    #[must_use]
    pub fn vertices_of(&self, mesh: &Mesh, primitive: &Primitive) -> [Range<usize>; 3] {
        let edge = lattice::edge_points(self.level) as usize;
        let interior = lattice::interior_points(self.level) as usize;
        let edges = mesh.av_gv.len();
        let interiors = edges + mesh.ae_av.len() * edge;
        let scaled = |range: &Range<u32>, first: usize, each: usize| {
            first + range.start as usize * each..first + range.end as usize * each
        };
        [
            scaled(&primitive.avs, 0, 1),
            scaled(&primitive.aes, edges, edge),
            scaled(&primitive.triangles, interiors, interior),
        ]
    }
}
