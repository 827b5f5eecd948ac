//! The fine vertices of one primitive: three contiguous ranges of the surface, renumbered from 0, and where
//! each lies on the base mesh.

use std::ops::Range;

use displace_glsl::lattice::{edge_points, interior_points};

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
    let ranges = blocks(mesh, surface.level);
    let vertices = ranges[2].end;
    let triangles = mesh.triangles.len() << (2 * surface.level);
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

fn blocks(mesh: &Mesh, level: u32) -> [Range<usize>; 3] {
    let corners = mesh.av_gv.len();
    let edges = corners + mesh.ae_av.len() * edge_points(level) as usize;
    let inner = edges + mesh.triangles.len() * interior_points(level) as usize;
    [0..corners, corners..edges, edges..inner]
}

impl<'a> Fine<'a> {
    pub(super) fn new(mesh: &'a Mesh, surface: &'a Surface, index: usize) -> Self {
        let primitive = &mesh.primitives[index];
        let blocks = blocks(mesh, surface.level);
        let scaled = |range: &Range<u32>, by: u64, block: usize| {
            let place = |i: u32| blocks[block].start + i as usize * by as usize;
            place(range.start)..place(range.end)
        };
        let ranges = [
            scaled(&primitive.avs, 1, 0),
            scaled(&primitive.aes, edge_points(surface.level), 1),
            scaled(&primitive.triangles, interior_points(surface.level), 2),
        ];
        Self { mesh, surface, primitive, index, ranges }
    }

    pub(super) fn vertices(&self) -> usize {
        self.ranges.iter().map(Range::len).sum()
    }

    /// Fine triangles in the numbering of the surface.
    pub(super) fn triangles(&self) -> &'a [[u32; 3]] {
        let shift = 2 * self.surface.level;
        &self.surface.triangles
            [(self.primitive.triangles.start as usize) << shift..(self.primitive.triangles.end as usize) << shift]
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

    /// Where the vertices lie on the base mesh.
    pub(super) fn stencils(&self) -> Stencils<'_> {
        let n = 1u32 << self.surface.level;
        let mut inner = Vec::with_capacity(interior_points(self.surface.level) as usize);
        for j in 1..n {
            inner.extend((1..n - j).map(|i| [i, j]));
        }
        Stencils { fine: self, n, inner }
    }
}

/// Corner avs and barycentric weights of fine vertices.
pub(super) struct Stencils<'a> {
    fine: &'a Fine<'a>,
    n: u32,
    /// Lattice points inside a triangle, by rank.
    inner: Vec<[u32; 2]>,
}

impl Stencils<'_> {
    /// Weights are exact: multiples of 2^-level. Corners and edge points repeat an av with weight 0.
    pub(super) fn of(&self, local: usize) -> ([u32; 3], [f32; 3]) {
        let [corners, edges, _] = &self.fine.ranges;
        let part = |k: u32| k as f32 / self.n as f32;
        if local < corners.len() {
            let av = (corners.start + local) as u32;
            return ([av; 3], [1.0, 0.0, 0.0]);
        }
        let local = local - corners.len();
        if local < edges.len() {
            let per_edge = self.n as usize - 1;
            let ae = self.fine.primitive.aes.start as usize + local / per_edge;
            let [a, b] = self.fine.mesh.ae_av[ae];
            let k = (local % per_edge) as u32 + 1;
            return ([a, b, b], [part(self.n - k), part(k), 0.0]);
        }
        let local = local - edges.len();
        let triangle = self.fine.primitive.triangles.start as usize + local / self.inner.len();
        let [i, j] = self.inner[local % self.inner.len()];
        (self.fine.mesh.triangles[triangle].av, [part(self.n - i - j), part(i), part(j)])
    }
}
