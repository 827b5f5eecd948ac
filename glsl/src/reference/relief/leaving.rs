//! Twin of `relief_leaving.glsl`: which base triangles of relief keep no light off.

use std::ops::Range;

use glam::DVec3;

use super::flat::{LEAST_MARGIN, MARGIN};

/// Where a ray begins, and along which unit direction of the world.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    pub position: DVec3,
    pub direction: DVec3,
    /// Of the base there, unit.
    pub normal: DVec3,
}

/// A base triangle in the world.
#[derive(Clone, Debug)]
pub struct Base {
    pub corners: [DVec3; 3],
    /// Unit.
    pub front: DVec3,
    /// Least and greatest height above it, world units along `front`.
    pub heights: Range<f64>,
    /// Of the instance and the material that the ray begins on.
    pub is_own: bool,
}

impl Base {
    /// Whether a ray that crosses it with these weights of the corners only comes out, through its front, of what its heights
    /// lie in: from no farther behind than they are deep, or from its own base, above which it has risen by no more than twice
    /// that: triangles bend away below it.
    #[must_use]
    pub fn is_left(&self, start: &Start, weights: DVec3) -> bool {
        let [a, b, c] = self.corners;
        if start.direction.dot(self.front) <= 0.0 {
            return false;
        }
        let side = a.distance(b).max(a.distance(c)).max(b.distance(c));
        let margin = ((self.heights.end - self.heights.start) * MARGIN).max(side * LEAST_MARGIN);
        let deepest = (-self.heights.start).max(0.0) + margin;
        if (a - start.position).dot(self.front) <= deepest {
            return true;
        }
        let crossing = a * weights.x + b * weights.y + c * weights.z;
        let rise = (crossing - start.position).dot(start.normal);
        self.is_own && rise > 0.0 && rise <= 2.0 * deepest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In z = 0, with heights from -0.1 to 0.2.
    fn floor(is_own: bool) -> Base {
        Base { corners: [DVec3::ZERO, DVec3::X, DVec3::Y], front: DVec3::Z, heights: -0.1..0.2, is_own }
    }

    fn is_left(base: &Base, from: DVec3, direction: DVec3, normal: DVec3) -> bool {
        base.is_left(&Start { position: from, direction: direction.normalize(), normal }, DVec3::splat(1.0 / 3.0))
    }

    #[test]
    fn what_lies_in_a_pit_sees_the_sky_and_what_lies_below_all_pits_does_not() {
        for is_own in [false, true] {
            assert!(is_left(&floor(is_own), DVec3::new(0.3, 0.3, -0.1), DVec3::Z, DVec3::Z));
            assert!(!is_left(&floor(is_own), DVec3::new(0.3, 0.3, -0.22), DVec3::Z, DVec3::Z));
        }
    }

    #[test]
    fn what_stands_out_sees_nothing_through_the_base() {
        assert!(!is_left(&floor(true), DVec3::new(0.3, 0.3, 0.1), DVec3::NEG_Z, DVec3::Z));
    }

    /// A quarter off a bend: 0.3 behind this triangle, and below its own by what it has risen to here, 0.04 or 0.4.
    #[test]
    fn a_ray_leaves_its_own_base_where_it_bends_away() {
        let from = DVec3::new(0.3, 0.3, -0.3);
        let up = |rise: f64| DVec3::new((1.0 - (rise / 0.3).powi(2)).sqrt(), 0.0, rise / 0.3);
        let along = |rise: f64| (DVec3::new(1.0 / 3.0, 1.0 / 3.0, 0.0) - from).dot(up(rise));
        for (rise, expected) in [(0.04, true), (0.29, false)] {
            let normal = up(rise);
            assert!((0.0..0.2).contains(&along(rise)) == expected, "{}", along(rise));
            assert_eq!(is_left(&floor(true), from, DVec3::Z, normal), expected);
            assert!(!is_left(&floor(false), from, DVec3::Z, normal));
        }
    }
}
