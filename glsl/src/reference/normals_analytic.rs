//! Normals of the displaced surface by its derivatives. The twin of `normals_analytic.comp`.

use glam::{DMat3, DVec3};

use super::{
    frame::Jet,
    samples::Sample,
    site::vector,
    smooth::{self, Fields},
};
use crate::tables::Tables;

/// The normal of a vertex from its contributions: the sample at the vertex in each base triangle that
/// shades it, and the jet of the displacement there. `corner` is the av of a corner vertex.
#[must_use]
pub fn normal(tables: &Tables, corner: Option<u32>, contributions: &[(Sample, Jet)]) -> DVec3 {
    let moved = contributions.iter().any(|(_, d)| *d != DMat3::ZERO);
    let sum: DVec3 = contributions.iter().map(|(own, d)| displaced(tables, own, *d)).sum();
    let base: DVec3 = match corner {
        Some(av) => vector(&tables.av_normal[av as usize]),
        None => contributions
            .iter()
            .map(|(own, _)| smooth::fields(tables, &own.site).normal.x_axis)
            .sum::<DVec3>()
            .normalize(),
    };
    if moved && sum.length() > 1e-6 { sum.normalize() } else { base }
}

/// Unit normal of one displaced base triangle, on the side of its shading normal; zero where undefined.
fn displaced(tables: &Tables, own: &Sample, d: Jet) -> DVec3 {
    let Fields { position: p, normal, .. } = smooth::fields(tables, &own.site);
    let n = normal.x_axis.normalize();
    let along = |p: DVec3, d: DVec3| p - n * n.dot(p) + d;
    let side = p.y_axis.cross(p.z_axis).dot(n);
    let normal = along(p.y_axis, d.y_axis).cross(along(p.z_axis, d.z_axis)).normalize_or_zero();
    if side == 0.0 { DVec3::ZERO } else { normal * side.signum() }
}
