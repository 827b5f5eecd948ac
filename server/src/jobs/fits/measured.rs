//! How far results are found to be from their surfaces.

use glam::DVec3;

use super::Made;
use crate::{
    domain::{
        Result, cancel::Cancel, grid::Grid, mesh::Mesh, plan::TolerancePlan, request::Geometry, surface::Surface,
    },
    oracle::{
        sampled_error::{Sampled, lattice},
        surface::{self as oracle, SeamChoice},
    },
};

/// Triangles that are looked at, spread evenly where a mesh has more: a place takes the oracle microseconds.
const MOST: usize = 1 << 20;
/// Those that were found farthest off are looked at closely.
const FARTHEST: usize = 16;
/// At the points of a lattice with so many segments along a side.
const ALONG_SIDE: u32 = 8;
/// Where triangles that stand for a surface are farthest from it: their middles, and those of their sides.
const MIDDLES: [DVec3; 4] =
    [DVec3::splat(1.0 / 3.0), DVec3::new(0.5, 0.5, 0.0), DVec3::new(0.0, 0.5, 0.5), DVec3::new(0.5, 0.0, 0.5)];

impl Made<'_> {
    /// Of mesh number `index`: `tolerance_local` of its plan times the largest share of what is allowed to a triangle.
    pub(super) fn measured_local(
        &self,
        (index, mesh): (usize, &Mesh),
        plan: &TolerancePlan,
        geometry: &Geometry,
        cancel: &Cancel,
    ) -> Result<f64> {
        let truth = oracle::Surface::new(mesh, &self.details[index], SeamChoice::from(geometry));
        let (surface, grid) = (&self.surfaces[index], self.grids.get(index).copied().flatten());
        let sampled = Sampled {
            truth: &truth,
            surface,
            position: &|vertex| written(surface, grid, vertex),
            allowed: &|corners| plan.allowed_to(corners),
        };
        Ok(plan.tolerance_local * largest_share(&sampled, cancel)?)
    }
}

fn largest_share(sampled: &Sampled<'_>, cancel: &Cancel) -> Result<f64> {
    let triangles = sampled.surface.triangles.len();
    let looked_at: Vec<usize> = (0..triangles).step_by(triangles.div_ceil(MOST).max(1)).collect();
    let shares = sampled.shares(&looked_at, |_| MIDDLES, cancel)?;
    let mut order: Vec<usize> = (0..shares.len()).collect();
    if order.len() > FARTHEST {
        order.select_nth_unstable_by(FARTHEST, |a, b| shares[*b].total_cmp(&shares[*a]));
        order.truncate(FARTHEST);
    }
    let farthest: Vec<usize> = order.into_iter().map(|k| looked_at[k]).collect();
    let closely = sampled.shares(&farthest, |_| lattice(ALONG_SIDE), cancel)?;
    Ok(shares.into_iter().chain(closely).fold(0.0, f64::max))
}

/// As readers of the result have it, mesh-local units.
fn written(surface: &Surface, grid: Option<Grid>, vertex: u32) -> DVec3 {
    let position = surface.positions[vertex as usize];
    let placed = grid.map(|grid| grid.position(grid.place(position)));
    DVec3::from_array(placed.unwrap_or(position.map(f64::from)))
}
