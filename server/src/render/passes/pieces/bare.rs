//! All of a surface but its normals, on the host: it is made of reading and writing.

use std::sync::Arc;

use displace_glsl::{
    reference::{site::vector, triangles},
    tables::Tables,
};
use rayon::prelude::*;

use crate::{
    domain::{
        Error, Result,
        mesh::{Attribute, Mesh},
        surface::{Layout, Shape, Surface},
    },
    render::passes::{check_finite, skin},
};

/// Interpolates attributes, blends skins and counts flipped triangles. Fails where a position is not finite.
pub fn surface(tables: &Tables, mesh: &Mesh, shape: Shape) -> Result<Surface> {
    let layout = Layout::Pieces(Arc::new(shape.pieces));
    let surface = Surface { layout, positions: shape.positions, triangles: shape.triangles, ..Surface::default() };
    check(mesh, &surface)?;
    check_finite(mesh, broken(&surface))?;
    let attributes = attributes(mesh, &surface.layout);
    Ok(Surface { attributes, flipped: flipped(tables, mesh, &surface), ..surface })
}

/// Fails when the shape is not one of the mesh: a fault of ours.
fn check(mesh: &Mesh, surface: &Surface) -> Result<()> {
    let fault = |what: String| Err(Error::internal(format!("the shape of mesh '{}': {what}", mesh.name)));
    if let Some(what) = surface.layout.fault(mesh) {
        return fault(what);
    }
    let wanted = [surface.layout.vertices(mesh), surface.layout.triangles(mesh)];
    let found = [surface.positions.len(), surface.triangles.len()];
    let beyond = surface.triangles.par_iter().flatten().any(|vertex| *vertex as usize >= wanted[0]);
    if found != wanted || beyond {
        return fault(format!("{found:?} vertices and triangles where the lists have {wanted:?}"));
    }
    Ok(())
}

fn broken(surface: &Surface) -> u64 {
    let sound = |vertex: &u32| surface.positions[*vertex as usize].iter().all(|x| x.is_finite());
    surface.triangles.par_iter().filter(|ids| !ids.iter().all(sound)).count() as u64
}

fn flipped(tables: &Tables, mesh: &Mesh, surface: &Surface) -> u64 {
    let back = |t: u32, ids: &[u32; 3]| {
        let corners = ids.map(|vertex| vector(&surface.positions[vertex as usize]));
        triangles::facing(tables, t, corners) < 0.0
    };
    let of_base = |t: usize| {
        let fine = &surface.triangles[surface.triangles_of(t)];
        fine.iter().filter(|ids| back(t as u32, ids)).count() as u64
    };
    (0..mesh.triangles.len()).into_par_iter().map(of_base).sum()
}

fn attributes(mesh: &Mesh, layout: &Layout) -> Vec<Vec<f32>> {
    let one = |attribute: &Attribute| {
        if skin::is_skin(&attribute.semantic) { Vec::new() } else { interpolated(mesh, layout, attribute) }
    };
    let mut values: Vec<Vec<f32>> = mesh.attributes.iter().map(one).collect();
    skin::blend(layout, mesh, &mut values);
    values
}

fn interpolated(mesh: &Mesh, layout: &Layout, attribute: &Attribute) -> Vec<f32> {
    let components = attribute.components;
    let mut values = vec![0.0; layout.vertices(mesh) * components];
    values.par_chunks_mut(components.max(1)).enumerate().for_each(|(vertex, values)| {
        let (avs, weights) = layout.place(mesh, vertex).site(mesh);
        for (k, value) in values.iter_mut().enumerate() {
            let at = |corner: usize| f64::from(attribute.values[avs[corner] as usize * components + k]);
            *value = (weights[0] * at(0) + weights[1] * at(1) + weights[2] * at(2)) as f32;
        }
    });
    values
}
