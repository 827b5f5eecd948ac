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
    let keys: Vec<Key> = places.into_par_iter().map(key).collect::<Result<_>>()?;
    let mut distinct = keys.clone();
    distinct.par_sort_unstable();
    distinct.dedup();
    let mut found: Vec<[f32; 3]> = Vec::with_capacity(distinct.len());
    for lot in distinct.chunks(LOT) {
        let shape = shape(mesh, lot);
        let (surface, times) = context.executor.finish(&context.job(), &plan, mesh, details, shape)?;
        found.extend(&surface.normals[mesh.av_gv.len()..]);
        inputs::add_times(passes, times);
    }
    let of = |key: &Key| distinct.binary_search(key).map(|at| Vec3::from(found[at]).as_dvec3());
    let missing = |_| Error::internal("a place that was asked for has no normal");
    keys.par_iter().map(|key| of(key).map_err(missing)).collect()
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
        edge_first: vec![0; mesh.ae_av.len() + 1],
        edge_place: Vec::new(),
        interior_first,
        interior_place: sorted.iter().map(|(_, b2, b1)| [*b1, *b2]).collect(),
        triangle_first: vec![0; mesh.triangles.len() + 1],
    };
    Shape { pieces, positions: vec![[0.0; 3]; mesh.av_gv.len() + sorted.len()], triangles: Vec::new() }
}
