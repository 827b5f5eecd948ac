//! Normals from finished triangles (Max 1999), as `normals_geometric` has them: each facet weighted by the sine of its
//! angle over the product of its two edges' lengths, over the base triangles that meet smoothly at the vertex. On the
//! host: it reads the lists once and computes little.

use displace_glsl::{reference::site::vector, tables::Tables};
use glam::DVec3;
use rayon::prelude::*;

use super::places::contributions;
use crate::domain::{
    mesh::{Csr, Mesh},
    surface::{Place, Surface},
};

/// Unit normals of all fine vertices; where facets give none, the shading normals of the base.
#[must_use]
pub fn normals(tables: &Tables, mesh: &Mesh, surface: &Surface) -> Vec<[f32; 3]> {
    let corners = surface.triangles.as_flattened().iter().copied().zip(0..).collect::<Vec<(u32, u32)>>();
    let around = Facets { tables, mesh, surface, corners: Csr::from_pairs(surface.positions.len(), &corners) };
    (0..surface.positions.len()).into_par_iter().map(|vertex| around.normal(vertex).as_vec3().to_array()).collect()
}

struct Facets<'a> {
    tables: &'a Tables,
    mesh: &'a Mesh,
    surface: &'a Surface,
    /// Fine `triangle * 3 + corner` of each fine vertex, ascending.
    corners: Csr,
}

impl Facets<'_> {
    fn normal(&self, vertex: usize) -> DVec3 {
        let place = self.surface.layout.place(self.mesh, vertex);
        let listed = contributions(self.tables, place).iter();
        let sum: DVec3 = match place {
            Place::Inside { triangle, .. } => self.around(triangle as usize, vertex),
            _ => listed.map(|&item| self.around(item as usize / 3, self.counterpart(place, vertex, item))).sum(),
        };
        sum.try_normalize().unwrap_or_else(|| self.shading(vertex))
    }

    /// The fine vertex of base triangle `item / 3` that lies where `vertex` does: the one of its own av or ae.
    fn counterpart(&self, place: Place, vertex: usize, item: u32) -> usize {
        let (triangle, k) = (&self.mesh.triangles[item as usize / 3], item as usize % 3);
        match place {
            Place::Edge { ae, .. } => {
                let rank = vertex - self.surface.edge_vertices(self.mesh, ae).start;
                self.surface.edge_vertices(self.mesh, triangle.ae[k]).start + rank
            }
            _ => triangle.av[k] as usize,
        }
    }

    /// The facets that base triangle `t` has around its own `vertex`, on the side of the shading normals.
    fn around(&self, t: usize, vertex: usize) -> DVec3 {
        let range = self.surface.triangles_of(t);
        let all = self.corners.list(vertex);
        let first = all.partition_point(|item| (*item as usize) < 3 * range.start);
        let end = all.partition_point(|item| (*item as usize) < 3 * range.end);
        let sum: DVec3 = all[first..end].iter().map(|item| self.facet(*item as usize)).sum();
        let av = self.mesh.triangles[t].av;
        let [a, b, c] = av.map(|av| vector(&self.tables.av_position_u[av as usize]));
        let shading: DVec3 = av.iter().map(|&av| vector(&self.tables.av_normal[av as usize])).sum();
        if (b - a).cross(c - a).dot(shading) < 0.0 { -sum } else { sum }
    }

    fn facet(&self, item: usize) -> DVec3 {
        let ids = self.surface.triangles[item / 3];
        let [p, q, r] = [0, 1, 2].map(|k| vector(&self.surface.positions[ids[(item + k) % 3] as usize]));
        let (a, b) = (q - p, r - p);
        let weight = a.length_squared() * b.length_squared();
        if weight > 0.0 { a.cross(b) / weight } else { DVec3::ZERO }
    }

    fn shading(&self, vertex: usize) -> DVec3 {
        let (avs, weights) = self.surface.site(self.mesh, vertex);
        let normal = |k: usize| vector(&self.tables.av_normal[avs[k] as usize]) * weights[k];
        (normal(0) + normal(1) + normal(2)).normalize_or_zero()
    }
}
