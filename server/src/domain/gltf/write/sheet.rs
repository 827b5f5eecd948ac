//! A displaced primitive as readers of the file see it, for what is made from its triangles before it is written.

use rayon::prelude::*;

use super::{
    fine::{self, Fine},
    tangents,
};
use crate::domain::{Error, Result, mesh::Mesh, normal_map::Sheet, surface::Surface};

/// Primitive `index` of the mesh in the order of the surface, with MikkTSpace tangents of `TEXCOORD_{uv_set}`, which it
/// has.
pub fn sheet(mesh: &Mesh, surface: &Surface, index: usize, uv_set: u32) -> Result<Sheet> {
    fine::check(mesh, surface)?;
    let fine = Fine::new(mesh, surface, index);
    let semantic = format!("TEXCOORD_{uv_set}");
    let attribute = mesh.attributes.iter().position(|a| a.semantic == semantic && a.primitives[index]);
    let uvs = attribute.map(|attribute| &surface.attributes[attribute]);
    let uvs = uvs.ok_or_else(|| Error::internal(format!("a sheet of mesh '{}' without {semantic}", mesh.name)))?;
    let split = tangents::made(&fine, uvs)?;
    let global: Vec<usize> = split.listing.vertices.iter().map(|v| fine.global(*v as usize)).collect();
    let first = surface.layout.triangles_of_primitive(fine.primitive).start;
    let count = split.listing.triangles.len();
    let bases: Vec<u32> = (first..first + count).into_par_iter().map(|t| surface.layout.base_of(t)).collect();
    let place = |(triangle, base): (&[u32; 3], &u32)| -> Option<[[u32; 3]; 3]> {
        let at = |v: u32| surface.layout.place(mesh, global[v as usize]).within(mesh, *base as usize);
        let [a, b, c] = triangle.map(at);
        Some([a?, b?, c?])
    };
    let places: Option<Vec<_>> = split.listing.triangles.par_iter().zip(&bases).map(place).collect();
    Ok(Sheet {
        positions: global.iter().map(|v| surface.positions[*v]).collect(),
        normals: global.iter().map(|v| surface.normals[*v]).collect(),
        uvs: global.iter().map(|v| [uvs[2 * v], uvs[2 * v + 1]]).collect(),
        tangents: split.tangents,
        triangles: split.listing.triangles,
        places: places.ok_or_else(|| Error::internal("a triangle has a corner that is not of its base triangle"))?,
        bases,
    })
}
