//! The images, in order.

use std::sync::Arc;

use glam::DVec3;

use super::{
    cameras::Cameras,
    pop,
    stock::{Made, Stock},
};
use crate::{
    domain::{
        Error, Result,
        cancel::NoProgress,
        encode::{self, EncodedImage},
        environment::Environment,
        image::{ImagePlan, ImageSet, ImageSettings, MarchCounters, RenderScene},
        report::{Report, Warning},
        sequence::{Eye, Frame, SequenceRequest, Shown, Timeline},
        surface::Surface,
    },
    jobs::{
        BUILD_ID, WorkContext, images,
        inputs::{self, Inputs},
        looks, plans,
        render::{layers_left_out, refuse_projected_shadows, with_samples},
    },
    render::JobContext,
};

/// Of the diagonal: what is nearer to an eye counts as being so far, as `plan::tolerance` has it.
const NEAREST: f64 = 1e-3;

pub(super) struct Film<'a> {
    context: &'a WorkContext<'a>,
    request: &'a SequenceRequest,
    cameras: Cameras,
    timeline: Timeline,
    stock: Stock<'a>,
    /// What the last frame showed.
    scene: Option<(Shown, RenderScene)>,
}

impl<'a> Film<'a> {
    pub(super) fn new(
        context: &'a WorkContext<'a>,
        request: &'a SequenceRequest,
        cameras: Cameras,
        inputs: Inputs,
        report: Report,
    ) -> Self {
        let nearest = NEAREST * inputs.scene.diagonal;
        let eyes: Vec<Eye> = cameras.each.iter().map(|camera| Eye::new(camera, nearest)).collect();
        let timeline = Timeline::new(request.tessellation, &eyes, &corners(cameras.bounds));
        let stock = Stock::new(context, request, inputs, report);
        Self { context, request, cameras, timeline, stock, scene: None }
    }

    /// The report, all warnings, and how many tessellations there were.
    pub(super) fn finished(self) -> (Report, Vec<Warning>, u32) {
        let Stock { inputs, report, .. } = self.stock;
        (report, inputs.scene.warnings, self.timeline.made_for.len() as u32)
    }

    pub(super) fn frame(&mut self, number: usize) -> Result<(Frame, Vec<EncodedImage>)> {
        let shown = self.timeline.shown[number];
        let mut ms = self.stocked(shown)?;
        let pop_px = self.pop_px(number);
        self.show(shown)?;
        let (images, image_ms, settings) = self.image(number)?;
        ms += image_ms;
        self.count(images.counters);
        let mut passes = std::mem::take(&mut self.stock.report.passes);
        let encode = || encode::encode_with(&images, self.request.render.format, Some(&settings));
        let files = inputs::timed(&NoProgress, "encode", &mut passes, encode)?;
        inputs::add_times(&mut self.stock.report.passes, passes);
        let (triangles, tolerance_px) = (self.triangles(), self.tolerance_px(shown));
        Ok((Frame { triangles, ms, pop_px, tolerance_px, morph: shown.morph }, files))
    }

    /// Makes what a frame shows, and what that becomes; what it took.
    fn stocked(&mut self, Shown { tessellation, morph }: Shown) -> Result<f64> {
        let mut ms = 0.0;
        for number in tessellation..=tessellation + usize::from(morph > 0.0) {
            ms += self.stock.make(number, self.timeline.made_for[number].clone(), &self.cameras)?;
        }
        Ok(ms)
    }

    fn pop_px(&mut self, number: usize) -> f64 {
        let shown = self.timeline.shown[number];
        let Some(before) = number.checked_sub(1).map(|before| self.timeline.shown[before]) else { return 0.0 };
        if before == shown {
            return 0.0;
        }
        self.stock.meet(before.tessellation);
        let now = if shown.tessellation == before.tessellation { shown.morph } else { 1.0 };
        let (camera, render) = (&self.cameras.each[number], &self.request.render);
        let (scene, size) = (&self.stock.inputs.scene, [render.width, render.height]);
        self.stock.met().map_or(0.0, |met| pop::worst(scene, met, [before.morph, now], camera, size))
    }

    /// Gives the renderer what a frame shows, unless it has that.
    fn show(&mut self, shown: Shown) -> Result<()> {
        if self.scene.as_ref().is_some_and(|(known, _)| *known == shown) {
            return Ok(());
        }
        let surfaces = self.surfaces(shown)?;
        let Inputs { scene, bumps, reliefs, .. } = &mut self.stock.inputs;
        let (render, shows) = (&self.request.render, (&*bumps, &*reliefs));
        let scene = match self.scene.take() {
            Some((_, known)) => RenderScene { meshes: images::meshes(render, scene, shows, surfaces)?, ..known },
            None => {
                let environment = environment(self.context, self.request)?;
                // Rays show every normal.
                let traces = render.rays().is_some() && self.context.executor.traces_rays();
                let moments = render.look.moments && !traces;
                images::render_scene(render, scene, shows, surfaces, environment, moments)?
            }
        };
        self.scene = Some((shown, scene));
        Ok(())
    }

    fn surfaces(&mut self, Shown { tessellation, morph }: Shown) -> Result<Vec<Surface>> {
        if morph == 0.0 {
            return self.made(tessellation).map(|made| made.surfaces.clone());
        }
        self.stock.meet(tessellation);
        let (common, [a, b]) = self.stock.met().ok_or_else(gone)?;
        let meshes = self.stock.inputs.scene.meshes.iter().zip(common).enumerate();
        Ok(meshes.map(|(k, (m, common))| common.between(&m.mesh, [&a[k], &b[k]], morph)).collect())
    }

    fn made(&self, number: usize) -> Result<&Made> {
        self.stock.get(number).ok_or_else(gone)
    }

    fn image(&mut self, number: usize) -> Result<(ImageSet, f64, ImageSettings)> {
        let (context, render) = (self.context, &self.request.render);
        let (_, scene) = self.scene.as_mut().ok_or_else(gone)?;
        scene.camera = self.cameras.each[number];
        let plan = ImagePlan::new(render.width, render.height, &scene.contents())?;
        if plan.device_bytes > context.limits.device_bytes {
            let limit = context.limits.device_bytes;
            return Err(plans::too_large(&render.surface.geometry, "device memory", plan.device_bytes, limit));
        }
        let plan = with_samples(plan, render, context)?;
        refuse_projected_shadows(&plan, scene)?;
        let quiet = JobContext { cancel: context.cancel, progress: &NoProgress };
        let (images, times) = context.executor.render(&quiet, &plan, scene)?;
        let ms = times.iter().filter(|time| time.name != "compile").map(|time| time.ms).sum();
        inputs::add_times(&mut self.stock.report.passes, times);
        if images.layers_left_out {
            self.stock.inputs.scene.warnings.push(layers_left_out());
        }
        let samples = plan.rays.map_or(plan.samples * plan.supersample.pow(2), |rays| rays.samples);
        let settings = ImageSettings {
            samples,
            shadows: render.look.shadows,
            lighting: scene.lighting.clone(),
            device: context.executor.device_name().into(),
            build: BUILD_ID.into(),
            residual_world: 0.0,
        };
        Ok((images, ms, settings))
    }

    fn triangles(&self) -> u64 {
        let meshes = self.scene.iter().flat_map(|(_, scene)| &scene.meshes);
        meshes.map(|mesh| mesh.triangles.len() as u64).sum()
    }

    /// What is between two keeps what both keep.
    fn tolerance_px(&self, Shown { tessellation, morph }: Shown) -> Option<f64> {
        let of = |number| self.stock.get(number).and_then(|made| made.tolerance_px);
        let own = of(tessellation)?;
        Some(if morph > 0.0 { own.max(of(tessellation + 1)?) } else { own })
    }

    /// Of all frames together.
    fn count(&mut self, counters: Option<MarchCounters>) {
        let Some(more) = counters else { return };
        let all = self.stock.report.counters.get_or_insert_default();
        all.rays += more.rays;
        all.fetches += more.fetches;
        all.steps += more.steps;
        all.cap_hits += more.cap_hits;
    }
}

fn gone() -> Error {
    Error::internal("a frame is to show what was not made for it")
}

fn environment(context: &WorkContext<'_>, request: &SequenceRequest) -> Result<Option<Arc<Environment>>> {
    looks::environment(&request.render.look, context.assets)
}

fn corners([low, high]: [[f32; 3]; 2]) -> Vec<DVec3> {
    let pick = |corner: usize, axis: usize| f64::from([low, high][corner >> axis & 1][axis]);
    (0..8).map(|corner| DVec3::new(pick(corner, 0), pick(corner, 1), pick(corner, 2))).collect()
}
