//! The host side of the geometry passes: tables from a mesh and its details, dispatches, results.
//!
//! | pass | file | what it does |
//! |---|---|---|
//! | subdivide | `subdivide.rs` | base surface at fine vertices |
//! | displace, displace_vector, displace_expression, rest | `displace.rs` | positions, layer by layer |
//! | samples, fields, jets_* | `jets.rs` | displacements with derivatives; `fields` of a smooth base |
//! | reconcile_corners, _edges, _interiors | `reconcile.rs` | one place for each geometric vertex |
//! | normals_analytic, normals_geometric | `normals.rs` | normals |
//! | triangles | `triangles.rs` | fine triangles, flipped and broken ones counted |
//! | attributes | `attributes.rs` | everything else that is interpolated |
//!
//! Over a smooth base, passes that read it run as `*_smooth`. `pieces.rs` ends the work on a mesh that was tessellated elsewhere.

pub mod attributes;
pub mod contributions;
pub mod displace;
pub mod jets;
pub mod layers;
pub mod normals;
pub mod pieces;
pub mod reconcile;
pub mod seams;
pub mod skin;
pub mod streams;
pub mod subdivide;
pub mod tables;
pub mod triangles;

use std::sync::Arc;

use displace_glsl::layout::geometry::counter;

use crate::{
    domain::{
        Error, Result,
        detail::Detail,
        mesh::Mesh,
        plan::{NormalsPlan, SurfacePlan, TessellationPlan},
        report,
        surface::{Layout, Shape, Surface},
    },
    vulkan::{Device, PassTime, Recorder},
};
use streams::{BaseStreams, FineStreams};

use super::{
    JobContext,
    tessellate::{across, tessellate_on},
};

/// Displaces one mesh on a device.
pub fn displace(
    device: &Arc<Device>,
    job: &JobContext<'_>,
    plan: &SurfacePlan,
    mesh: &Mesh,
    details: &[Option<Arc<Detail>>],
) -> Result<(Surface, Vec<report::PassTime>)> {
    match &plan.tessellation {
        TessellationPlan::Uniform { .. } => {
            let recorder = device.recorder(job.cancel, job.progress);
            let (surface, times) = displace_uniformly(device, recorder, plan, mesh, details)?;
            Ok((surface, times.into_iter().map(report::PassTime::from).collect()))
        }
        TessellationPlan::Tolerance(tolerance) => {
            let tables = tables::build(plan, mesh, details)?;
            across::fewest(job, tolerance, mesh, |tolerance| {
                let tessellation = tessellate_on(device, job, tolerance, &tables, mesh)?;
                let (base, recorder) = (BaseStreams::new(device, &tables)?, device.recorder(job.cancel, job.progress));
                tessellation.finished(mesh, |shape| pieces::finish(device, recorder, plan, &tables, &base, mesh, shape))
            })
        }
    }
}

/// Gives a shape of a base mesh its normals and attributes.
pub fn finish(
    device: &Arc<Device>,
    job: &JobContext<'_>,
    plan: &SurfacePlan,
    mesh: &Mesh,
    details: &[Option<Arc<Detail>>],
    shape: Shape,
) -> Result<(Surface, Vec<report::PassTime>)> {
    let tables = tables::build(plan, mesh, details)?;
    let base = BaseStreams::new(device, &tables)?;
    let recorder = device.recorder(job.cancel, job.progress);
    let (surface, times) = pieces::finish(device, recorder, plan, &tables, &base, mesh, shape)?;
    Ok((surface, times.into_iter().map(report::PassTime::from).collect()))
}

fn displace_uniformly(
    device: &Arc<Device>,
    mut recorder: Recorder<'_>,
    plan: &SurfacePlan,
    mesh: &Mesh,
    details: &[Option<Arc<Detail>>],
) -> Result<(Surface, Vec<PassTime>)> {
    let tables = tables::build(plan, mesh, details)?;
    let base = BaseStreams::new(device, &tables)?;
    let mut fine = FineStreams::new(device, plan, &tables)?;
    subdivide::record(&mut recorder, &tables, &base, &fine)?;
    displace::record(&mut recorder, &tables, mesh, &base, &fine)?;
    fine.release_base(device)?;
    reconcile::record(device, &mut recorder, &tables, &base, &fine)?;
    match plan.normals {
        NormalsPlan::Analytic => normals::record_analytic(device, &mut recorder, &tables, &base, &fine)?,
        NormalsPlan::Geometric => normals::record_geometric(&mut recorder, &tables, &base, &fine)?,
    }
    triangles::record(&mut recorder, &tables, &base, &fine)?;
    let attributes = attributes::record(device, &mut recorder, plan, &tables, mesh, &base)?;
    let times = recorder.finish()?;
    Ok((surface(plan, mesh, &fine, &attributes)?, times))
}

fn surface(plan: &SurfacePlan, mesh: &Mesh, fine: &FineStreams, attributes: &[attributes::Values]) -> Result<Surface> {
    let counters: Vec<u32> = fine.counters.read()?;
    check_finite(mesh, u64::from(counters[counter::NOT_FINITE]))?;
    let mut values = attributes.iter().map(attributes::Values::read).collect::<Result<Vec<_>>>()?;
    let layout = Layout::Uniform { level: plan.tessellation.lattice_level() };
    skin::blend(&layout, mesh, &mut values);
    Ok(Surface {
        layout,
        positions: fine.positions.read()?,
        normals: fine.normals.read()?,
        attributes: values,
        triangles: fine.triangles.read()?,
        mismatch_max: f32::from_bits(counters[counter::MISMATCH]),
        flipped: u64::from(counters[counter::FLIPPED]),
        fit: None,
    })
}

/// Refuses results with infinite or undefined positions.
pub fn check_finite(mesh: &Mesh, broken_triangles: u64) -> Result<()> {
    if broken_triangles == 0 {
        return Ok(());
    }
    Err(Error::invalid(
        "details",
        format!(
            "{broken_triangles} triangles of mesh '{}' have positions that are not finite: lower the scale, or keep the expression away from division by 0, roots and logarithms of negative numbers (max(value, 0.001) helps)",
            mesh.name
        ),
    ))
}
