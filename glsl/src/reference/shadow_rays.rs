//! Twin of `shadow_rays`: whether anything stops a ray, by the watertight test of Woop, Benthin and Wald (2013) with
//! edges that belong to both sides, along the same nodes.

use glam::DVec3;

use crate::layout::raster::{BVH_INNER, BvhNode};

/// What stops light: triangles in world space, in the order of the nodes' leaves.
#[derive(Clone, Debug, Default)]
pub struct Occluders {
    /// In the order of a walk. Boxes are larger than what they hold: rays that run along their sides may miss them.
    pub nodes: Vec<BvhNode>,
    /// World, three for each occluder.
    pub corners: Vec<[f32; 3]>,
    /// Triangle << 1, and whether it is the last of its leaf.
    pub items: Vec<u32>,
}

/// From `origin` along the unit `direction` to `end`.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    pub origin: DVec3,
    pub direction: DVec3,
    pub end: f64,
}

/// Quotients of rounded differences are off by no more (Ize 2013).
const SLACK: f64 = 1.0 + 4.0 * f64::EPSILON;

impl Occluders {
    /// Whether a triangle that is opaque where it is met lies on the ray. `is_opaque` gets triangle and weights.
    pub fn stop(&self, ray: &Ray, mut is_opaque: impl FnMut(u32, DVec3) -> bool) -> bool {
        let sheared = Sheared::new(ray);
        // Along a plane of a box, 0 times infinity would be no number.
        let inverse = ray.direction.abs().max(DVec3::splat(1e-20)).recip() * ray.direction.signum();
        let mut n = 0;
        while n < self.nodes.len() {
            let node = &self.nodes[n];
            let met = meets(node, ray, inverse);
            if met && node.first != BVH_INNER && self.leaf_stops(&sheared, node.first as usize, &mut is_opaque) {
                return true;
            }
            n = if met { n + 1 } else { node.skip as usize };
        }
        false
    }

    fn leaf_stops(&self, ray: &Sheared, first: usize, is_opaque: &mut impl FnMut(u32, DVec3) -> bool) -> bool {
        for k in first..self.items.len() {
            let corners = [0, 1, 2].map(|c| wide(self.corners[3 * k + c]));
            if ray.crossing(corners).is_some_and(|weights| is_opaque(self.items[k] >> 1, weights)) {
                return true;
            }
            if self.items[k] & 1 != 0 {
                break;
            }
        }
        false
    }
}

fn wide(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

fn meets(node: &BvhNode, ray: &Ray, inverse: DVec3) -> bool {
    let (a, b) = ((wide(node.low) - ray.origin) * inverse, (wide(node.high) - ray.origin) * inverse);
    let (near, far) = (a.min(b), a.max(b));
    let enter = near.x.max(near.y).max(near.z.max(0.0));
    let leave = far.x.min(far.y).min(far.z.min(ray.end)) * SLACK;
    enter <= leave
}

/// A ray in its own axes: z is where it points most, and the others are sheared along it.
struct Sheared {
    origin: DVec3,
    axes: [usize; 3],
    shear: DVec3,
    end: f64,
}

impl Sheared {
    fn new(ray: &Ray) -> Self {
        let (d, size) = (ray.direction, ray.direction.abs());
        let z = if size.x > size.y { if size.x > size.z { 0 } else { 2 } } else { 1 + usize::from(size.y <= size.z) };
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        Self { origin: ray.origin, axes, shear: DVec3::new(d[axes[0]], d[axes[1]], 1.0) / d[z], end: ray.end }
    }

    fn in_ray(&self, corner: DVec3) -> DVec3 {
        let p = corner - self.origin;
        let [x, y, z] = self.axes.map(|axis| p[axis]);
        DVec3::new(x - self.shear.x * z, y - self.shear.y * z, self.shear.z * z)
    }

    /// Weights of the corners where the ray crosses the triangle, from either side.
    fn crossing(&self, corners: [DVec3; 3]) -> Option<DVec3> {
        let [a, b, c] = corners.map(|corner| self.in_ray(corner));
        let edge = |p: DVec3, q: DVec3| p.x * q.y - p.y * q.x;
        let weights = DVec3::new(edge(c, b), edge(a, c), edge(b, a));
        let total = weights.element_sum();
        if (weights.min_element() < 0.0 && weights.max_element() > 0.0) || total == 0.0 {
            return None;
        }
        let weights = weights / total;
        let t = weights.dot(DVec3::new(a.z, b.z, c.z));
        (t > 0.0 && t < self.end).then_some(weights)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A unit square of two triangles at z = 1, in one leaf, whose box is larger as boxes are.
    fn square() -> Occluders {
        let node = BvhNode { low: [-0.001, -0.001, 0.999], high: [1.001, 1.001, 1.001], skip: 1, first: 0 };
        let corners = [[0, 0], [1, 0], [1, 1], [0, 0], [1, 1], [0, 1]].map(|[x, y]| [x as f32, y as f32, 1.0]);
        Occluders { nodes: vec![node], corners: corners.to_vec(), items: vec![0, 3] }
    }

    fn stops(x: f64, y: f64, end: f64) -> bool {
        let ray = Ray { origin: DVec3::new(x, y, 0.0), direction: DVec3::Z, end };
        square().stop(&ray, |_, _| true)
    }

    #[test]
    fn no_ray_slips_through_where_triangles_meet() {
        assert!((0..=100).all(|k| stops(f64::from(k) / 100.0, f64::from(k) / 100.0, 2.0)));
    }

    #[test]
    fn what_lies_beside_behind_or_beyond_the_end_stops_nothing() {
        assert!(!stops(1.001, 0.5, 2.0) && !stops(0.5, 0.5, 0.999) && stops(0.5, 0.5, 1.001));
        let away = Ray { origin: DVec3::new(0.5, 0.5, 0.0), direction: DVec3::NEG_Z, end: 9.0 };
        assert!(!square().stop(&away, |_, _| true));
    }

    #[test]
    fn what_is_not_opaque_there_lets_light_through() {
        let ray = Ray { origin: DVec3::new(0.75, 0.25, 0.0), direction: DVec3::Z, end: 2.0 };
        let mut asked = Vec::new();
        assert!(!square().stop(&ray, |triangle, weights| {
            asked.push((triangle, weights));
            false
        }));
        assert_eq!(asked, [(0, DVec3::new(0.25, 0.5, 0.25))]);
    }
}
