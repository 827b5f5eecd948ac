//! What every mesh and every displaced surface must keep. Each check tells the first offence and counts all; a
//! check that holds is silent.
//!
//! | file | checks |
//! |---|---|
//! | `partition.rs` | that fine triangles tile their base triangles, in whole numbers |
//! | `attributes.rs` | that attributes are those of the base between its corners |
//! | `junctions.rs` | that no vertex lies within another triangle's side |

mod attributes;
mod junctions;
mod partition;

use std::{collections::HashMap, fmt};

use glam::DVec3;

pub use attributes::attributes;
pub use junctions::t_junctions;
pub use partition::partition;

use super::topology::{Edge, Topology};
use crate::domain::{
    mesh::{Mesh, Triangle},
    surface::Surface,
};

/// A rule that does not hold.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Broken {
    /// Snake case.
    pub rule: &'static str,
    /// How often.
    pub count: u64,
    /// What and where the first is.
    pub first: String,
}

impl fmt::Display for Broken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {} times, first {}", self.rule, self.count, self.first)
    }
}

impl Broken {
    /// None where there is no offence.
    fn of<T>(
        rule: &'static str,
        offences: impl IntoIterator<Item = T>,
        describe: impl FnOnce(T) -> String,
    ) -> Option<Self> {
        let mut offences = offences.into_iter();
        let first = describe(offences.next()?);
        Some(Self { rule, count: 1 + offences.count() as u64, first })
    }
}

/// All checks of a surface displaced from `mesh`: finite streams, indices in range, lists of a sound layout, triangles
/// that tile the base, attributes of the base, one position for each place, and the base's boundary, manifoldness,
/// winding and Euler characteristic; no T-junction where the base has none.
#[must_use]
pub fn of_surface(mesh: &Mesh, surface: &Surface) -> Vec<Broken> {
    let vertices = surface.positions.len();
    let unsound =
        indices(vertices, &surface.triangles).or_else(|| lists(mesh, surface)).or_else(|| sizes(mesh, surface));
    if let Some(broken) = unsound {
        return vec![broken];
    }
    let checks = [
        not_finite("positions_finite", &surface.positions),
        not_finite("normals_finite", &surface.normals),
        partition(mesh, surface),
        attributes(mesh, surface),
        one_position_per_place(mesh, surface),
    ];
    checks.into_iter().flatten().chain(kept(mesh, surface)).collect()
}

/// What the base has is what the surface has, as many edges for each of its edges as that has segments.
fn kept(mesh: &Mesh, surface: &Surface) -> Vec<Broken> {
    let corners = |t: &Triangle| t.av.map(|av| mesh.av_gv[av as usize]);
    let base = Topology::new(&mesh.gv_position, &mesh.triangles.iter().map(corners).collect::<Vec<_>>());
    let fine = Topology::new(&surface.positions, &surface.triangles);
    let segments = segments(mesh, surface);
    let of_base = |edge: &Edge| {
        let gvs = edge.places.map(|place| base.vertex_of_place[place as usize]);
        segments.get(&[gvs[0].min(gvs[1]), gvs[0].max(gvs[1])]).copied().unwrap_or(1)
    };
    let [base_edges, fine_edges] = [special_edges(&base, of_base), special_edges(&fine, |_| 1)];
    let [base_euler, fine_euler] = [base.euler_characteristic(), fine.euler_characteristic()];
    let rules = ["boundary_edges", "non_manifold_edges", "badly_wound_edges"];
    let edges = rules.iter().zip(base_edges).zip(fine_edges);
    let differences = edges.map(|((&rule, expected), found)| differs(rule, expected, found));
    let euler = differs("euler_characteristic", base_euler, fine_euler);
    let junctions = match t_junctions(&mesh.gv_position, &base) {
        None => t_junctions(&surface.positions, &fine),
        Some(_) => None,
    };
    differences.chain([euler, junctions]).flatten().collect()
}

/// Boundary, non-manifold and badly wound edges, each counted as `worth` says.
fn special_edges(topology: &Topology, worth: impl Fn(&Edge) -> i64) -> [i64; 3] {
    [
        topology.boundary().map(&worth).sum(),
        topology.non_manifold().map(&worth).sum(),
        topology.badly_wound().map(&worth).sum(),
    ]
}

/// How many segments each base edge has, by its gvs, the lower first.
fn segments(mesh: &Mesh, surface: &Surface) -> HashMap<[u32; 2], i64> {
    let of_edge = |(ge, gvs): (usize, &[u32; 2])| {
        let inner = mesh.ge_ae.list(ge).first().map_or(0, |ae| surface.edge_vertices(mesh, *ae).len());
        (*gvs, inner as i64 + 1)
    };
    mesh.ge_gv.iter().enumerate().map(of_edge).collect()
}

fn differs(rule: &'static str, expected: i64, found: i64) -> Option<Broken> {
    let first = format!("{found} where the base has {expected}");
    (found != expected).then(|| Broken { rule, count: found.abs_diff(expected), first })
}

fn lists(mesh: &Mesh, surface: &Surface) -> Option<Broken> {
    Broken::of("lists", surface.layout.fault(mesh), |fault| fault)
}

fn sizes(mesh: &Mesh, surface: &Surface) -> Option<Broken> {
    let (vertices, triangles) = (surface.layout.vertices(mesh), surface.layout.triangles(mesh));
    let found = [surface.positions.len(), surface.normals.len(), surface.triangles.len()];
    let wanted = [vertices, vertices, triangles];
    Broken::of("sizes", (found != wanted).then_some(()), |()| {
        format!("{found:?} positions, normals and triangles where the layout asks for {wanted:?}")
    })
}

/// Indices of triangles below `vertices`.
#[must_use]
pub fn indices(vertices: usize, triangles: &[[u32; 3]]) -> Option<Broken> {
    let beyond = |t: &(usize, &[u32; 3])| t.1.iter().any(|&v| v as usize >= vertices);
    Broken::of("indices_in_range", triangles.iter().enumerate().filter(beyond), |(t, ids)| {
        format!("triangle {t} {ids:?} of {vertices} vertices")
    })
}

/// No NaN and nothing infinite.
#[must_use]
pub fn not_finite<const N: usize>(rule: &'static str, values: &[[f32; N]]) -> Option<Broken> {
    let bad = values.iter().enumerate().filter(|(_, v)| v.iter().any(|x| !x.is_finite()));
    Broken::of(rule, bad, |(vertex, value)| format!("vertex {vertex} {value:?}"))
}

/// Edges, by exact position, with one triangle.
#[must_use]
pub fn boundary_edges(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> u64 {
    Topology::new(positions, triangles).boundary().count() as u64
}

/// Places − edges + triangles: topology is kept when this is.
#[must_use]
pub fn euler_characteristic(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> i64 {
    Topology::new(positions, triangles).euler_characteristic()
}

/// Fine vertices of one place of the base have bit-equal positions.
#[must_use]
pub fn one_position_per_place(mesh: &Mesh, surface: &Surface) -> Option<Broken> {
    let bits = |v: usize| surface.positions[v].map(f32::to_bits);
    let apart = |&[a, b]: &[usize; 2]| bits(a) != bits(b);
    Broken::of("one_position_per_place", shared(mesh, surface).filter(apart), |[a, b]| {
        let [p, q] = [a, b].map(|v| surface.positions[v]);
        format!("vertices {a} {p:?} and {b} {q:?}")
    })
}

/// The largest distance between two fine vertices of one place of the base: 0 where nothing is apart. With more
/// than two vertices in a place, at least half of it.
#[must_use]
pub fn largest_gap(mesh: &Mesh, surface: &Surface) -> f64 {
    let at = |v: usize| DVec3::from_array(surface.positions[v].map(f64::from));
    shared(mesh, surface).map(|[a, b]| at(a).distance(at(b))).fold(0.0, f64::max)
}

/// Fine vertices that share a place of the base: the first of each place with every other.
fn shared<'a>(mesh: &'a Mesh, surface: &'a Surface) -> impl Iterator<Item = [usize; 2]> + 'a {
    let with_first = |list: &'a [u32]| list.iter().skip(1).map(|&other| [list[0], other]);
    let corners = (0..mesh.gv_position.len()).flat_map(move |gv| with_first(mesh.gv_av.list(gv)));
    let edges = (0..mesh.ge_gv.len()).flat_map(move |ge| with_first(mesh.ge_ae.list(ge)));
    let along = edges.flat_map(move |aes| {
        let [first, other] = aes.map(|ae| surface.edge_vertices(mesh, ae));
        first.zip(other).map(|(a, b)| [a, b])
    });
    corners.map(|avs| avs.map(|av| av as usize)).chain(along)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_offence_is_told_and_all_are_counted() {
        let values = [[0.0, 1.0], [f32::NAN, 0.0], [0.0, f32::INFINITY]];
        let broken = not_finite("uv_finite", &values).expect("two are not finite");
        assert_eq!((broken.count, broken.first.starts_with("vertex 1 ")), (2, true));
        assert_eq!(not_finite("uv_finite", &values[..1]), None);
        let broken = indices(3, &[[0, 1, 2], [1, 2, 3], [9, 9, 9]]).expect("two are out of range");
        assert_eq!(broken.to_string(), "indices_in_range: 2 times, first triangle 1 [1, 2, 3] of 3 vertices");
    }
}
