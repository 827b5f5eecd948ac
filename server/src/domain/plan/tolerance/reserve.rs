//! What of a tolerance is kept back for vertices that are moved after tessellating, as quantising does.

use serde::{Deserialize, Serialize};

use super::{Sphere, TolerancePlan};
use crate::domain::{fit::Fit, grid::Grid, mesh::Mesh};

/// Largest share of a tolerance that is kept back: more would cost too many triangles.
const MOST: f64 = 0.2;

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reserve {
    /// How far vertices may be moved, mesh-local units.
    pub error_local: f64,
    /// What that is of the least tolerance asked for anywhere: what the plan has is the rest.
    pub share: f64,
}

impl TolerancePlan {
    /// Keeps back what quantising takes, where that is no more than a fifth of the tolerance. The surface is nowhere
    /// farther than `reach_local` from the base.
    pub fn keep_back(&mut self, mesh: &Mesh, reach_local: f64) {
        let sphere = Sphere::around(mesh);
        let error_local = Grid::error_over(sphere.longest + 2.0 * reach_local);
        // Twice the radius, so that it holds every sphere around a triangle.
        let least = self.tolerance_at(sphere.centre, 2.0 * (sphere.radius + reach_local));
        let share = error_local / least;
        if share > MOST || share.is_nan() {
            return;
        }
        self.tolerance_local *= 1.0 - share;
        self.views.iter_mut().for_each(|view| view.tolerance_at_unit_depth *= 1.0 - share);
        self.reserve = Some(Reserve { error_local, share });
    }

    /// The fit once vertices have been moved by up to `error_local`; none where the tolerance asked for does not hold
    /// then, though the tessellation kept it. What a budget or seams without ramps have broken already is broken further.
    #[must_use]
    pub fn moved(&self, fit: Fit, error_local: f64) -> Option<Fit> {
        let Reserve { error_local: reserved, share } = self.reserve?;
        let asked = self.tolerance_local / (1.0 - share);
        let bound_local = fit.bound_local + asked * share * error_local / reserved;
        if fit.budget_reached || fit.bound_local > asked {
            return Some(Fit { bound_local, tolerance_local: bound_local, ..fit });
        }
        (bound_local <= asked * (1.0 + 1e-12)).then_some(Fit { bound_local, tolerance_local: asked, ..fit })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::request::{ErrorAt, Quality};

    fn plan(tolerance_local: f64) -> TolerancePlan {
        TolerancePlan {
            tolerance_local,
            unit_per_local: 1.0,
            views: Vec::new(),
            error_at: ErrorAt::Surface,
            quality: Quality::Normal,
            max_triangles: 1000,
            spans_base: false,
            reserve: None,
        }
    }

    /// Its longest side is 2.
    fn mesh() -> Mesh {
        Mesh { gv_position: vec![[0.0; 3], [2.0, 1.0, 0.0]], ..Mesh::default() }
    }

    fn kept(bound_local: f64) -> Fit {
        Fit { bound_local, tolerance_local: 9e-4, certified: true, ..Fit::default() }
    }

    #[test]
    fn what_quantising_takes_is_kept_back_and_given_back() {
        let mut plan = plan(1e-3);
        plan.keep_back(&mesh(), 0.5);
        let reserve = plan.reserve.unwrap();
        assert_eq!(reserve.error_local, Grid::error_over(3.0));
        assert_eq!(plan.tolerance_local, 1e-3 * (1.0 - reserve.share));
        let fit = plan.moved(kept(plan.tolerance_local), reserve.error_local).unwrap();
        assert!((fit.bound_local - 1e-3).abs() < 1e-15 && (fit.tolerance_local - 1e-3).abs() < 1e-15, "{fit:?}");
        // A finer grid than feared takes less.
        let fit = plan.moved(kept(5e-4), 0.5 * reserve.error_local).unwrap();
        assert!((fit.bound_local - 5e-4 - 0.5 * reserve.error_local).abs() < 1e-15, "{fit:?}");
    }

    #[test]
    fn more_than_a_fifth_is_not_kept_back() {
        let mut plan = plan(4.9 * Grid::error_over(2.0));
        let before = plan.clone();
        plan.keep_back(&mesh(), 0.0);
        assert_eq!(plan, before);
        assert_eq!(plan.moved(kept(0.0), 1e-6), None);
    }

    #[test]
    fn a_grid_coarser_than_feared_is_refused_where_the_bound_leaves_no_room() {
        let mut plan = plan(1e-3);
        plan.keep_back(&mesh(), 0.0);
        let coarse = 2.0 * plan.reserve.unwrap().error_local;
        assert_eq!(plan.moved(kept(plan.tolerance_local), coarse), None);
        assert!(plan.moved(kept(5e-4), coarse).is_some());
    }

    #[test]
    fn where_the_tolerance_is_broken_already_the_bound_is_what_is_kept() {
        let mut plan = plan(1e-3);
        plan.keep_back(&mesh(), 0.0);
        let error = plan.reserve.unwrap().error_local;
        let short = Fit { bound_local: 2e-3, tolerance_local: 2e-3, budget_reached: true, ..Fit::default() };
        for broken in [short, Fit { budget_reached: false, ..short }] {
            let fit = plan.moved(broken, error).unwrap();
            assert_eq!(fit.bound_local, fit.tolerance_local);
            assert!((fit.bound_local - 2e-3 - error).abs() < 1e-15);
        }
    }
}
