//! Twin of `parallax`: where the ray would meet the surface, were it level at the height above where the ray meets the
//! base (Kaneko et al. 2001). Of the shifted place's height it is off by at most what heights change over the shift.

use glam::DVec2;

use super::{Course, March, ReliefMap};

/// Where a ray meets the base.
#[derive(Clone, Copy, Debug)]
pub(super) struct Base {
    pub(super) s: f64,
    pub(super) place: DVec2,
    pub(super) z: f64,
    /// Texels towards the viewer for each unit of height.
    pub(super) slope: DVec2,
}

impl Base {
    /// The height 0 of a course of two nodes, or the end that is nearer to it.
    pub(super) fn of(course: &Course) -> Self {
        let [first, last] = [course.nodes[0], course.nodes[1]];
        let down = first.z - last.z;
        if down <= 0.0 {
            return Self { s: 0.0, place: first.truncate().truncate(), z: first.z, slope: DVec2::ZERO };
        }
        let s = (first.z / down).clamp(0.0, 1.0);
        let place = course.place(s);
        let slope = (first - last).truncate().truncate() / down;
        Self { s, place: place.truncate().truncate(), z: place.z, slope }
    }

    /// Where the ray is at a height.
    pub(super) fn at(&self, height: f64) -> DVec2 {
        self.place + (height - self.z) * self.slope
    }

    /// Maps are read where the ray is at a height.
    pub(super) fn shifted(&self, height: f64, fetches: u32) -> March {
        March { s: self.s, place: self.at(height), fetches, steps: fetches, capped: false }
    }
}

/// The setting says nothing.
#[must_use]
pub fn marched(map: &ReliefMap, course: &Course, _setting: f64) -> March {
    let base = Base::of(course);
    base.shifted(map.level.height(base.place), 1)
}

#[cfg(test)]
mod tests {
    use super::{
        super::tests::{Random, first_met, flat, lipschitz, ray, rough},
        *,
    };

    #[test]
    fn a_level_surface_is_shown_where_the_ray_meets_it() {
        let mut random = Random(8);
        for _ in 0..1000 {
            let height = random.within(-1.0, 1.0) as f32;
            let course = ray(&mut random, [1.5, -1.5]);
            let found = marched(&flat(height), &course, 0.0);
            let met = course.place((1.5 - f64::from(height)) / 3.0).truncate().truncate();
            assert!(found.place.distance(met) < 1e-12, "{} not {met}", found.place);
            assert_eq!((found.s, found.fetches), (0.5, 1));
        }
    }

    /// What is taken for the height, H0, is off from that of the place that is met, H*, by at most how much heights
    /// change over the shift |H*| tan, and by at most their range.
    #[test]
    fn the_height_is_off_by_at_most_the_range_and_the_change_over_the_shift() {
        let mut random = Random(9);
        let mut nearest = 0.0f64;
        for round in 0..40 {
            let map = rough(round, [0.1, 0.5, 3.0][round as usize % 3]);
            let steepest = lipschitz(&map.level);
            let [low, high] = map.level.range();
            for _ in 0..250 {
                let course = ray(&mut random, [high.max(0.0) + 0.01, low.min(0.0) - 0.01]);
                let base = Base::of(&course);
                let met = course.place(first_met(&map.level, &course)).z;
                let off = (map.level.height(base.place) - met).abs();
                let bound = (high - low).min(steepest * met.abs() * base.slope.length());
                assert!(off <= bound + 1e-6, "{off} is more than {bound} at {course:?}");
                nearest = nearest.max(off / (bound + 1e-6));
            }
        }
        assert!(nearest > 0.8, "a bound of which {nearest} is the most that is seen says little");
    }
}
