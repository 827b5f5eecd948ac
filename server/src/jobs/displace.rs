//! The job that makes displaced geometry: load, plan, execute, write.

use super::{
    AssetReader, JobLimits, Output, Work, WorkContext, WorkOutput, fits, inputs, inputs::Inputs, levels, packing,
    seams, strain, work::canonical,
};
use crate::{
    domain::{
        Digest, Result,
        cancel::{Cancel, NoProgress},
        describe::{self, Description},
        gltf,
        report::{Estimate, Report},
        request::DisplaceRequest,
    },
    render::JobContext,
};

pub(super) struct DisplaceWork {
    pub(super) request: DisplaceRequest,
}

impl Work for DisplaceWork {
    fn kind(&self) -> &'static str {
        "displace"
    }

    fn method(&self) -> &'static str {
        self.request.method.name()
    }

    fn canonical(&self) -> Vec<u8> {
        canonical(&self.request)
    }

    fn host_bytes(&self) -> u64 {
        self.request.assets().iter().map(|asset| asset.size_bytes).sum()
    }

    fn run(&self, context: &WorkContext<'_>) -> Result<WorkOutput> {
        let mut inputs = Inputs::load(context.assets, context.limits, &context.job(), &self.request)?;
        let (mut surfaces, mut passes) = inputs.displaced(context)?;
        let mut report = self.report(context, &inputs);
        let packing = inputs::timed(context.progress, "check_surface", &mut passes, || {
            let Inputs { scene, plans, .. } = &mut inputs;
            let packing = packing::choose(scene, plans.each(), &mut surfaces, self.request.compression);
            fits::describe(&mut report, scene, plans.each(), &surfaces, &self.request.geometry);
            seams::describe(&mut report, &mut inputs.scene, &surfaces);
            strain::describe(&mut report, &mut inputs.scene, &surfaces);
            Ok(packing)
        })?;
        let levels = levels::make(context, &mut inputs, &surfaces, &self.request, &mut passes)?;
        report.lods = levels.report;
        context.cancel.check()?;
        let displaced = inputs.displaced_materials();
        gltf::forget_displacement(&mut inputs.scene, &displaced);
        let written = inputs::timed(context.progress, "write_glb", &mut passes, || {
            gltf::write_lods(&inputs.scene, &surfaces, &packing, &levels.chains)
        })?;
        report.warnings = inputs.scene.warnings;
        report.warnings.extend(written.warnings);
        report.passes = passes;
        let output =
            Output { name: "mesh.glb".into(), media_type: "model/gltf-binary".into(), bytes: written.bytes.into() };
        Ok(WorkOutput { report, outputs: vec![output] })
    }
}

impl DisplaceWork {
    fn report(&self, context: &WorkContext<'_>, inputs: &Inputs) -> Report {
        let device = context.executor.device_name().to_owned();
        let mut report = Report { method: self.method().into(), device, ..Report::default() };
        inputs.count(&mut report);
        report
    }
}

pub(super) fn describe(assets: &dyn AssetReader, mesh: &Digest, resources: &[(String, Digest)]) -> Result<Description> {
    Ok(describe::describe(&inputs::scene(assets, mesh, resources)?))
}

pub(super) fn estimate(assets: &dyn AssetReader, limits: &JobLimits, request: &DisplaceRequest) -> Result<Estimate> {
    Ok(Inputs::load(assets, limits, &JobContext { cancel: &Cancel::default(), progress: &NoProgress }, request)?
        .estimate())
}
