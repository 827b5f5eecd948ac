//! What a report says of seams, measured on the result.

use glam::DVec3;

use crate::{
    domain::{
        mesh::Mesh,
        report::{Report, Seams, Warning},
        scene::{Scene, SceneMesh},
        surface::Surface,
    },
    oracle::invariants::largest_gap,
};

/// Fills in the seam figures and warns where the sides of a seam disagree.
pub(super) fn describe(report: &mut Report, scene: &mut Scene, surfaces: &[Surface]) {
    let meshes = scene.meshes.iter().map(|m| &m.mesh);
    let gap_max = meshes.zip(surfaces).map(|(mesh, surface)| largest_gap(mesh, surface)).fold(0.0, f64::max);
    let mismatch_max = surfaces.iter().map(|s| f64::from(s.mismatch_max)).fold(0.0, f64::max);
    report.seams = Some(Seams { gap_max, mismatch_max });
    let shows = |(m, s): (&SceneMesh, &Surface)| f64::from(s.mismatch_max) > 1e-4 * diagonal(&m.mesh);
    if scene.meshes.iter().zip(surfaces).any(shows) {
        scene.warnings.push(Warning::new(
            "seam_mismatch",
            format!("the sides of a seam ask for heights up to {mismatch_max:.4} local units apart: the map does not tile across it; the surface was closed by a ramp"),
        ));
    }
}

/// Of the box of the base mesh, local units.
pub(super) fn diagonal(mesh: &Mesh) -> f64 {
    let points = || mesh.gv_position.iter().map(|p| DVec3::from_array(p.map(f64::from)));
    let low = points().fold(DVec3::INFINITY, DVec3::min);
    let high = points().fold(DVec3::NEG_INFINITY, DVec3::max);
    low.distance(high)
}
