//! Which points no other beats.

use crate::domain::chart::{Metric, Point};

/// Tells each point which fronts it is on.
pub(super) fn mark(points: &mut [Point]) {
    for metric in Metric::ALL {
        let places: Vec<Option<[f64; 2]>> =
            points.iter().map(|point| Some([point.ms, metric.of(&point.error)?])).collect();
        for (point, on_front) in points.iter_mut().zip(front(&places)) {
            if on_front {
                point.fronts.push(metric);
            }
        }
    }
}

/// Of places (time, error), those that no other dominates; what has no error is on no front.
fn front(places: &[Option<[f64; 2]>]) -> Vec<bool> {
    let is_beaten = |place: &[f64; 2]| places.iter().flatten().any(|other| dominates(other, place));
    places.iter().map(|place| place.as_ref().is_some_and(|place| !is_beaten(place))).collect()
}

/// Nowhere worse, and better somewhere.
fn dominates(a: &[f64; 2], b: &[f64; 2]) -> bool {
    a[0] <= b[0] && a[1] <= b[1] && a != b
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::domain::report::Comparison;

    fn place() -> impl Strategy<Value = Option<[f64; 2]>> {
        // Few values, so that ties are many.
        prop::option::weighted(0.9, [0..12u32, 0..12u32].prop_map(|place| place.map(f64::from)))
    }

    proptest! {
        #[test]
        fn none_on_the_front_is_dominated_and_every_other_is_by_one_on_it(places in prop::collection::vec(place(), 0..30)) {
            let on_front = front(&places);
            let members: Vec<[f64; 2]> =
                places.iter().zip(&on_front).filter(|(_, on)| **on).filter_map(|(place, _)| *place).collect();
            for (place, on) in places.iter().zip(on_front) {
                let Some(place) = place else {
                    prop_assert!(!on);
                    continue;
                };
                let [time, error] = *place;
                let beaten = |[t, e]: &[f64; 2]| (*t < time && *e <= error) || (*t <= time && *e < error);
                prop_assert_eq!(on, !members.iter().any(beaten));
            }
        }
    }

    #[test]
    fn each_metric_has_a_front_of_its_own() {
        let point = |ms: f64, flip_mean: f64, hit_error_px: Option<f64>| Point {
            ms,
            error: Comparison { flip_mean, hit_error_px, silhouette_xor_px: Some(0), ..Comparison::default() },
            ..Point::default()
        };
        let mut points = [point(1.0, 0.3, Some(2.0)), point(2.0, 0.2, Some(2.0)), point(3.0, 0.25, None)];
        mark(&mut points);
        let fronts = points.map(|point| point.fronts);
        assert_eq!(fronts, [Metric::ALL.to_vec(), vec![Metric::Flip], vec![]]);
    }
}
