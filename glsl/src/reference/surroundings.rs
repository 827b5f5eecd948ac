//! Twin of `surroundings`: what a surface sees of an environment, by its hemisphere and by the lobe of its roughness.

use glam::{DVec3, DVec4};

use super::{brdf::visible_normal, environment::Environment};

/// What a fragment sees of an environment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surroundings {
    /// Irradiance over pi.
    pub diffuse: DVec3,
    /// Radiance, mean over the lobe around the mirrored direction.
    pub specular: DVec3,
}

impl Surroundings {
    /// The blend of three, as Gouraud (1971) has it.
    #[must_use]
    pub fn blended(corners: [Self; 3], weights: DVec3) -> Self {
        let sum = |part: fn(&Self) -> DVec3| {
            weights.x * part(&corners[0]) + weights.y * part(&corners[1]) + weights.z * part(&corners[2])
        };
        Self { diffuse: sum(|s| s.diffuse), specular: sum(|s| s.specular) }
    }
}

/// At `position`, seen from `eye`: w = 1 a place, w = 0 the direction towards an orthographic camera. An environment
/// without rough levels makes every surface a mirror.
#[must_use]
pub fn seen(
    environment: &Environment,
    position: DVec3,
    normal: DVec3,
    eye: DVec4,
    roughness: f64,
    footprint: f64,
) -> Surroundings {
    let v = (eye.truncate() - eye.w * position).normalize();
    let n = visible_normal(normal, v);
    let mirrored = 2.0 * n.dot(v) * n - v;
    // Wide lobes lean towards the normal, where less is shadowed: by alpha squared.
    let lean = if environment.glossy.is_empty() { 0.0 } else { roughness.powi(4).clamp(0.0, 1.0) };
    let specular = environment.glossy(mirrored.lerp(n, lean).normalize(), roughness, footprint);
    Surroundings { diffuse: environment.diffuse(n), specular }
}

/// How a surface changes from a pixel to the next, along x and y of the image.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Change {
    /// Of the unit normal that vertices' normals give; zero where shading is flat.
    pub normal: [DVec3; 2],
    /// Of the place in the world.
    pub position: [DVec3; 2],
}

/// Radians that r = 2 (n.v) n - v moves by from this pixel to the next, whichever way it moves more. `n`: unit, as
/// `visible_normal` has it.
#[must_use]
pub fn mirrored_footprint(change: &Change, n: DVec3, position: DVec3, eye: DVec4) -> f64 {
    let way = eye.truncate() - eye.w * position;
    let (v, nearness) = (way.normalize(), eye.w / way.length());
    let along = |axis: usize| {
        let (dn, step) = (change.normal[axis], change.position[axis]);
        let dv = -nearness * (step - step.dot(v) * v);
        (2.0 * ((dn.dot(v) + n.dot(dv)) * n + n.dot(v) * dn) - dv).length()
    };
    along(0).max(along(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_footprint_is_how_far_the_mirrored_direction_moves() {
        let eye = DVec4::new(0.3, 0.2, 4.0, 1.0);
        // A unit ball: its normals are its places.
        let place = |x: f64, y: f64| DVec3::new(x, y, (1.0 - x * x - y * y).sqrt());
        let mirrored = |p: DVec3| {
            let v = (eye.truncate() - p).normalize();
            2.0 * p.dot(v) * p - v
        };
        let (at, step) = ([0.4, -0.3], 1e-6);
        let centre = place(at[0], at[1]);
        let sides = [place(at[0] + step, at[1]), place(at[0], at[1] + step)];
        let moved = sides.map(|p| (p - centre) / step);
        let change = Change { normal: moved, position: moved };
        let expected = sides.map(|p| (mirrored(p) - mirrored(centre)).length() / step);
        let found = mirrored_footprint(&change, centre, centre, eye);
        assert!((found - expected[0].max(expected[1])).abs() < 1e-4 * found, "{found} {expected:?}");
    }
}
