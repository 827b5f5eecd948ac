//! The fine vertices of one primitive: three contiguous ranges of the surface, renumbered from 0, and where
//! each lies on the base mesh.

use std::ops::Range;

use crate::domain::{
    Error, Result,
    mesh::{Mesh, Primitive},
    surface::Surface,
};

#[derive(Clone)]
pub(super) struct Fine<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) surface: &'a Surface,
    pub(super) primitive: &'a Primitive,
    /// Index of the primitive in `mesh`.
    pub(super) index: usize,
    /// Corners, edge points and inner points in the numbering of the surface.
    pub(super) ranges: [Range<usize>; 3],
}

/// Fails when the surface is not one of the mesh: a fault of ours.
pub(super) fn check(mesh: &Mesh, surface: &Surface) -> Result<()> {
    if let Some(fault) = surface.layout.fault(mesh) {
        return Err(Error::internal(format!("the surface of mesh '{}': {fault}", mesh.name)));
    }
    let (vertices, triangles) = (surface.layout.vertices(mesh), surface.layout.triangles(mesh));
    let blended = |i: usize| is_skin(&mesh.attributes[i].semantic);
    let right = surface.positions.len() == vertices
        && surface.normals.len() == vertices
        && surface.triangles.len() == triangles
        && surface.attributes.len() == mesh.attributes.len()
        && (0..mesh.attributes.len())
            .all(|i| blended(i) || surface.attributes[i].len() == vertices * mesh.attributes[i].components);
    if right {
        return Ok(());
    }
    let message =
        format!("the surface of mesh '{}' does not have {vertices} vertices and {triangles} triangles", mesh.name);
    Err(Error::internal(message))
}

/// Joints and weights are blended here, from the base mesh; their streams may be empty.
pub(super) fn is_skin(semantic: &str) -> bool {
    semantic.starts_with("JOINTS_") || semantic.starts_with("WEIGHTS_")
}

impl<'a> Fine<'a> {
    pub(super) fn new(mesh: &'a Mesh, surface: &'a Surface, index: usize) -> Self {
        let primitive = &mesh.primitives[index];
        let ranges = surface.vertices_of(mesh, primitive);
        Self { mesh, surface, primitive, index, ranges }
    }

    pub(super) fn vertices(&self) -> usize {
        self.ranges.iter().map(Range::len).sum()
    }

    /// Fine triangles in the numbering of the surface.
    pub(super) fn triangles(&self) -> &'a [[u32; 3]] {
        &self.surface.triangles[self.surface.layout.triangles_of_primitive(self.primitive)]
    }

    /// The number of a vertex of the surface within this primitive.
    pub(super) fn local(&self, vertex: u32) -> u32 {
        let vertex = vertex as usize;
        let [corners, edges, inner] = &self.ranges;
        let local = if vertex < corners.end {
            vertex - corners.start
        } else if vertex < edges.end {
            vertex - edges.start + corners.len()
        } else {
            vertex - inner.start + corners.len() + edges.len()
        };
        local as u32
    }

    /// The number in the surface of a vertex of this primitive.
    pub(super) fn global(&self, local: usize) -> usize {
        let [corners, edges, inner] = &self.ranges;
        if local < corners.len() {
            corners.start + local
        } else if local < corners.len() + edges.len() {
            edges.start + local - corners.len()
        } else {
            inner.start + local - corners.len() - edges.len()
        }
    }

    /// Copies the primitive's elements of a stream of the surface, `size` values each.
    pub(super) fn gather<T: Copy>(&self, stream: &[T], size: usize, out: &mut [T]) {
        let mut rest = out;
        for range in &self.ranges {
            let (part, tail) = rest.split_at_mut(range.len() * size);
            part.copy_from_slice(&stream[range.start * size..range.end * size]);
            rest = tail;
        }
    }

    /// Three base avs and the weights of a vertex of this primitive among them: exact, with 0 where an av is repeated.
    pub(super) fn site(&self, local: usize) -> ([u32; 3], [f32; 3]) {
        let (avs, weights) = self.surface.site(self.mesh, self.global(local));
        (avs, weights.map(|weight| weight as f32))
    }
}
