//! Where a fine vertex lies on the base mesh. The twin of `site.glsl`.

use glam::DVec3;

use super::smooth;
use crate::{
    lattice,
    layout::geometry::{BaseEdge, block},
    patches,
    tables::Tables,
};

/// Three attribute vertices and barycentrics among them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    pub av: [u32; 3],
    pub b: DVec3,
    /// Where it is on a smooth base; see [`crate::patches`].
    pub patch: u32,
}

impl Site {
    #[must_use]
    pub fn at_vertex(av: u32) -> Self {
        Self { av: [av; 3], b: DVec3::X, patch: patches::AT_VERTEX }
    }

    /// In base triangle t, by its barycentrics.
    #[must_use]
    pub fn inside(tables: &Tables, t: u32, b: DVec3) -> Self {
        Self { av: tables.base_triangles[t as usize].av, b, patch: patches::inside(t) }
    }

    /// On a base edge, `t` along its ae.
    #[must_use]
    pub fn on_edge(tables: &Tables, edge: u32, t: f64) -> Self {
        let BaseEdge { av: [from, to], patch_code: patch, .. } = tables.base_edges[edge as usize];
        Self { av: [from, to, to], b: DVec3::new(1.0 - t, t, 0.0), patch }
    }

    /// Vertex `index` of a block of fine vertices.
    #[must_use]
    pub fn of(tables: &Tables, which: u32, index: u32) -> Self {
        let n = tables.segments();
        match which {
            block::CORNERS => Self::at_vertex(index),
            block::EDGES => {
                let (edge, point) = (index / (n - 1), index % (n - 1));
                Self::on_edge(tables, edge, f64::from(point + 1) / f64::from(n))
            }
            _ => {
                let points = lattice::interior_points(tables.lattice.level) as u32;
                let (i, j) = lattice::interior_point(tables.lattice.level, u64::from(index % points));
                let [b1, b2] = [i, j].map(|x| x as f64 / f64::from(n));
                Self::inside(tables, index / points, DVec3::new(1.0 - b1 - b2, b1, b2))
            }
        }
    }

    #[must_use]
    pub fn blend(&self, values: [DVec3; 3]) -> DVec3 {
        values[0] * self.b.x + values[1] * self.b.y + values[2] * self.b.z
    }

    /// The blend of a table of vectors at the three vertices.
    #[must_use]
    pub fn blend_table<const N: usize>(&self, table: &[[f32; N]]) -> DVec3 {
        self.blend(self.av.map(|av| vector(&table[av as usize])))
    }

    #[must_use]
    pub fn position(&self, tables: &Tables) -> DVec3 {
        match tables.patches {
            None => self.blend_table(&tables.av_position_u),
            Some(_) => smooth::fields(tables, self).position.x_axis,
        }
    }
}

/// The first three components.
#[must_use]
pub fn vector<const N: usize>(v: &[f32; N]) -> DVec3 {
    DVec3::new(f64::from(v[0]), f64::from(v[1]), f64::from(v[2]))
}
