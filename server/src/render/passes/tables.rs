//! The tables of one base mesh, from the mesh, its details and the plan.

use std::sync::Arc;

use displace_glsl::{
    layout::geometry::{BaseEdge, BaseTriangle, Lattice, rule},
    tables::Tables,
};
use glam::Vec3;

use super::{
    contributions,
    layers::{self, Numbering},
    seams,
};
use crate::domain::{
    Error, Result,
    detail::{Detail, LayerSource},
    mesh::{Attribute, Mesh},
    plan::{SeamsPlan, SurfacePlan},
};

/// `details[p]` is the detail of primitive p.
pub fn build(plan: &SurfacePlan, mesh: &Mesh, details: &[Option<Arc<Detail>>]) -> Result<Tables> {
    if details.len() != mesh.primitives.len() {
        let (given, wanted) = (details.len(), mesh.primitives.len());
        return Err(Error::internal(format!("{given} details for {wanted} primitives")));
    }
    let numbering = Numbering::new(details);
    let mut tables = Tables {
        lattice: Lattice {
            level: plan.tessellation.lattice_level(),
            corners: mesh.av_gv.len() as u32,
            edges: mesh.ae_av.len() as u32,
        },
        av_normal: mesh.av_normal.clone(),
        patches: mesh.patches.clone(),
        av_tangent: tangents(mesh, &numbering)?,
        rule: match plan.seams {
            SeamsPlan::Mean => rule::MEAN,
            SeamsPlan::Dominant => rule::DOMINANT,
        },
        ..Tables::default()
    };
    layers::fill(&mut tables, &numbering)?;
    fill_vertices(&mut tables, mesh, &numbering)?;
    fill_edges(&mut tables, mesh, &numbering);
    fill_triangles(&mut tables, mesh, &numbering);
    contributions::fill(&mut tables, mesh)?;
    seams::fill(&mut tables, plan, mesh, &numbering);
    if plan.feather_texels > 0.0 && tables.max_rank > MAX_FEATHERED_SIDES {
        let message = format!(
            "{} sheets of mesh '{}' with different texture coordinates meet in one edge; at most {MAX_FEATHERED_SIDES} are feathered: split the mesh there, or use --feather 0",
            tables.max_rank, mesh.name
        );
        return Err(Error::too_large("geometry.feather_texels", message));
    }
    Ok(tables)
}

/// Ramps are added for one side of all seams at a time, so the seam with the most sides decides their cost.
const MAX_FEATHERED_SIDES: u32 = 64;

/// Tangents where a layer reads them.
fn tangents(mesh: &Mesh, numbering: &Numbering) -> Result<Vec<[f32; 4]>> {
    let mut layers = numbering.details.iter().flat_map(|detail| &detail.layers);
    if !layers.any(|layer| matches!(layer.source, LayerSource::VectorTangent(_))) {
        return Ok(Vec::new());
    }
    if mesh.av_tangent.len() != mesh.av_gv.len() {
        return Err(Error::internal(format!("mesh '{}' came without the tangents its vector map reads", mesh.name)));
    }
    Ok(mesh.av_tangent.clone())
}

fn fill_vertices(tables: &mut Tables, mesh: &Mesh, numbering: &Numbering) -> Result<()> {
    let extend = |v: [f32; 3], w: f32| [v[0], v[1], v[2], w];
    tables.av_position_u.reserve(mesh.av_gv.len());
    tables.av_direction_v.reserve(mesh.av_gv.len());
    for (p, primitive) in mesh.primitives.iter().enumerate() {
        let uvs = texture_coordinates(mesh, p, numbering)?;
        for av in primitive.avs.clone() {
            let gv = mesh.av_gv[av as usize] as usize;
            let [u, v] = uvs.map_or([0.0; 2], |a| [a.values[2 * av as usize], a.values[2 * av as usize + 1]]);
            tables.av_position_u.push(extend(mesh.gv_position[gv], u));
            tables.av_direction_v.push(extend(mesh.gv_direction[gv], v));
        }
    }
    Ok(())
}

/// The UV set that the detail of primitive p reads; fails where it has none.
fn texture_coordinates<'a>(mesh: &'a Mesh, p: usize, numbering: &Numbering) -> Result<Option<&'a Attribute>> {
    let Some(detail) = numbering.detail(numbering.of_primitive[p]) else { return Ok(None) };
    let semantic = format!("TEXCOORD_{}", detail.uv_set);
    let found = mesh.attribute(&semantic).filter(|a| a.components == 2 && a.primitives.get(p) == Some(&true));
    let needed = detail.layers.iter().any(|layer| match &layer.source {
        LayerSource::Expression(program) => program.reads_uv(),
        _ => true,
    });
    if needed && found.is_none() {
        let primitive = mesh.primitives[p].gltf_primitive;
        return Err(Error::invalid(
            "mesh",
            format!(
                "primitive {primitive} of mesh '{}' has no {semantic}, which the detail reads: give the mesh texture coordinates, choose another UV set, or use an expression of x, y, z",
                mesh.name
            ),
        ));
    }
    Ok(found)
}

fn fill_edges(tables: &mut Tables, mesh: &Mesh, numbering: &Numbering) {
    for (primitive, &detail) in mesh.primitives.iter().zip(&numbering.of_primitive) {
        let aes = &mesh.ae_av[primitive.aes.start as usize..primitive.aes.end as usize];
        let first = tables.base_edges.len();
        let edge = |(k, &av): (usize, &[u32; 2])| BaseEdge { av, detail, patch_code: patch_of(mesh, first + k) };
        tables.base_edges.extend(aes.iter().enumerate().map(edge));
    }
}

/// Where an ae lies on a smooth base; 0 on a flat one, where nothing reads it.
fn patch_of(mesh: &Mesh, ae: usize) -> u32 {
    mesh.patches.as_ref().map_or(0, |patches| patches.edges[ae])
}

fn fill_triangles(tables: &mut Tables, mesh: &Mesh, numbering: &Numbering) {
    for triangle in &mesh.triangles {
        let runs_back = |k: usize| mesh.ae_av[triangle.ae[k] as usize][0] != triangle.av[k];
        let reversed = (0..3).map(|k| u32::from(runs_back(k)) << k).sum();
        let detail = numbering.of_primitive[triangle.primitive as usize];
        tables.base_triangles.push(BaseTriangle { av: triangle.av, ae: triangle.ae, reversed, detail });
        tables.triangle_facing.push(facing(mesh, triangle.av));
    }
}

/// The shading normal of a base triangle; its opposite where the winding runs against it.
fn facing(mesh: &Mesh, av: [u32; 3]) -> [f32; 3] {
    let gv = av.map(|av| mesh.av_gv[av as usize] as usize);
    let [a, b, c] = gv.map(|gv| Vec3::from(mesh.gv_position[gv]).as_dvec3());
    let shading: Vec3 = av.iter().map(|&av| Vec3::from(mesh.av_normal[av as usize])).sum();
    let side = (b - a).cross(c - a).dot(shading.as_dvec3());
    let sign = if side == 0.0 { 0.0 } else { side.signum() as f32 };
    (shading * sign).into()
}
