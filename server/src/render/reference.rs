//! The executor in f64 on the CPU: the twins of the passes, composed. It needs no device and is the
//! oracle the device is measured against.

pub mod pieces;

use std::{sync::Arc, time::Instant};

use displace_glsl::{
    layout::geometry::{Layer, NONE, OWN, SamplesParams, Seam, block, kind},
    reference::{
        attributes, displace, displace_expression, displace_vector,
        frame::Jet,
        jets_correction, jets_expression, jets_height, jets_vector, normals_analytic, normals_geometric,
        reconcile_corners, reconcile_edges, reconcile_interiors,
        samples::{self, Sample},
        site::Site,
        subdivide::{self, Base},
        triangles,
    },
    tables::Tables,
};
use glam::DVec3;
use rayon::prelude::*;

use super::{
    Executor, JobContext,
    passes::{self, displace::runs, skin, subdivide::blocks},
    reference_image,
    tessellate::{across, tessellate},
};
use crate::domain::{
    Result,
    detail::Detail,
    image::{ImagePlan, ImageSet, RenderScene},
    mesh::Mesh,
    plan::{NormalsPlan, SurfacePlan, TessellationPlan},
    report::PassTime,
    surface::{Layout, Shape, Surface},
};

/// The device called `reference`.
#[derive(Debug, Default)]
pub struct ReferenceExecutor;

impl Executor for ReferenceExecutor {
    fn device_name(&self) -> &str {
        "reference"
    }

    fn device_class(&self) -> &str {
        "reference"
    }

    fn displace(
        &self,
        job: &JobContext<'_>,
        plan: &SurfacePlan,
        mesh: &Mesh,
        detail_of_primitive: &[Option<Arc<Detail>>],
    ) -> Result<(Surface, Vec<PassTime>)> {
        let tables = passes::tables::build(plan, mesh, detail_of_primitive)?;
        let mut stages = Stages { job, times: Vec::new() };
        match &plan.tessellation {
            TessellationPlan::Uniform { .. } => {
                let surface = Displacer::new(&tables, mesh, plan).run(&mut stages)?;
                Ok((surface, stages.times))
            }
            TessellationPlan::Tolerance(tolerance) => across::fewest(job, tolerance, mesh, |tolerance| {
                tessellate(job, tolerance, &tables, mesh)?
                    .finished(mesh, |shape| pieces::finish(job, plan, &tables, mesh, shape))
            }),
        }
    }

    fn finish(
        &self,
        job: &JobContext<'_>,
        plan: &SurfacePlan,
        mesh: &Mesh,
        detail_of_primitive: &[Option<Arc<Detail>>],
        shape: Shape,
    ) -> Result<(Surface, Vec<PassTime>)> {
        let tables = passes::tables::build(plan, mesh, detail_of_primitive)?;
        pieces::finish(job, plan, &tables, mesh, shape)
    }

    fn traces_rays(&self) -> bool {
        true
    }

    fn render(&self, job: &JobContext<'_>, plan: &ImagePlan, scene: &RenderScene) -> Result<(ImageSet, Vec<PassTime>)> {
        reference_image::render(job, plan, scene)
    }
}

/// Times the stages and asks between them whether to go on.
struct Stages<'a> {
    job: &'a JobContext<'a>,
    times: Vec<PassTime>,
}

impl Stages<'_> {
    fn run<T>(&mut self, name: &str, work: impl FnOnce() -> T) -> Result<T> {
        self.job.cancel.check()?;
        let start = Instant::now();
        let result = work();
        self.job.progress.pass(name, 1, 1);
        self.times.push(PassTime { name: name.into(), ms: start.elapsed().as_secs_f64() * 1e3, bytes: 0 });
        self.job.cancel.check()?;
        Ok(result)
    }
}

/// Displaces one mesh; positions stay f64 until the end.
struct Displacer<'a> {
    tables: &'a Tables,
    mesh: &'a Mesh,
    plan: &'a SurfacePlan,
    positions: Vec<DVec3>,
    av_correction: Vec<DVec3>,
    mismatch: f64,
}

impl<'a> Displacer<'a> {
    fn new(tables: &'a Tables, mesh: &'a Mesh, plan: &'a SurfacePlan) -> Self {
        let av_correction = vec![DVec3::ZERO; tables.av_normal.len()];
        Self { tables, mesh, plan, positions: Vec::new(), av_correction, mismatch: 0.0 }
    }

    fn run(mut self, stages: &mut Stages<'_>) -> Result<Surface> {
        self.positions = stages.run("displace", || self.displaced())?;
        stages.run("reconcile", || self.reconcile())?;
        let normals = stages.run("normals", || self.normals())?;
        let triangles = stages.run("triangles", || self.triangles())?;
        let mut attributes = stages.run("attributes", || self.attributes())?;
        let layout = Layout::Uniform { level: self.plan.tessellation.lattice_level() };
        skin::blend(&layout, self.mesh, &mut attributes);
        passes::check_finite(self.mesh, self.broken(&triangles))?;
        Ok(Surface {
            layout,
            flipped: self.flipped(&triangles),
            positions: self.positions.iter().map(|p| p.as_vec3().to_array()).collect(),
            normals,
            attributes,
            triangles,
            mismatch_max: self.mismatch as f32,
            fit: None,
        })
    }

    /// Every fine vertex with its block and its number in it, in order.
    fn vertices(&self) -> impl IndexedParallelIterator<Item = (u32, u32)> + use<> {
        let [(_, _, corners), (_, edges_first, edges), (_, interiors_first, interiors)] = blocks(self.tables);
        let place = move |v: usize| match v as u64 {
            v if v < corners => (block::CORNERS, v as u32),
            v if v < edges_first + edges => (block::EDGES, (v - edges_first) as u32),
            v => (block::INTERIORS, (v - interiors_first) as u32),
        };
        (0..(corners + edges + interiors) as usize).into_par_iter().map(place)
    }

    fn displaced(&self) -> Vec<DVec3> {
        let mut detail_of_vertex = vec![0; self.plan.vertices as usize];
        for (detail, range) in runs(self.tables, self.mesh) {
            detail_of_vertex[range.start as usize..range.end as usize].fill(detail);
        }
        let place = |(detail, (which, index)): (&u32, (u32, u32))| {
            let base = subdivide::base(self.tables, which, index);
            base.position + self.layers(*detail).iter().map(|layer| self.layer(layer, &base)).sum::<DVec3>()
        };
        detail_of_vertex.par_iter().zip(self.vertices()).map(place).collect()
    }

    fn layers(&self, detail: u32) -> &'a [Layer] {
        let range = self.tables.details[detail as usize].clone();
        &self.tables.layers[range.start as usize..range.end as usize]
    }

    fn layer(&self, layer: &Layer, base: &Base) -> DVec3 {
        match layer.kind {
            kind::HEIGHT => displace::displacement(self.tables, layer, base),
            kind::EXPRESSION => displace_expression::displacement(self.tables, layer, base),
            _ => displace_vector::displacement(self.tables, layer, base),
        }
    }

    /// A sample's own detail.
    fn own_jet(&self, sample: &Sample) -> Jet {
        let one = |layer: &Layer| match layer.kind {
            kind::HEIGHT => jets_height::jet(self.tables, layer, sample),
            kind::EXPRESSION => jets_expression::jet(self.tables, layer, sample),
            _ => jets_vector::jet(self.tables, layer, sample),
        };
        self.layers(sample.detail).iter().map(one).fold(Jet::ZERO, |sum, jet| sum + jet)
    }

    /// With the corner corrections of its seams.
    fn hatted_jet(&self, sample: &Sample) -> Jet {
        self.own_jet(sample) + jets_correction::jet(&self.av_correction, sample)
    }

    /// The whole displacement of base triangle t at lattice point ij, and the sample there.
    fn jet(&self, t: u32, ij: [u32; 2]) -> Option<(Sample, Jet)> {
        let [b1, b2] = ij.map(|x| f64::from(x) / f64::from(self.tables.segments()));
        self.jet_at(t, b1, b2)
    }

    /// The same where the second and the third corner have weights b1 and b2.
    fn jet_at(&self, t: u32, b1: f64, b2: f64) -> Option<(Sample, Jet)> {
        let at =
            |side, rank| samples::vertex_sample(self.tables, &self.sampling(block::INTERIORS, side, rank), t, b1, b2);
        let own = at(OWN, 0)?;
        if self.tables.correction(t).is_none() {
            return Some((own, self.own_jet(&own)));
        }
        let ranks = (0..3).flat_map(|side| (0..self.tables.max_rank).map(move |rank| (side, rank)));
        let ramps = ranks.filter_map(|(side, rank)| at(side, rank)).map(|sample| self.hatted_jet(&sample));
        Some((own, ramps.fold(self.hatted_jet(&own), |sum, jet| sum + jet)))
    }

    fn sampling(&self, block: u32, side: u32, rank: u32) -> SamplesParams {
        let (rule, lattice) = (self.tables.rule, self.tables.lattice);
        SamplesParams { block, side, rank, rule, lattice, ..SamplesParams::default() }
    }

    fn reconcile(&mut self) {
        self.reconcile_corners();
        self.reconcile_edges();
        self.reconcile_interiors();
    }

    fn reconcile_corners(&mut self) {
        let sampling = self.sampling(block::SEAM_CORNERS, OWN, 0);
        let count = self.tables.seam_corners.len() as u32;
        let candidate = |k| samples::sample(self.tables, &sampling, k).map_or(DVec3::ZERO, |s| self.own_jet(&s).x_axis);
        let candidates: Vec<DVec3> = (0..count).into_par_iter().map(candidate).collect();
        let candidate = |k: u32| candidates[k as usize];
        for seam in &self.tables.seam_vertices {
            let reconciled = reconcile_corners::reconcile(self.tables, seam, candidate);
            self.mismatch = self.mismatch.max(reconciled.mismatch);
            for rank in 0..seam.count {
                let av = self.tables.seam_corners[(seam.first + rank) as usize].id as usize;
                let base = Site::at_vertex(av as u32).position(self.tables);
                self.positions[av] = base + reconciled.displacement;
                self.av_correction[av] =
                    reconcile_corners::correction(self.tables, seam, rank, reconciled.displacement, candidate);
            }
        }
    }

    fn reconcile_edges(&mut self) {
        let points = self.tables.segments() - 1;
        let hats = !self.tables.corrections.is_empty();
        let sampling = self.sampling(block::SEAM_EDGES, OWN, 0);
        let candidate = |side: u32, point: u32| {
            let sample = samples::sample(self.tables, &sampling, side * points + point);
            sample.map_or(DVec3::ZERO, |s| if hats { self.hatted_jet(&s) } else { self.own_jet(&s) }.x_axis)
        };
        let all = |seam: &Seam| -> Vec<_> {
            (0..points)
                .map(|point| reconcile_edges::reconcile(self.tables, seam, |side| candidate(side, point)))
                .collect()
        };
        let reconciled: Vec<_> = self.tables.seams.par_iter().map(all).collect();
        for (seam, along) in self.tables.seams.iter().zip(reconciled) {
            let sides = &self.tables.seam_sides[seam.first as usize..(seam.first + seam.count) as usize];
            for (point, result) in along.into_iter().enumerate() {
                self.mismatch = self.mismatch.max(result.mismatch);
                let t = (point + 1) as f64 / f64::from(points + 1);
                let place = Site::on_edge(self.tables, sides[0].id, t).position(self.tables) + result.displacement;
                for side in sides {
                    let vertex = self.tables.lattice.corners + side.id * points;
                    self.positions[vertex as usize + point] = place;
                }
            }
        }
    }

    fn reconcile_interiors(&mut self) {
        let [_, _, (_, first, _)] = blocks(self.tables);
        let points = displace_glsl::lattice::interior_points(self.tables.lattice.level);
        let level = self.tables.lattice.level;
        for &t in &self.tables.triangle_order[self.tables.uncorrected_triangles as usize..] {
            let place = |rank: u64| {
                let (i, j) = displace_glsl::lattice::interior_point(level, rank);
                let found = self.jet(t, [i as u32, j as u32]);
                found.map(|(own, jet)| reconcile_interiors::position(self.tables, &own, jet))
            };
            let places: Vec<Option<DVec3>> = (0..points).into_par_iter().map(place).collect();
            let start = (first + u64::from(t) * points) as usize;
            for (position, place) in self.positions[start..].iter_mut().zip(places) {
                *position = place.unwrap_or(*position);
            }
        }
    }

    fn normals(&self) -> Vec<[f32; 3]> {
        let one = |(which, index): (u32, u32)| {
            let normal = match self.plan.normals {
                NormalsPlan::Analytic => self.analytic(which, index),
                NormalsPlan::Geometric => {
                    normals_geometric::normal(self.tables, which, index, |v| self.positions[v as usize])
                }
            };
            normal.as_vec3().to_array()
        };
        self.vertices().map(one).collect()
    }

    fn analytic(&self, which: u32, index: u32) -> DVec3 {
        let contributions: Vec<(Sample, Jet)> =
            places(self.tables, which, index).into_iter().filter_map(|(t, ij)| self.jet(t, ij)).collect();
        let corner = (which == block::CORNERS).then_some(index);
        normals_analytic::normal(self.tables, corner, &contributions)
    }

    fn triangles(&self) -> Vec<[u32; 3]> {
        (0..self.plan.triangles as u32).into_par_iter().map(|t| triangles::triangle(self.tables, t)).collect()
    }

    fn corners(&self, triangle: [u32; 3]) -> [DVec3; 3] {
        triangle.map(|v| self.positions[v as usize])
    }

    fn flipped(&self, fine: &[[u32; 3]]) -> u64 {
        let base = |t: usize| (t >> (2 * self.tables.lattice.level)) as u32;
        let back = |(t, ids): &(usize, &[u32; 3])| triangles::facing(self.tables, base(*t), self.corners(**ids)) < 0.0;
        fine.par_iter().enumerate().filter(back).count() as u64
    }

    fn broken(&self, fine: &[[u32; 3]]) -> u64 {
        let sound = |p: &DVec3| p.as_vec3().is_finite();
        fine.par_iter().filter(|ids| !self.corners(**ids).iter().all(sound)).count() as u64
    }

    fn attributes(&self) -> Vec<Vec<f32>> {
        let one = |attribute: &crate::domain::mesh::Attribute| {
            if skin::is_skin(&attribute.semantic) {
                return Vec::new();
            }
            let c = attribute.components;
            let values = |(which, index): (u32, u32)| -> Vec<f32> {
                (0..c).map(|k| attributes::value(self.tables, &attribute.values, c, which, index, k) as f32).collect()
            };
            self.vertices().flat_map_iter(values).collect()
        };
        self.mesh.attributes.iter().map(one).collect()
    }
}

/// The base triangles that shade a fine vertex, and its lattice point in each.
#[must_use]
pub fn places(tables: &Tables, which: u32, index: u32) -> Vec<(u32, [u32; 2])> {
    let points = tables.segments() - 1;
    let (list, along) = match which {
        block::CORNERS => (index, 0),
        block::EDGES => (tables.lattice.corners + index / points, index % points + 1),
        _ => (NONE, 0),
    };
    if list == NONE {
        let inside = displace_glsl::lattice::interior_points(tables.lattice.level) as u32;
        let (i, j) = displace_glsl::lattice::interior_point(tables.lattice.level, u64::from(index % inside));
        return vec![(index / inside, [i as u32, j as u32])];
    }
    let items = tables.contributions_of(list).iter();
    items.map(|&item| (item / 3, samples::place_in_triangle(tables, item, along, tables.segments()))).collect()
}
