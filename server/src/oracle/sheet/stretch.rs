//! How much a displaced surface stretches its base.

use glam::{DMat2, DVec3};
use rayon::prelude::*;

use super::{Part, Sheet, blend};
use crate::domain::report::Stretch;

impl Sheet<'_> {
    /// The largest factor by which directions of the flat base are lengthened, over the surface's triangles: each
    /// counts by its area on the base. `None` of a mesh, and of bases without area.
    #[must_use]
    pub fn stretch(&self) -> Option<Stretch> {
        let of_part = |part: &Part<'_>| {
            let triangles = (0..part.base.len()).into_par_iter();
            triangles.filter_map(|k| self.stretch_of(part, k)).collect::<Vec<_>>()
        };
        let mut all: Vec<(f64, f64)> = self.parts.iter().flat_map(of_part).collect();
        all.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let total: f64 = all.iter().map(|(_, area)| area).sum();
        let mut sum = 0.0;
        let p99 = all.iter().find(|(_, area)| {
            sum += area;
            sum >= 0.99 * total
        });
        Some(Stretch { p99: p99?.0, max: all.last()?.0 })
    }

    /// Stretch (Sander et al. 2001) and area on the base of triangle k of a part.
    fn stretch_of(&self, part: &Part<'_>, k: usize) -> Option<(f64, f64)> {
        let mesh = part.surface.mesh();
        let base = mesh.triangles[part.base[k] as usize].av.map(|av| {
            let gv = mesh.av_gv[av as usize] as usize;
            part.world_from_mesh.transform_point3(DVec3::from_array(mesh.gv_position[gv].map(f64::from)))
        });
        let flat = part.at[k].map(|at| blend(base, at));
        let [p, q, r] = self.corners((part.first_triangle + k) as u32);
        let (metric, double_area) =
            (gram(flat[1] - flat[0], flat[2] - flat[0]), (flat[1] - flat[0]).cross(flat[2] - flat[0]).length());
        let inverse = metric.inverse();
        let moved = gram(q - p, r - p);
        let product = inverse * moved;
        let (trace, determinant) = (product.x_axis.x + product.y_axis.y, product.determinant());
        let largest = 0.5 * trace + (0.25 * trace * trace - determinant).max(0.0).sqrt();
        largest.is_finite().then(|| (largest.max(0.0).sqrt(), double_area))
    }
}

/// Products of two vectors with each other.
fn gram(u: DVec3, v: DVec3) -> DMat2 {
    DMat2::from_cols_array(&[u.dot(u), u.dot(v), u.dot(v), v.dot(v)])
}
