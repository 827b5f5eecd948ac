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

use std::fmt;

use glam::DVec3;

pub use attributes::attributes;
pub use junctions::t_junctions;
pub use partition::partition;

use super::topology::Topology;
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

/// All checks of a surface displaced from `mesh`: finite streams, indices in range, triangles that tile the base,
/// attributes of the base, one position for each place, and the base's boundary, manifoldness, winding and Euler
/// characteristic; no T-junction where the base has none.
#[must_use]
pub fn of_surface(mesh: &Mesh, surface: &Surface) -> Vec<Broken> {
    let vertices = surface.positions.len();
    if let Some(broken) = indices(vertices, &surface.triangles).or_else(|| sizes(mesh, surface)) {
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

/// What the base has is what the surface has, n = 2^level edges for each of its edges.
fn kept(mesh: &Mesh, surface: &Surface) -> Vec<Broken> {
    let corners = |t: &Triangle| t.av.map(|av| mesh.av_gv[av as usize]);
    let base = Topology::new(&mesh.gv_position, &mesh.triangles.iter().map(corners).collect::<Vec<_>>());
    let fine = Topology::new(&surface.positions, &surface.triangles);
    let n = 1i64 << surface.level;
    let count = |topology: &Topology| {
        [
            topology.boundary().count() as i64,
            topology.non_manifold().count() as i64,
            topology.badly_wound().count() as i64,
        ]
    };
    let [base_edges, fine_edges] = [count(&base), count(&fine)];
    let [base_euler, fine_euler] = [base.euler_characteristic(), fine.euler_characteristic()];
    let rules = ["boundary_edges", "non_manifold_edges", "badly_wound_edges"];
    let edges = rules.iter().zip(base_edges.map(|edges| n * edges)).zip(fine_edges);
    let differences = edges.map(|((&rule, expected), found)| differs(rule, expected, found));
    let euler = differs("euler_characteristic", base_euler, fine_euler);
    let junctions = match t_junctions(&mesh.gv_position, &base) {
        None => t_junctions(&surface.positions, &fine),
        Some(_) => None,
    };
    differences.chain([euler, junctions]).flatten().collect()
}

fn differs(rule: &'static str, expected: i64, found: i64) -> Option<Broken> {
    let first = format!("{found} where the base has {expected}");
    (found != expected).then(|| Broken { rule, count: found.abs_diff(expected), first })
}

fn sizes(mesh: &Mesh, surface: &Surface) -> Option<Broken> {
    let (inner, interior) = points(surface.level);
    let vertices = mesh.av_gv.len() + mesh.ae_av.len() * inner + mesh.triangles.len() * interior;
    let triangles = mesh.triangles.len() << (2 * surface.level);
    let found = [surface.positions.len(), surface.normals.len(), surface.triangles.len()];
    let wanted = [vertices, vertices, triangles];
    Broken::of("sizes", (found != wanted).then_some(()), |()| {
        format!("{found:?} positions, normals and triangles where the level asks for {wanted:?}")
    })
}

/// Fine vertices within an edge and within a triangle, as `Surface` documents them.
fn points(level: u32) -> (usize, usize) {
    let n = 1usize << level;
    (n - 1, (n - 1) * n.saturating_sub(2) / 2)
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
    Broken::of("one_position_per_place", shared(mesh, surface.level).filter(apart), |[a, b]| {
        let [p, q] = [a, b].map(|v| surface.positions[v]);
        format!("vertices {a} {p:?} and {b} {q:?}")
    })
}

/// The largest distance between two fine vertices of one place of the base: 0 where nothing is apart. With more
/// than two vertices in a place, at least half of it.
#[must_use]
pub fn largest_gap(mesh: &Mesh, surface: &Surface) -> f64 {
    let at = |v: usize| DVec3::from_array(surface.positions[v].map(f64::from));
    shared(mesh, surface.level).map(|[a, b]| at(a).distance(at(b))).fold(0.0, f64::max)
}

/// Fine vertices that share a place of the base: the first of each place with every other.
fn shared(mesh: &Mesh, level: u32) -> impl Iterator<Item = [usize; 2]> {
    let (inner, _) = points(level);
    let with_first = |list: &[u32]| -> Vec<[usize; 2]> {
        list.iter().skip(1).map(|&other| [list[0] as usize, other as usize]).collect()
    };
    let corners = (0..mesh.gv_position.len()).flat_map(move |gv| with_first(mesh.gv_av.list(gv)));
    let edges = (0..mesh.ge_gv.len()).flat_map(move |ge| with_first(mesh.ge_ae.list(ge)));
    let along = edges.flat_map(move |aes| (0..inner).map(move |k| aes.map(|ae| mesh.av_gv.len() + ae * inner + k)));
    corners.chain(along)
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
