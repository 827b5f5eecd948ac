//! Where a place lies on maps that are not read at texture coordinates: closed forms over places and normals of a mesh.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use crate::domain::projection::{Projection, ProjectionBox};

/// A place on a map, and its share of what is shown.
pub(super) struct Spot {
    pub(super) uv: DVec2,
    pub(super) share: f64,
    /// Unit, in the mesh's space: where u grows, and where v shrinks.
    pub(super) axes: [DVec3; 2],
}

/// A place of a mesh, with a normal of any length; `None` where maps are read at texture coordinates.
pub(super) fn spots(kind: Projection, around: &ProjectionBox, place: DVec3, normal: DVec3) -> Option<Vec<Spot>> {
    let centre = DVec3::from_array(around.centre.map(f64::from));
    let p = (place - centre) / f64::from(around.side);
    let n = normal.normalize_or_zero();
    let flat = |axis: usize, share: f64| spot(axis, n[axis] < 0.0, p, share);
    let through = |axis: usize| vec![spot(axis, false, p, 1.0)];
    Some(match kind {
        Projection::Uv => return None,
        Projection::Sphere => vec![on_sphere(p, false)],
        Projection::SphereAsPrinted => vec![on_sphere(p, true)],
        Projection::PlanarX => through(0),
        Projection::PlanarY => through(1),
        Projection::PlanarZ => through(2),
        Projection::Box => {
            let largest = n.abs().max_element();
            let axis = (0..3).find(|k| n[*k].abs() == largest).unwrap_or(0);
            vec![flat(axis, 1.0)]
        }
        Projection::Triplanar => {
            let facing = n.to_array().map(|c| (c.abs() - 0.2).max(0.0).powi(3));
            let all: f64 = facing.iter().sum();
            (0..3).map(|k| flat(k, if all > 0.0 { facing[k] / all } else { 1.0 / 3.0 })).collect()
        }
    })
}

/// The map upright, as an eye outside sees it.
fn spot(axis: usize, from_behind: bool, p: DVec3, share: f64) -> Spot {
    let [right, up] = [[-DVec3::Z, DVec3::Y], [DVec3::X, -DVec3::Z], [DVec3::X, DVec3::Y]][axis];
    let right = if from_behind { -right } else { right };
    Spot { uv: DVec2::new(0.5 + p.dot(right), 0.5 - p.dot(up)), share, axes: [right, up] }
}

fn on_sphere(p: DVec3, as_printed: bool) -> Spot {
    let around = p.with_y(0.0).length();
    let (phi, sense) = if as_printed && p.z > 0.0 { (p.z.atan2(p.x), -1.0) } else { ((-p.z).atan2(p.x), 1.0) };
    let outwards = if around > 0.0 { p.with_y(0.0) / around } else { DVec3::X };
    let along = DVec3::Y.cross(outwards);
    let north = (DVec3::Y * around - outwards * p.y).normalize_or_zero();
    let uv = DVec2::new((phi / TAU).rem_euclid(1.0), around.atan2(p.y) / PI);
    Spot { uv, share: 1.0, axes: [along * sense, north] }
}
