//! Twin of `steep`: even steps until the ray is below the surface (McGuire and McGuire 2005).

use super::{Course, March, ReliefMap};

/// The setting says nothing.
#[must_use]
pub fn marched(map: &ReliefMap, course: &Course, _setting: f64) -> March {
    let steps = map.steps(course);
    let stride = (course.nodes.len() - 1) as f64 / f64::from(steps);
    let mut above = false;
    for k in 0..=steps {
        let s = f64::from(k) * stride;
        let place = course.place(s);
        let across = place.truncate().truncate();
        let gap = place.z - map.level.height(across);
        if above && gap <= 0.0 {
            return March { s, place: across, fetches: k + 1, steps: k, capped: false };
        }
        above |= gap > 0.0;
    }
    March::missed(steps + 1, steps)
}

#[cfg(test)]
mod tests {
    use glam::DVec4;

    use super::{super::HeightLevel, *};

    fn flat(height: f32) -> ReliefMap {
        let level = HeightLevel { size: [4, 4], heights: vec![height; 16], repeats: [true; 2] };
        ReliefMap { level, bounds: Vec::new(), cones: Vec::new(), thinnest_texels: 1.0, steps: 16 }
    }

    #[test]
    fn a_plane_is_met_at_the_first_step_below_it() {
        let nodes = vec![DVec4::new(0.0, 0.0, 1.0, 0.0), DVec4::new(8.0, 0.0, 0.0, 1.0)];
        let course = Course { nodes, cosine: 0.5 };
        let found = marched(&flat(0.4), &course, 0.0);
        assert_eq!((found.s, found.steps), (0.625, 10));
        assert_eq!(found.place.x, 5.0);
    }

    #[test]
    fn a_ray_that_stays_above_or_below_meets_nothing() {
        for z in [1.0, 0.1] {
            let nodes = vec![DVec4::new(0.0, 0.0, z, 0.0), DVec4::new(8.0, 0.0, z, 1.0)];
            assert!(!marched(&flat(0.4), &Course { nodes, cosine: 0.0 }, 0.0).is_hit());
        }
    }
}
