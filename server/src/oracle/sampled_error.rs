//! How far the triangles of a result are found to be from the surface they stand for: at places, not everywhere, so no
//! more than a bound that holds everywhere.

use glam::DVec3;
use rayon::prelude::*;

use super::surface::Surface;
use crate::domain::{Result, cancel::Cancel, surface};

/// A result, and what it may be off by.
pub struct Sampled<'s> {
    pub truth: &'s Surface<'s>,
    pub surface: &'s surface::Surface,
    /// Of fine vertices, mesh-local units.
    pub position: &'s (dyn Fn(u32) -> DVec3 + Sync),
    /// What a triangle with these corners may be off by, mesh-local units, above 0.
    pub allowed: &'s (dyn Fn([DVec3; 3]) -> f64 + Sync),
}

/// Triangles between two looks at whether the job is cancelled.
const LOT: usize = 1024;

impl Sampled<'_> {
    /// For each of these fine triangles, the largest distance found between a place of the surface and the place of the
    /// triangle over the same place of the base, as a share of what is allowed to it. `places` are those looked at of a
    /// triangle, barycentrics. Fails where the job is cancelled.
    pub fn shares<P: IntoIterator<Item = DVec3>>(
        &self,
        triangles: &[usize],
        places: impl Fn(usize) -> P + Sync,
        cancel: &Cancel,
    ) -> Result<Vec<f64>> {
        let one = |(k, triangle): (usize, &usize)| {
            if k.is_multiple_of(LOT) {
                cancel.check()?;
            }
            Ok(self.of_triangle(*triangle, places(*triangle)))
        };
        triangles.par_iter().enumerate().map(one).collect()
    }

    fn of_triangle(&self, triangle: usize, places: impl IntoIterator<Item = DVec3>) -> f64 {
        let base = self.surface.layout.base_of(triangle) as usize;
        let ids = self.surface.triangles[triangle];
        let [Some(a), Some(b), Some(c)] = ids.map(|id| self.weights(base, id)) else { return 0.0 };
        let corners = ids.map(self.position);
        let apart = |share| self.truth.position(base, blend([a, b, c], share)).distance(blend(corners, share));
        let farthest = places.into_iter().map(apart).fold(0.0, f64::max);
        farthest / (self.allowed)(corners)
    }

    /// Barycentrics of a fine vertex in a base triangle that has it.
    fn weights(&self, base: usize, id: u32) -> Option<DVec3> {
        let mesh = self.truth.mesh();
        let units = self.surface.layout.place(mesh, id as usize).within(mesh, base)?;
        let weights = DVec3::from_array(units.map(f64::from));
        Some(weights / weights.element_sum())
    }
}

fn blend(of: [DVec3; 3], share: DVec3) -> DVec3 {
    of[0] * share.x + of[1] * share.y + of[2] * share.z
}

/// The points of a lattice with n segments, 1 or more, on each side, barycentrics.
pub fn lattice(n: u32) -> impl Iterator<Item = DVec3> {
    let row = move |i: u32| (0..=n - i).map(move |j| DVec3::new(i.into(), j.into(), (n - i - j).into()) / f64::from(n));
    (0..=n).flat_map(row)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lattice_has_corners_sides_and_insides_that_weigh_one() {
        let places: Vec<DVec3> = lattice(3).collect();
        assert_eq!(places.len(), 10);
        assert!(places.iter().all(|place| (place.element_sum() - 1.0).abs() < 1e-15));
        assert!(places.contains(&DVec3::X) && places.contains(&DVec3::splat(1.0 / 3.0)));
    }
}
