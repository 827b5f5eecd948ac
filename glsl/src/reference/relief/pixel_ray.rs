//! Twin of `pixel_ray`: the ray through a place of the image, mesh-local, where it passes a point nearest.

use glam::{DVec2, DVec3, DVec4};

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelRay {
    /// Mesh-local.
    pub origin: DVec3,
    /// Unit, away from the viewer.
    pub direction: DVec3,
    /// Distance along it where what is before the viewer begins.
    pub least: f64,
}

/// By the first four rows of an instance.
#[must_use]
pub fn pixel_ray(rows: &[[f32; 4]], at_px: DVec2, point: DVec3) -> PixelRay {
    let [x, y, z, w] = [0, 1, 2, 3].map(|row| DVec4::from_array(rows[row].map(f64::from)));
    let (a, b, at) = (x - w * at_px.x, y - w * at_px.y, point.extend(1.0));
    let along = a.truncate().cross(b.truncate());
    let squared = along.length_squared();
    let across = (b.truncate().cross(along) * -a.dot(at) + along.cross(a.truncate()) * -b.dot(at)) / squared;
    let change = z.truncate().dot(along) * w.dot(at) - z.dot(at) * w.truncate().dot(along);
    let direction = along.normalize() * if change > 0.0 { -1.0 } else { 1.0 };
    let (before, origin) = (z - w, point + across);
    let rate = before.truncate().dot(direction);
    let least = if rate < 0.0 { -before.dot(origin.extend(1.0)) / rate } else { f64::NEG_INFINITY };
    PixelRay { origin, direction, least }
}

#[cfg(test)]
mod tests {
    use glam::{DMat4, DQuat, DVec4};

    use super::*;

    fn rows(pixel_from_mesh: DMat4) -> Vec<[f32; 4]> {
        (0..4).map(|row| pixel_from_mesh.row(row).as_vec4().to_array()).collect()
    }

    #[test]
    fn a_ray_leads_from_the_viewer_through_what_is_seen_there() {
        let perspective = DMat4::from_cols(DVec4::X * 1.2, DVec4::Y * 1.8, -DVec4::W, DVec4::Z * 0.25);
        let orthographic =
            DMat4::from_cols(DVec4::X * 0.3, DVec4::Y * 0.4, DVec4::Z * 0.01, DVec4::new(0.0, 0.0, 1.0, 1.0));
        let view = DMat4::from_translation(DVec3::new(0.2, 0.1, -5.0))
            * DMat4::from_quat(DQuat::from_rotation_x(0.6) * DQuat::from_rotation_y(0.8));
        let viewport = DMat4::from_cols(DVec4::X * 50.0, DVec4::Y * -40.0, DVec4::Z, DVec4::new(50.0, 40.0, 0.0, 1.0));
        for (clip, mirror) in [(perspective, 1.0), (orthographic, 1.0), (perspective, -1.0)] {
            let mesh = DMat4::from_scale(DVec3::new(mirror, 2.0, 0.5));
            let pixel_from_mesh = viewport * clip * view * mesh;
            let seen = DVec3::new(0.3, -0.2, 0.7);
            let h = pixel_from_mesh * seen.extend(1.0);
            let ray = pixel_ray(&rows(pixel_from_mesh), DVec2::new(h.x, h.y) / h.w, DVec3::new(0.5, 0.5, 0.5));
            let way = seen - ray.origin;
            assert!(way.reject_from_normalized(ray.direction).length() < 1e-5);
            assert!((ray.origin - DVec3::splat(0.5)).dot(ray.direction).abs() < 1e-5);
            let depth = |t: f64| {
                let h = pixel_from_mesh * (ray.origin + ray.direction * t).extend(1.0);
                h.z / h.w
            };
            assert!(depth(way.dot(ray.direction) + 0.1) < h.z / h.w);
            assert!((depth(ray.least) - 1.0).abs() < 1e-4, "{}", depth(ray.least));
        }
    }
}
