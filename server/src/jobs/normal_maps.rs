//! Normal maps of a result: what its triangles leave out of the surface, as `--normals map` asks.

mod size;
mod truth;

use rayon::prelude::*;

use super::{
    JobLimits, WorkContext,
    inputs::{self, Inputs},
};
use crate::domain::{
    Error, Result,
    detail::Detail,
    encode,
    gltf::{self, NormalMap},
    mesh::Mesh,
    normal_map::{self, Claim, Sample, Sheet, Texels, angles_degrees, claims, samples},
    report::{self, PassTime, Warning},
    request::{Geometry, Normals},
    surface::Surface,
};

/// Places that a report's angles are of, for each map.
const SAMPLES: usize = 4096;
/// What one surface gets.
#[derive(Debug, Default)]
pub(super) struct Made {
    /// Of each primitive.
    pub(super) maps: Vec<Option<NormalMap>>,
    pub(super) report: Vec<report::NormalMap>,
}

/// Refuses meshes that have no coordinates to lay a map by, and maps that take more memory than a job is given; warns of
/// maps that are replaced.
pub(super) fn check(inputs: &mut Inputs, geometry: &Geometry, lods: u32, limits: &JobLimits) -> Result<()> {
    let Normals::Map { .. } = geometry.normals else { return Ok(()) };
    size::Needed::of(inputs, geometry, lods).check(limits.host_bytes)?;
    let mut replaced = std::collections::BTreeSet::new();
    for (m, details) in inputs.scene.meshes.iter().zip(&inputs.details) {
        for (p, detail) in details.iter().enumerate() {
            let Some(detail) = detail else { continue };
            require_uvs(&m.mesh, p, detail)?;
            let material = m.mesh.primitives[p].material;
            replaced.extend(material.filter(|m| inputs.scene.materials[*m].has_normal_map));
        }
    }
    inputs.scene.warnings.extend(replaced.into_iter().map(|material| {
        let message =
            format!("materials[{material}] has a normal map; displaced primitives show the one made for them");
        Warning::new("normal_map_replaced", message)
    }));
    Ok(())
}

/// Host memory of all maps of a job once they are made.
pub(super) fn kept_bytes(inputs: &Inputs, geometry: &Geometry, lods: u32) -> u64 {
    size::Needed::of(inputs, geometry, lods).kept_bytes()
}

fn require_uvs(mesh: &Mesh, primitive: usize, detail: &Detail) -> Result<()> {
    let semantic = format!("TEXCOORD_{}", detail.uv_set);
    if mesh.attribute(&semantic).is_some_and(|a| a.primitives[primitive]) {
        return Ok(());
    }
    let message = format!(
        "mesh '{}' primitive {} has no {semantic}, by which a normal map is laid on it: unwrap the mesh, choose another UV set, or take analytic normals",
        mesh.name, mesh.primitives[primitive].gltf_primitive
    );
    Err(Error::invalid("geometry.normals", message))
}

/// One primitive on its way.
struct Work {
    primitive: usize,
    uv_set: u32,
    size: [u32; 2],
    sheet: Sheet,
    claims: Vec<Claim>,
    samples: Vec<Sample>,
}

/// Makes the maps of one surface of a mesh, level 0 or a coarser one: each level has its own, since its triangles have
/// other frames, with sides half as long as those of the level before it, since it is seen from farther.
pub(super) fn make(
    context: &WorkContext<'_>,
    inputs: &Inputs,
    geometry: &Geometry,
    (mesh, surface): (usize, &Surface),
    level: u32,
    passes: &mut Vec<PassTime>,
) -> Result<Made> {
    let Normals::Map { size } = geometry.normals else { return Ok(Made::default()) };
    let (own, details) = (&inputs.scene.meshes[mesh].mesh, &inputs.details[mesh]);
    let progress = context.progress;
    let works = inputs::timed(progress, "cover_texels", passes, || works(inputs, (mesh, surface), size, level))?;
    let places = works.iter().flat_map(Work::places);
    let normals = truth::normals(context, geometry, (mesh, own), details, places.collect(), passes)?;
    context.cancel.check()?;
    inputs::timed(progress, "encode_texels", passes, || finished(&works, own, &normals, level))
}

/// One for each primitive that has a detail.
fn works(inputs: &Inputs, (mesh, surface): (usize, &Surface), size: Option<u32>, level: u32) -> Result<Vec<Work>> {
    let (own, details) = (&inputs.scene.meshes[mesh].mesh, &inputs.details[mesh]);
    let mut works = Vec::new();
    for (primitive, detail) in details.iter().enumerate() {
        let Some(detail) = detail else { continue };
        if own.primitives[primitive].triangles.is_empty() {
            continue;
        }
        let size = size::of_level(size, detail, level);
        works.push(Work::new(own, surface, primitive, detail.uv_set, size)?);
    }
    Ok(works)
}

fn finished(works: &[Work], mesh: &Mesh, normals: &[glam::DVec3], level: u32) -> Result<Made> {
    let mut made = Made { maps: vec![None; mesh.primitives.len()], report: Vec::new() };
    let mut rest = normals;
    for work in works {
        let (of_work, others) = rest.split_at(work.claims.len() + work.samples.len());
        rest = others;
        let (map, report) = work.finish(mesh, of_work)?;
        made.maps[work.primitive] = Some(map);
        made.report.push(report::NormalMap { lod: level, ..report });
    }
    Ok(made)
}

impl Work {
    fn new(mesh: &Mesh, surface: &Surface, primitive: usize, uv_set: u32, size: [u32; 2]) -> Result<Self> {
        let sheet = gltf::sheet(mesh, surface, primitive, uv_set)?;
        let claims = claims(&sheet, size, &mesh.name)?;
        let samples = samples(&sheet, SAMPLES);
        Ok(Self { primitive, uv_set, size, sheet, claims, samples })
    }

    /// Those of the claims, then those of the samples.
    fn places(&self) -> impl Iterator<Item = crate::domain::surface::Place> {
        let of_claims = self.claims.iter().map(|c| self.sheet.place(c.triangle as usize, c.barycentrics()));
        of_claims.chain(self.samples.iter().map(|s| self.sheet.place(s.triangle as usize, s.b)))
    }

    fn finish(&self, mesh: &Mesh, normals: &[glam::DVec3]) -> Result<(NormalMap, report::NormalMap)> {
        let (of_claims, of_samples) = normals.split_at(self.claims.len());
        let inside = self.claims.par_iter().zip(of_claims).filter_map(|(claim, normal)| {
            let frame = self.sheet.frame(claim.triangle as usize, claim.barycentrics());
            let (direction, clamped) = frame.encode(*normal)?;
            Some((claim.texel, direction, clamped))
        });
        let mut texels = Texels::of(self.size, inside.collect::<Vec<_>>().into_iter());
        self.check(mesh, &texels)?;
        texels.continue_islands();
        let rgb = texels.rgb();
        let angles = angles_degrees(&self.sheet, &rgb, self.size, &self.samples, of_samples);
        let at = |share: f64| angles.get((share * angles.len() as f64) as usize).copied().unwrap_or(0.0);
        let report = report::NormalMap {
            mesh: mesh.name.clone(),
            primitive: mesh.primitives[self.primitive].gltf_primitive as u32,
            size: self.size,
            coverage: texels.coverage(),
            clamped: texels.clamped,
            angle_p50_deg: at(0.5),
            angle_p99_deg: at(0.99),
            ..report::NormalMap::default()
        };
        let png = encode::encode_linear_rgb8(self.size[0], self.size[1], &rgb)?;
        Ok((NormalMap { png: png.into(), uv_set: self.uv_set }, report))
    }

    /// Fails where places that share texels want different normals of them.
    fn check(&self, mesh: &Mesh, texels: &Texels) -> Result<()> {
        let apart = texels.disagreement;
        if apart.texels as f64 <= normal_map::MOST_DISAGREEING * texels.covered as f64 {
            return Ok(());
        }
        let message = format!(
            "mesh '{}' primitive {}: of {} texels that TEXCOORD_{} covers, {} are shared by places whose normals are more than {} degrees apart, up to {:.0}; one map cannot serve both: unwrap the mesh so that no two places share a texel, or take analytic normals",
            mesh.name,
            mesh.primitives[self.primitive].gltf_primitive,
            texels.covered,
            self.uv_set,
            apart.texels,
            normal_map::MOST_APART_DEGREES,
            apart.most_degrees,
        );
        Err(Error::invalid("geometry.normals", message))
    }
}
