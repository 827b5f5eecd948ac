//! The surface's own normals anywhere, by the passes that make those of vertices.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::{
    domain::{
        Error, Result,
        detail::Detail,
        mesh::Mesh,
        plan::SurfacePlan,
        report::PassTime,
        request::Geometry,
        surface::{Pieces, Place, Shape},
    },
    jobs::{WorkContext, inputs},
};

/// Places of one dispatch.
const LOT: usize = 1 << 21;

/// Of places inside base triangles, in their order.
pub(super) fn normals(
    context: &WorkContext<'_>,
    geometry: &Geometry,
    (index, mesh): (usize, &Mesh),
    details: &[Option<Arc<Detail>>],
    places: Vec<Place>,
    passes: &mut Vec<PassTime>,
) -> Result<Vec<DVec3>> {
    let plan = SurfacePlan::uniform(index, mesh, 0, geometry)?;
    let mut order: Vec<(Key, u32)> =
        places.into_par_iter().enumerate().map(|(n, place)| Ok((key(place)?, n as u32))).collect::<Result<_>>()?;
    order.par_sort_unstable();
    let mut normals = vec![DVec3::ZERO; order.len()];
    let mut rest = &order[..];
    while !rest.is_empty() {
        let (lot, distinct) = lot(rest);
        let (surface, times) = context.executor.finish(&context.job(), &plan, mesh, details, shape(mesh, &distinct))?;
        inputs::add_times(passes, times);
        let found = &surface.normals[mesh.av_gv.len()..];
        for (same, normal) in lot.chunk_by(|a, b| a.0 == b.0).zip(found) {
            same.iter().for_each(|(_, n)| normals[*n as usize] = Vec3::from(*normal).as_dvec3());
        }
        rest = &rest[lot.len()..];
    }
    Ok(normals)
}

/// The first of sorted places, all that are the same among them, and those that differ.
fn lot(sorted: &[(Key, u32)]) -> (&[(Key, u32)], Vec<Key>) {
    let groups = || sorted.chunk_by(|a, b| a.0 == b.0).take(LOT);
    let distinct = groups().map(|same| same[0].0).collect();
    (&sorted[..groups().map(<[_]>::len).sum()], distinct)
}

/// Base triangle, then the weights of its third and its second corner: the order of `Pieces`.
type Key = (u32, u32, u32);

fn key(place: Place) -> Result<Key> {
    match place {
        Place::Inside { triangle, b: [b1, b2] } => Ok((triangle, b2, b1)),
        Place::Corner { .. } | Place::Edge { .. } => Err(Error::internal("a place is not inside a base triangle")),
    }
}

/// The base vertices, and the places inside; no triangles.
fn shape(mesh: &Mesh, sorted: &[Key]) -> Shape {
    let mut interior_first = vec![0; mesh.triangles.len() + 1];
    sorted.iter().for_each(|(triangle, ..)| interior_first[*triangle as usize + 1] += 1);
    let mut sum = 0;
    for first in &mut interior_first {
        sum += *first;
        *first = sum;
    }
    let pieces = Pieces {
        is_spanning: false,
        edge_first: vec![0; mesh.ae_av.len() + 1],
        edge_place: Vec::new(),
        interior_first,
        interior_place: sorted.iter().map(|(_, b2, b1)| [*b1, *b2]).collect(),
        triangle_first: vec![0; mesh.triangles.len() + 1],
    };
    Shape { pieces, positions: vec![[0.0; 3]; mesh.av_gv.len() + sorted.len()], triangles: Vec::new() }
}
