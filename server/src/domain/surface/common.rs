//! Two tessellations of one base mesh cut by one another: the parts on each of which both are flat.
//!
//! Within a base triangle the triangles of either tile it, in whole units of 2^-24 of its sides, so that the parts of both
//! are convex and found exactly (`cut.rs`). A corner of a part is a vertex of one, or where a side of one crosses a side of
//! the other. Crossings are rounded to whole units to name them, after they are evaluated: what two parts share has one
//! name, and nothing opens between them.

mod cut;
mod meet;

use std::sync::Arc;

use rayon::prelude::*;

use super::{Layout, Pieces, Surface};
use crate::domain::{fit::Fit, mesh::Mesh};
use meet::Met;

/// Vertices of a tessellation, of which a place is a mean, and their weights.
type At = ([u32; 3], [f64; 3]);

/// The parts, as a tessellation of its own.
#[derive(Clone, Debug)]
pub struct Common {
    layout: Layout,
    triangles: Vec<[u32; 3]>,
    /// Of each fine vertex: where it is in either.
    at: Vec<[At; 2]>,
}

impl Common {
    /// Of two surfaces whose triangles tile base triangles.
    #[must_use]
    pub fn new(mesh: &Mesh, surfaces: [&Surface; 2]) -> Self {
        let edges: Vec<Vec<u32>> = (0..mesh.ae_av.len() as u32).map(|ae| along(mesh, surfaces, ae)).collect();
        let met: Vec<Met> = (0..mesh.triangles.len()).into_par_iter().map(|t| Met::new(mesh, surfaces, t)).collect();
        let pieces = Pieces {
            edge_first: firsts(edges.iter().map(Vec::len)),
            edge_place: edges.concat(),
            interior_first: firsts(met.iter().map(|met| met.inside.len())),
            interior_place: met.iter().flat_map(|met| met.inside.keys().map(|[b2, b1]| [*b1, *b2])).collect(),
            triangle_first: firsts(met.iter().map(|met| met.triangles.len())),
            is_spanning: false,
        };
        let mut at: Vec<[At; 2]> = (0..mesh.av_gv.len() as u32).map(|av| [only(av), only(av)]).collect();
        for (ae, places) in (0..).zip(&edges) {
            let own = surfaces.map(|surface| self::places(mesh, surface, ae));
            let of = |n: usize, place| on_edge(mesh, (surfaces[n], &own[n]), ae, place);
            at.extend(places.iter().map(|place| [of(0, *place), of(1, *place)]));
        }
        at.extend(met.iter().flat_map(|met| met.inside.values().copied()));
        let triangles = met.par_iter().enumerate().flat_map_iter(|(t, met)| met.numbered(mesh, &pieces, t)).collect();
        Self { layout: Layout::Pieces(Arc::new(pieces)), triangles, at }
    }

    #[must_use]
    pub fn triangles(&self) -> usize {
        self.triangles.len()
    }

    /// Where either puts each corner of a part, mesh-local units.
    pub fn pairs<'c>(&'c self, surfaces: [&'c Surface; 2]) -> impl IndexedParallelIterator<Item = [[f64; 3]; 2]> + 'c {
        let place = move |at: &[At; 2], n: usize| mean(&surfaces[n].positions, &at[n]);
        self.at.par_iter().map(move |at| [place(at, 0), place(at, 1)])
    }

    /// What is a share of the way from the first to the second, 0 to 1, in every place of the base.
    #[must_use]
    pub fn between(&self, mesh: &Mesh, surfaces: [&Surface; 2], share: f64) -> Surface {
        let [a, b] = surfaces;
        let both = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|k| a[k] + share * (b[k] - a[k]));
        let of = |a: &[[f32; 3]], b: &[[f32; 3]], at: &[At; 2]| both(mean(a, &at[0]), mean(b, &at[1]));
        let positions = self.at.par_iter().map(|at| of(&a.positions, &b.positions, at).map(|x| x as f32));
        let normals = self.at.par_iter().map(|at| unit(of(&a.normals, &b.normals, at)));
        let attributes = mesh.attributes.iter().zip(&a.attributes).map(|(attribute, values)| {
            let blend = |at: &[At; 2]| blended(values, attribute.components, &at[0]);
            self.at.par_iter().flat_map_iter(blend).collect()
        });
        Surface {
            layout: self.layout.clone(),
            positions: positions.collect(),
            normals: normals.collect(),
            attributes: attributes.collect(),
            triangles: self.triangles.clone(),
            mismatch_max: a.mismatch_max.max(b.mismatch_max),
            flipped: 0,
            fit: a.fit.zip(b.fit).map(worse),
        }
    }
}

/// What holds for both.
fn worse((a, b): (Fit, Fit)) -> Fit {
    Fit {
        bound_local: a.bound_local.max(b.bound_local),
        tolerance_local: a.tolerance_local.max(b.tolerance_local),
        certified: a.certified && b.certified,
        rounds: a.rounds.max(b.rounds),
        collapse_rounds: a.collapse_rounds.max(b.collapse_rounds),
        budget_reached: a.budget_reached || b.budget_reached,
    }
}

fn only(vertex: u32) -> At {
    ([vertex; 3], [1.0, 0.0, 0.0])
}

/// The inner vertices of either on an edge, in units from its first av.
fn along(mesh: &Mesh, surfaces: [&Surface; 2], ae: u32) -> Vec<u32> {
    let mut places: Vec<u32> = surfaces.into_iter().flat_map(|surface| places(mesh, surface, ae)).collect();
    places.sort_unstable();
    places.dedup();
    places
}

fn places(mesh: &Mesh, surface: &Surface, ae: u32) -> Vec<u32> {
    let place = |vertex| match surface.layout.place(mesh, vertex) {
        super::Place::Edge { along, .. } => along,
        _ => 0,
    };
    surface.edge_vertices(mesh, ae).map(place).collect()
}

/// Between the neighbours there. The aes of one ge get the same weights of the same positions.
fn on_edge(mesh: &Mesh, (surface, own): (&Surface, &[u32]), ae: u32, along: u32) -> At {
    let first = surface.edge_vertices(mesh, ae).start as u32;
    let [start, end] = mesh.ae_av[ae as usize];
    let next = own.partition_point(|place| *place < along);
    let vertex = |k: usize| first + k as u32;
    if own.get(next) == Some(&along) {
        return only(vertex(next));
    }
    let (from, low) = if next == 0 { (start, 0) } else { (vertex(next - 1), own[next - 1]) };
    let (to, high) =
        if next == own.len() { (end, displace_glsl::layout::refine::UNIT) } else { (vertex(next), own[next]) };
    let share = f64::from(along - low) / f64::from(high - low);
    ([from, to, to], [1.0 - share, share, 0.0])
}

fn mean(values: &[[f32; 3]], (ids, weights): &At) -> [f64; 3] {
    let [a, b, c] = ids.map(|id| values[id as usize].map(f64::from));
    // Left as it is where it is one vertex.
    [0, 1, 2].map(|k| if weights[0] == 1.0 { a[k] } else { weights[0] * a[k] + weights[1] * b[k] + weights[2] * c[k] })
}

fn blended(values: &[f32], components: usize, (ids, weights): &At) -> Vec<f32> {
    let value = |id: u32, k: usize| f64::from(values[id as usize * components + k]);
    let sum = |k: usize| ids.iter().zip(weights).map(|(id, weight)| weight * value(*id, k)).sum::<f64>();
    (0..components).map(|k| sum(k) as f32).collect()
}

fn unit(normal: [f64; 3]) -> [f32; 3] {
    glam::DVec3::from_array(normal).normalize_or(glam::DVec3::Y).as_vec3().to_array()
}

/// Where each list begins, and the end.
fn firsts(lengths: impl Iterator<Item = usize>) -> Vec<u32> {
    let mut end = 0;
    [0].into_iter()
        .chain(lengths.map(|length| {
            end += length as u32;
            end
        }))
        .collect()
}
