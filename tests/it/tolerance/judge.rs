//! How far results are from the surface, by brute force: the oracle evaluates it, no bound is asked.

use displace_server::{
    domain::{cancel::Cancel, surface::Surface},
    oracle::{
        sampled_error::{Sampled, lattice},
        surface as oracle,
    },
};
use glam::DVec3;

use super::cases::Case;

/// Segments along a side of every triangle of the result.
const ALONG_SIDE: u32 = 8;

/// The greatest distance found between places of the surface and of the triangle above them, mesh-local units.
pub(super) fn farthest(case: &Case, surface: &Surface) -> f64 {
    farthest_at(case, surface, &|_| ALONG_SIDE)
}

/// The same at the points of a lattice with `along_side` segments on each side of a triangle.
pub(super) fn farthest_at(case: &Case, surface: &Surface, along_side: &(dyn Fn(usize) -> u32 + Sync)) -> f64 {
    let position = |vertex: u32| DVec3::from_array(surface.positions[vertex as usize].map(f64::from));
    let details = vec![Some(case.detail.clone()); case.mesh.primitives.len()];
    let truth = oracle::Surface::new(&case.mesh, &details, oracle::SeamChoice::from(&case.geometry));
    let sampled = Sampled { truth: &truth, surface, position: &position, allowed: &|_| 1.0 };
    let all: Vec<usize> = (0..surface.triangles.len()).collect();
    let found = sampled.shares(&all, |triangle| lattice(along_side(triangle)), &Cancel::default());
    found.expect("nobody cancels").into_iter().fold(0.0, f64::max)
}
