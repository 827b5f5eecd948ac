//! Twin of `soft_shadow`: how much of a light arrives over the heights, by how far even steps towards it come below them,
//! in shares of how far they have come up (Tatarchuk 2006).

use super::{Course, ReliefMap};

/// As in `soft_shadow.comp`: so many times as deep as it is far, and nothing arrives.
const HARDNESS: f64 = 4.0;

/// From 0 to 1.
#[must_use]
pub fn share(map: &ReliefMap, course: &Course) -> f64 {
    let steps = map.steps(course);
    let stride = (course.nodes.len() - 1) as f64 / f64::from(steps);
    let from = course.place(0.0).z;
    let depth = |k: u32| {
        let place = course.place(f64::from(k) * stride);
        (map.level.height(place.truncate().truncate()) - place.z) / (place.z - from).max(1e-20)
    };
    let deepest = (1..=steps).map(depth).fold(0.0, f64::max);
    (1.0 - HARDNESS * deepest).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use glam::DVec4;

    use super::{super::tests::flat, *};

    /// Below a level height h, a step that has come up by z is h - from - z below it: the first of 16 is the deepest.
    #[test]
    fn a_level_is_as_dark_as_its_first_step_is_deep() {
        let nodes = vec![DVec4::new(0.0, 0.0, 0.5, 0.0), DVec4::new(16.0, 0.0, 2.1, 1.0)];
        let course = Course { nodes, cosine: 1.0, is_open: [false; 2] };
        for (height, expected) in [(0.5, 1.0), (0.61, 0.6), (0.7, 0.0)] {
            let found = share(&flat(height), &course);
            assert!((found - expected).abs() < 1e-6, "{height}: {found}");
        }
    }
}
