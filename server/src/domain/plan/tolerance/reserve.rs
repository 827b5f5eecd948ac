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
    /// then, though the tessellation kept it.
    #[must_use]
    pub fn moved(&self, fit: Fit, error_local: f64) -> Option<Fit> {
        let Reserve { error_local: reserved, share } = self.reserve?;
        let asked = self.tolerance_local / (1.0 - share);
        let bound_local = fit.bound_local + asked * share * error_local / reserved;
        if fit.budget_reached {
            return Some(Fit { bound_local, tolerance_local: bound_local, ..fit });
        }
        (bound_local <= asked * (1.0 + 1e-12)).then_some(Fit { bound_local, tolerance_local: asked, ..fit })
    }
}
