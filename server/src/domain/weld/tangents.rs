//! Tangents of the base mesh: mending a file's, and making them where a detail needs them.

use glam::{Vec3, Vec4};
use rayon::prelude::*;

use super::{PrimitiveInput, VertexAttribute, mikktspace::mikk_tangents, weld};
use crate::domain::{
    Error, Result,
    mesh::{Mesh, Primitive},
};

/// The mesh with tangents in each primitive for which `uv_set` names a set: the file's where it has some,
/// MikkTSpace's of that `TEXCOORD` elsewhere. Avs split where the handedness or the tangents of their
/// triangles differ.
pub fn with_tangents(mesh: &Mesh, uv_set: impl Fn(usize) -> Option<u32> + Sync) -> Result<Mesh> {
    let inputs = (0..mesh.primitives.len()).into_par_iter().map(|p| cornered(mesh, p, uv_set(p)));
    let inputs: Vec<PrimitiveInput> = inputs.collect::<Result<_>>()?;
    let mut welded = weld(&mesh.name, &inputs)?;
    welded.health.degenerate_triangles = mesh.health.degenerate_triangles;
    welded.health.normals_generated = mesh.health.normals_generated;
    welded.health.normals_repaired = mesh.health.normals_repaired;
    Ok(welded)
}

/// Primitive `p` with every corner of every triangle a vertex of its own, and tangents where asked for.
fn cornered(mesh: &Mesh, p: usize, uv_set: Option<u32>) -> Result<PrimitiveInput> {
    let primitive = &mesh.primitives[p];
    let triangles = &mesh.triangles[primitive.triangles.start as usize..primitive.triangles.end as usize];
    let avs: Vec<u32> = triangles.iter().flat_map(|t| t.av).collect();
    let of_mesh = |a: &&crate::domain::mesh::Attribute| a.primitives[p];
    let attributes = mesh.attributes.iter().filter(of_mesh).map(|a| VertexAttribute {
        semantic: a.semantic.clone(),
        components: a.components,
        values: avs.iter().flat_map(|&av| &a.values[av as usize * a.components..][..a.components]).copied().collect(),
    });
    let from_file = mesh.has_tangents(primitive);
    let tangents = match uv_set {
        _ if from_file => Some(avs.iter().map(|&av| mesh.av_tangent[av as usize]).collect()),
        Some(set) => Some(made(mesh, primitive, p, &avs, set)?),
        None => None,
    };
    Ok(PrimitiveInput {
        gltf_primitive: primitive.gltf_primitive,
        material: primitive.material,
        positions: avs.iter().map(|&av| mesh.gv_position[mesh.av_gv[av as usize] as usize]).collect(),
        normals: Some(avs.iter().map(|&av| mesh.av_normal[av as usize]).collect()),
        made_tangents: tangents.is_some() && !from_file,
        tangents,
        attributes: attributes.collect(),
        triangles: (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
    })
}

fn made(mesh: &Mesh, primitive: &Primitive, p: usize, avs: &[u32], uv_set: u32) -> Result<Vec<[f32; 4]>> {
    let semantic = format!("TEXCOORD_{uv_set}");
    let uvs = mesh.attribute(&semantic).filter(|a| a.primitives[p]).ok_or_else(|| {
        let field = format!("mesh '{}' primitive {}", mesh.name, primitive.gltf_primitive);
        Error::invalid(
            field,
            format!("tangents need {semantic}, which it lacks: unwrap the mesh, or use a map in object space"),
        )
    })?;
    let local: Vec<[u32; 3]> = avs.as_chunks().0.to_vec();
    let position = |av: u32| mesh.gv_position[mesh.av_gv[av as usize] as usize];
    let normal = |av: u32| mesh.av_normal[av as usize];
    let uv = |av: u32| [uvs.values[av as usize * 2], uvs.values[av as usize * 2 + 1]];
    mikk_tangents(&local, position, normal, uv)
}

/// Unit length, handedness ±1; a tangent that says nothing becomes some direction across the normal.
pub(super) fn repaired_tangent(tangent: [f32; 4], normal: [f32; 3]) -> [f32; 4] {
    let t = Vec4::from(tangent);
    let handedness = if t.w < 0.0 { -1.0 } else { 1.0 };
    let length = t.truncate().length();
    let axis = if length.is_finite() && length > 1e-12 {
        if (length - 1.0).abs() > 1e-6 { t.truncate() / length } else { t.truncate() }
    } else {
        Vec3::from(normal).any_orthonormal_vector()
    };
    axis.extend(handedness).to_array()
}
