//! What a report says of seams, measured on the result.

use glam::DVec3;

use crate::domain::{
    mesh::Mesh,
    report::{Report, Seams, Warning},
    scene::{Scene, SceneMesh},
    surface::Surface,
};

/// Fills in the seam figures and warns where the sides of a seam disagree.
pub(super) fn describe(report: &mut Report, scene: &mut Scene, surfaces: &[Surface]) {
    let meshes = scene.meshes.iter().map(|m| &m.mesh);
    let gap_max = meshes.zip(surfaces).map(|(mesh, surface)| gap(mesh, surface)).fold(0.0, f64::max);
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

/// Largest distance between the fine vertices of one geometric vertex.
fn gap(mesh: &Mesh, surface: &Surface) -> f64 {
    let inner = displace_glsl::lattice::edge_points(surface.level) as usize;
    let avs = mesh.av_gv.len();
    let mut largest: f64 = 0.0;
    for gv in 0..mesh.gv_position.len() {
        largest = largest.max(spread(surface, mesh.gv_av.list(gv).iter().map(|&av| av as usize)));
    }
    for ge in 0..mesh.ge_gv.len() {
        let aes = mesh.ge_ae.list(ge);
        if aes.len() > 1 {
            for k in 0..inner {
                largest = largest.max(spread(surface, aes.iter().map(|&ae| avs + ae as usize * inner + k)));
            }
        }
    }
    largest
}

fn spread(surface: &Surface, mut vertices: impl Iterator<Item = usize>) -> f64 {
    let Some(first) = vertices.next() else { return 0.0 };
    let a = surface.positions[first];
    let distance = |v: usize| {
        let b = surface.positions[v];
        (0..3).map(|k| f64::from(a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
    };
    vertices.map(distance).fold(0.0, f64::max)
}
