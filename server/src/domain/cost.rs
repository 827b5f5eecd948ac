//! What an image takes on a device: a model of what is counted, whose constants are measured once on it
//! (`jobs::calibration`) and kept.
//!
//! T = pixels c_pixel + rays c_ray + fetches c_fetch + vertices c_vertex + triangles c_triangle.

use serde::{Deserialize, Serialize};

/// What is counted of an image and of what it shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Work {
    /// Pixels that show something.
    pub pixels: f64,
    /// Rays that are marched.
    pub rays: f64,
    /// Lookups of heights, bounds and cones, of all rays.
    pub fetches: f64,
    /// Vertices that are made.
    pub vertices: f64,
    /// Triangles that are made.
    pub triangles: f64,
}

/// Nanoseconds of each thing counted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CostModel {
    pub pixel_ns: f64,
    pub ray_ns: f64,
    pub fetch_ns: f64,
    pub vertex_ns: f64,
    pub triangle_ns: f64,
}

impl Default for CostModel {
    /// Of the device `reference`, and of one that could not be measured: lavapipe on two cores, 2026.
    fn default() -> Self {
        Self { pixel_ns: 240.0, ray_ns: 500.0, fetch_ns: 50.0, vertex_ns: 20_000.0, triangle_ns: 20_000.0 }
    }
}

impl CostModel {
    /// Finite, and none of it negative or nothing.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        let Self { pixel_ns, ray_ns, fetch_ns, vertex_ns, triangle_ns } = *self;
        [pixel_ns, ray_ns, fetch_ns, vertex_ns, triangle_ns].iter().all(|ns| ns.is_finite() && *ns > 0.0)
    }

    /// Milliseconds.
    #[must_use]
    pub fn ms(&self, work: &Work) -> f64 {
        let Work { pixels, rays, fetches, vertices, triangles } = *work;
        1e-6 * (pixels * self.pixel_ns
            + rays * self.ray_ns
            + fetches * self.fetch_ns
            + vertices * self.vertex_ns
            + triangles * self.triangle_ns)
    }
}

impl std::ops::Add for Work {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            pixels: self.pixels + other.pixels,
            rays: self.rays + other.rays,
            fetches: self.fetches + other.fetches,
            vertices: self.vertices + other.vertices,
            triangles: self.triangles + other.triangles,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_counted_adds_up() {
        let model = CostModel { pixel_ns: 1000.0, ray_ns: 50.0, fetch_ns: 10.0, vertex_ns: 200.0, triangle_ns: 100.0 };
        let work = Work { pixels: 1000.0, rays: 2000.0, fetches: 10_000.0, vertices: 1000.0, triangles: 2000.0 };
        assert!((model.ms(&work) - 1.6).abs() < 1e-12);
        assert!((model.ms(&(work + work)) - 3.2).abs() < 1e-12);
        assert!(model.is_sound() && CostModel::default().is_sound());
        assert!(
            !CostModel { fetch_ns: f64::NAN, ..model }.is_sound() && !CostModel { pixel_ns: 0.0, ..model }.is_sound()
        );
    }
}
