//! From the triangle primitives of one glTF mesh to the welded [`Mesh`] all passes read.
//!
//! Everything is decided by sorting bit patterns, never by hash or arrival order, so that permuted input
//! triangles give the same mesh up to the order of its triangles. Reading glTF is `gltf`'s matter.

mod directions;
mod edges;
mod looks;
mod mikktspace;
mod places;
mod tangents;
mod wedges;

use std::collections::HashMap;

use rayon::prelude::*;

use super::{
    Error, Result,
    mesh::{Csr, Mesh, MeshHealth, Primitive, Triangle},
};
pub use mikktspace::mikk_tangents;
pub use tangents::with_tangents;
use wedges::Wedges;

/// One triangle primitive as it comes out of a file, indices resolved.
#[derive(Clone, Debug, Default)]
pub struct PrimitiveInput {
    /// Index of the primitive in the glTF mesh.
    pub gltf_primitive: usize,
    pub material: Option<usize>,
    /// Mesh-local units.
    pub positions: Vec<[f32; 3]>,
    /// Flat normals are made where the file has none.
    pub normals: Option<Vec<[f32; 3]>>,
    pub tangents: Option<Vec<[f32; 4]>>,
    /// The tangents are ours, not the file's.
    pub made_tangents: bool,
    pub attributes: Vec<VertexAttribute>,
    pub triangles: Vec<[u32; 3]>,
}

/// `values.len() == components * positions.len()`; semantics as in [`super::mesh::Attribute`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VertexAttribute {
    pub semantic: String,
    pub components: usize,
    pub values: Vec<f32>,
}

/// Welds the primitives of one glTF mesh, in their order, to the invariants of [`Mesh`].
pub fn weld(name: &str, primitives: &[PrimitiveInput]) -> Result<Mesh> {
    check(name, primitives)?;
    let mut health = MeshHealth::default();
    let (gv_position, wedges) = wedges_of(primitives, &mut health);
    let looks = looks::weld(primitives, &wedges);
    let mut mesh = Mesh {
        name: name.into(),
        gv_position,
        av_gv: looks.av_gv,
        av_normal: looks.av_normal,
        av_tangent: looks.av_tangent,
        attributes: looks.attributes,
        health,
        ..Mesh::default()
    };
    let corners: Vec<Vec<[u32; 3]>> = wedges
        .par_iter()
        .zip(&looks.av_of_wedge)
        .map(|(part, av)| part.triangles.iter().map(|t| t.map(|wedge| av[wedge as usize])).collect())
        .collect();
    edges::build(&mut mesh, &corners);
    mesh.primitives = primitive_ranges(primitives, &corners, &looks.avs_of_primitive, &mesh);
    lists(&mut mesh);
    mesh.gv_direction = directions::mitred(&mesh);
    Ok(mesh)
}

/// Bit pattern of a coordinate with −0 counted as +0: equal bits are equal values.
fn canonical_bits(value: f32) -> u32 {
    if value == 0.0 { 0 } else { value.to_bits() }
}

fn check(name: &str, primitives: &[PrimitiveInput]) -> Result<()> {
    // Corners are numbered triangle * 3 + corner in u32 throughout.
    const LIMIT: usize = u32::MAX as usize;
    const PRIMITIVE_LIMIT: usize = 1 << 16;
    let triangles: usize = primitives.iter().map(|p| p.triangles.len()).sum();
    let vertices: usize = primitives.iter().map(|p| p.positions.len()).sum();
    if triangles > LIMIT / 3 || vertices > LIMIT || primitives.len() > PRIMITIVE_LIMIT {
        let message = format!(
            "{triangles} triangles and {vertices} vertices; at most {} triangles and {LIMIT} vertices fit one mesh: split it",
            LIMIT / 3
        );
        return Err(Error::too_large(format!("mesh '{name}'"), message));
    }
    check_attributes(name, primitives)?;
    primitives.iter().try_for_each(|p| check_primitive(name, p))
}

/// Bytes of the attribute rows of one mesh.
const ROW_BYTES_LIMIT: u64 = 4 << 30;
/// Distinct attributes and morph target parts of one mesh.
const ATTRIBUTE_LIMIT: usize = 4096;

/// Every vertex gets a row of all attributes that any primitive has: few vertices with many attributes
/// beside many vertices with few would take memory out of all proportion.
fn check_attributes(name: &str, primitives: &[PrimitiveInput]) -> Result<()> {
    let field = format!("mesh '{name}'");
    let names: HashMap<&str, usize> =
        primitives.iter().flat_map(|p| &p.attributes).map(|a| (a.semantic.as_str(), a.components)).collect();
    if names.len() > ATTRIBUTE_LIMIT {
        let message =
            format!("has {} attributes and morph target parts; at most {ATTRIBUTE_LIMIT} are read", names.len());
        return Err(Error::too_large(field, message));
    }
    let rows = primitives.iter().map(|p| if p.normals.is_some() { p.positions.len() } else { p.triangles.len() * 3 });
    let words = looks::FIXED_WORDS + names.values().sum::<usize>();
    let bytes = rows.sum::<usize>() as u64 * words as u64 * 4;
    if bytes > ROW_BYTES_LIMIT {
        let message =
            format!("its attributes take {bytes} bytes; at most {ROW_BYTES_LIMIT} are allowed: split the mesh");
        return Err(Error::too_large(field, message));
    }
    Ok(())
}

fn check_primitive(name: &str, primitive: &PrimitiveInput) -> Result<()> {
    let count = primitive.positions.len();
    let field = |what: &str| format!("mesh '{name}' primitive {}: {what}", primitive.gltf_primitive);
    if let Some(index) = primitive.triangles.iter().flatten().find(|&&i| i as usize >= count) {
        return Err(Error::invalid(
            field("indices"),
            format!("index {index} is out of range; the primitive has {count} vertices"),
        ));
    }
    if let Some(vertex) = primitive.positions.iter().position(|p| !p.iter().all(|c| c.is_finite())) {
        let message = format!("vertex {vertex} is {:?}; coordinates must be finite", primitive.positions[vertex]);
        return Err(Error::invalid(field("POSITION"), message));
    }
    let lengths = [primitive.normals.as_ref().map(Vec::len), primitive.tangents.as_ref().map(Vec::len)];
    let short = lengths.into_iter().flatten().any(|length| length != count)
        || primitive.attributes.iter().any(|a| a.values.len() != a.components * count);
    if short {
        return Err(Error::invalid(
            field("attributes"),
            format!("an attribute does not have {count} elements like POSITION"),
        ));
    }
    Ok(())
}

/// Welds positions, drops degenerate triangles and gives every remaining corner its normal.
fn wedges_of(primitives: &[PrimitiveInput], health: &mut MeshHealth) -> (Vec<[f32; 3]>, Vec<Wedges>) {
    let mut places = places::rank(primitives);
    let mut kept: Vec<Vec<[u32; 3]>> = primitives
        .par_iter()
        .zip(&places.gv_of_vertex)
        .map(|(p, gv)| p.triangles.iter().copied().filter(|t| !degenerate(t.map(|v| gv[v as usize]))).collect())
        .collect();
    for (primitive, triangles) in primitives.iter().zip(&kept) {
        health.degenerate_triangles += (primitive.triangles.len() - triangles.len()) as u32;
    }
    places.drop_unused(&kept);
    let wedges: Vec<Wedges> = primitives
        .par_iter()
        .zip(&places.gv_of_vertex)
        .zip(&mut kept)
        .map(|((p, gv), triangles)| Wedges::new(p, gv, std::mem::take(triangles), &places.positions))
        .collect();
    health.normals_generated = primitives.iter().any(|p| p.normals.is_none());
    health.normals_repaired = wedges.iter().map(|w| w.repaired).sum();
    (places.positions, wedges)
}

fn degenerate([a, b, c]: [u32; 3]) -> bool {
    a == b || b == c || c == a
}

fn primitive_ranges(
    primitives: &[PrimitiveInput],
    corners: &[Vec<[u32; 3]>],
    avs: &[std::ops::Range<u32>],
    mesh: &Mesh,
) -> Vec<Primitive> {
    let mut first_triangle = 0;
    let mut first_ae = 0;
    let of_primitive = |ae: usize, p: usize| avs[p].contains(&mesh.ae_av[ae][0]);
    let mut ranges = Vec::with_capacity(primitives.len());
    for (p, input) in primitives.iter().enumerate() {
        let end_triangle = first_triangle + corners[p].len() as u32;
        let end_ae = first_ae + mesh.ae_av[first_ae as usize..].partition_point(|av| avs[p].contains(&av[0])) as u32;
        debug_assert!((first_ae..end_ae).all(|ae| of_primitive(ae as usize, p)));
        ranges.push(Primitive {
            gltf_primitive: input.gltf_primitive,
            material: input.material,
            made_tangents: input.made_tangents,
            avs: avs[p].clone(),
            aes: first_ae..end_ae,
            triangles: first_triangle..end_triangle,
        });
        (first_triangle, first_ae) = (end_triangle, end_ae);
    }
    ranges
}

fn lists(mesh: &mut Mesh) {
    let gvs = mesh.gv_position.len();
    mesh.gv_av = Csr::from_pairs(gvs, &numbered(mesh.av_gv.iter().copied()));
    let corner_gv = |t: &Triangle| t.av.map(|av| mesh.av_gv[av as usize]);
    mesh.gv_corner = Csr::from_pairs(gvs, &numbered(mesh.triangles.iter().flat_map(corner_gv)));
}

fn numbered(lists: impl Iterator<Item = u32>) -> Vec<(u32, u32)> {
    lists.zip(0..).collect()
}

#[cfg(test)]
mod tests;
