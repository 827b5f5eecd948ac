//! Twin of `parallax_iterative`: each turn goes on along the ray by (H - z) n_z V (Premecz 2006), where V has length 1 and
//! leads to the viewer, and n is the surface's normal at the place reached.
//!
//! In heights that is z += (H - z) n_z cos, the place following along the ray: V's own height is the cosine of its angle.
//! To meet the plane through the surface exactly it would have to go (H - z) n_z / (n . V); what is left out keeps it from
//! running off where n . V is small. The normal needs the length of a texel, which the ray tells: its texels for each unit
//! of height are the tangent of its angle times the texels for each unit of length.

use glam::{DVec2, IVec2};

use super::{Course, HeightLevel, March, ReliefMap, parallax::Base};

const TURNS: u32 = 4;

/// The setting says nothing.
#[must_use]
pub fn marched(map: &ReliefMap, course: &Course, _setting: f64) -> March {
    turned(map, course, |_, place| place.floor().as_ivec2())
}

/// By slopes of the cells that are named, by turn and place.
pub fn turned(map: &ReliefMap, course: &Course, mut cell_of: impl FnMut(u32, DVec2) -> IVec2) -> March {
    let base = Base::of(course);
    let squared_cosine = course.cosine.powi(2);
    let texels_squared = base.slope.length_squared() * squared_cosine / (1.0 - squared_cosine).max(1e-6);
    let mut z = base.z;
    for turn in 0..TURNS {
        let place = base.at(z);
        let slope = slope(&map.level, cell_of(turn, place), place);
        let upright = 1.0 / (1.0 + slope.length_squared() * texels_squared).sqrt();
        z += (map.level.height(place) - z) * upright * course.cosine;
    }
    base.shifted(z, TURNS)
}

/// Change of height for each texel.
pub(super) fn slope(level: &HeightLevel, cell: IVec2, place: DVec2) -> DVec2 {
    let [a, b, c, d] = level.corners(cell);
    let f = place - cell.as_dvec2();
    DVec2::new((b - a) * (1.0 - f.y) + (d - c) * f.y, (c - a) * (1.0 - f.x) + (d - b) * f.x)
}

#[cfg(test)]
mod tests {
    use super::{
        super::{
            parallax,
            tests::{Random, first_met, flat, ray, rough},
        },
        *,
    };

    /// Each turn leaves 1 - cos of what is missing.
    #[test]
    fn a_level_surface_is_reached_but_for_a_power_of_one_less_the_cosine() {
        let mut random = Random(12);
        for _ in 0..1000 {
            let height = random.within(-1.0, 1.0) as f32;
            let course = ray(&mut random, [1.5, -1.5]);
            let base = Base::of(&course);
            let wanted = base.at(f64::from(height) * (1.0 - (1.0 - course.cosine).powi(4)));
            let found = marched(&flat(height), &course, 0.0);
            assert!(found.place.distance(wanted) < 1e-12, "{} not {wanted}", found.place);
            assert_eq!(found.fetches, 4);
        }
    }

    /// Seen from at most 60 degrees, where slopes are at most 1/2 and nothing is hidden.
    #[test]
    fn over_gentle_heights_it_is_nearer_to_what_is_met_than_a_single_shift() {
        let mut random = Random(13);
        let mut off = [0.0; 2];
        for round in 0..20 {
            let map = rough(round, 0.15);
            for _ in 0..200 {
                let course = ray(&mut random, [2.0, -2.0]);
                if course.cosine < 0.5 {
                    continue;
                }
                let met = course.place(first_met(&map.level, &course)).truncate().truncate();
                for (off, marched) in off.iter_mut().zip([marched, parallax::marched]) {
                    *off += marched(&map, &course, 0.0).place.distance_squared(met);
                }
            }
        }
        assert!(off[0] < 0.25 * off[1], "{} of {}", off[0].sqrt(), off[1].sqrt());
    }
}
