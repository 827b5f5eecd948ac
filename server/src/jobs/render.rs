//! The job that makes images: as `displace` up to the surface, then render and encode.

use super::{
    AssetReader, JobLimits, Output, Work, WorkContext, WorkOutput, images, inputs, inputs::Inputs, seams, strain,
    work::canonical,
};
use crate::{
    domain::{
        Result, camera,
        cancel::{Cancel, NoProgress},
        encode,
        image::{ImageContents, ImagePlan},
        report::{Estimate, Report},
        request::{ImageFormat, RenderRequest},
    },
    render::JobContext,
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
        let inputs: u64 = self.request.surface.assets().iter().map(|asset| asset.size_bytes).sum();
        inputs + image_bytes(&self.request)
    }

    fn run(&self, context: &WorkContext<'_>) -> Result<WorkOutput> {
        let request = &self.request;
        let mut inputs = Inputs::load(context.assets, context.limits, &context.job(), &request.surface)?;
        planned(&inputs, context.limits, request)?;
        let (surfaces, mut passes) = inputs.displaced(context)?;
        let device = context.executor.device_name().to_owned();
        let mut report = Report { method: self.method().into(), device, ..inputs.counts() };
        inputs::timed(context.progress, "check_surface", &mut passes, || {
            seams::describe(&mut report, &mut inputs.scene, &surfaces);
            strain::describe(&mut report, &mut inputs.scene, &surfaces);
            Ok(())
        })?;
        context.cancel.check()?;
        let decode = || images::render_scene(request, &mut inputs.scene, surfaces);
        let scene = inputs::timed(context.progress, "decode_images", &mut passes, decode)?;
        let plan = ImagePlan::new(request.width, request.height, &scene.contents())?;
        let (images, times) = context.executor.render(&context.job(), &plan, &scene)?;
        inputs::add_times(&mut passes, times);
        let files = inputs::timed(context.progress, "encode", &mut passes, || encode::encode(&images, request.format))?;
        report.warnings = inputs.scene.warnings;
        report.passes = passes;
        let ending = match request.format {
            ImageFormat::Png => "png",
            ImageFormat::Exr => "exr",
        };
        let outputs = files.into_iter().map(|file| Output {
            name: format!("{}.{ending}", file.name),
            media_type: file.media_type.into(),
            bytes: file.bytes.into(),
        });
        Ok(WorkOutput { report, outputs: outputs.collect() })
    }
}

/// The image's plan as far as it is known before the work, its base colour maps excepted; refuses what can be
/// refused before it.
fn planned(inputs: &Inputs, limits: &JobLimits, request: &RenderRequest) -> Result<ImagePlan> {
    camera::check(&request.camera, &inputs.scene)?;
    let geometry = inputs.estimate();
    let (instance_vertices, instance_triangles) = inputs.instanced();
    let contents = ImageContents {
        vertices: geometry.vertices,
        triangles: geometry.triangles,
        instance_vertices,
        instance_triangles,
        aovs: request.aovs.clone(),
        ..ImageContents::default()
    };
    let plan = ImagePlan::new(request.width, request.height, &contents)?;
    if plan.device_bytes > limits.device_bytes {
        return Err(inputs::too_large("device memory", plan.device_bytes, limits.device_bytes));
    }
    Ok(plan)
}

fn image_bytes(request: &RenderRequest) -> u64 {
    u64::from(request.width) * u64::from(request.height) * BYTES_PER_PIXEL
}

pub(super) fn estimate(assets: &dyn AssetReader, limits: &JobLimits, request: &RenderRequest) -> Result<Estimate> {
    let inputs = Inputs::load(
        assets,
        limits,
        &JobContext { cancel: &Cancel::default(), progress: &NoProgress },
        &request.surface,
    )?;
    let geometry = inputs.estimate();
    let plan = planned(&inputs, limits, request)?;
    Ok(Estimate {
        device_bytes: geometry.device_bytes.max(plan.device_bytes),
        output_bytes: geometry.output_bytes + image_bytes(request),
        ..geometry
    })
}
