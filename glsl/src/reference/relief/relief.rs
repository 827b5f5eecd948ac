//! Twin of `relief`: even steps, then five bisections of the last (Policarpo, Oliveira and Comba 2005).

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
    let Some(crossing) = gauge.crossing() else { return gauge.nothing_met() };
    let below = crossing.step * PARTS;
    let part = gauge.bisected(below - PARTS, below);
    gauge.met(gauge.s(part), crossing.step)
}

#[cfg(test)]
mod tests {
    use super::{
        super::tests::{Random, flat, ray},
        *,
    };

    #[test]
    fn a_plane_is_met_at_most_a_part_behind_it() {
        let mut random = Random(3);
        for _ in 0..1000 {
            let height = random.within(-1.0, 1.0);
            let course = ray(&mut random, [1.5, -1.5]);
            let found = marched(&flat(height as f32), &course, 0.0);
            let behind = f64::from(height as f32) - course.place(found.s).z;
            // Of a range of 3 in 16 steps of 32 parts.
            assert!((0.0..3.0 / 512.0).contains(&behind), "{behind}");
            assert_eq!(found.fetches, found.steps + 6);
        }
    }
}
