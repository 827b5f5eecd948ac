//! The displaced surface as triangles with a certified residual: cut along the texels of its maps, where it
//! has kinks, then wherever a caller wants it finer.
//!
//! The triangles meet without cracks: what is cut on a base edge from one side is cut from all.

mod ears;
mod kinks;
mod patch;

use std::collections::BTreeMap;

use glam::DVec3;
use rayon::prelude::*;

use self::patch::Patch;
use super::surface::Surface;
use crate::domain::{Error, Result, cancel::Cancel};

/// Triangles of a surface. Corners lie on it; everywhere else it is within `residual` of the triangle.
#[derive(Clone, Debug, Default)]
pub struct Dicing {
    /// Mesh-local units.
    pub positions: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
    /// The base triangle of each triangle.
    pub base: Vec<u32>,
    /// Barycentrics of each triangle's corners in its base triangle.
    pub at: Vec<[DVec3; 3]>,
    /// Largest distance of corresponding points of triangle and surface, mesh-local units.
    pub residual: Vec<f32>,
    /// The most by which a vertex on a seam was moved from where one side has it to where all agree.
    pub moved: f64,
}

/// A convex piece of a base triangle that may be cut further.
pub struct Region<'r> {
    /// The base triangle.
    pub base: usize,
    /// Where the surface is at its corners, mesh-local units.
    pub positions: &'r [DVec3],
    /// How far the surface is at most from triangles with these corners.
    pub deviation: f64,
}

/// What keeps a dicing within bounds.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    pub max_triangles: usize,
    /// Cuts of one region that follow each other.
    pub max_depth: u32,
}

impl Default for Limits {
    fn default() -> Self {
        Self { max_triangles: 24_000_000, max_depth: 64 }
    }
}

/// Dices every base triangle until `wants_more` is content with each region, or the limit of depth is
/// reached. Fails where it would take more than `limits.max_triangles`, or when cancelled.
pub fn dice(
    surface: &Surface<'_>,
    limits: &Limits,
    cancel: &Cancel,
    wants_more: &(dyn Fn(&Region<'_>) -> bool + Sync),
) -> Result<Dicing> {
    let count = surface.mesh().triangles.len();
    let spent = std::sync::atomic::AtomicUsize::new(0);
    let one = |t: usize| Patch::cut(surface, t, limits, &spent, cancel, wants_more);
    let mut patches: Vec<Patch> = (0..count).into_par_iter().map(one).collect::<Result<_>>()?;
    if !patches.par_iter().all(Patch::is_finite) {
        let message = "the surface is not finite everywhere: lower the scale, or keep the expression away from division by 0, roots and logarithms of negative numbers";
        return Err(Error::invalid("details", message));
    }
    let edges = shared_edges(surface, &patches);
    patches.par_iter_mut().enumerate().for_each(|(t, patch)| patch.insert_shared(surface, t, &edges));
    cancel.check()?;
    let dicing = assemble(surface, &patches, &edges);
    if dicing.residual.iter().any(|residual| !residual.is_finite()) {
        return Err(unbounded());
    }
    Ok(dicing)
}

fn unbounded() -> Error {
    let message = "the surface cannot be bounded everywhere: keep the expression away from division by 0 and from roots and logarithms of numbers near 0";
    Error::invalid("details", message)
}

fn too_many(limits: &Limits) -> Error {
    Error::too_large(
        "details",
        format!(
            "the surface takes more than {} triangles: allow a larger error, show it smaller, or use a smaller map",
            limits.max_triangles
        ),
    )
}

/// Points along each base edge, as the order-preserving bits of 0 < t < 1, and their places.
type SharedEdges = Vec<BTreeMap<u64, DVec3>>;

/// Points nearer to each other along an edge are one.
const SAME_POINT: f64 = 1e-9;

/// The point known nearest to `t`, if any is near.
fn near(points: &BTreeMap<u64, DVec3>, t: f64) -> Option<u64> {
    let known = points.range((t - SAME_POINT).max(0.0).to_bits()..=(t + SAME_POINT).to_bits());
    let apart = |bits: &u64| (f64::from_bits(*bits) - t).abs();
    known.map(|(bits, _)| *bits).min_by(|a, b| apart(a).total_cmp(&apart(b)))
}

fn shared_edges(surface: &Surface<'_>, patches: &[Patch]) -> SharedEdges {
    let mesh = surface.mesh();
    let mut edges: SharedEdges = vec![BTreeMap::new(); mesh.ge_gv.len()];
    for (t, patch) in patches.iter().enumerate() {
        for side in 0..3 {
            let ge = mesh.ae_ge[mesh.triangles[t].ae[side] as usize] as usize;
            let points = patch.on_side(mesh, t, side);
            for (along, position) in points {
                if near(&edges[ge], along).is_none() {
                    edges[ge].insert(along.to_bits(), position);
                }
            }
        }
    }
    edges.par_iter_mut().enumerate().for_each(|(ge, points)| {
        if surface.is_seam(ge) {
            points.iter_mut().for_each(|(bits, place)| *place = surface.seam_position(ge, f64::from_bits(*bits)));
        }
    });
    edges
}

fn assemble(surface: &Surface<'_>, patches: &[Patch], edges: &SharedEdges) -> Dicing {
    let mesh = surface.mesh();
    let mut dicing = Dicing::default();
    dicing.positions.extend((0..mesh.gv_position.len()).map(|gv| corner_position(surface, patches, gv)));
    let mut first_of_edge = Vec::with_capacity(edges.len());
    for points in edges {
        first_of_edge.push(dicing.positions.len() as u32);
        dicing.positions.extend(points.values());
    }
    let keys: Vec<Vec<u64>> = edges.iter().map(|points| points.keys().copied().collect()).collect();
    let shared = |ge: usize, along: f64| {
        let rank = keys[ge].binary_search(&near(&edges[ge], along)?).ok()?;
        Some(first_of_edge[ge] + rank as u32)
    };
    for (t, patch) in patches.iter().enumerate() {
        patch.append(mesh, t, &shared, &mut dicing);
        dicing.moved = dicing.moved.max(patch.most_moved());
    }
    dicing
}

/// Of a place of several sides, what they agree on; else what its one side gives.
fn corner_position(surface: &Surface<'_>, patches: &[Patch], gv: usize) -> DVec3 {
    let mesh = surface.mesh();
    match mesh.gv_corner.list(gv).first() {
        Some(&corner) => patches[corner as usize / 3].corner(corner as usize % 3),
        None => DVec3::from_array(mesh.gv_position[gv].map(f64::from)),
    }
}
