//! Twin of `course_flat`: the way of a ray over a flat triangle, in the skew frame of its two sides and the normal that is
//! seen there. It goes on beyond the triangle, so that what is met may lie beside it.

use std::ops::Range;

use glam::{DMat2, DMat3, DVec2, DVec3, DVec4};

use super::{Course, pixel_ray::PixelRay};

/// Beyond the least and the greatest height, of their distance.
pub(super) const MARGIN: f64 = 1.0 / 64.0;
/// At least, of the longest side.
pub(super) const LEAST_MARGIN: f64 = 1.0 / 4096.0;

/// A triangle, and the direction that heights are above it along.
#[derive(Clone, Copy, Debug)]
pub struct Base {
    first: DVec3,
    /// From the first corner to the second and to the third.
    pub sides: [DVec3; 2],
    /// Unit.
    pub normal: DVec3,
    first_texel: DVec2,
    /// What the sides are on the map, in the columns.
    pub texel_edges: DMat2,
    from_mesh: DMat3,
    from_texels: DMat2,
}

impl Base {
    /// Mesh-local corners and unit normal, and where the corners lie on the map, texels; none where either has no area.
    #[must_use]
    pub fn new(corners: [DVec3; 3], normal: DVec3, texels: [DVec2; 3]) -> Option<Self> {
        let sides = [corners[1] - corners[0], corners[2] - corners[0]];
        let texel_edges = DMat2::from_cols(texels[1] - texels[0], texels[2] - texels[0]);
        let from_mesh = DMat3::from_cols(sides[0], sides[1], normal).inverse();
        let from_texels = texel_edges.inverse();
        let base =
            Self { first: corners[0], sides, normal, first_texel: texels[0], texel_edges, from_mesh, from_texels };
        (from_mesh.is_finite() && from_texels.is_finite()).then_some(base)
    }

    /// Shares of the sides, and the height.
    #[must_use]
    pub fn under(&self, point: DVec3) -> DVec3 {
        self.from_mesh * (point - self.first)
    }

    /// Shares and height that a direction changes.
    #[must_use]
    pub fn along(&self, direction: DVec3) -> DVec3 {
        self.from_mesh * direction
    }

    /// With the sides laid across the normal; none where nothing is left of them.
    #[must_use]
    pub fn across_normal(&self) -> Option<Self> {
        let [b, c] = self.sides.map(|side| self.first + side.reject_from_normalized(self.normal));
        let texels = [DVec2::ZERO, self.texel_edges.x_axis, self.texel_edges.y_axis];
        Self::new([self.first, b, c], self.normal, texels.map(|edge| self.first_texel + edge))
    }

    /// Weights of the corners at a place on the map.
    #[must_use]
    pub fn weights(&self, place: DVec2) -> DVec3 {
        let b = self.from_texels * (place - self.first_texel);
        DVec3::new(1.0 - b.x - b.y, b.x, b.y)
    }

    /// On the map, of weights of the corners.
    #[must_use]
    pub fn place(&self, weights: DVec3) -> DVec2 {
        self.first_texel + self.texel_edges * DVec2::new(weights.y, weights.z)
    }

    /// Mesh-local, of weights of the corners.
    #[must_use]
    pub fn point(&self, weights: DVec3) -> DVec3 {
        self.first + self.sides[0] * weights.y + self.sides[1] * weights.z
    }

    /// What lies beyond the least and the greatest height.
    #[must_use]
    pub fn margin(&self, heights: &Range<f64>) -> f64 {
        let [a, b] = self.sides;
        let longest = a.length().max(b.length()).max(a.distance(b));
        ((heights.end - heights.start) * MARGIN).max(longest * LEAST_MARGIN)
    }

    /// Of shares of the sides and a height.
    pub(super) fn node(&self, at: DVec3, t: f64) -> DVec4 {
        (self.first_texel + self.texel_edges * at.truncate()).extend(at.z).extend(t)
    }
}

/// Of t, from above all heights to below them; none of a ray that does not go down.
#[must_use]
pub fn range(base: &Base, ray: &PixelRay, heights: &Range<f64>) -> Option<Range<f64>> {
    let (start, change) = (base.under(ray.origin), base.along(ray.direction));
    if change.z >= 0.0 {
        return None;
    }
    let margin = base.margin(heights);
    let time = |height: f64| (height - start.z) / change.z;
    let (first, last) = (time(heights.end + margin).max(ray.least), time(heights.start - margin));
    (first < last).then_some(first..last)
}

/// Down through all heights, as if the map had no borders; none of a ray that does not go down.
#[must_use]
pub fn course(base: &Base, ray: &PixelRay, heights: Range<f64>) -> Option<Course> {
    let range = range(base, ray, &heights)?;
    let (start, change) = (base.under(ray.origin), base.along(ray.direction));
    let nodes = [range.start, range.end].map(|t| base.node(start + change * t, t)).to_vec();
    Some(Course { nodes, cosine: ray.direction.dot(base.normal).abs(), is_open: [false; 2] })
}

#[cfg(test)]
pub(super) mod tests {
    use super::{super::tests::Random, *};

    /// Sides (2, 0, 0) and (0, 1, 0), which are 32 and 8 texels.
    pub(in super::super) fn quad(normal: DVec3) -> Base {
        let corners = [DVec3::ZERO, DVec3::X * 2.0, DVec3::Y];
        let texels = [DVec2::new(1.0, 3.0), DVec2::new(33.0, 3.0), DVec2::new(1.0, 11.0)];
        Base::new(corners, normal, texels).expect("a triangle")
    }

    fn ray(origin: DVec3, direction: DVec3) -> PixelRay {
        PixelRay { origin, direction: direction.normalize(), least: f64::NEG_INFINITY }
    }

    #[test]
    fn weights_are_the_inverse_of_places() {
        let mut random = Random(5);
        for _ in 0..100 {
            let mut unit = || random.within(-2.0, 2.0);
            let corners = [(); 3].map(|()| DVec3::new(unit(), unit(), unit()));
            let texels = [(); 3].map(|()| DVec2::new(unit(), unit()) * 64.0);
            let base = Base::new(corners, DVec3::new(unit(), unit(), unit()).normalize(), texels).expect("a triangle");
            let weights = base.weights(DVec2::new(7.0, -3.0));
            let place = texels[0] * weights.x + texels[1] * weights.y + texels[2] * weights.z;
            assert!((place - DVec2::new(7.0, -3.0)).length() < 1e-6);
            assert!((weights.element_sum() - 1.0).abs() < 1e-9);
        }
    }

    /// By thales: each unit down is one along x, which is 16 texels.
    #[test]
    fn a_ray_at_45_degrees_goes_as_far_along_as_down() {
        let course = course(&quad(DVec3::Z), &ray(DVec3::new(0.5, 0.25, 1.0), DVec3::new(1.0, 0.0, -1.0)), 0.0..0.64)
            .expect("a course");
        let margin = 0.01;
        for (node, z) in course.nodes.iter().zip([0.64 + margin, -margin]) {
            let expected = DVec4::new(1.0 + 16.0 * (1.5 - z), 5.0, z, (1.0 - z) * 2.0_f64.sqrt());
            assert!((*node - expected).abs().max_element() < 1e-12, "{node} {expected}");
        }
        assert!((course.cosine - 0.5_f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn heights_are_along_a_normal_that_leans() {
        let lean = DVec3::new(0.6, 0.0, 0.8);
        let course = course(&quad(lean), &ray(DVec3::new(0.5, 0.25, 1.0), DVec3::NEG_Z), 0.0..0.64).expect("a course");
        for node in &course.nodes {
            let at = DVec3::new((node.x - 1.0) / 16.0, (node.y - 3.0) / 8.0, 0.0) + lean * node.z;
            assert!((at.truncate() - DVec2::new(0.5, 0.25)).length() < 1e-12, "{at}");
        }
    }

    #[test]
    fn what_is_before_the_viewer_begins_later_and_what_rises_meets_nothing() {
        let down = PixelRay { least: 0.5, ..ray(DVec3::new(0.5, 0.25, 1.0), DVec3::NEG_Z) };
        assert_eq!(course(&quad(DVec3::Z), &down, 0.0..0.64).expect("a course").nodes[0].w, 0.5);
        let behind = PixelRay { least: 1.5, ..down };
        assert_eq!(course(&quad(DVec3::Z), &behind, 0.0..0.64), None);
        assert_eq!(course(&quad(DVec3::Z), &ray(DVec3::Z, DVec3::Z), 0.0..0.64), None);
    }
}
