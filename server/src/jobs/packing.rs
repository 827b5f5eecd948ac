//! Which meshes of a result are quantised: those that may be, and whose tolerance bears it.

use crate::domain::{
    gltf::{self, Packing},
    grid::Grid,
    plan::{SurfacePlan, TessellationPlan},
    report::Warning,
    request::Compression,
    scene::Scene,
    surface::Surface,
};

/// Chooses the grids; fits tell of the moved vertices from now on. A mesh that keeps f32 positions is told of by a
/// warning of the scene.
pub(super) fn choose(
    scene: &mut Scene,
    plans: &[SurfacePlan],
    surfaces: &mut [Surface],
    compression: Compression,
) -> Packing {
    if compression == Compression::None {
        return Packing::default();
    }
    let mut packing = Packing::finest(scene, surfaces, compression);
    let obstacles = gltf::obstacles(scene);
    for ((grid, obstacle), (plan, surface)) in packing.grids.iter_mut().zip(obstacles).zip(plans.iter().zip(surfaces)) {
        let why = match (*grid, obstacle) {
            (Some(found), _) => too_coarse(found, plan, surface),
            (None, obstacle) => obstacle.map(str::to_owned),
        };
        if let Some(why) = why {
            *grid = None;
            let name = &scene.meshes[plan.mesh].mesh.name;
            scene.warnings.push(kept(name, &why));
        }
    }
    packing
}

/// Why not, where a tolerance does not bear the error of the grid; else its fit is that of the moved vertices.
fn too_coarse(grid: Grid, plan: &SurfacePlan, surface: &mut Surface) -> Option<String> {
    let (TessellationPlan::Tolerance(tolerance), Some(fit)) = (&plan.tessellation, surface.fit) else { return None };
    match tolerance.moved(fit, grid.error_local()) {
        Some(moved) => {
            surface.fit = Some(moved);
            None
        }
        None => Some(format!(
            "16 bits would move them by up to {:.3e} local units, too much of the tolerance of {:.3e}: allow more",
            grid.error_local(),
            fit.tolerance_local
        )),
    }
}

fn kept(name: &str, why: &str) -> Warning {
    Warning::new("positions_not_quantized", format!("the positions of mesh '{name}' stay f32: {why}"))
}
