//! What a report says of a tolerance: whether it is kept, and how well.

mod measured;
mod near;

use std::sync::Arc;

use crate::domain::{
    Result,
    cancel::Cancel,
    detail::Detail,
    fit::Fit,
    grid::Grid,
    plan::{SurfacePlan, TessellationPlan, TolerancePlan},
    report::{Accuracy, Fitted, Report, ToleranceUnit, Warning},
    request::{Allowed, ErrorAt, Geometry, Tolerance},
    scene::Scene,
    surface::Surface,
};

/// The surfaces of all meshes, and what they were made of.
#[derive(Clone, Copy)]
pub(super) struct Made<'a> {
    pub(super) plans: &'a [SurfacePlan],
    pub(super) surfaces: &'a [Surface],
    /// For each mesh, for each of its primitives.
    pub(super) details: &'a [Vec<Option<Arc<Detail>>>],
    /// Of meshes whose positions are quantised; those left out are not.
    pub(super) grids: &'a [Option<Grid>],
}

/// One mesh.
struct Part<'a> {
    name: &'a str,
    surface: usize,
    plan: &'a TolerancePlan,
    fit: Fit,
    /// As `Fit::bound_local`, of the places looked at.
    measured_local: f64,
}

/// Fills in what the result keeps of its tolerance, and warns where that is less than asked for, or not proven. Fails
/// where the job is cancelled.
pub(super) fn describe(
    report: &mut Report,
    scene: &mut Scene,
    made: Made<'_>,
    geometry: &Geometry,
    cancel: &Cancel,
) -> Result<()> {
    let Some(asked) = geometry.tolerance() else { return Ok(()) };
    let parts = (0..made.surfaces.len()).filter_map(|index| part(scene, made, index, geometry, cancel).transpose());
    let parts: Vec<Part<'_>> = parts.collect::<Result<_>>()?;
    report.fitted = fitted(asked, &parts);
    let warnings: Vec<Warning> = parts.iter().flat_map(|part| part.warnings(asked, made)).collect();
    scene.warnings.extend(warnings);
    Ok(())
}

/// The tolerance that a surface keeps, and its bound, in the unit of the request; none where no tolerance decided.
pub(super) fn kept(plan: &SurfacePlan, surface: &Surface) -> Option<(f64, f64)> {
    let (TessellationPlan::Tolerance(plan), Some(fit)) = (&plan.tessellation, surface.fit) else { return None };
    Some((fit.tolerance_local * plan.unit_per_local, fit.bound_local * plan.unit_per_local))
}

/// None where no tolerance decided.
fn part<'a>(
    scene: &'a Scene,
    made: Made<'a>,
    index: usize,
    geometry: &Geometry,
    cancel: &Cancel,
) -> Result<Option<Part<'a>>> {
    let (TessellationPlan::Tolerance(plan), Some(fit)) = (&made.plans[index].tessellation, made.surfaces[index].fit)
    else {
        return Ok(None);
    };
    let mesh = &scene.meshes[index].mesh;
    let measured_local = made.measured_local((index, mesh), plan, geometry, cancel)?;
    Ok(Some(Part { name: &mesh.name, surface: index, plan, fit, measured_local }))
}

/// What a tolerance may seem larger by, as a share, for having been converted to local units and back.
const CONVERTED: f64 = 1e-9;

/// The worst of all meshes.
fn fitted(asked: &Tolerance, parts: &[Part<'_>]) -> Option<Fitted> {
    let worst = |of: &dyn Fn(&Part<'_>) -> f64| parts.iter().map(of).reduce(f64::max);
    let bound = worst(&|part| part.fit.bound_local * part.plan.unit_per_local)?;
    let measured = worst(&|part| part.measured_local * part.plan.unit_per_local)?;
    let (tolerance, achieved) = (asked.allowed.value(), worst(&|part| part.achieved())?);
    Some(Fitted {
        tolerance,
        achieved_tolerance: if achieved <= tolerance * (1.0 + CONVERTED) { tolerance } else { achieved },
        accuracy: Accuracy { bound, measured, unit: unit(&asked.allowed) },
        rounds: parts.iter().map(|part| part.fit.rounds + part.fit.collapse_rounds).max()?,
    })
}

fn unit(allowed: &Allowed) -> ToleranceUnit {
    match allowed {
        Allowed::Diagonal(_) => ToleranceUnit::Diagonal,
        Allowed::World(_) => ToleranceUnit::World,
        Allowed::Pixels { .. } => ToleranceUnit::Pixels,
    }
}

impl Part<'_> {
    /// In the unit of the request.
    fn achieved(&self) -> f64 {
        self.fit.tolerance_local * self.plan.unit_per_local
    }

    fn warnings(&self, asked: &Tolerance, made: Made<'_>) -> Vec<Warning> {
        let estimated = !self.fit.certified && asked.error_at == ErrorAt::Surface;
        let budget = self.fit.budget_reached.then(|| self.budget_reached(&asked.allowed));
        let near = self.too_near(&made.surfaces[self.surface], &asked.allowed);
        budget.into_iter().chain(estimated.then(|| self.estimated())).chain(near).collect()
    }

    fn budget_reached(&self, allowed: &Allowed) -> Warning {
        let message = format!(
            "mesh '{}' reached the {} triangles allowed: it keeps {:.3e} ({unit}) where {:.3e} was asked for: raise max_triangles or the memory of a job, or allow more",
            self.name,
            self.plan.max_triangles,
            self.achieved(),
            allowed.value(),
            unit = allowed.unit(),
        );
        Warning::new("budget_reached", message)
    }

    fn estimated(&self) -> Warning {
        let figure = format!("the accuracy of mesh '{}'", self.name);
        Warning::estimated_not_certified(&figure, "its detail has none that can be proven everywhere")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::{
        mesh::Mesh,
        request::{Base, Normals, Quality, Refinement, SeamRule},
        scene::SceneMesh,
    };

    fn geometry(allowed: Allowed, error_at: ErrorAt) -> Geometry {
        Geometry {
            refinement: Refinement::Tolerance(Tolerance { allowed, error_at, quality: Quality::Normal }),
            max_triangles: None,
            normals: Normals::Analytic,
            seams: SeamRule::Mean,
            feather_texels: 0.0,
            base: Base::Flat,
        }
    }

    /// The report and the warnings of two meshes of which a local unit is two of the world.
    fn described(fits: [Fit; 2], error_at: ErrorAt) -> (Report, Vec<Warning>) {
        let geometry = geometry(Allowed::World(0.5), error_at);
        let mesh = |name: &str| SceneMesh { gltf_mesh: 0, mesh: Mesh { name: name.into(), ..Mesh::default() } };
        let mut scene = Scene { meshes: vec![mesh("a"), mesh("b")], ..Scene::default() };
        let tolerance = geometry.tolerance().unwrap();
        let plan = |index| SurfacePlan::within_tolerance(index, &scene, tolerance, &geometry, 1000).unwrap().0;
        let mut plans = [plan(0), plan(1)];
        for plan in &mut plans {
            let TessellationPlan::Tolerance(tolerance) = &mut plan.tessellation else { panic!("a tolerance") };
            (tolerance.tolerance_local, tolerance.unit_per_local) = (0.25, 2.0);
        }
        let surfaces = fits.map(|fit| Surface { fit: Some(fit), ..Surface::default() });
        let mut report = Report::default();
        let made = Made { plans: &plans, surfaces: &surfaces, details: &[vec![], vec![]], grids: &[] };
        describe(&mut report, &mut scene, made, &geometry, &Cancel::default()).unwrap();
        (report, scene.warnings)
    }

    fn kept(bound_local: f64) -> Fit {
        let fit = Fit { bound_local, tolerance_local: 0.25, certified: true, ..Fit::default() };
        Fit { rounds: 7, collapse_rounds: 2, ..fit }
    }

    #[test]
    fn the_worst_mesh_speaks_for_all_in_the_unit_of_the_request() {
        let (report, warnings) = described([kept(0.125), Fit { rounds: 3, ..kept(0.2) }], ErrorAt::Surface);
        let accuracy = Accuracy { bound: 0.4, measured: 0.0, unit: ToleranceUnit::World };
        assert_eq!(report.fitted, Some(Fitted { tolerance: 0.5, achieved_tolerance: 0.5, accuracy, rounds: 9 }));
        assert_eq!(warnings, []);
    }

    #[test]
    fn a_budget_that_ends_refinement_is_told_with_figures_and_remedy() {
        let short = Fit { budget_reached: true, tolerance_local: 0.75, bound_local: 0.75, ..kept(0.0) };
        let (report, warnings) = described([kept(0.1), short], ErrorAt::Surface);
        assert_eq!(report.fitted.unwrap().achieved_tolerance, 1.5);
        let [warning] = &warnings[..] else { panic!("{warnings:?}") };
        assert_eq!(warning.code, "budget_reached");
        for part in ["'b'", "1000 triangles", "1.500e0", "5.000e-1", "world units", "raise max_triangles"] {
            assert!(warning.message.contains(part), "{part}: {}", warning.message);
        }
    }

    #[test]
    fn an_estimate_is_told_unless_it_is_what_was_asked_for() {
        let estimate = Fit { certified: false, ..kept(0.1) };
        let (_, warnings) = described([estimate, kept(0.1)], ErrorAt::Surface);
        assert_eq!(warnings.iter().map(|w| &*w.code).collect::<Vec<_>>(), ["estimated_not_certified"]);
        assert_eq!(described([estimate, estimate], ErrorAt::Texels).1, []);
    }

    #[test]
    fn nothing_is_said_where_no_tolerance_decided() {
        let (mut report, mut scene) = (Report::default(), Scene::default());
        let uniform =
            Geometry { refinement: Refinement::Uniform(1), ..geometry(Allowed::World(1.0), ErrorAt::Surface) };
        let made = Made { plans: &[], surfaces: &[], details: &[], grids: &[] };
        describe(&mut report, &mut scene, made, &uniform, &Cancel::default()).unwrap();
        assert_eq!(report, Report::default());
    }
}
