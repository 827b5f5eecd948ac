//! Twin of `course_light`: the way from what was struck towards a light, up to the greatest height or to the light.

use std::ops::Range;

use glam::{DVec2, DVec3, DVec4};

use super::{
    Course, HeightLevel,
    charts::{Charts, MOST_BENDS, Way},
    flat::Base,
};

/// Of the heights' range, how far above what is struck a way begins, so that it does not meet the facet it leaves.
const LIFT: f64 = 1.0 / 1024.0;

/// From a place on the map to a light, `way` from there, mesh-local; endless where it is not finitely far. None of what lies
/// below the horizon across the base's normal.
#[must_use]
pub fn course(
    base: &Base,
    level: &HeightLevel,
    place: DVec2,
    (direction, far): (DVec3, f64),
    heights: &Range<f64>,
) -> Option<Course> {
    let base = base.across_normal()?;
    let (weights, change) = (base.weights(place), base.along(direction));
    if change.z <= 0.0 {
        return None;
    }
    let low = level.height(place) + (heights.end - heights.start) * LIFT;
    let last = ((heights.end + base.margin(heights) - low) / change.z).min(far);
    let first = DVec3::new(weights.y, weights.z, low);
    let nodes = [0.0, last].map(|t| base.node(first + change * t, t)).to_vec();
    Some(Course { nodes, cosine: 1.0, is_open: [false; 2] })
}

/// The same within the chart of the triangle that it begins on; without nodes where nothing of it is on the way.
#[must_use]
pub fn bordered(course: Course, charts: &Charts<'_>, triangle: usize, size: DVec2) -> Course {
    let (first, last) = (course.nodes[0], course.nodes[1]);
    let place = |node: DVec4| (node.truncate().truncate() + 0.5) / size;
    let until = last.w;
    let rate = (place(last) - place(first)) / until;
    let way = Way::new(triangle, place(first), rate).followed(charts, until, MOST_BENDS);
    let node = |(place, t): (DVec2, f64)| {
        let texel = place * size - 0.5;
        DVec4::new(texel.x, texel.y, first.z + (last.z - first.z) * (t / until), t)
    };
    let end = (way.place(way.t), way.t);
    let nodes = [first].into_iter().chain(way.bends.iter().copied().chain([end]).map(node)).collect();
    Course { nodes: if way.t > 0.0 { nodes } else { Vec::new() }, ..course }
}

#[cfg(test)]
mod tests {
    use super::{
        super::{flat::tests::quad, tests::flat},
        *,
    };

    /// Towards (1, 0, 1), and each unit along x is 16 texels.
    #[test]
    fn it_leads_from_above_the_heights_to_above_the_greatest() {
        let direction = DVec3::new(1.0, 0.0, 1.0).normalize();
        let found =
            course(&quad(DVec3::Z), &flat(0.25).level, DVec2::new(17.0, 7.0), (direction, f64::INFINITY), &(0.0..0.64));
        let (low, high) = (0.25 + 0.64 / 1024.0, 0.65);
        let nodes = found.expect("a course").nodes;
        let last = DVec4::new(17.0 + 16.0 * (high - low), 7.0, high, (high - low) * 2.0_f64.sqrt());
        assert!((nodes[0] - DVec4::new(17.0, 7.0, low, 0.0)).abs().max_element() < 1e-12, "{}", nodes[0]);
        assert!((nodes[1] - last).abs().max_element() < 1e-12, "{} {last}", nodes[1]);
    }

    #[test]
    fn it_ends_at_a_light_below_the_greatest_height() {
        let direction = DVec3::new(1.0, 0.0, 1.0).normalize();
        let of = |far| course(&quad(DVec3::Z), &flat(0.25).level, DVec2::ZERO, (direction, far), &(0.0..0.64));
        let nodes = of(0.1).expect("a course").nodes;
        assert_eq!((nodes[1].w, nodes[1].z), (0.1, nodes[0].z + 0.1 * direction.z));
        assert_eq!(of(9.0), of(f64::INFINITY));
    }

    /// A normal that leans by 0.6 over 0.8 sees (1, 0, -0.7), and does not see (-1, 0, 0.7), though the triangle does.
    #[test]
    fn the_horizon_is_that_of_the_normal() {
        let of = |direction: DVec3| {
            let direction = (direction.normalize(), f64::INFINITY);
            course(&quad(DVec3::new(0.6, 0.0, 0.8)), &flat(0.25).level, DVec2::ZERO, direction, &(0.0..0.64))
        };
        assert!(of(DVec3::new(1.0, 0.0, -0.7)).is_some() && of(DVec3::new(-1.0, 0.0, 0.7)).is_none());
    }

    #[test]
    fn what_lies_below_the_horizon_has_none() {
        let towards = |z: f64| DVec3::new(1.0, 0.0, z).normalize();
        let of = |z| course(&quad(DVec3::Z), &flat(0.25).level, DVec2::ZERO, (towards(z), f64::INFINITY), &(0.0..0.64));
        assert!(of(0.1).is_some() && of(0.0).is_none() && of(-0.1).is_none());
    }
}
