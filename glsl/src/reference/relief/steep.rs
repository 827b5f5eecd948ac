//! Twin of `steep`: even steps until the ray is below the surface (McGuire and McGuire 2005).

use super::{
    Course, March, ReliefMap,
    search::{Gauge, PARTS},
};

/// The setting says nothing.
#[must_use]
pub fn marched(map: &ReliefMap, course: &Course, _setting: f64) -> March {
    searched(&mut Gauge::new(map, course))
}

pub fn searched(gauge: &mut Gauge<'_>) -> March {
    match gauge.crossing() {
        Some(crossing) => gauge.met(gauge.s(crossing.step * PARTS), crossing.step),
        None => gauge.nothing_met(),
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec4;

    use super::{super::tests::flat, *};

    #[test]
    fn a_plane_is_met_at_the_first_step_below_it() {
        let nodes = vec![DVec4::new(0.0, 0.0, 1.0, 0.0), DVec4::new(8.0, 0.0, 0.0, 1.0)];
        let course = Course { nodes, cosine: 0.5, is_open: [false; 2] };
        let found = marched(&flat(0.4), &course, 0.0);
        assert_eq!((found.s, found.steps), (0.625, 10));
        assert_eq!(found.place.x, 5.0);
    }

    #[test]
    fn a_ray_that_stays_above_or_below_meets_nothing() {
        for z in [1.0, 0.1] {
            let nodes = vec![DVec4::new(0.0, 0.0, z, 0.0), DVec4::new(8.0, 0.0, z, 1.0)];
            assert!(!marched(&flat(0.4), &Course { nodes, cosine: 0.0, is_open: [false; 2] }, 0.0).is_hit());
        }
    }
}
