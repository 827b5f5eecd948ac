//! One setting after the other: made several times, measured, and compared with the truth.

mod took;

use super::{truth, truth::Truth};
use crate::{
    domain::{
        Error, Result,
        cancel::NoProgress,
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
        lens, looks,
        plans::{self, Plans},
        reliefs,
        render::{planned, refuse_projected_shadows},
    },
    oracle::metrics::{self, hit::hit_error, picture::Picture},
    render::JobContext,
};
use took::{Took, all_of, median, refuse_slow, setup_of, spread, sum_of};

/// What has taken as long is not run again, milliseconds.
const ENOUGH_MS: f64 = 500.0;
/// What settings of one sweep may take together for each `SMALL` pixels, milliseconds; images of fewer count as many.
const MOST_MS: f64 = 8000.0;
const SMALL: f64 = 65536.0;
/// The pass that no method is charged with.
const COMPILE: &str = "compile";
/// Passes that maps and light need once, however many images follow.
const SETUP: [&str; 4] = ["mip", "cone_map", "brdf_table", "brdf_averages"];

pub(super) struct Settings<'a> {
    context: &'a WorkContext<'a>,
    request: &'a ChartRequest,
    truth: &'a Truth<'a>,
    read: Read,
    /// The last setting, what it took, what its sweep has taken so far, and what that was set up by.
    last: Option<(Candidate, [f64; 3])>,
    pub(super) passes: Vec<PassTime>,
}

/// What was read for kinds of methods.
pub(super) struct Read {
    /// Where methods come kind by kind, one is enough.
    most: usize,
    inputs: Vec<(Method, Inputs)>,
}

impl Read {
    /// Keeps that of so many kinds.
    pub(super) fn keeping(most: usize) -> Self {
        Self { most, inputs: Vec::new() }
    }

    fn take(&mut self, method: Method) -> Option<Inputs> {
        let place = self.inputs.iter().position(|(read, _)| *read == kind(method))?;
        Some(self.inputs.swap_remove(place).1)
    }

    fn put(&mut self, method: Method, inputs: Inputs) {
        self.inputs.truncate(self.most - 1);
        self.inputs.push((kind(method), inputs));
    }
}

/// A point and its pictures, as PNG.
pub(super) struct Shown {
    pub(super) candidate: Candidate,
    pub(super) point: Point,
    /// All runs.
    took_ms: f64,
    pub(super) image: Vec<u8>,
    pub(super) difference: Vec<u8>,
}

/// The runs of one setting.
struct Runs {
    images: ImageSet,
    took: Vec<Took>,
    triangles: u64,
    vertices: u64,
    scene_bytes: u64,
}

impl<'a> Settings<'a> {
    pub(super) fn new(
        context: &'a WorkContext<'a>,
        request: &'a ChartRequest,
        truth: &'a Truth<'a>,
        read: Read,
    ) -> Self {
        Self { context, request, truth, read, last: None, passes: Vec::new() }
    }

    /// For the same surface from elsewhere.
    pub(super) fn into_read(self) -> Read {
        self.read
    }

    /// Unless its sweep has taken too long.
    pub(super) fn show(&mut self, candidate: &Candidate) -> Result<Shown> {
        let beside = self.last.filter(|(last, _)| last.is_beside(candidate));
        let [took, spent, setup] = beside.map_or([0.0; 3], |(_, times)| times);
        let pixels = f64::from(self.request.truth.width) * f64::from(self.request.truth.height);
        refuse_slow(took, spent, MOST_MS * (pixels / SMALL).max(1.0))?;
        let mut shown = self.shown(candidate)?;
        // What the first made, the others found.
        shown.point.setup_ms = shown.point.setup_ms.max(setup);
        self.last = Some((*candidate, [shown.took_ms, spent + shown.took_ms, shown.point.setup_ms]));
        Ok(shown)
    }

    fn shown(&mut self, candidate: &Candidate) -> Result<Shown> {
        let mut request = candidate.request(&self.request.truth);
        if let Setting::TolerancePx(px) = candidate.setting {
            let size = [request.width, request.height];
            request.surface.geometry.refinement = lens::within(px, &self.truth.camera, size);
        }
        let mut inputs = self.inputs(&request)?;
        let runs = self.runs(&mut inputs, &request);
        self.read.put(candidate.method, inputs);
        self.compared(candidate, &runs?)
    }

    /// What methods of its kind read is read once.
    fn inputs(&mut self, request: &RenderRequest) -> Result<Inputs> {
        let (context, surface) = (self.context, &request.surface);
        let mut inputs = match self.read.take(surface.method) {
            Some(inputs) => inputs,
            None => Inputs::load(context.assets, context.limits, &quiet(context), surface)?,
        };
        inputs::add_times(&mut self.passes, inputs.take_passes());
        inputs.plans = Plans::make(&mut inputs.scene, &surface.geometry, context.limits)?;
        planned(&inputs, context.limits, request)?;
        Ok(inputs)
    }

    fn runs(&self, inputs: &mut Inputs, request: &RenderRequest) -> Result<Runs> {
        let (surfaces, geometry) = self.surfaces(inputs, request)?;
        let (scene, plan) = self.scene(inputs, request, surfaces)?;
        let (mut images, [image, setup]) = self.image(&plan, &scene)?;
        let mut took = vec![Took { geometry, image, setup }];
        while took.len() < self.request.repeats as usize && all_of(&took) < ENOUGH_MS {
            self.context.cancel.check()?;
            let (_, geometry) = self.surfaces(inputs, request)?;
            let (again, [image, setup]) = self.image(&plan, &scene)?;
            took.push(Took { geometry, image, setup });
            images = again;
        }
        let (triangles, vertices) = (inputs.plans.triangles(), inputs.plans.vertices());
        Ok(Runs { images, took, triangles, vertices, scene_bytes: scene.contents().scene_bytes() })
    }

    fn surfaces(&self, inputs: &mut Inputs, request: &RenderRequest) -> Result<(Vec<Surface>, f64)> {
        let context = WorkContext { progress: &NoProgress, ..*self.context };
        let (mut surfaces, mut times) = inputs.displaced(&context)?;
        for one in surfaces.iter_mut().enumerate() {
            bumps::keep_base_normals(&context, inputs, &request.surface.geometry, one, &mut times)?;
        }
        Ok((surfaces, sum_of(&times, |name| name != COMPILE)))
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

    /// The image, and what it and its setup took.
    fn image(&self, plan: &ImagePlan, scene: &RenderScene) -> Result<(ImageSet, [f64; 2])> {
        let (images, times) = self.context.executor.render(&quiet(self.context), plan, scene)?;
        let is_setup = |name: &str| SETUP.contains(&name);
        let image = sum_of(&times, |name| name != COMPILE && !is_setup(name));
        Ok((images, [image, sum_of(&times, is_setup)]))
    }

    fn compared(&self, candidate: &Candidate, runs: &Runs) -> Result<Shown> {
        let picture = Picture::of_images("image", &runs.images)?;
        let (mut error, differences) = metrics::compare(&self.truth.picture, &picture, self.context.cancel)?;
        let apart = || hit_error(&self.truth.towards(&picture), &picture).map(|error| error.p99);
        error.hit_error_px = self.truth.reprojected_px(&runs.images).or_else(apart);
        let took = median(&runs.took).ok_or_else(|| Error::internal("a setting was never run"))?;
        let point = Point {
            name: candidate.name(),
            method: candidate.method.name().into(),
            setting: candidate.setting(),
            triangles: runs.triangles,
            vertices: runs.vertices,
            counters: runs.images.counters,
            scene_bytes: runs.scene_bytes,
            ms: took.ms(),
            ms_spread: spread(&runs.took),
            geometry_ms: took.geometry,
            image_ms: took.image,
            setup_ms: setup_of(&runs.took),
            runs: runs.took.len() as u32,
            error,
            fronts: Vec::new(),
            predicted_px: None,
            chosen: false,
        };
        let difference = encode::encode_rgb8(differences.width, differences.height, &differences.colors())?;
        let took_ms = all_of(&runs.took);
        Ok(Shown { candidate: *candidate, point, took_ms, image: truth::png(&runs.images)?, difference })
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
