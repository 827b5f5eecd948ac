//! One setting after the other: made several times, measured, and compared with the truth.

use super::{truth, truth::Truth};
use crate::{
    domain::{
        Error, ErrorKind, Result,
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
    oracle::metrics::{self, picture::Picture},
    render::JobContext,
};

/// What has taken as long is not run again, milliseconds.
const ENOUGH_MS: f64 = 500.0;
/// What settings of one sweep may take together for each `SMALL` pixels, milliseconds; images of fewer count as many.
const MOST_MS: f64 = 8000.0;
const SMALL: f64 = 65536.0;
/// The pass that no method is charged with.
const COMPILE: &str = "compile";
/// Passes that maps and light need once, however many images follow.
const SETUP: [&str; 4] = ["mip", "cone_map", "brdf_table", "brdf_averages"];

pub(super) struct Sweep<'a> {
    context: &'a WorkContext<'a>,
    request: &'a ChartRequest,
    truth: &'a Truth,
    /// What was read for one kind of methods; they come kind by kind.
    read: Option<(Method, Inputs)>,
    /// The last setting, what it took, and what its sweep has taken so far.
    last: Option<(Candidate, [f64; 2])>,
    pub(super) passes: Vec<PassTime>,
}

/// A point and its pictures, as PNG.
pub(super) struct Shown {
    pub(super) point: Point,
    /// All runs, with what they were set up by.
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

/// What one run took, milliseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Took {
    geometry: f64,
    image: f64,
    setup: f64,
}

impl Took {
    fn ms(&self) -> f64 {
        self.geometry + self.image
    }
}

impl<'a> Sweep<'a> {
    pub(super) fn new(context: &'a WorkContext<'a>, request: &'a ChartRequest, truth: &'a Truth) -> Self {
        Self { context, request, truth, read: None, last: None, passes: Vec::new() }
    }

    /// Unless its sweep has taken too long.
    pub(super) fn show(&mut self, candidate: &Candidate) -> Result<Shown> {
        let beside = self.last.filter(|(last, _)| last.is_beside(candidate));
        let [took, spent] = beside.map_or([0.0; 2], |(_, times)| times);
        let pixels = f64::from(self.request.truth.width) * f64::from(self.request.truth.height);
        refuse_slow(took, spent, MOST_MS * (pixels / SMALL).max(1.0))?;
        let shown = self.shown(candidate)?;
        self.last = Some((*candidate, [shown.took_ms, spent + shown.took_ms]));
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
        let (error, differences) = metrics::compare(&self.truth.picture, &picture, self.context.cancel)?;
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
            setup_ms: took.setup,
            runs: runs.took.len() as u32,
            error,
            fronts: Vec::new(),
            predicted_px: None,
            chosen: false,
        };
        let difference = encode::encode_rgb8(differences.width, differences.height, &differences.colors())?;
        let took_ms = all_of(&runs.took);
        Ok(Shown { point, took_ms, image: truth::png(&runs.images)?, difference })
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

/// Fails where one more setting like the last would take too long.
fn refuse_slow(took_ms: f64, spent_ms: f64, most_ms: f64) -> Result<()> {
    if spent_ms + took_ms <= most_ms {
        return Ok(());
    }
    let message = format!(
        "its method has taken {:.1} s for other settings, and one more would make it more than {:.0} s: take a faster device or a smaller map",
        spent_ms / 1e3,
        most_ms / 1e3
    );
    Err(Error::new(ErrorKind::TooLarge, message))
}

fn all_of(runs: &[Took]) -> f64 {
    runs.iter().map(|took| took.ms() + took.setup).sum()
}

fn sum_of(times: &[PassTime], counts: impl Fn(&str) -> bool) -> f64 {
    times.iter().filter(|time| counts(&time.name)).map(|time| time.ms).sum()
}

/// The run in the middle, of two the faster.
fn median(runs: &[Took]) -> Option<Took> {
    let mut runs = runs.to_vec();
    runs.sort_by(|a, b| a.ms().total_cmp(&b.ms()));
    runs.get(runs.len().saturating_sub(1) / 2).copied()
}

fn spread(runs: &[Took]) -> Option<f64> {
    let ms = runs.iter().map(Took::ms);
    let [least, most] = ms.fold([f64::INFINITY, 0.0], |[least, most]: [f64; 2], ms| [least.min(ms), most.max(ms)]);
    (runs.len() > 1).then_some(most - least)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn took(geometry: f64, image: f64) -> Took {
        Took { geometry, image, setup: 100.0 * geometry }
    }

    #[test]
    fn the_run_in_the_middle_counts_whole() {
        assert_eq!(median(&[took(1.0, 5.0), took(4.0, 1.0), took(0.5, 9.0)]), Some(took(1.0, 5.0)));
        assert_eq!(median(&[took(1.0, 5.0), took(4.0, 1.0)]), Some(took(4.0, 1.0)));
        assert_eq!(median(&[]), None);
    }

    #[test]
    fn one_run_has_no_spread() {
        assert_eq!(spread(&[took(1.0, 2.0)]), None);
        assert_eq!(spread(&[took(1.0, 2.0), took(1.0, 4.0), took(0.0, 2.5)]), Some(2.5));
    }

    #[test]
    fn a_method_that_takes_too_long_is_not_asked_again() {
        assert!(refuse_slow(0.0, 0.0, 8000.0).is_ok() && refuse_slow(2000.0, 6000.0, 8000.0).is_ok());
        let error = refuse_slow(5000.0, 5000.0, 8000.0).unwrap_err();
        assert!(error.message.contains("5.0 s") && error.message.contains("8 s"), "{error}");
    }
}
