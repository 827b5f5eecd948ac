//! Twin of `course_light`: the way from what was struck towards a light, up to the greatest height.

use glam::{DVec2, DVec3};

use super::{Course, flat::Base};

/// What is between a place of the heights and a light.
#[derive(Clone, Debug, PartialEq)]
pub enum Way {
    /// The heights at the place itself, or the base: they face away from the light.
    Dark,
    /// Nothing.
    Clear,
    /// Whatever a march meets.
    Over(Course),
}

/// Where a way begins.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// On the map.
    pub place: DVec2,
    /// Height above the base, mesh-local units.
    pub z: f64,
    /// Mesh-local normal of the heights, of any length.
    pub facing: DVec3,
}

/// Along a mesh-local direction, which is t's unit, up to `end` or `high`.
///
/// A march lets a ray out that begins in the heights, so that one that leads into them would come out behind them: what
/// faces away is dark before any march.
#[must_use]
pub fn way(base: &Base, start: &Start, direction: DVec3, high: f64, end: f64) -> Way {
    let (weights, change) = (base.weights(start.place), base.along(direction));
    if change.z <= 0.0 || start.facing.dot(direction) <= 0.0 {
        return Way::Dark;
    }
    let last = ((high - start.z) / change.z).min(end);
    if last <= 0.0 {
        return Way::Clear;
    }
    let first = DVec3::new(weights.y, weights.z, start.z);
    let nodes = [0.0, last].map(|t| base.node(first + change * t, t)).to_vec();
    Way::Over(Course { nodes, cosine: direction.normalize().dot(base.normal).abs() })
}

#[cfg(test)]
mod tests {
    use glam::DVec4;

    use super::{super::flat::tests::quad, *};

    const START: Start = Start { place: DVec2::new(17.0, 7.0), z: 0.25, facing: DVec3::Z };

    /// Towards (1, 0, 1), and each unit along x is 16 texels.
    #[test]
    fn it_leads_up_to_the_greatest_height_or_the_light() {
        for (end, last) in [(f64::INFINITY, 0.5), (0.25, 0.25)] {
            let found = way(&quad(DVec3::Z), &START, DVec3::new(1.0, 0.0, 1.0), 0.75, end);
            let nodes = vec![DVec4::new(17.0, 7.0, 0.25, 0.0), DVec4::new(17.0 + 16.0 * last, 7.0, 0.25 + last, last)];
            let Way::Over(course) = found else { panic!("{found:?}") };
            assert_eq!(course.nodes, nodes);
        }
    }

    #[test]
    fn what_is_as_high_as_any_is_clear_and_what_faces_away_is_dark() {
        let towards = |direction: DVec3, start: Start| way(&quad(DVec3::Z), &start, direction, 0.75, 9.0);
        assert_eq!(towards(DVec3::new(1.0, 0.0, 1.0), Start { z: 0.75, ..START }), Way::Clear);
        assert_eq!(towards(DVec3::new(1.0, 0.0, -0.1), START), Way::Dark);
        assert_eq!(
            towards(DVec3::new(1.0, 0.0, 0.5), Start { facing: DVec3::new(-1.0, 0.0, 1.0), ..START }),
            Way::Dark
        );
    }
}
