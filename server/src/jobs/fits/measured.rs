//! How far results are found to be from their surfaces.

use glam::DVec3;
use rayon::prelude::*;

use super::Made;
use crate::{
    domain::{
        Result, cancel::Cancel, grid::Grid, mesh::Mesh, plan::TolerancePlan, request::Geometry, surface::Surface,
    },
    oracle::{
        sampled_error::{Sampled, lattice},
        sheet::Sheet,
        surface::{self as oracle, SeamChoice},
    },
};

/// So many triangles at most, spread over all, are looked at in the middle: that takes the oracle microseconds each.
const MOST_IN_MIDDLE: usize = 1 << 13;
const MIDDLE: [DVec3; 1] = [DVec3::splat(1.0 / 3.0)];
/// Of the triangles found farthest off there, one in so many is looked at on its sides as well, but not fewer than
/// `LEAST_ON_SIDES`.
const ON_SIDES: usize = 16;
const LEAST_ON_SIDES: usize = 64;
const SIDES: [DVec3; 3] = [DVec3::new(0.5, 0.5, 0.0), DVec3::new(0.0, 0.5, 0.5), DVec3::new(0.5, 0.0, 0.5)];
/// And so many of these at the points of a lattice with `ALONG_SIDE` segments along a side.
const CLOSELY: usize = 16;
const ALONG_SIDE: u32 = 8;

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
        if surface.layout.is_spanning() {
            return largest_distance(&sampled, cancel);
        }
        Ok(plan.tolerance_local * largest_share(&sampled, cancel)?)
    }
}

/// Of places of the surface from triangles that stand for no one base triangle, mesh-local units.
fn largest_distance(sampled: &Sampled<'_>, cancel: &Cancel) -> Result<f64> {
    let positions = (0..sampled.surface.positions.len() as u32).map(sampled.position).collect();
    let sheet = Sheet::of_triangles(positions, sampled.surface.triangles.clone());
    let count = sampled.truth.mesh().triangles.len();
    let some: Vec<usize> = (0..count).step_by(count.div_ceil(MOST_IN_MIDDLE).max(1)).collect();
    let of = |base: &usize| {
        cancel.check()?;
        let places = [MIDDLE[0], DVec3::X, DVec3::Y, DVec3::Z].map(|b| sampled.truth.position(*base, b));
        let nearest = places.iter().filter_map(|place| sheet.nearest(*place, None, 0.0));
        Ok(nearest.fold(0.0, |most: f64, near| most.max(near.lower)))
    };
    let found: Vec<f64> = some.par_iter().map(of).collect::<Result<_>>()?;
    Ok(found.into_iter().fold(0.0, f64::max))
}

fn largest_share(sampled: &Sampled<'_>, cancel: &Cancel) -> Result<f64> {
    let count = sampled.surface.triangles.len();
    let all: Vec<usize> = (0..count).step_by(count.div_ceil(MOST_IN_MIDDLE).max(1)).collect();
    let middles = sampled.shares(&all, |_| MIDDLE, cancel)?;
    let some = farthest(&all, &middles, LEAST_ON_SIDES.max(all.len() / ON_SIDES));
    let sides = sampled.shares(&some, |_| SIDES, cancel)?;
    let few = farthest(&some, &sides, CLOSELY);
    let closely = sampled.shares(&few, |_| lattice(ALONG_SIDE), cancel)?;
    Ok(middles.into_iter().chain(sides).chain(closely).fold(0.0, f64::max))
}

/// The triangles with the largest shares, `count` of them where there are so many.
fn farthest(triangles: &[usize], shares: &[f64], count: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..triangles.len()).collect();
    if count < order.len() {
        order.select_nth_unstable_by(count, |a, b| shares[*b].total_cmp(&shares[*a]).then(a.cmp(b)));
        order.truncate(count);
    }
    order.into_iter().map(|k| triangles[k]).collect()
}

/// As readers of the result have it, mesh-local units.
fn written(surface: &Surface, grid: Option<Grid>, vertex: u32) -> DVec3 {
    let position = surface.positions[vertex as usize];
    let placed = grid.map(|grid| grid.position(grid.place(position)));
    DVec3::from_array(placed.unwrap_or(position.map(f64::from)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_farthest_are_those_with_the_largest_shares() {
        let mut found = farthest(&[10, 11, 12, 13], &[0.2, 0.9, 0.1, 0.5], 2);
        found.sort_unstable();
        assert_eq!(found, [11, 13]);
        assert_eq!(farthest(&[10, 11], &[0.2, 0.9], 5), [10, 11]);
    }
}
