//! Simplification across base triangles: what is denser than its tolerance asks for gets fewer triangles than its base.
//!
//! Refining and collapsing keep at least one triangle for each base triangle. Where they end near that, the tolerance
//! is shared: they make a mesh within the first part of it, and here meshoptimizer proposes simpler meshes of the same
//! vertices. What is taken is measured: the Hausdorff distance of a proposal to the mesh it stands for, both ways and
//! bounded by the oracle, is within the rest of the tolerance.
//!
//! | file | holds |
//! |---|---|
//! | `search.rs` | proposals until none of their faults is left |
//! | `patch.rs` | the mesh as meshoptimizer takes it |
//! | `verdict.rs` | what is wrong with a proposal |
//! | `spanning.rs` | the surface with triangles that span several base triangles |

mod patch;
mod search;
mod spanning;
mod verdict;

use std::time::Instant;

use crate::{
    domain::{Result, fit::Fit, mesh::Mesh, plan::TolerancePlan, report::PassTime, surface::Surface},
    render::JobContext,
};

/// What refining and collapsing may take of a tolerance where the rest is for simplification: less of it would make
/// them finer than it saves, and of what is left the triangles are in inverse proportion.
const FIRST_SHARE: f64 = 0.3;
/// Less of a tolerance than this is not worth the work.
const LEAST_SHARE: f64 = 0.25;
/// Bases with fewer triangles are never denser than asked for by much.
const LEAST_BASE: usize = 1024;
/// Results with more triangles for each base triangle have hardly any that is there for the base's sake.
const MOST_PER_BASE: usize = 3;

/// The surface that `displaced` makes within the plan's tolerance, or, where it is mostly base triangles, one with
/// fewer triangles that spans them. Never more triangles, and never farther than the tolerance.
pub fn fewest(
    job: &JobContext<'_>,
    plan: &TolerancePlan,
    mesh: &Mesh,
    displaced: impl Fn(&TolerancePlan) -> Result<(Surface, Vec<PassTime>)>,
) -> Result<(Surface, Vec<PassTime>)> {
    let (surface, mut times) = displaced(plan)?;
    if !is_dense(plan, mesh, &surface) {
        return Ok((surface, times));
    }
    let first_local = FIRST_SHARE * plan.tolerance_local;
    let finer = match surface.fit {
        Some(fit) if fit.bound_local <= first_local => None,
        _ => {
            let (finer, more) = displaced(&TolerancePlan { tolerance_local: first_local, ..plan.clone() })?;
            times.extend(more);
            Some(finer)
        }
    };
    let start = Instant::now();
    let simpler = simplified(job, plan, mesh, finer.as_ref().unwrap_or(&surface), surface.triangles.len())?;
    let ms = start.elapsed().as_secs_f64() * 1e3;
    times.push(PassTime { name: "simplify_across".into(), ms, bytes: 0 });
    Ok((simpler.unwrap_or(surface), times))
}

fn is_dense(plan: &TolerancePlan, mesh: &Mesh, surface: &Surface) -> bool {
    let base = mesh.triangles.len();
    plan.spans_base
        && base >= LEAST_BASE
        && surface.triangles.len() <= MOST_PER_BASE * base
        && surface.fit.is_some_and(|fit| !fit.budget_reached)
}

/// With fewer than `most` triangles; none where the surface leaves too little of the tolerance, or that cannot be.
fn simplified(
    job: &JobContext<'_>,
    plan: &TolerancePlan,
    mesh: &Mesh,
    surface: &Surface,
    most: usize,
) -> Result<Option<Surface>> {
    let Some(fit) = surface.fit else { return Ok(None) };
    let tolerance_local = plan.tolerance_local - fit.bound_local;
    if tolerance_local < LEAST_SHARE * plan.tolerance_local {
        return Ok(None);
    }
    let Some(simpler) = search::fewest(job, mesh, surface, (tolerance_local, plan.quality), most)? else {
        return Ok(None);
    };
    let bound_local = fit.bound_local + simpler.error_local;
    let fit = Fit { bound_local, tolerance_local: plan.tolerance_local, budget_reached: false, ..fit };
    Ok(Some(Surface { fit: Some(fit), ..spanning::surface(mesh, surface, simpler.triangles) }))
}
