//! The fewest triangles within a tolerance: refinement until every triangle keeps the bound, then collapses and flips
//! that keep it. By the f64 twins, on all cores, or by the passes (`device`), which know height layers and a tolerance
//! that is the same everywhere.

pub mod across;
mod budget;
pub mod device;
mod refine;
mod simplify;
mod times;

use std::sync::Arc;

use displace_glsl::{
    layout::refine::RefinedTriangle,
    reference::{
        bound::Asked,
        collapse::{Facet, Judge, Simplified, Stars},
        place::Places,
    },
    tables::Tables,
};
use glam::DVec3;
use rayon::prelude::*;

use super::JobContext;
use crate::{
    domain::{
        ErrorKind, Result,
        fit::Fit,
        mesh::Mesh,
        plan::TolerancePlan,
        report::PassTime,
        request::{ErrorAt, Quality},
        surface::{Arrangement, Shape, Surface},
    },
    vulkan::Device,
};
use budget::Attempt;
use device::OnDevice;
use refine::Grown;
use times::Times;

/// The tessellation of one base mesh.
#[derive(Clone, Debug)]
pub struct Tessellated {
    pub mesh: Simplified,
    /// Largest disagreement of the sides of a seam before reconciling, mesh-local units.
    pub mismatch_max: f64,
    pub fit: Fit,
    /// Of all attempts. What a device could not do, or did wrong, and the processor then did, is `refine (host)` and
    /// `collapse (host)`.
    pub times: Vec<PassTime>,
}

impl Tessellated {
    /// With the normals and attributes that `finish` gives its shape.
    pub fn finished<T: Into<PassTime>>(
        self,
        mesh: &Mesh,
        finish: impl FnOnce(Shape) -> Result<(Surface, Vec<T>)>,
    ) -> Result<(Surface, Vec<PassTime>)> {
        let triangle = |facet: &Facet| RefinedTriangle { gv: facet.gv, base: facet.base, ..RefinedTriangle::default() };
        let triangles: Vec<RefinedTriangle> = self.mesh.triangles.iter().map(triangle).collect();
        let positions: Vec<[f32; 3]> = self.mesh.positions.iter().map(|p| p.as_vec3().to_array()).collect();
        let shape = Arrangement::of(mesh, &self.mesh.vertices, &triangles)?.placed(&positions);
        let (surface, more) = finish(shape)?;
        let mismatch_max = surface.mismatch_max.max(self.mismatch_max as f32);
        let times = self.times.into_iter().chain(more.into_iter().map(T::into)).collect();
        Ok((Surface { mismatch_max, fit: Some(self.fit), ..surface }, times))
    }
}

/// How much finer than the tolerance refinement goes: collapses make more of vertices to choose from, and each costs time.
const START: [f64; 2] = [0.85, 0.5];
/// Meshes that keep the tolerance with more triangles than this go no finer: they have vertices to choose from.
const MOST_FINER: [usize; 2] = [1 << 14, usize::MAX];
/// Flips and collapses by turns, so often.
const SWEEPS: [u32; 2] = [1, 4];
/// A refined mesh with more triangles for each that is allowed seldom collapses into the budget: the tolerance is loosened
/// first.
const MOST_REFINED: u64 = 8;
/// Refined triangles that fit a job's memory, at some 170 bytes each and twice while they are split.
const MOST_IN_MEMORY: u64 = 1 << 24;
/// f32 positions are off by half a unit in the last place along each axis, with their place and their height.
const ROUNDING: f64 = 2.0 / (1 << 24) as f64;
/// Refined meshes this small are collapsed in so many orders; the fewest triangles count.
const FEW_REFINED: usize = 1000;
const ORDERS: u32 = 8;

/// Tessellates `mesh`, whose tables are at level 0, on the processor.
pub fn tessellate(job: &JobContext<'_>, plan: &TolerancePlan, tables: &Tables, mesh: &Mesh) -> Result<Tessellated> {
    attempts(job, plan, tables, mesh, None)
}

/// As [`tessellate`], where a device is at hand: on it, if it can and is faster.
pub fn tessellate_on(
    device: &Arc<Device>,
    job: &JobContext<'_>,
    plan: &TolerancePlan,
    tables: &Tables,
    mesh: &Mesh,
) -> Result<Tessellated> {
    let on = device::is_chosen(device, plan, tables).then_some(device);
    attempts(job, plan, tables, mesh, on)
}

fn attempts(
    job: &JobContext<'_>,
    plan: &TolerancePlan,
    tables: &Tables,
    mesh: &Mesh,
    device: Option<&Arc<Device>>,
) -> Result<Tessellated> {
    let base = super::refine::base(mesh);
    let places = Places::new(tables, &base);
    let on = match device.map(|device| OnDevice::new(job, device, &places, asked(plan))).transpose() {
        Err(error) if error.kind == ErrorKind::TooLarge => None,
        made => made?,
    };
    let fell_back = device.is_some() && on.is_none();
    let times = Times::default();
    let work = |factor| Work::new(job, plan, &places, mesh, factor, &times);
    let attempt = |factor| (Work { on: on.as_ref(), fell_back, ..work(factor) }).run_anywhere();
    let found = match budget::fitting(plan.max_triangles, attempt)? {
        Some(result) => result,
        None => work(1.0).of_base()?,
    };
    Ok(Tessellated { times: times.taken(), ..found })
}

fn asked(plan: &TolerancePlan) -> Asked {
    Asked { at_texels: plan.error_at == ErrorAt::Texels }
}

/// One attempt at the tolerance of the plan times `factor`.
#[derive(Clone, Copy)]
struct Work<'w> {
    job: &'w JobContext<'w>,
    plan: &'w TolerancePlan,
    places: &'w Places<'w>,
    mesh: &'w Mesh,
    asked: Asked,
    factor: f64,
    /// What rounding may take of it, local units.
    rounding: f64,
    /// None: by the twins.
    on: Option<&'w OnDevice>,
    /// Whether a device was to do it.
    fell_back: bool,
    times: &'w Times,
}

impl<'w> Work<'w> {
    fn new(
        job: &'w JobContext<'w>,
        plan: &'w TolerancePlan,
        places: &'w Places<'w>,
        mesh: &'w Mesh,
        factor: f64,
        times: &'w Times,
    ) -> Self {
        let reach = mesh.gv_position.as_flattened().iter().fold(0.0, |most: f32, x| most.max(x.abs()));
        let (asked, rounding) = (asked(plan), ROUNDING * f64::from(reach));
        Self { job, plan, places, mesh, asked, factor, rounding, on: None, fell_back: false, times }
    }

    fn quality(&self) -> usize {
        usize::from(self.plan.quality == Quality::High)
    }

    /// Notes the time of a step, under its second name where a device was to do it, also where it fails.
    fn timed<T>(&self, [name, on_host]: [&str; 2], step: impl FnOnce() -> Result<T>) -> Result<T> {
        self.times.timed(if self.fell_back { on_host } else { name }, step)
    }

    /// On the device, if it has room.
    fn run_anywhere(&self) -> Result<Attempt> {
        match self.run() {
            Err(error) if self.on.is_some() && error.kind == ErrorKind::TooLarge => self.run_on_host(),
            done => done,
        }
    }

    fn run_on_host(&self) -> Result<Attempt> {
        Self { on: None, fell_back: true, ..*self }.run()
    }

    fn run(&self) -> Result<Attempt> {
        let budget = self.plan.max_triangles.max(self.places.base.triangles.len() as u64);
        let limit = budget.saturating_mul(MOST_REFINED).min(budget.max(MOST_IN_MEMORY));
        let Some(grown) = self.timed(["refine", "refine (host)"], || self.grow(START[self.quality()], limit))? else {
            return Ok(Attempt::TooMany { most_likely: 2.0 });
        };
        self.reaching(&grown).shrunk(grown, budget)
    }

    /// With what rounding takes of places as far out as those of the mesh.
    fn reaching(&self, grown: &Grown) -> Self {
        let reach = grown.mesh.positions.iter().fold(0.0, |most: f64, p| most.max(p.abs().max_element()));
        Self { rounding: self.rounding.max(ROUNDING * reach), ..*self }
    }

    fn shrunk(&self, grown: Grown, budget: u64) -> Result<Attempt> {
        let mut fit = Fit { rounds: grown.rounds, ..Fit::default() };
        let mut mesh = grown.mesh.prepared(self.places);
        let shrink = || self.shrink(&mut mesh, SWEEPS[self.quality()]);
        fit.collapse_rounds = self.timed(["collapse", "collapse (host)"], shrink)?;
        let triangles = mesh.triangles.len() as u64;
        if triangles > budget {
            return Ok(Attempt::TooMany { most_likely: triangles as f64 / budget as f64 });
        }
        let worst = self.worst(&mesh);
        if self.on.is_some() && worst.0 > 1.0 {
            // Rounding to f32 has let a triangle pass that should not have.
            return self.run_on_host();
        }
        Ok(Attempt::Done(self.result(mesh, worst, grown.mismatch, fit)))
    }

    fn grow(&self, share: f64, limit: u64) -> Result<Option<Grown>> {
        match self.on {
            Some(on) => self.refine_on(on, share, limit),
            None => self.refine(share, MOST_FINER[self.quality()], limit),
        }
    }

    fn shrink(&self, mesh: &mut Simplified, sweeps: u32) -> Result<u32> {
        if let Some(on) = self.on {
            return self.simplify_on(on, mesh, sweeps);
        }
        let orders = if mesh.triangles.len() <= FEW_REFINED { ORDERS } else { 1 };
        let grown = mesh.clone();
        let mut rounds = self.simplify(mesh, sweeps, 0)?;
        for order in 1..orders {
            let mut other = grown.clone();
            let other_rounds = self.simplify(&mut other, sweeps, order)?;
            if other.triangles.len() < mesh.triangles.len() {
                (*mesh, rounds) = (other, other_rounds);
            }
        }
        Ok(rounds)
    }

    /// The base mesh as it is, whatever its error.
    fn of_base(&self) -> Result<Tessellated> {
        let grown = self.start()?;
        let work = self.reaching(&grown);
        let worst = work.worst(&grown.mesh);
        Ok(work.result(grown.mesh, worst, grown.mismatch, Fit::default()))
    }

    /// Largest distance allowed to a triangle with these displaced corners, beside rounding.
    fn tolerance(&self, corners: [DVec3; 3]) -> f64 {
        self.within(self.plan.allowed_to(corners))
    }

    /// What is left of an allowed distance beside rounding.
    fn within(&self, allowed: f64) -> f64 {
        (allowed * self.factor - self.rounding).max(0.5 * allowed)
    }

    /// Calls `ask` with what judges changes of the mesh.
    fn judged<T>(&self, mesh: &Simplified, stars: &Stars, ask: impl FnOnce(&Judge<'_>) -> T) -> T {
        let tolerance = |corners| self.tolerance(corners);
        ask(&Judge { places: self.places, asked: self.asked, mesh, stars, tolerance: &tolerance })
    }

    /// The largest known error, as a share of the tolerance, and whether all are known.
    fn worst(&self, mesh: &Simplified) -> (f64, bool) {
        self.judged(mesh, &Stars::default(), |judge| {
            let errors = mesh.triangles.par_iter().map(|facet| judge.error_of(facet, f64::INFINITY));
            let known = |error: f64| if error.is_finite() { error } else { 0.0 };
            errors.map(|e| (known(e), e.is_finite())).reduce(|| (0.0, true), |a, b| (a.0.max(b.0), a.1 && b.1))
        })
    }

    /// With what was found of its errors, measured anew.
    fn result(&self, mesh: Simplified, (worst, all_known): (f64, bool), mismatch_max: f64, fit: Fit) -> Tessellated {
        let found = worst * self.within(self.plan.tolerance_local) + self.rounding;
        let budget_reached = found > self.plan.tolerance_local;
        // Without ramps a seam's sides stay apart from the one place all get: each at most twice as far as from the first.
        let open = if self.places.tables.corrections.is_empty() { 2.0 * mismatch_max } else { 0.0 };
        let bound_local = found + open;
        let fit = Fit {
            bound_local,
            tolerance_local: bound_local.max(self.plan.tolerance_local),
            certified: all_known && !self.asked.at_texels,
            budget_reached,
            ..fit
        };
        Tessellated { mesh, mismatch_max, fit, times: Vec::new() }
    }
}
