//! Twin of `occlusion`: even steps, the last one cut where the surface counts as straight (Brawley and Tatarchuk 2004,
//! Tatarchuk 2006).

use super::{Course, March, ReliefMap, search::Gauge};

/// The setting says nothing.
#[must_use]
pub fn marched(map: &ReliefMap, course: &Course, _setting: f64) -> March {
    searched(&mut Gauge::new(map, course))
}

pub fn searched(gauge: &mut Gauge<'_>) -> March {
    let Some(crossing) = gauge.crossing() else { return gauge.nothing_met() };
    let stride = (gauge.course.nodes.len() - 1) as f64 / f64::from(gauge.steps);
    let w = crossing.above_gap / (crossing.above_gap - crossing.below_gap);
    gauge.met((f64::from(crossing.step - 1) + w) * stride, crossing.step)
}

#[cfg(test)]
mod tests {
    use super::{
        super::tests::{Random, flat, ray, slope},
        *,
    };

    #[test]
    fn a_plane_is_met_exactly() {
        let mut random = Random(1);
        for _ in 0..1000 {
            let height = random.within(-1.0, 1.0);
            let course = ray(&mut random, [1.5, -1.5]);
            let found = marched(&flat(height as f32), &course, 0.0);
            let z = course.place(found.s).z;
            assert!((z - f64::from(height as f32)).abs() < 1e-13, "{z} for {height}");
        }
    }

    #[test]
    fn a_ramp_is_met_exactly() {
        let mut random = Random(2);
        for _ in 0..1000 {
            let rise = random.within(-0.2, 0.2) as f32;
            let course = ray(&mut random, [4.0, -4.0]);
            let found = marched(&slope(rise), &course, 0.0);
            let place = course.place(found.s);
            let away = place.z - f64::from(rise) * (place.x - 32.0);
            assert!(!found.is_hit() || away.abs() < 1e-5, "{away} at {place}");
        }
    }
}
