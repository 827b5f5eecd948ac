//! A view that a tolerance in pixels is meant for, as seen from one instance of a mesh: everything in the mesh's
//! own units, so that whoever asks needs no transform.

use glam::{DVec3, DVec4};
use serde::{Deserialize, Serialize};

use crate::domain::{Error, Result, camera, request::ToleranceView, scene::Instance};

/// Of the most that an instance enlarges: what it shortens to less, a plane's normal among them, is the rounding of a flat
/// one.
const FLAT: f64 = 1e-9;

/// One view of one instance. Depth is along the axis of the view, world units, positive ahead of the eye.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ViewPlan {
    /// Depth of a place p is row . (p, 1).
    pub depth_from_local: [f64; 4],
    /// What lies nearer is held to what holds at this depth.
    pub near_world: f64,
    /// Largest distance allowed at depth 1 in the corner of the image, local units: `tolerance_px` pixels of that depth,
    /// times `least_cosine`, over `largest_scale`.
    pub tolerance_at_unit_depth: f64,
    /// Of the angle between the axis and the ray through the image's corner.
    ///
    /// A shift along the ray moves what is not on the axis: the projection (x, y) / depth turns a unit shift at tangents
    /// (s, t) from the axis into up to sqrt(1 + s^2 + t^2) / depth, which is 1 / (cosine of the ray's angle x depth).
    pub least_cosine: f64,
    /// Right, left, top and bottom side, and the plane through the eye: n . p + d >= 0 inside, |n| = 1, local units.
    /// A plane that a flattened instance lies along is left out.
    pub planes_local: Vec<[f64; 4]>,
    /// The eye. Where the instance flattens it has no place, and `least_scale` is 0.
    pub eye_local: [f64; 3],
    /// Least that the instance enlarges a distance, world units for a local unit.
    pub least_scale: f64,
    /// Most that it does.
    pub largest_scale: f64,
}

impl ViewPlan {
    /// What is outside is held to so many times of what the view would ask for if it looked there: only shadows and
    /// reflections show it.
    pub const UNSEEN: f64 = 8.0;

    /// `instance` enlarges something. Fails where the view looks at its own eye.
    pub(super) fn new(view: &ToleranceView, instance: &Instance, tolerance_px: f64, near_world: f64) -> Result<Self> {
        let [eye, target] = [view.eye, view.target].map(|place| DVec3::from_array(place.map(f64::from)));
        let view_from_world = camera::looking_at(eye, target).ok_or_else(|| {
            Error::invalid("geometry.tolerance.pixels.views", "a view looks at its own eye; move one of the two")
        })?;
        let world = instance.world();
        let rows_from_view = (view_from_world * world).transpose();
        let [least_scale, largest_scale] = instance.singular_values();
        // Of what is flat, rounding leaves dust.
        let least_scale = if least_scale > FLAT * largest_scale { least_scale } else { 0.0 };
        let upright = (0.5 * f64::from(view.yfov_degrees).to_radians()).tan();
        let across = upright * f64::from(view.width) / f64::from(view.height);
        let pixel = 2.0 * upright / f64::from(view.height);
        let sides = sides(across, upright).map(|plane| rows_from_view * plane);
        let least_cosine = 1.0 / (1.0 + upright * upright + across * across).sqrt();
        Ok(Self {
            depth_from_local: (rows_from_view * DVec4::new(0.0, 0.0, -1.0, 0.0)).to_array(),
            near_world,
            tolerance_at_unit_depth: tolerance_px * pixel * least_cosine / largest_scale,
            least_cosine,
            planes_local: sides.into_iter().filter_map(|plane| unit(plane, FLAT * largest_scale)).collect(),
            eye_local: if least_scale > 0.0 { world.inverse().transform_point3(eye).to_array() } else { [0.0; 3] },
            least_scale,
            largest_scale,
        })
    }

    /// The least that it allows anywhere, local units.
    #[must_use]
    pub fn least(&self) -> f64 {
        self.near_world * self.tolerance_at_unit_depth
    }

    /// Largest distance allowed to what lies in the sphere, local units: `tolerance_at_unit_depth` for each world unit
    /// of the sphere's least depth, at least of `near_world`, and as much more as all of the sphere is nearer to the axis
    /// than the image's corner.
    ///
    /// A sphere wholly outside a plane has its least distance to the eye for depth, as if the view looked there, and
    /// [`Self::UNSEEN`] times as much is allowed. Its distance to the eye's own plane, ahead or behind, is as safe.
    #[must_use]
    pub fn tolerance_at(&self, centre: DVec3, radius: f64) -> f64 {
        let row = DVec4::from_array(self.depth_from_local);
        let reach = radius * row.truncate().length();
        let depth = row.dot(centre.extend(1.0)).abs() - reach;
        let away = centre.distance(DVec3::from_array(self.eye_local));
        if !self.is_outside(centre, radius) {
            let cosine = self.cosine(depth, (away + radius) * self.largest_scale);
            return depth.max(self.near_world) * self.tolerance_at_unit_depth * (cosine / self.least_cosine);
        }
        let distance = (away - radius) * self.least_scale;
        let depth = distance.max(depth).max(self.near_world);
        Self::UNSEEN * depth * (self.tolerance_at_unit_depth / self.least_cosine)
    }

    /// No more than that of the angle between the axis and any place so deep or deeper and no farther from the eye.
    fn cosine(&self, depth: f64, away_world: f64) -> f64 {
        // A flattened instance tells no place of the eye.
        let least = if self.least_scale > 0.0 && depth > 0.0 { depth / away_world } else { 0.0 };
        // What is no number is the least.
        least.max(self.least_cosine).min(1.0)
    }

    /// The least depth of what this view sees of a triangle, world units, where that is nearer than `near_world`: it is
    /// held to less than the pixels asked for.
    #[must_use]
    pub fn seen_too_near(&self, corners: [DVec3; 3]) -> Option<f64> {
        let row = DVec4::from_array(self.depth_from_local);
        let depth = |p: &DVec3| row.dot(p.extend(1.0));
        let depths = corners.each_ref().map(depth);
        if depths.iter().all(|depth| *depth >= self.near_world) || depths.iter().all(|depth| *depth < 0.0) {
            return None;
        }
        let seen = self.planes_local.iter().fold(corners.to_vec(), |part, plane| clipped(&part, *plane));
        seen.iter().map(depth).reduce(f64::min).filter(|least| *least < self.near_world)
    }

    fn is_outside(&self, centre: DVec3, radius: f64) -> bool {
        self.planes_local.iter().any(|plane| DVec4::from_array(*plane).dot(centre.extend(1.0)) < -radius)
    }
}

/// Of the view's pyramid, inward, view space; `across` and `upright` are the tangents of the half angles.
fn sides(across: f64, upright: f64) -> [DVec4; 5] {
    [
        DVec4::new(-1.0, 0.0, -across, 0.0),
        DVec4::new(1.0, 0.0, -across, 0.0),
        DVec4::new(0.0, -1.0, -upright, 0.0),
        DVec4::new(0.0, 1.0, -upright, 0.0),
        // Nothing that is ahead is left out for being too near.
        DVec4::new(0.0, 0.0, -1.0, 0.0),
    ]
}

/// What of a convex polygon is on the inner side of a plane (Sutherland and Hodgman 1974).
fn clipped(polygon: &[DVec3], plane: [f64; 4]) -> Vec<DVec3> {
    let above = |p: &DVec3| DVec4::from_array(plane).dot(p.extend(1.0));
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, from) in polygon.iter().enumerate() {
        let to = &polygon[(k + 1) % polygon.len()];
        let (a, b) = (above(from), above(to));
        if a >= 0.0 {
            kept.push(*from);
        }
        if (a >= 0.0) != (b >= 0.0) {
            kept.push(from.lerp(*to, a / (a - b)));
        }
    }
    kept
}

/// With a normal of length 1, if it is longer than `least`.
fn unit(plane: DVec4, least: f64) -> Option<[f64; 4]> {
    let length = plane.truncate().length();
    (length > least).then(|| (plane / length).to_array())
}
