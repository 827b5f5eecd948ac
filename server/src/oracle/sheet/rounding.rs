//! How well f64 knows the places of a surface.

use glam::DVec3;
use rayon::prelude::*;

use super::{Sheet, blend};

/// Triangles looked at, spread evenly.
const SAMPLES: usize = 4096;

impl Sheet<'_> {
    /// The most by which rounding moves the middle of any of the triangles looked at, world units: large where an
    /// expression takes near numbers from each other. Triangles with a jump are left out; 0 of meshes.
    #[must_use]
    pub fn rounding(&self) -> f64 {
        let step = self.triangles.len().div_ceil(SAMPLES).max(1);
        let looked_at = (0..self.triangles.len() as u32).into_par_iter().step_by(step);
        looked_at.filter_map(|triangle| self.rounding_of(triangle)).reduce(|| 0.0, f64::max)
    }

    fn rounding_of(&self, triangle: u32) -> Option<f64> {
        let (part, k) = self.part(triangle)?;
        let middle = blend(part.at[k], DVec3::splat(1.0 / 3.0));
        let rounding = part.surface.rounding(part.base[k] as usize, middle) * part.enlargement;
        let corners = self.corners(triangle);
        let side = corners[0].distance(corners[1]).max(corners[1].distance(corners[2]));
        // At a jump nothing is known, however exact the numbers.
        (rounding < side).then_some(rounding)
    }
}
