//! Twin of `cone`: from each place as far as the cone of its cell reaches, then bisections (Policarpo and Oliveira 2007,
//! after Dummer 2006). See [`cone_map`](super::super::cone_map) for what cones are safe for.
//!
//! No step is shorter than what is left divided by the steps that are left, so that they always lead to the end; beyond
//! cones none is longer than an even one.

use glam::DVec2;

use super::{
    Course, HeightLevel, March, ReliefMap,
    search::{Gauge, PARTS},
};

const LEAST_PARTS: u32 = PARTS / 2;

/// The setting says nothing.
#[must_use]
pub fn marched(map: &ReliefMap, course: &Course, _setting: f64) -> March {
    searched(&mut Gauge::new(map, course))
}

pub fn searched(gauge: &mut Gauge<'_>) -> March {
    let all = gauge.steps * PARTS;
    let (mut at, mut above, mut was_above) = (0, 0, false);
    for step in 0..=gauge.steps {
        let gap = gauge.gap(at);
        if was_above && gap <= 0.0 {
            let part = gauge.bisected(above, at);
            return gauge.met(gauge.s(part), step);
        }
        if at == all {
            return March { steps: step, ..gauge.nothing_met() };
        }
        was_above = gap > 0.0;
        above = at;
        let within = if was_above { parts_within(gauge, at, gap) } else { 0 };
        let least = (all - at).div_ceil(gauge.steps - step).max(LEAST_PARTS);
        at = (at + within.max(least)).min(all);
    }
    gauge.nothing_met()
}

/// Parts from one that is above the surface by a gap until the ray leaves the cone: it does where its way across is the
/// cone times its height above the apex. 0 where the course rises, of which cones say nothing.
fn parts_within(gauge: &mut Gauge<'_>, at: u32, gap: f64) -> u32 {
    let (course, all) = (gauge.course, gauge.steps * PARTS);
    let ways = course.nodes.len() as u32 - 1;
    let k = at * ways / all;
    let along = course.nodes[k as usize + 1] - course.nodes[k as usize];
    if along.z > 0.0 {
        return 0;
    }
    let cone = cone_at(&gauge.map.level, &gauge.map.cones, course.place(gauge.s(at)).truncate().truncate());
    let reach = cone * gap / (along.truncate().truncate().length() - cone * along.z).max(1e-30);
    let parts = gauge.whole(at, (reach / gauge.s(1)).min(all.into()));
    parts.min((k + 1) * all / ways - at)
}

fn cone_at(level: &HeightLevel, cones: &[f32], place: DVec2) -> f64 {
    f64::from(cones[level.index(place.floor().as_ivec2())])
}

#[cfg(test)]
mod tests {
    use glam::DVec4;

    use super::{
        super::{
            super::cone_map::cones,
            relief,
            tests::{Random, first_met, flat, map, ray, ray_at, rough},
        },
        *,
    };

    fn with_cones_of(map: ReliefMap) -> ReliefMap {
        ReliefMap { cones: cones(&map.level), ..map }
    }

    #[test]
    fn a_plane_is_met_at_most_a_part_behind_it_after_a_step() {
        let mut random = Random(14);
        for _ in 0..1000 {
            let height = random.within(-1.0, 1.0) as f32;
            let course = ray(&mut random, [1.5, -1.5]);
            let found = marched(&with_cones_of(flat(height)), &course, 0.0);
            let behind = f64::from(height) - course.place(found.s).z;
            assert!((0.0..3.0 / 512.0).contains(&behind), "{behind}");
            assert!(found.steps <= 2, "{}", found.steps);
        }
    }

    /// Hills that are smooth, seen at 80 degrees: of relief's fetches and of what it gets wrong.
    #[test]
    fn over_hills_it_is_as_right_as_even_steps_for_less() {
        let hill = |x: u32| (f64::from(x) * std::f64::consts::TAU / 32.0).sin() as f32;
        let map = map([64, 64], |x, y| 2.0 * (hill(x) + hill(y)));
        let map = with_cones_of(ReliefMap { steps: 0, ..map });
        let mut random = Random(15);
        let (mut wrong, mut fetches) = ([0, 0], [0, 0]);
        for _ in 0..2000 {
            let course = ray_at(&mut random, 80.0, [4.01, -4.01]);
            let met = first_met(&map.level, &course);
            for (k, marched) in [marched, relief::marched].into_iter().enumerate() {
                let found = marched(&map, &course, 0.0);
                wrong[k] += u32::from((found.s - met).abs() * course.travel() > 0.5);
                fetches[k] += found.fetches;
                assert!(!found.capped);
            }
        }
        assert!(wrong[0] <= wrong[1] + 4, "{wrong:?} of 2000 wrong");
        assert!(f64::from(fetches[0]) < 0.8 * f64::from(fetches[1]), "{fetches:?} fetches");
    }

    #[test]
    fn it_takes_no_more_steps_than_even_ones_and_they_lead_to_the_end() {
        let mut random = Random(16);
        for round in 0..6 {
            let map = with_cones_of(rough(round, 2.0));
            for _ in 0..500 {
                let [high, low] = [2.01, random.within(-2.0, 2.0)];
                let found = marched(&map, &ray(&mut random, [high, low]), 0.0);
                assert!(found.steps <= 16 && !found.capped);
                // Below a range that is not all of it, what is not met is passed.
                assert!(found.is_hit() || low > -2.0);
            }
        }
    }

    #[test]
    fn where_a_course_rises_steps_are_even() {
        let map = with_cones_of(map([32, 32], |x, _| if (18..22).contains(&x) { 4.0 } else { 0.0 }));
        let nodes = vec![DVec4::new(4.0, 4.0, 1.0, 0.0), DVec4::new(28.0, 4.0, 3.0, 1.0)];
        let course = Course { nodes, cosine: 0.1, is_open: [false; 2] };
        let found = marched(&map, &course, 0.0);
        let even = relief::marched(&map, &course, 0.0);
        assert_eq!((found.s, found.steps, found.fetches), (even.s, even.steps, even.fetches));
        assert!(found.is_hit());
    }
}
