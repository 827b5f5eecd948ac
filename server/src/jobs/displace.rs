//! The job that makes displaced geometry: load, plan, execute, write.

use super::{
    AssetReader, JobLimits, Output, Work, WorkContext, WorkOutput, bumps, fits, inputs, inputs::Inputs, levels,
    normal_maps, packing, seams, strain, work::canonical,
};
use crate::{
    domain::{
        Digest, Result,
        cancel::{Cancel, NoProgress},
        describe::{self, Description},
        gltf::{self, Contents, NormalMap},
        report::{Estimate, PassTime, Report},
        request::DisplaceRequest,
        surface::Surface,
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
        bumps::refuse_in_files(&inputs.bumps, &self.request)?;
        let (mut surfaces, mut passes) = inputs.displaced(context)?;
        let mut report = self.report(context, &inputs);
        let packing = inputs::timed(context.progress, "check_surface", &mut passes, || {
            let Inputs { scene, plans, details, .. } = &mut inputs;
            let packing = packing::choose(scene, plans.each(), &mut surfaces, self.request.compression);
            let made = fits::Made { plans: plans.each(), surfaces: &surfaces, details, grids: &packing.grids };
            fits::describe(&mut report, scene, made, &self.request.geometry, context.cancel)?;
            seams::describe(&mut report, &mut inputs.scene, &surfaces);
            strain::describe(&mut report, &mut inputs.scene, &surfaces);
            Ok(packing)
        })?;
        for one in surfaces.iter_mut().enumerate() {
            bumps::keep_base_normals(context, &inputs, &self.request.geometry, one, &mut passes)?;
        }
        let normal_maps = self.normal_maps(context, &inputs, &surfaces, &mut report, &mut passes)?;
        let levels = levels::make(context, &mut inputs, &surfaces, &self.request, &mut passes)?;
        report.lods = levels.report;
        report.normal_maps.extend(levels.normal_maps);
        context.cancel.check()?;
        let displaced = inputs.displaced_materials();
        gltf::forget_displacement(&mut inputs.scene, &displaced);
        let written = inputs::timed(context.progress, "write_glb", &mut passes, || {
            let (packing, chains, normal_maps) = (&packing, &levels.chains[..], &normal_maps[..]);
            gltf::write_contents(&inputs.scene, &Contents { surfaces: &surfaces, packing, chains, normal_maps })
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
    /// Of each mesh, of each of its primitives.
    fn normal_maps(
        &self,
        context: &WorkContext<'_>,
        inputs: &Inputs,
        surfaces: &[Surface],
        report: &mut Report,
        passes: &mut Vec<PassTime>,
    ) -> Result<Vec<Vec<Option<NormalMap>>>> {
        let mut maps = Vec::with_capacity(surfaces.len());
        for one in surfaces.iter().enumerate() {
            let made = normal_maps::make(context, inputs, &self.request.geometry, one, 0, passes)?;
            report.normal_maps.extend(made.report);
            maps.push(made.maps);
        }
        Ok(maps)
    }

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
    let job = JobContext { cancel: &Cancel::default(), progress: &NoProgress };
    let inputs = Inputs::load(assets, limits, &job, request)?;
    bumps::refuse_in_files(&inputs.bumps, request)?;
    Ok(inputs.estimate())
}
