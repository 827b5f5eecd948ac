//! Tangents: mending a file's, and making MikkTSpace ones where a detail or a normal map needs them.
//!
//! MikkTSpace gives the true dP/du, right on mirrored UVs (handedness in w), and lends triangles without
//! UV area the tangents of their neighbours.

use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::{Vec3, Vec4};
use rayon::prelude::*;

use super::{PrimitiveInput, VertexAttribute, weld};
use crate::domain::{
    Error, Result,
    mesh::{Mesh, Primitive},
};

/// A mesh whose every av has a tangent: the file's where it has one, MikkTSpace's of `TEXCOORD_{uv_set}`
/// elsewhere. Avs split where the handedness or the tangents of their triangles differ.
pub fn with_tangents(mesh: &Mesh, uv_set: u32) -> Result<Mesh> {
    let inputs = (0..mesh.primitives.len()).into_par_iter().map(|p| cornered(mesh, p, uv_set));
    let inputs: Vec<PrimitiveInput> = inputs.collect::<Result<_>>()?;
    let mut welded = weld(&mesh.name, &inputs)?;
    welded.health.degenerate_triangles = mesh.health.degenerate_triangles;
    welded.health.normals_generated = mesh.health.normals_generated;
    welded.health.normals_repaired = mesh.health.normals_repaired;
    Ok(welded)
}

/// Primitive `p` with every corner of every triangle a vertex of its own, and tangents.
fn cornered(mesh: &Mesh, p: usize, uv_set: u32) -> Result<PrimitiveInput> {
    let primitive = &mesh.primitives[p];
    let triangles = &mesh.triangles[primitive.triangles.start as usize..primitive.triangles.end as usize];
    let avs: Vec<u32> = triangles.iter().flat_map(|t| t.av).collect();
    let of_mesh = |a: &&crate::domain::mesh::Attribute| a.primitives[p];
    let attributes = mesh.attributes.iter().filter(of_mesh).map(|a| VertexAttribute {
        semantic: a.semantic.clone(),
        components: a.components,
        values: avs.iter().flat_map(|&av| &a.values[av as usize * a.components..][..a.components]).copied().collect(),
    });
    Ok(PrimitiveInput {
        gltf_primitive: primitive.gltf_primitive,
        material: primitive.material,
        positions: avs.iter().map(|&av| mesh.gv_position[mesh.av_gv[av as usize] as usize]).collect(),
        normals: Some(avs.iter().map(|&av| mesh.av_normal[av as usize]).collect()),
        tangents: Some(corner_tangents(mesh, primitive, p, &avs, uv_set)?),
        attributes: attributes.collect(),
        triangles: (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
    })
}

fn corner_tangents(mesh: &Mesh, primitive: &Primitive, p: usize, avs: &[u32], uv_set: u32) -> Result<Vec<[f32; 4]>> {
    let from_file = mesh.av_tangent.get(primitive.avs.start as usize).is_some_and(|t| t[3] != 0.0);
    if from_file {
        return Ok(avs.iter().map(|&av| mesh.av_tangent[av as usize]).collect());
    }
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

/// Triangles around one vertex that MikkTSpace handles in seconds: its time grows with the square.
const LARGEST_FAN: usize = 8192;

/// MikkTSpace tangents as glTF wants them, one per corner, in the order of `triangles`. Corners are named by
/// vertex; a corner with no usable UVs around gets some direction across its normal. Fails with `TooLarge`
/// where too many triangles meet in one vertex.
pub fn mikk_tangents(
    triangles: &[[u32; 3]],
    position: impl Fn(u32) -> [f32; 3] + Send,
    normal: impl Fn(u32) -> [f32; 3] + Send,
    uv: impl Fn(u32) -> [f32; 2] + Send,
) -> Result<Vec<[f32; 4]>> {
    let fan = largest_fan(triangles);
    if fan > LARGEST_FAN {
        let message =
            format!("{fan} triangles meet in one vertex; tangents are made for at most {LARGEST_FAN}: split the fan");
        return Err(Error::too_large("TANGENT", message));
    }
    let mut corners = Corners { triangles, position, normal, uv, tangents: vec![[0.0; 4]; triangles.len() * 3] };
    let generate = |corners: &mut Corners<'_, _, _, _>| {
        generate_tangents(corners)
            .map_err(|error| Error::internal("tangents could not be made").with_cause(error.to_string()))
    };
    // The generator walks the fan around a vertex by recursion: a big fan needs a stack of its own.
    if fan < 256 {
        generate(&mut corners)?;
    } else {
        std::thread::scope(|scope| {
            let builder = std::thread::Builder::new().name("mikktspace".into()).stack_size(4096 * LARGEST_FAN);
            let thread = builder.spawn_scoped(scope, || generate(&mut corners)).map_err(no_thread)?;
            thread.join().unwrap_or_else(|_| Err(Error::internal("the tangent generator failed")))
        })?;
    }
    Ok(corners.tangents)
}

fn no_thread(error: std::io::Error) -> Error {
    Error::new(crate::domain::ErrorKind::TooLarge, "no memory for the stack of the tangent generator").with_cause(error)
}

/// Most triangles around one vertex.
fn largest_fan(triangles: &[[u32; 3]]) -> usize {
    let vertices = triangles.as_flattened().iter().max().map_or(0, |&v| v as usize + 1);
    let mut uses = vec![0u32; vertices];
    triangles.as_flattened().iter().for_each(|&v| uses[v as usize] += 1);
    uses.into_iter().max().unwrap_or(0) as usize
}

struct Corners<'a, P, N, U> {
    triangles: &'a [[u32; 3]],
    position: P,
    normal: N,
    uv: U,
    tangents: Vec<[f32; 4]>,
}

impl<P, N, U> Geometry for Corners<'_, P, N, U>
where
    P: Fn(u32) -> [f32; 3],
    N: Fn(u32) -> [f32; 3],
    U: Fn(u32) -> [f32; 2],
{
    fn num_faces(&self) -> usize {
        self.triangles.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        (self.position)(self.triangles[face][corner])
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        (self.normal)(self.triangles[face][corner])
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        (self.uv)(self.triangles[face][corner])
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        let normal = self.normal(face, corner);
        let [x, y, z, w] = space.map_or([0.0, 0.0, 0.0, 1.0], |space| space.tangent_encoded());
        // glTF's v runs down the image and its bitangent up, so the handedness is the other one.
        self.tangents[face * 3 + corner] = repaired_tangent([x, y, z, -w], normal);
    }
}
