//! Normals and attributes of a surface whose places are listed, in f64: the twin of `passes/pieces.rs`.

use displace_glsl::{layout::refine::UNIT, reference::normals_analytic, tables::Tables};
use glam::DVec3;
use rayon::prelude::*;

use super::{Displacer, Stages};
use crate::{
    domain::{
        Result,
        mesh::Mesh,
        plan::{NormalsPlan, SurfacePlan},
        report::PassTime,
        surface::{Layout, Place, Shape, Surface},
    },
    render::{
        JobContext,
        passes::pieces::{bare, facets, places::places},
    },
};

/// Makes a tessellated `shape` of `mesh` a whole surface. Of `plan` it reads the kind of normals; levels, there and in
/// `tables`, do not matter. `mismatch_max` is that of the base's vertices: whoever put vertices on seams between them
/// knows the rest.
pub fn finish(
    job: &JobContext<'_>,
    plan: &SurfacePlan,
    tables: &Tables,
    mesh: &Mesh,
    shape: Shape,
) -> Result<(Surface, Vec<PassTime>)> {
    let mut stages = Stages { job, times: Vec::new() };
    let mut surface = stages.run("attributes", || bare::surface(tables, mesh, shape))??;
    let mut displacer = Displacer::new(tables, mesh, plan);
    displacer.positions = vec![DVec3::ZERO; mesh.av_gv.len()];
    stages.run("reconcile", || displacer.reconcile_corners())?;
    surface.mismatch_max = displacer.mismatch as f32;
    surface.normals = stages.run("normals", || match plan.normals {
        NormalsPlan::Analytic => displacer.listed_normals(&surface.layout),
        NormalsPlan::Geometric => facets::normals(tables, mesh, &surface),
    })?;
    Ok((surface, stages.times))
}

impl Displacer<'_> {
    fn listed_normals(&self, layout: &Layout) -> Vec<[f32; 3]> {
        let one = |vertex: usize| self.listed_normal(layout.place(self.mesh, vertex)).as_vec3().to_array();
        (0..layout.vertices(self.mesh)).into_par_iter().map(one).collect()
    }

    fn listed_normal(&self, place: Place) -> DVec3 {
        let weight = |units: u32| f64::from(units) / f64::from(UNIT);
        let jets = places(self.tables, place).filter_map(|(t, [b1, b2])| self.jet_at(t, weight(b1), weight(b2)));
        let corner = if let Place::Corner { av } = place { Some(av) } else { None };
        normals_analytic::normal(self.tables, corner, &jets.collect::<Vec<_>>())
    }
}
