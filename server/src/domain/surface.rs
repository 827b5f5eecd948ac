//! The result of displacing one base mesh, in host memory.
//!
//! | file | holds |
//! |---|---|
//! | `layout.rs` | how fine vertices and triangles are numbered |
//! | `pieces.rs` | the numbering of a mesh that is finer where it needs to be |
//! | `arrangement.rs` | from a refined mesh to that numbering |
//! | `common.rs` | two of them cut by one another, and what is between them |

mod arrangement;
mod common;
mod layout;
mod pieces;

use std::ops::Range;

use glam::DVec3;

pub use arrangement::Arrangement;
pub use common::Common;
pub use layout::{Layout, Place};
pub use pieces::{Pieces, Shape};

use super::{
    fit::Fit,
    mesh::{Mesh, Primitive, Triangle},
};

/// Fine vertices are attribute vertices, numbered as `layout` says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    pub layout: Layout,
    /// Mesh-local units. Fine avs of one geometric vertex have bit-equal positions.
    pub positions: Vec<[f32; 3]>,
    /// Unit length.
    pub normals: Vec<[f32; 3]>,
    /// Parallel to `Mesh::attributes`: `components` values for each fine vertex.
    pub attributes: Vec<Vec<f32>>,
    /// Fine vertex ids, sorted by base triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Largest disagreement of the sides of a seam before reconciling, mesh-local units.
    pub mismatch_max: f32,
    /// Triangles that face against their base triangle; where they span several, against those at each corner.
    pub flipped: u64,
    /// Where a tolerance decided.
    pub fit: Option<Fit>,
}

impl Surface {
    /// The three ranges of fine vertices of one primitive: corners, edges, interiors.
    #[must_use]
    pub fn vertices_of(&self, mesh: &Mesh, primitive: &Primitive) -> [Range<usize>; 3] {
        self.layout.vertices_of(mesh, primitive)
    }

    /// Inner vertices of an ae, from its first av to its second.
    #[must_use]
    pub fn edge_vertices(&self, mesh: &Mesh, ae: u32) -> Range<usize> {
        self.layout.edge_vertices(mesh, ae)
    }

    /// Entries of `triangles` that a base triangle owns.
    #[must_use]
    pub fn triangles_of(&self, base_triangle: usize) -> Range<usize> {
        self.layout.triangles_of(base_triangle)
    }

    /// Three base avs and the weights of a fine vertex among them: exact, and of sum 1.
    #[must_use]
    pub fn site(&self, mesh: &Mesh, vertex: usize) -> ([u32; 3], [f64; 3]) {
        self.layout.place(mesh, vertex).site(mesh)
    }

    /// Where a fine vertex is on the flat base, mesh-local units.
    #[must_use]
    pub fn base_place(&self, mesh: &Mesh, vertex: usize) -> DVec3 {
        let (avs, weights) = self.site(mesh, vertex);
        let place = |av: u32| DVec3::from_array(mesh.gv_position[mesh.av_gv[av as usize] as usize].map(f64::from));
        avs.into_iter().zip(weights).map(|(av, weight)| weight * place(av)).sum()
    }

    /// Where the base triangles face that a fine vertex is of: the sum of their unit normals.
    #[must_use]
    pub fn base_facing(&self, mesh: &Mesh, vertex: usize) -> DVec3 {
        let of = |items: &[u32], is_own: &dyn Fn(&Triangle) -> bool| -> DVec3 {
            let triangles = items.iter().map(|item| &mesh.triangles[*item as usize / 3]);
            triangles.filter(|triangle| is_own(triangle)).map(|triangle| facing(mesh, triangle)).sum()
        };
        match self.layout.place(mesh, vertex) {
            Place::Corner { av } => of(mesh.gv_corner.list(mesh.av_gv[av as usize] as usize), &|t| t.av.contains(&av)),
            Place::Edge { ae, .. } => of(mesh.ge_side.list(mesh.ae_ge[ae as usize] as usize), &|t| t.ae.contains(&ae)),
            Place::Inside { triangle, .. } => facing(mesh, &mesh.triangles[triangle as usize]),
        }
    }

    /// Whether a triangle faces against the base triangles at each of its corners.
    #[must_use]
    pub fn faces_back(&self, mesh: &Mesh, ids: [u32; 3]) -> bool {
        let [a, b, c] = ids.map(|v| DVec3::from_array(self.positions[v as usize].map(f64::from)));
        let normal = (b - a).cross(c - a);
        ids.iter().all(|v| normal.dot(self.base_facing(mesh, *v as usize)) < 0.0)
    }

    /// Fine vertices that triangles have: all of them, but where triangles span several base triangles.
    #[must_use]
    pub fn vertices_used(&self) -> u64 {
        if !self.layout.is_spanning() {
            return self.positions.len() as u64;
        }
        let mut used = vec![false; self.positions.len()];
        self.triangles.as_flattened().iter().for_each(|v| used[*v as usize] = true);
        used.into_iter().filter(|used| *used).count() as u64
    }
}

fn facing(mesh: &Mesh, triangle: &Triangle) -> DVec3 {
    let place = |av: u32| DVec3::from_array(mesh.gv_position[mesh.av_gv[av as usize] as usize].map(f64::from));
    let [a, b, c] = triangle.av.map(place);
    (b - a).cross(c - a).normalize_or_zero()
}
