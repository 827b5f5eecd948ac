//! One setting after the other: made several times, measured, and compared with the truth.

use super::{lens, truth, truth::Truth};
use crate::domain::cancel::NoProgress;
use crate::{
    domain::{
        Error, Result,
        chart::{Candidate, ChartRequest, Point, Setting},
        encode,
        image::{ImagePlan, ImageSet, RenderScene},
        report::PassTime,
        request::{Method, RenderRequest},
        surface::Surface,
    },
    jobs::{
        WorkContext, bumps, images,
        inputs::{self, Inputs},
        looks,
        plans::{self, Plans},
        reliefs,
        render::{planned, refuse_projected_shadows},
    },
    oracle::metrics::{self, picture::Picture},
    render::JobContext,
};

/// What took longer than this is not run again, milliseconds.
const ENOUGH_MS: f64 = 1000.0;
/// The pass that no method is charged with.
const COMPILE: &str = "compile";

pub(super) struct Sweep<'a> {
    context: &'a WorkContext<'a>,
    request: &'a ChartRequest,
    truth: &'a Truth,
    /// What was read for one kind of methods; they come kind by kind.
    read: Option<(Method, Inputs)>,
    pub(super) passes: Vec<PassTime>,
}

/// A point and its pictures, as PNG.
pub(super) struct Shown {
    pub(super) point: Point,
    pub(super) image: Vec<u8>,
    pub(super) difference: Vec<u8>,
}

/// The runs of one setting: of each, what surface and image took.
struct Runs {
    images: ImageSet,
    ms: Vec<[f64; 2]>,
    triangles: u64,
    vertices: u64,
    scene_bytes: u64,
}

impl<'a> Sweep<'a> {
    pub(super) fn new(context: &'a WorkContext<'a>, request: &'a ChartRequest, truth: &'a Truth) -> Self {
        Self { context, request, truth, read: None, passes: Vec::new() }
    }

    pub(super) fn show(&mut self, candidate: &Candidate) -> Result<Shown> {
        let mut request = candidate.request(&self.request.truth);
        if let Setting::TolerancePx(px) = candidate.setting {
            let size = [request.width, request.height];
            request.surface.geometry.refinement = lens::within(px, &self.truth.camera, size);
        }
        let mut inputs = self.inputs(&request)?;
        let runs = self.runs(&mut inputs, &request);
        self.read = Some((kind(candidate.method), inputs));
        self.compared(candidate, &runs?)
    }

    /// What methods of its kind read is read once.
    fn inputs(&mut self, request: &RenderRequest) -> Result<Inputs> {
        let (context, surface) = (self.context, &request.surface);
        let mut inputs = match self.read.take() {
            Some((read, inputs)) if read == kind(surface.method) => inputs,
            _ => Inputs::load(context.assets, context.limits, &quiet(context), surface)?,
        };
        inputs::add_times(&mut self.passes, inputs.take_passes());
        inputs.plans = Plans::make(&mut inputs.scene, &surface.geometry, context.limits)?;
        planned(&inputs, context.limits, request)?;
        Ok(inputs)
    }

    fn runs(&self, inputs: &mut Inputs, request: &RenderRequest) -> Result<Runs> {
        let (surfaces, geometry_ms) = self.surfaces(inputs, request)?;
        let (scene, plan) = self.scene(inputs, request, surfaces)?;
        let (mut images, image_ms) = self.image(&plan, &scene)?;
        let mut ms = vec![[geometry_ms, image_ms]];
        while ms.len() < self.request.repeats as usize && total(&ms) < ENOUGH_MS {
            self.context.cancel.check()?;
            let (_, geometry_ms) = self.surfaces(inputs, request)?;
            let (again, image_ms) = self.image(&plan, &scene)?;
            ms.push([geometry_ms, image_ms]);
            images = again;
        }
        let (triangles, vertices) = (inputs.plans.triangles(), inputs.plans.vertices());
        Ok(Runs { images, ms, triangles, vertices, scene_bytes: scene.contents().scene_bytes() })
    }

    fn surfaces(&self, inputs: &mut Inputs, request: &RenderRequest) -> Result<(Vec<Surface>, f64)> {
        let context = WorkContext { progress: &NoProgress, ..*self.context };
        let (mut surfaces, mut times) = inputs.displaced(&context)?;
        for one in surfaces.iter_mut().enumerate() {
            bumps::keep_base_normals(&context, inputs, &request.surface.geometry, one, &mut times)?;
        }
        Ok((surfaces, device_ms(&times)))
    }

    fn scene(
        &self,
        inputs: &mut Inputs,
        request: &RenderRequest,
        surfaces: Vec<Surface>,
    ) -> Result<(RenderScene, ImagePlan)> {
        let limits = self.context.limits;
        reliefs::check(inputs, request, self.context)?;
        planned(inputs, limits, request)?;
        let environment = looks::environment(&request.look, self.context.assets)?;
        let shown = (&inputs.bumps, &inputs.reliefs);
        let moments = request.look.moments;
        let mut scene = images::render_scene(request, &mut inputs.scene, shown, surfaces, environment, moments)?;
        scene.camera = self.truth.camera;
        let plan = ImagePlan::new(request.width, request.height, &scene.contents())?;
        if plan.device_bytes > limits.device_bytes {
            let geometry = &request.surface.geometry;
            return Err(plans::too_large(geometry, "device memory", plan.device_bytes, limits.device_bytes));
        }
        refuse_projected_shadows(&plan, &scene)?;
        Ok((scene, plan))
    }

    fn image(&self, plan: &ImagePlan, scene: &RenderScene) -> Result<(ImageSet, f64)> {
        let (images, times) = self.context.executor.render(&quiet(self.context), plan, scene)?;
        Ok((images, device_ms(&times)))
    }

    fn compared(&self, candidate: &Candidate, runs: &Runs) -> Result<Shown> {
        let picture = Picture::of_images("image", &runs.images)?;
        let (error, differences) = metrics::compare(&self.truth.picture, &picture, self.context.cancel)?;
        let [geometry_ms, image_ms] = median(&runs.ms).ok_or_else(|| Error::internal("a setting was never run"))?;
        let point = Point {
            name: candidate.name(),
            method: candidate.method.name().into(),
            setting: candidate.setting(),
            triangles: runs.triangles,
            vertices: runs.vertices,
            counters: runs.images.counters,
            scene_bytes: runs.scene_bytes,
            ms: geometry_ms + image_ms,
            ms_spread: spread(&runs.ms),
            geometry_ms,
            image_ms,
            runs: runs.ms.len() as u32,
            error,
            fronts: Vec::new(),
        };
        let difference = encode::encode_rgb8(differences.width, differences.height, &differences.colors())?;
        Ok(Shown { point, image: truth::png(&runs.images)?, difference })
    }
}

/// Of all that show heights per pixel the same is read.
fn kind(method: Method) -> Method {
    if method.marcher().is_some() { Method::Exact } else { method }
}

/// What a setting's own passes tell is not the job's.
fn quiet<'a>(context: &WorkContext<'a>) -> JobContext<'a> {
    JobContext { cancel: context.cancel, progress: &NoProgress }
}

fn device_ms(times: &[PassTime]) -> f64 {
    times.iter().filter(|time| time.name != COMPILE).map(|time| time.ms).sum()
}

fn sum([geometry_ms, image_ms]: &[f64; 2]) -> f64 {
    geometry_ms + image_ms
}

fn total(runs: &[[f64; 2]]) -> f64 {
    runs.iter().map(sum).sum()
}

/// The run in the middle, of two the faster.
fn median(runs: &[[f64; 2]]) -> Option<[f64; 2]> {
    let mut runs = runs.to_vec();
    runs.sort_by(|a, b| sum(a).total_cmp(&sum(b)));
    runs.get(runs.len().saturating_sub(1) / 2).copied()
}

fn spread(runs: &[[f64; 2]]) -> Option<f64> {
    let ends = runs.iter().map(sum).fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], ms| [low.min(ms), high.max(ms)]);
    (runs.len() > 1).then(|| ends[1] - ends[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_run_in_the_middle_counts_whole() {
        assert_eq!(median(&[[1.0, 5.0], [4.0, 1.0], [0.5, 9.0]]), Some([1.0, 5.0]));
        assert_eq!(median(&[[1.0, 5.0], [4.0, 1.0]]), Some([4.0, 1.0]));
        assert_eq!(median(&[]), None);
    }

    #[test]
    fn one_run_has_no_spread() {
        assert_eq!(spread(&[[1.0, 2.0]]), None);
        assert_eq!(spread(&[[1.0, 2.0], [1.0, 4.0], [0.0, 2.5]]), Some(2.5));
    }

    #[test]
    fn compiling_is_not_charged_to_a_method() {
        let time = |name: &str, ms| PassTime { name: name.into(), ms, bytes: 0 };
        assert_eq!(device_ms(&[time("compile", 900.0), time("march", 2.0), time("refine (host)", 3.0)]), 5.0);
    }
}
