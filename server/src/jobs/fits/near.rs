//! What of a result is nearer to a view than the depth down to which pixels are kept.

use glam::DVec3;
use rayon::prelude::*;

use super::Part;
use crate::domain::{plan::ViewPlan, report::Warning, request::Allowed, surface::Surface};

/// Triangles that a view sees too near.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Near {
    triangles: u64,
    /// The least depth there, and that of the view down to which pixels are kept, world units.
    depths_world: Option<[f64; 2]>,
}

impl Near {
    /// The one that is nearer decides.
    fn joined(self, other: Self) -> Self {
        let [Some(a), Some(b)] = [self.depths_world, other.depths_world] else {
            return Self { depths_world: self.depths_world.or(other.depths_world), ..self.counted(other) };
        };
        Self { depths_world: Some(if a[0] <= b[0] { a } else { b }), ..self.counted(other) }
    }

    fn counted(self, other: Self) -> Self {
        Self { triangles: self.triangles + other.triangles, ..self }
    }
}

impl Part<'_> {
    /// Tells of triangles that a view shows so near that they are held to less than was asked for.
    pub(super) fn too_near(&self, surface: &Surface, allowed: &Allowed) -> Option<Warning> {
        let near = self.near(surface);
        let [least, kept] = near.depths_world?;
        let message = format!(
            "mesh '{}': {} triangles are nearer to a view than {kept:.3e} world units, 1/1000 of the diagonal, the nearest {least:.3e}: they keep the {} {} asked for as seen from {kept:.3e}, and look farther off from where they are: move the view away from them",
            self.name,
            near.triangles,
            allowed.value(),
            allowed.unit(),
        );
        Some(Warning::new("view_too_near", message))
    }

    fn near(&self, surface: &Surface) -> Near {
        if self.plan.views.is_empty() {
            return Near::default();
        }
        let place = |vertex: u32| DVec3::from_array(surface.positions[vertex as usize].map(f64::from));
        let of_triangle = |corners: &[u32; 3]| self.seen_too_near(corners.map(place));
        surface.triangles.par_iter().map(of_triangle).reduce(Near::default, Near::joined)
    }

    fn seen_too_near(&self, corners: [DVec3; 3]) -> Near {
        let of_view = |view: &ViewPlan| Some([view.seen_too_near(corners)?, view.near_world]);
        let nearest = self.plan.views.iter().filter_map(of_view).min_by(|a, b| a[0].total_cmp(&b[0]));
        Near { triangles: u64::from(nearest.is_some()), depths_world: nearest }
    }
}
