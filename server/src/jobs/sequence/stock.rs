//! The tessellations of a sequence, made when the first frame asks for them and kept while one may.

use std::ops::Range;

use super::cameras::Cameras;
use crate::{
    domain::{
        Result,
        cancel::NoProgress,
        report::{Fitted, Report},
        request::{Allowed, Geometry, Refinement},
        sequence::{SequenceRequest, SequenceTessellation},
        surface::{Common, Surface},
    },
    jobs::{WorkContext, bumps, fits, inputs, inputs::Inputs, lens, plans::Plans, render::planned, seams, strain},
};

/// One tessellation of all meshes.
pub(super) struct Made {
    pub(super) surfaces: Vec<Surface>,
    /// What it keeps, pixels of the frames it is made for.
    pub(super) tolerance_px: Option<f64>,
    pub(super) ms: f64,
}

/// Two tessellations at most, one after the other, and what both have in common.
pub(super) struct Stock<'a> {
    context: &'a WorkContext<'a>,
    request: &'a SequenceRequest,
    pub(super) inputs: Inputs,
    pub(super) report: Report,
    made: Vec<(usize, Made)>,
    common: Option<(usize, Vec<Common>)>,
}

impl<'a> Stock<'a> {
    pub(super) fn new(
        context: &'a WorkContext<'a>,
        request: &'a SequenceRequest,
        inputs: Inputs,
        report: Report,
    ) -> Self {
        Self { context, request, inputs, report, made: Vec::new(), common: None }
    }

    /// Number `number`, for frames whose cameras are told; what it took where it is made by this call, else 0.
    pub(super) fn make(&mut self, number: usize, frames: Range<usize>, cameras: &Cameras) -> Result<f64> {
        if self.made.iter().any(|(known, _)| *known == number) {
            return Ok(0.0);
        }
        let geometry = self.geometry(frames, cameras);
        let made = self.made_for(&geometry, number == 0)?;
        let ms = made.ms;
        self.made.retain(|(known, _)| known + 1 == number);
        self.made.push((number, made));
        Ok(ms)
    }

    /// One that is in stock.
    pub(super) fn get(&self, number: usize) -> Option<&Made> {
        self.made.iter().find(|(known, _)| *known == number).map(|(_, made)| made)
    }

    /// What one and the next have in common, mesh by mesh; both are in stock.
    pub(super) fn meet(&mut self, number: usize) {
        if self.common.as_ref().is_some_and(|(known, _)| *known == number) {
            return;
        }
        let (Some(a), Some(b)) = (self.get(number), self.get(number + 1)) else { return };
        let meshes = self.inputs.scene.meshes.iter().zip(a.surfaces.iter().zip(&b.surfaces));
        let common = meshes.map(|(m, (a, b))| Common::new(&m.mesh, [a, b])).collect();
        self.common = Some((number, common));
    }

    /// What `meet` found last, with the two.
    pub(super) fn met(&self) -> Option<(&[Common], [&[Surface]; 2])> {
        let (number, common) = self.common.as_ref()?;
        let (a, b) = (self.get(*number)?, self.get(number + 1)?);
        Some((common, [&a.surfaces, &b.surfaces]))
    }

    fn geometry(&self, frames: Range<usize>, cameras: &Cameras) -> Geometry {
        let render = &self.request.render;
        let mut geometry = render.surface.geometry.clone();
        if let (Some(px), Refinement::Tolerance(tolerance)) = (self.request.kept_px(), &mut geometry.refinement) {
            let (size, cameras) = ([render.width, render.height], &cameras.each[frames]);
            tolerance.allowed = allowed(px, cameras, size);
        }
        geometry
    }

    fn made_for(&mut self, geometry: &Geometry, is_first: bool) -> Result<Made> {
        let Self { context, inputs, report, .. } = self;
        let quiet = WorkContext { progress: &NoProgress, ..**context };
        inputs.plans = Plans::make(&mut inputs.scene, geometry, context.limits)?;
        if self.request.tessellation != SequenceTessellation::Frozen {
            inputs.plans.keep_within_base();
        }
        let (mut surfaces, mut times) = inputs.displaced(&quiet)?;
        planned(inputs, context.limits, &self.request.render)?;
        let fitted = report.fitted.take();
        let made = fits::Made { plans: inputs.plans.each(), surfaces: &surfaces, details: &inputs.details, grids: &[] };
        fits::describe(report, &mut inputs.scene, made, geometry, context.cancel)?;
        report.fitted = worst(fitted, report.fitted.take());
        let tolerance_px = tolerance_px(self.request, geometry, inputs, &surfaces);
        if is_first {
            seams::describe(report, &mut inputs.scene, &surfaces);
            strain::describe(report, &mut inputs.scene, &surfaces);
        }
        for one in surfaces.iter_mut().enumerate() {
            bumps::keep_base_normals(&quiet, inputs, geometry, one, &mut times)?;
        }
        report.vertices = report.vertices.max(inputs.plans.vertices());
        let ms = times.iter().map(|time| time.ms).sum();
        inputs::add_times(&mut report.passes, times);
        Ok(Made { surfaces, tolerance_px, ms })
    }
}

/// Without perspective a pixel is as long everywhere, and cameras of one kind are all alike.
fn allowed(px: f64, cameras: &[crate::domain::image::RenderCamera], size: [u32; 2]) -> Allowed {
    let views: Option<Vec<_>> = cameras.iter().map(|camera| lens::view(camera, size)).collect();
    if let Some(views) = views {
        return Allowed::Pixels { tolerance_px: px, views };
    }
    let flat = cameras.iter().find(|camera| lens::view(camera, size).is_none());
    match flat.map(|camera| lens::within(px, camera, size)) {
        Some(Refinement::Tolerance(tolerance)) => tolerance.allowed,
        _ => Allowed::Pixels { tolerance_px: px, views: Vec::new() },
    }
}

/// The pixels asked for, and more where a mesh keeps less than was asked of it.
fn tolerance_px(request: &SequenceRequest, geometry: &Geometry, inputs: &Inputs, surfaces: &[Surface]) -> Option<f64> {
    let (px, asked) = (request.kept_px()?, geometry.tolerance()?.allowed.value());
    let kept = inputs.plans.each().iter().zip(surfaces).filter_map(|(plan, surface)| fits::kept(plan, surface));
    Some(px * kept.map(|(kept, _)| kept / asked).fold(1.0, f64::max))
}

/// Of all tessellations.
fn worst(a: Option<Fitted>, b: Option<Fitted>) -> Option<Fitted> {
    let (Some(a), Some(b)) = (a, b) else { return a.or(b) };
    let mut worst = a;
    worst.achieved_tolerance = a.achieved_tolerance.max(b.achieved_tolerance);
    worst.accuracy.bound = a.accuracy.bound.max(b.accuracy.bound);
    worst.accuracy.measured = a.accuracy.measured.max(b.accuracy.measured);
    worst.rounds = a.rounds.max(b.rounds);
    Some(worst)
}
