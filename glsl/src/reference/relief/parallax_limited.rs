//! Twin of `parallax_limited`: the shift of parallax mapping times the cosine of the angle (Welsh 2004).

use super::{Course, March, ReliefMap, parallax::Base};

/// The setting says nothing.
#[must_use]
pub fn marched(map: &ReliefMap, course: &Course, _setting: f64) -> March {
    let base = Base::of(course);
    let limited = Base { slope: base.slope * course.cosine, ..base };
    limited.shifted(map.level.height(base.place), 1)
}

#[cfg(test)]
mod tests {
    use super::{
        super::{
            parallax,
            tests::{Random, ray, rough},
        },
        *,
    };

    /// The range of heights being A: A tan (1 - cos) across, which is A sin (1 - cos) as seen from the viewer.
    #[test]
    fn what_is_shown_is_off_from_parallax_by_at_most_the_range_times_sine_and_one_less_the_cosine() {
        let mut random = Random(10);
        let mut nearest = 0.0f64;
        for round in 0..20 {
            let map = rough(round, 2.0);
            let most = map.level.range().map(f64::abs).into_iter().fold(0.0, f64::max);
            for _ in 0..200 {
                let course = ray(&mut random, [most, -most]);
                let sine = (1.0 - course.cosine.powi(2)).sqrt();
                let [limited, free] = [marched, parallax::marched].map(|marched| marched(&map, &course, 0.0).place);
                let seen = limited.distance(free) * course.cosine;
                let bound = most * sine * (1.0 - course.cosine);
                assert!(seen <= bound + 1e-12, "{seen} is more than {bound}");
                nearest = nearest.max(seen / (bound + 1e-12));
            }
        }
        assert!(nearest > 0.9, "{nearest}");
    }

    #[test]
    fn a_shift_is_at_most_the_height_times_the_sine() {
        let mut random = Random(11);
        let map = rough(3, 2.0);
        for _ in 0..1000 {
            let course = ray(&mut random, [4.0, -4.0]);
            let base = Base::of(&course);
            let shift = marched(&map, &course, 0.0).place.distance(base.place);
            let sine = (1.0 - course.cosine.powi(2)).sqrt();
            assert!(shift <= map.level.height(base.place).abs() * sine + 1e-12, "{shift}");
        }
    }
}
