//! The fewest triangles within a tolerance: refinement until every triangle keeps the bound, then collapses and flips
//! that keep it. By the f64 twins, on all cores, or by the passes (`device`), which know height layers and a tolerance
//! that is the same everywhere.

pub mod across;
mod budget;
pub mod device;
mod refine;
mod simplify;

use std::{sync::Arc, time::Instant};

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

/// The tessellation of one base mesh.
#[derive(Clone, Debug)]
pub struct Tessellated {
    pub mesh: Simplified,
    /// Largest disagreement of the sides of a seam before reconciling, mesh-local units.
    pub mismatch_max: f64,
    pub fit: Fit,
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
    let on = device.map(|device| OnDevice::new(job, device, &places, asked(plan))).transpose()?;
    let work = |factor| Work::new(job, plan, &places, mesh, factor);
    let attempt = |factor| (Work { on: on.as_ref(), ..work(factor) }).run_anywhere();
    match budget::fitting(plan.max_triangles, attempt)? {
        Some(result) => Ok(result),
        None => work(1.0).of_base(),
    }
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
}

impl<'w> Work<'w> {
    fn new(
        job: &'w JobContext<'w>,
        plan: &'w TolerancePlan,
        places: &'w Places<'w>,
        mesh: &'w Mesh,
        factor: f64,
    ) -> Self {
        let reach = mesh.gv_position.as_flattened().iter().fold(0.0, |most: f32, x| most.max(x.abs()));
        Self { job, plan, places, mesh, asked: asked(plan), factor, rounding: ROUNDING * f64::from(reach), on: None }
    }

    fn quality(&self) -> usize {
        usize::from(self.plan.quality == Quality::High)
    }

    /// On the device, if it has room.
    fn run_anywhere(&self) -> Result<Attempt> {
        match self.run() {
            Err(error) if self.on.is_some() && error.kind == ErrorKind::TooLarge => self.run_on_host(),
            done => done,
        }
    }

    fn run_on_host(&self) -> Result<Attempt> {
        Self { on: None, ..*self }.run()
    }

    fn run(&self) -> Result<Attempt> {
        let budget = self.plan.max_triangles.max(self.places.base.triangles.len() as u64);
        let limit = budget.saturating_mul(MOST_REFINED).min(budget.max(MOST_IN_MEMORY));
        let mut times = Vec::new();
        let Some(grown) = timed("refine", &mut times, || self.grow(START[self.quality()], limit))? else {
            return Ok(Attempt::TooMany { most_likely: 2.0 });
        };
        self.reaching(&grown).shrunk(grown, budget, times)
    }

    /// With what rounding takes of places as far out as those of the mesh.
    fn reaching(&self, grown: &Grown) -> Self {
        let reach = grown.mesh.positions.iter().fold(0.0, |most: f64, p| most.max(p.abs().max_element()));
        Self { rounding: self.rounding.max(ROUNDING * reach), ..*self }
    }

    fn shrunk(&self, grown: Grown, budget: u64, mut times: Vec<PassTime>) -> Result<Attempt> {
        let mut fit = Fit { rounds: grown.rounds, ..Fit::default() };
        let mut mesh = grown.mesh.keyed(self.places.base);
        fit.collapse_rounds = timed("collapse", &mut times, || self.shrink(&mut mesh, SWEEPS[self.quality()]))?;
        let triangles = mesh.triangles.len() as u64;
        if triangles > budget {
            return Ok(Attempt::TooMany { most_likely: triangles as f64 / budget as f64 });
        }
        let worst = self.worst(&mesh);
        if self.on.is_some() && worst.0 > 1.0 {
            // Rounding to f32 has let a triangle pass that should not have.
            return self.run_on_host();
        }
        Ok(Attempt::Done(self.result(mesh, worst, grown.mismatch, fit, times)))
    }

    fn grow(&self, share: f64, limit: u64) -> Result<Option<Grown>> {
        match self.on {
            Some(on) => self.refine_on(on, share, limit),
            None => self.refine(share, limit),
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
        Ok(work.result(grown.mesh, worst, grown.mismatch, Fit::default(), Vec::new()))
    }

    /// Largest distance allowed to a triangle with these displaced corners. The surface it stands for lies around it
    /// by no more than what is allowed.
    fn tolerance(&self, corners: [DVec3; 3]) -> f64 {
        let at = |radius: f64, centre: DVec3| self.plan.tolerance_at(centre, radius);
        let mut allowed = self.plan.tolerance_local;
        if !self.plan.views.is_empty() {
            let centre = corners.iter().sum::<DVec3>() / 3.0;
            let radius = corners.iter().fold(0.0, |most: f64, c| most.max(c.distance(centre)));
            allowed = at(radius + at(radius, centre), centre);
        }
        self.within(allowed)
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
    fn result(
        &self,
        mesh: Simplified,
        (worst, all_known): (f64, bool),
        mismatch_max: f64,
        fit: Fit,
        times: Vec<PassTime>,
    ) -> Tessellated {
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
        Tessellated { mesh, mismatch_max, fit, times }
    }
}

fn timed<T>(name: &str, times: &mut Vec<PassTime>, step: impl FnOnce() -> Result<T>) -> Result<T> {
    let start = Instant::now();
    let result = step()?;
    times.push(PassTime { name: name.into(), ms: start.elapsed().as_secs_f64() * 1e3, bytes: 0 });
    Ok(result)
}
