//! The job that makes images: as `displace` up to the surface, then render and encode.

use displace_glsl::{layout::raster::MAP_BASE_COLOR, reference::composite::MAX_LAYERS};

use super::{
    AssetReader, BUILD_ID, JobLimits, Output, Work, WorkContext, WorkOutput,
    auto::{self, Desk, Settled},
    breakdown, bumps, calibration, exact, fits, images, inputs,
    inputs::Inputs,
    looks, plans, reliefs, seams, strain,
    work::canonical,
};
use crate::{
    domain::{
        Error, Result, camera,
        cancel::{Cancel, NoProgress},
        choice::Choice,
        cost::CostModel,
        encode,
        image::{
            ImageContents, ImagePlan, ImageSet, ImageSettings, Lighting, RenderCamera, RenderMaterial, RenderScene,
            Silhouettes,
        },
        projection::Projection,
        report::{Estimate, PassTime, Report, Warning},
        request::{Aov, ImageFormat, Method, RenderRequest, Shadows},
    },
    oracle::{self, image::Exposure},
    render::{Executor, JobContext, reference_image::preimage},
};

/// Host bytes of a pixel while it is resolved and encoded: linear RGBA f32, and AOVs of up to three f32.
const BYTES_PER_PIXEL: u64 = 16 + 5 * 12;

pub(super) struct RenderWork {
    pub(super) request: RenderRequest,
}

impl Work for RenderWork {
    fn kind(&self) -> &'static str {
        "render"
    }

    fn method(&self) -> &'static str {
        self.request.surface.method.name()
    }

    fn canonical(&self) -> Vec<u8> {
        canonical(&self.request)
    }

    fn host_bytes(&self) -> u64 {
        let inputs: u64 = self.request.assets().iter().map(|asset| asset.size_bytes).sum();
        inputs + image_bytes(&self.request)
    }

    fn run(&self, context: &WorkContext<'_>) -> Result<WorkOutput> {
        let request = &self.request;
        refuse_rays(request, context.executor)?;
        let model = self.model(context)?;
        let job = context.job();
        let (assets, limits, traces_rays) = (context.assets, context.limits, context.executor.traces_rays());
        let desk = Desk { assets, limits, job: &job, model, traces_rays };
        let mut settled = auto::settle(desk, request)?;
        let (mut report, mut taken) = taken(context, &mut settled)?;
        if !settled.measure(desk, &taken.images)? {
            let missed = std::mem::take(&mut taken.passes);
            settled = auto::displace_all(desk, request, &settled, MISSED)?;
            (report, taken) = self::taken(context, &mut settled)?;
            inputs::add_times(&mut taken.passes, missed);
        }
        let Taken { mut images, settings, mut passes, preimage } = taken;
        keep_asked(&mut images, request);
        let encode = || encode::encode_with(&images, request.format, Some(&settings));
        let files = inputs::timed(context.progress, "encode", &mut passes, encode)?;
        report.warnings = settled.inputs.scene.warnings;
        report.passes = settled.passes;
        inputs::add_times(&mut report.passes, passes);
        report.choices = settled.choices;
        let ending = match request.format {
            ImageFormat::Png => "png",
            ImageFormat::Exr => "exr",
        };
        let outputs = files.into_iter().map(|file| Output {
            name: format!("{}.{ending}", file.name),
            media_type: file.media_type.into(),
            bytes: file.bytes.into(),
        });
        let preimage = preimage.map(|png| Output {
            name: "preimage.png".into(),
            media_type: "image/png".into(),
            bytes: png.into(),
        });
        Ok(WorkOutput { report, outputs: outputs.chain(preimage).collect() })
    }
}

/// Why what was chosen is not what is shown.
const MISSED: &str = "what was chosen was measured to be off by more than the tolerance, so that all is displaced";

/// What a settled request shows.
fn taken(context: &WorkContext<'_>, settled: &mut Settled) -> Result<(Report, Taken)> {
    let aovs = settled.measured_aovs();
    let Settled { request, inputs, camera, choices, .. } = settled;
    reliefs::check(inputs, request, context)?;
    with_samples(planned(inputs, context.limits, request)?, request, context)?;
    let device = context.executor.device_name().to_owned();
    let mut report = Report { method: shown_by(request, choices), device, ..Report::default() };
    inputs.count(&mut report);
    let taking = Taking { request, camera: *camera, aovs };
    let take = if request.surface.geometry.is_exact() { Taking::take_exactly } else { Taking::take };
    let taken = take(&taking, context, inputs, &mut report)?;
    Ok((report, taken))
}

/// One name where one method shows all.
fn shown_by(request: &RenderRequest, choices: &[Choice]) -> String {
    let mut names = choices.iter().map(|choice| choice.chosen.method.as_str());
    match names.next() {
        None => request.surface.method.name().into(),
        Some(first) if names.all(|name| name == first) => first.into(),
        Some(_) => Method::Auto.name().into(),
    }
}

/// Nothing that was made to be measured alone.
fn keep_asked(images: &mut ImageSet, request: &RenderRequest) {
    let asked = |aov| request.aovs.contains(&aov);
    if !asked(Aov::Triangle) {
        images.triangle = None;
    }
    if !asked(Aov::Depth) {
        images.depth = None;
    }
    if !asked(Aov::Position) {
        images.position = None;
    }
    if !asked(Aov::Uv) {
        images.uv = None;
    }
}

/// A settled request that is made an image.
struct Taking<'a> {
    request: &'a RenderRequest,
    /// Else what is made decides.
    camera: Option<RenderCamera>,
    /// Besides those asked for.
    aovs: &'static [Aov],
}

/// An image, and how it was taken.
struct Taken {
    images: ImageSet,
    settings: ImageSettings,
    passes: Vec<PassTime>,
    /// As PNG.
    preimage: Option<Vec<u8>>,
}

impl RenderWork {
    /// What a choice goes by.
    fn model(&self, context: &WorkContext<'_>) -> Result<CostModel> {
        if self.request.surface.method == Method::Auto { calibration::of(context) } else { Ok(CostModel::default()) }
    }
}

impl Taking<'_> {
    /// Of triangles. Where a plan could not count them, the image is planned again once they are made.
    fn take(&self, context: &WorkContext<'_>, inputs: &mut Inputs, report: &mut Report) -> Result<Taken> {
        let request = self.request;
        let (mut surfaces, mut passes) = inputs.displaced(context)?;
        inputs.count(report);
        planned(inputs, context.limits, request)?;
        inputs::timed(context.progress, "check_surface", &mut passes, || {
            let Inputs { scene, plans, details, .. } = inputs;
            let made = fits::Made { plans: plans.each(), surfaces: &surfaces, details, grids: &[] };
            fits::describe(report, scene, made, &request.surface.geometry, context.cancel)?;
            seams::describe(report, &mut inputs.scene, &surfaces);
            strain::describe(report, &mut inputs.scene, &surfaces);
            Ok(())
        })?;
        for one in surfaces.iter_mut().enumerate() {
            bumps::keep_base_normals(context, inputs, &request.surface.geometry, one, &mut passes)?;
        }
        context.cancel.check()?;
        let decode = || {
            let environment = looks::environment(&request.look, context.assets)?;
            // Rays show every normal.
            let traces = request.rays().is_some() && context.executor.traces_rays();
            let moments = request.look.moments && !traces;
            let shown = (&inputs.bumps, &inputs.reliefs);
            images::render_scene(request, &mut inputs.scene, shown, surfaces, environment, moments)
        };
        let mut scene = inputs::timed(context.progress, "decode_images", &mut passes, decode)?;
        scene.camera = self.camera.unwrap_or(scene.camera);
        if self.camera.is_none() {
            let found = inputs::timed(context.progress, "predict", &mut passes, || {
                breakdown::warnings(context, inputs, request, &scene.camera)
            })?;
            inputs.scene.warnings.extend(found);
        }
        for aov in self.aovs.iter().chain(request.preimage.map(|_| &Aov::Triangle)) {
            if !scene.aovs.contains(aov) {
                scene.aovs.push(*aov);
            }
        }
        let plan = with_samples(ImagePlan::new(request.width, request.height, &scene.contents())?, request, context)?;
        refuse_projected_shadows(&plan, &scene)?;
        let (images, times) = context.executor.render(&context.job(), &plan, &scene)?;
        report.counters = images.counters;
        inputs::add_times(&mut passes, times);
        if images.layers_left_out {
            inputs.scene.warnings.push(layers_left_out());
        }
        let preimage = request.preimage.map(|pixel| drawn(pixel, &plan, &scene, &images)).transpose()?;
        let samples = plan.rays.map_or(plan.samples * plan.supersample.pow(2), |rays| rays.samples);
        let settings = self.settings(samples, scene.lighting.clone(), 0.0, context.executor);
        Ok(Taken { images, settings, passes, preimage })
    }

    /// Of the surface itself.
    fn take_exactly(&self, context: &WorkContext<'_>, inputs: &mut Inputs, report: &mut Report) -> Result<Taken> {
        let request = self.request;
        let mut passes = Vec::new();
        let scene = inputs::timed(context.progress, "dice", &mut passes, || {
            exact::scene(context, inputs, request, exact::RESIDUAL_PX)
        })?;
        report.triangles = scene.meshes.iter().map(|mesh| mesh.triangles.len() as u64).sum();
        report.vertices = scene.meshes.iter().map(|mesh| mesh.positions.len() as u64).sum();
        let rays = request.rays().ok_or_else(|| Error::internal("an exact image without rays"))?;
        let shadows = rays.shadows != Shadows::None;
        let exposure = Exposure { width: request.width, height: request.height, samples: rays.samples, shadows };
        let trace = || oracle::image::render(&scene, &exposure, context.cancel, context.progress);
        let images = inputs::timed(context.progress, "image", &mut passes, trace)?;
        let settings = self.settings(rays.samples, scene.lighting.clone(), scene.residual_world(), context.executor);
        Ok(Taken { images, settings, passes, preimage: None })
    }

    fn settings(
        &self,
        samples: u32,
        lighting: Lighting,
        residual_world: f64,
        executor: &dyn Executor,
    ) -> ImageSettings {
        let shadows = self.request.look.shadows;
        let device = executor.device_name().into();
        ImageSettings { samples, shadows, lighting, device, build: BUILD_ID.into(), residual_world }
    }
}

/// Rays towards lights read cut-outs at texture coordinates.
pub(super) fn refuse_projected_shadows(plan: &ImagePlan, scene: &RenderScene) -> Result<()> {
    let cuts = |material: &RenderMaterial| material.alpha.cutoff() > 0.0 && material.maps[MAP_BASE_COLOR].is_some();
    let reads = scene.projection != Projection::Uv && scene.shadows == Shadows::Ray;
    if !reads || plan.rays.is_some() || !scene.materials.iter().any(cuts) {
        return Ok(());
    }
    let message = "some materials have holes where their map is transparent, and shadows by rays see these at texture coordinates alone: take shadows map or none, or samples on the device reference";
    Err(Error::unsupported("surface.look.projection", message))
}

/// A pixel on the map that it shows.
fn drawn(pixel: [u32; 2], plan: &ImagePlan, scene: &RenderScene, images: &ImageSet) -> Result<Vec<u8>> {
    let [x, y] = pixel;
    let place = y as usize * images.width as usize + x as usize;
    let seen = images.triangle.as_ref().map(|triangles| triangles[place]);
    let Some(triangle) = seen.filter(|triangle| *triangle != u32::MAX) else {
        return Err(Error::invalid("preimage", format!("pixel {x},{y} shows nothing: choose one on the surface")));
    };
    preimage(plan, scene, pixel, triangle)?.draw()
}

pub(super) fn layers_left_out() -> Warning {
    let message = format!(
        "in places more than {MAX_LAYERS} blended surfaces lie one behind the other, and those farther away are not shown: --alpha stochastic or mask shows all"
    );
    Warning::new("layers_left_out", message)
}

/// The image's plan as far as it is known, its maps excepted: before the work, of what the surfaces have
/// at least. Refuses what can be refused by it.
pub(super) fn planned(inputs: &Inputs, limits: &JobLimits, request: &RenderRequest) -> Result<ImagePlan> {
    camera::check(&request.camera, &inputs.scene)?;
    let (instance_vertices, instance_triangles) = inputs.plans.instanced(&inputs.scene);
    let silhouettes = reliefs::settings(request, &inputs.reliefs).silhouettes;
    let is_outlined = silhouettes != Silhouettes::None && reliefs::cover(inputs);
    let contents = ImageContents {
        vertices: inputs.plans.vertices(),
        triangles: inputs.plans.triangles(),
        instance_vertices,
        instance_triangles,
        outlined: if is_outlined { [inputs.plans.triangles(), instance_triangles] } else { [0; 2] },
        silhouettes,
        relief_texels: inputs.reliefs.texels(),
        aovs: request.aovs.clone(),
        ..ImageContents::default()
    };
    let plan = ImagePlan::new(request.width, request.height, &contents)?;
    if plan.device_bytes > limits.device_bytes {
        let geometry = &request.surface.geometry;
        return Err(plans::too_large(geometry, "device memory", plan.device_bytes, limits.device_bytes));
    }
    Ok(plan)
}

/// A device that traces takes samples as rays; others make a finer image and average it.
pub(super) fn with_samples(plan: ImagePlan, request: &RenderRequest, context: &WorkContext<'_>) -> Result<ImagePlan> {
    match (request.rays(), request.samples) {
        (Some(rays), _) if context.executor.traces_rays() => {
            refuse_counts(request)?;
            Ok(ImagePlan { rays: Some(rays), ..plan })
        }
        (_, Some(samples)) => plan.with_samples(samples),
        _ => Ok(plan),
    }
}

/// Rays cover nothing that could be counted.
fn refuse_counts(request: &RenderRequest) -> Result<()> {
    let Some(n) = request.aovs.iter().position(|aov| aov.is_of_rasteriser()) else { return Ok(()) };
    let message =
        format!("{:?} tells of the rasteriser, and this image is traced: leave it or the samples out", request.aovs[n]);
    Err(Error::unsupported(format!("aovs[{n}]"), message))
}

/// Before any work: the surface itself is seen by rays, and not every device traces.
fn refuse_rays(request: &RenderRequest, executor: &dyn Executor) -> Result<()> {
    if !request.surface.geometry.is_exact() {
        return Ok(());
    }
    if request.preimage.is_some() {
        let message = "is of triangles, and the surface itself has none: leave it out, or geometry.exact";
        return Err(Error::unsupported("preimage", message));
    }
    if executor.traces_rays() {
        return Ok(());
    }
    let device = executor.device_name();
    let message = format!("the surface itself is more than {device} does; use --device reference, or leave it out");
    Err(Error::unsupported("surface.geometry.exact", message))
}

pub(super) fn image_bytes(request: &RenderRequest) -> u64 {
    u64::from(request.width) * u64::from(request.height) * BYTES_PER_PIXEL
}

pub(super) fn estimate(assets: &dyn AssetReader, limits: &JobLimits, request: &RenderRequest) -> Result<Estimate> {
    let job = JobContext { cancel: &Cancel::default(), progress: &NoProgress };
    let desk = Desk { assets, limits, job: &job, model: CostModel::default(), traces_rays: false };
    let Settled { inputs, request, .. } = auto::settle(desk, request)?;
    let geometry = inputs.estimate();
    let plan = planned(&inputs, limits, &request)?;
    Ok(Estimate {
        device_bytes: geometry.device_bytes.map(|bytes| bytes.max(plan.device_bytes)),
        output_bytes: geometry.output_bytes.map(|bytes| bytes + image_bytes(&request)),
        ..geometry
    })
}
