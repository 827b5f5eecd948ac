//! The job that measures a mesh against another, or against the surface a detail describes. No device: the oracle
//! works on the job's thread and its helpers.

use super::{
    Output, Work, WorkContext, WorkOutput,
    inputs::{self, Inputs, timed},
    work::canonical,
};
use crate::{
    domain::{
        Error, ErrorKind, Result, gltf,
        gltf::Painted,
        report::Report,
        request::{Base, MeasureRequest, Method},
        scene::Scene,
    },
    oracle::{
        dicing::{Dicing, Limits, dice},
        measure::{colors, measure},
        samples::around_vertices,
        sheet::{Sheet, SheetBuilder, enlargement},
        surface::{SeamChoice, Surface},
    },
};

/// Triangles a surface is diced into at most, over all meshes; it is known more exactly where that decides.
const MOST_TRIANGLES: usize = 3_000_000;
/// A surface is first diced to so many times the precision: cut along its texels, where blind halves converge slowly.
const COARSE: f64 = 0.5;
/// Triangles of one of the two, all instances together.
const MOST_MEASURED: usize = 20_000_000;
/// From one attempt to the next, where a dicing does not fit.
const COARSER: f64 = 8.0;
/// Colours of the scale beside a painted mesh.
const SCALE_STEPS: usize = 33;

pub(super) struct MeasureWork {
    pub(super) request: MeasureRequest,
}

impl Work for MeasureWork {
    fn kind(&self) -> &'static str {
        "measure"
    }

    fn method(&self) -> &'static str {
        "meshes"
    }

    fn canonical(&self) -> Vec<u8> {
        canonical(&self.request)
    }

    fn host_bytes(&self) -> u64 {
        self.request.assets().iter().map(|asset| asset.size_bytes).sum()
    }

    fn run(&self, context: &WorkContext<'_>) -> Result<WorkOutput> {
        let request = &self.request;
        let mut passes = Vec::new();
        let reference = Inputs::load(context.assets, context.limits, &context.job(), &request.reference)?;
        let read = || inputs::scene(context.assets, &request.mesh, &request.resources);
        let scene = timed(context.progress, "read_result", &mut passes, read)?;
        context.cancel.check()?;
        let precision = request.precision * reference.scene.diagonal;
        if precision.is_nan() || precision <= 0.0 {
            return Err(Error::invalid("mesh", "has no extent: a precision relative to its diagonal says nothing"));
        }
        let surfaces = self.surfaces(&reference);
        check_size("mesh", &reference.scene, if surfaces.is_empty() { MOST_MEASURED } else { MOST_TRIANGLES })?;
        check_size("result", &scene, MOST_MEASURED)?;
        let dicings =
            timed(context.progress, "dice", &mut passes, || diced(context, &reference, &surfaces, precision))?;
        let a = reference_sheet(&reference.scene, &surfaces, &dicings)?;
        let b = plain_sheet("result", &scene)?;
        let diagonal = reference.scene.diagonal;
        let measured = timed(context.progress, "measure", &mut passes, || {
            measure(&a, &b, precision, diagonal, context.cancel, context.progress)
        })?;
        let mut outputs = Vec::new();
        if request.colors {
            let paint = || painted(&b, &around_vertices(&b, &a, precision, context.cancel)?);
            outputs.push(timed(context.progress, "paint", &mut passes, paint)?);
        }
        let mut warnings = reference.scene.warnings.clone();
        warnings.extend(scene.warnings);
        warnings.extend(measured.warnings);
        let triangles = |sheet: &Sheet<'_>| sheet.triangles.len() as u64;
        let report = Report {
            measurement: Some(measured.measurement),
            triangles_in: triangles(&a),
            triangles: triangles(&b),
            vertices: b.positions.len() as u64,
            warnings,
            passes,
            ..Report::default()
        };
        Ok(WorkOutput { report, outputs })
    }
}

impl MeasureWork {
    /// The surface of each mesh of the reference; none where the mesh itself is the reference.
    fn surfaces<'i>(&self, reference: &'i Inputs) -> Vec<Surface<'i>> {
        let request = &self.request.reference;
        if request.method == Method::Flat && request.geometry.base == Base::Flat {
            return Vec::new();
        }
        let choice = SeamChoice::from(&request.geometry);
        reference.scene.meshes.iter().zip(&reference.details).map(|(m, d)| Surface::new(&m.mesh, d, choice)).collect()
    }
}

/// Triangles of all instances.
fn check_size(field: &str, scene: &Scene, most: usize) -> Result<()> {
    let triangles = |instance: &crate::domain::scene::Instance| scene.meshes[instance.mesh].mesh.triangles.len();
    let total: usize = scene.instances.iter().map(triangles).sum();
    if total <= most {
        return Ok(());
    }
    let message = format!("its instances have {total} triangles; at most {most} are measured here: measure parts");
    Err(Error::too_large(field, message))
}

/// As coarse as it must be to fit. A detail that jumps, or has no bound, is refused in the end.
fn diced(
    context: &WorkContext<'_>,
    reference: &Inputs,
    surfaces: &[Surface<'_>],
    precision: f64,
) -> Result<Vec<Dicing>> {
    // What has no bound at all is found at once this way: nothing else is cut.
    diced_to(context, reference, surfaces, f64::MAX)?;
    let mut residual_world = COARSE * precision;
    loop {
        match diced_to(context, reference, surfaces, residual_world) {
            Err(error) if error.kind == ErrorKind::TooLarge && residual_world < reference.scene.diagonal => {
                residual_world *= COARSER;
            }
            Err(error) if error.kind == ErrorKind::TooLarge => {
                let message = "the surface cannot be bounded: keep the expression away from division by 0 and from steps, or leave the map coarser";
                return Err(Error::invalid("details", message).with_cause(error));
            }
            result => return result,
        }
    }
}

fn diced_to(
    context: &WorkContext<'_>,
    reference: &Inputs,
    surfaces: &[Surface<'_>],
    residual_world: f64,
) -> Result<Vec<Dicing>> {
    let mut left = MOST_TRIANGLES;
    let mut all = Vec::with_capacity(surfaces.len());
    for (mesh, surface) in surfaces.iter().enumerate() {
        let instances = reference.scene.instances.iter().filter(|instance| instance.mesh == mesh);
        let enlarged = instances.map(|instance| enlargement(&instance.world_from_mesh)).fold(0.0, f64::max);
        let uses = reference.scene.instances.iter().filter(|instance| instance.mesh == mesh).count().max(1);
        let limits = Limits { max_triangles: left / uses, ..Limits::default() };
        let wants_more = |region: &crate::oracle::dicing::Region<'_>| region.deviation * enlarged > residual_world;
        let dicing = dice(surface, &limits, context.cancel, &wants_more)?;
        left = left.saturating_sub(dicing.triangles.len() * uses);
        all.push(dicing);
    }
    Ok(all)
}

fn reference_sheet<'s>(scene: &Scene, surfaces: &'s [Surface<'s>], dicings: &'s [Dicing]) -> Result<Sheet<'s>> {
    if surfaces.is_empty() {
        return plain_sheet("mesh", scene);
    }
    let mut builder = SheetBuilder::default();
    for instance in &scene.instances {
        builder.surface(&surfaces[instance.mesh], &dicings[instance.mesh], &instance.world_from_mesh);
    }
    built("mesh", builder)
}

fn plain_sheet<'s>(field: &str, scene: &Scene) -> Result<Sheet<'s>> {
    let mut builder = SheetBuilder::default();
    for instance in &scene.instances {
        builder.mesh(&scene.meshes[instance.mesh].mesh, &instance.world_from_mesh);
    }
    built(field, builder)
}

fn built<'s>(field: &str, builder: SheetBuilder<'s>) -> Result<Sheet<'s>> {
    if builder.is_finite() {
        return Ok(builder.build());
    }
    Err(Error::invalid(field, "reaches beyond what f32 holds: look at the scales and translations of its nodes"))
}

fn painted(sheet: &Sheet<'_>, distances: &[f64]) -> Result<Output> {
    let positions: Vec<[f32; 3]> = sheet.positions.iter().map(|p| p.as_vec3().to_array()).collect();
    let (of_vertex, largest) = colors(distances);
    let steps: Vec<f64> = (0..SCALE_STEPS).map(|step| step as f64 / (SCALE_STEPS - 1) as f64).collect();
    let bytes = gltf::write_painted(&Painted {
        positions: &positions,
        triangles: &sheet.triangles,
        colors: &of_vertex,
        range: [0.0, largest],
        scale: &colors(&steps).0,
    })?;
    Ok(Output { name: "error.glb".into(), media_type: "model/gltf-binary".into(), bytes: bytes.into() })
}
