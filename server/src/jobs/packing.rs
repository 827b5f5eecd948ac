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

/// The grid of a surface of which nothing but its tolerance may keep it from being quantised.
pub(super) fn grid(plan: &SurfacePlan, surface: &mut Surface) -> Option<Grid> {
    let grid = Grid::around(&surface.positions);
    too_coarse(grid, plan, surface).is_none().then_some(grid)
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

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::domain::{
        fit::Fit,
        mesh::{Mesh, Primitive},
        request::{Allowed, Base, ErrorAt, Geometry, Normals, Quality, Refinement, SeamRule, Tolerance},
        scene::SceneMesh,
    };

    /// A mesh whose longest side is 1, shown by a node.
    fn scene() -> Scene {
        let document = json!({ "meshes": [{ "primitives": [{}] }], "nodes": [{ "mesh": 0 }] });
        let primitives = vec![Primitive { triangles: 0..1, ..Primitive::default() }];
        let gv_position = vec![[0.0; 3], [1.0, 0.5, 0.0]];
        let mesh = Mesh { name: "wall".into(), primitives, gv_position, ..Mesh::default() };
        Scene { document, meshes: vec![SceneMesh { gltf_mesh: 0, mesh }], diagonal: 1.0, ..Scene::default() }
    }

    fn plan(scene: &Scene, tolerance: f64) -> SurfacePlan {
        let allowed = Allowed::World(tolerance);
        let tolerance = Tolerance { allowed, error_at: ErrorAt::Surface, quality: Quality::Normal };
        let geometry = Geometry {
            refinement: Refinement::Tolerance(tolerance.clone()),
            max_triangles: None,
            normals: Normals::Analytic,
            seams: SeamRule::Mean,
            feather_texels: 0.0,
            base: Base::Flat,
        };
        let (mut plan, _) = SurfacePlan::within_tolerance(0, scene, &tolerance, &geometry, 1000).unwrap();
        if let TessellationPlan::Tolerance(tolerance) = &mut plan.tessellation {
            tolerance.keep_back(&scene.meshes[0].mesh, 0.0);
        }
        plan
    }

    /// What is chosen for a surface of the mesh's size that keeps all the plan leaves it.
    fn chosen(scene: &mut Scene, tolerance: f64) -> (Packing, Fit) {
        let plan = plan(scene, tolerance);
        let TessellationPlan::Tolerance(kept) = &plan.tessellation else { panic!("a tolerance was planned") };
        let bound_local = kept.tolerance_local;
        let fit = Fit { bound_local, tolerance_local: bound_local, certified: true, ..Fit::default() };
        let positions = scene.meshes[0].mesh.gv_position.clone();
        let mut surfaces = [Surface { positions, fit: Some(fit), ..Surface::default() }];
        let packing = choose(scene, &[plan], &mut surfaces, Compression::Quantize);
        (packing, surfaces[0].fit.unwrap())
    }

    #[test]
    fn a_tolerance_that_bears_it_is_kept_with_quantised_positions() {
        let mut scene = scene();
        let (packing, fit) = chosen(&mut scene, 1e-3);
        assert!(packing.grids[0].is_some() && scene.warnings.is_empty());
        assert!((fit.bound_local - 1e-3).abs() < 1e-12 && (fit.tolerance_local - 1e-3).abs() < 1e-12, "{fit:?}");
    }

    #[test]
    fn a_tolerance_too_small_for_16_bits_keeps_f32_and_says_why() {
        let mut scene = scene();
        let (packing, fit) = chosen(&mut scene, 5e-5);
        assert_eq!(packing.grids, [None]);
        assert_eq!(fit.bound_local, 5e-5);
        let [warning] = &scene.warnings[..] else { panic!("{:?}", scene.warnings) };
        assert_eq!(warning.code, "positions_not_quantized");
        for part in ["'wall'", "16 bits", "1.321e-5", "5.000e-5", "allow more"] {
            assert!(warning.message.contains(part), "{part}: {}", warning.message);
        }
    }

    #[test]
    fn an_obstacle_is_told_and_nothing_is_chosen_where_nothing_is_asked() {
        let mut scene = scene();
        scene.document["nodes"][0]["skin"] = 0.into();
        assert_eq!(chosen(&mut scene, 1e-3).0.grids, [None]);
        assert!(scene.warnings[0].message.contains("a skin places them"));
        assert_eq!(choose(&mut scene, &[], &mut [], Compression::None), Packing::default());
    }
}
