//! What a tolerance in pixels means under the camera of an image.

use glam::{DMat4, DVec3};

use crate::domain::{
    camera::looking_at,
    image::RenderCamera,
    request::{Allowed, ErrorAt, Quality, Refinement, Tolerance, ToleranceView},
};

/// Of directions, where a camera counts as level.
const LEVEL: f64 = 1e-5;

/// Triangles for the surface that are off by so many pixels at most.
pub(in crate::jobs) fn within(tolerance_px: f64, camera: &RenderCamera, [width, height]: [u32; 2]) -> Refinement {
    let allowed = match view(camera, [width, height]) {
        Some(view) => Allowed::Pixels { tolerance_px, views: vec![view] },
        // Without perspective a pixel is as long everywhere.
        None => Allowed::World(tolerance_px * 2.0 / (f64::from(height) * cotangent(camera))),
    };
    Refinement::Tolerance(Tolerance { allowed, error_at: ErrorAt::Surface, quality: Quality::Normal })
}

fn cotangent(camera: &RenderCamera) -> f64 {
    f64::from(camera.clip_from_view[5]).abs()
}

/// The view of a camera with perspective. One that is not level is seen by a square around the circle around its image.
pub(in crate::jobs) fn view(camera: &RenderCamera, [width, height]: [u32; 2]) -> Option<ToleranceView> {
    if camera.clip_from_view[15] != 0.0 {
        return None;
    }
    let eye = DVec3::from_array(camera.eye_world.map(f64::from));
    let view_from_world = DMat4::from_cols_array(&camera.view_from_world.map(f64::from));
    let ahead = -view_from_world.row(2).truncate();
    // As far as numbers near the eye tell apart.
    let target = eye + ahead * eye.length().max(1.0);
    let level = looking_at(eye, target)?.row(1).truncate();
    let is_level = level.dot(view_from_world.row(1).truncate()) > 1.0 - LEVEL;
    let tangent = 1.0 / cotangent(camera);
    let [w, h] = [width, height].map(f64::from);
    let side = w.hypot(h).ceil();
    let (tangent, width, height) =
        if is_level { (tangent, width, height) } else { (tangent * side / h, side as u32, side as u32) };
    Some(ToleranceView {
        eye: camera.eye_world,
        target: target.as_vec3().to_array(),
        yfov_degrees: (2.0 * tangent.atan()).to_degrees() as f32,
        width,
        height,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::{
        camera::render_camera,
        request::CameraChoice,
        scene::{Camera, Scene},
    };

    const BOX: [[f32; 3]; 2] = [[-1.0; 3], [1.0; 3]];

    fn seen(choice: &CameraChoice, scene: &Scene) -> RenderCamera {
        render_camera(choice, scene, BOX, 320, 200).unwrap()
    }

    fn of_file(world_from_camera: glam::Mat4, yfov_radians: Option<f32>) -> Scene {
        let world_from_camera = world_from_camera.to_cols_array();
        let camera = Camera { name: None, world_from_camera, yfov_radians, ymag: 2.0, znear: 0.1, zfar: Some(9.0) };
        Scene { cameras: vec![camera], ..Scene::default() }
    }

    #[test]
    fn a_level_camera_is_its_own_view() {
        let choice = CameraChoice::LookAt { eye: [3.0, 2.0, 1.0], target: [0.0; 3], yfov_degrees: 35.0 };
        let view = view(&seen(&choice, &Scene::default()), [320, 200]).unwrap();
        assert_eq!((view.eye, view.width, view.height), ([3.0, 2.0, 1.0], 320, 200));
        assert!((view.yfov_degrees - 35.0).abs() < 1e-3, "{view:?}");
        let towards = DVec3::from_array(view.target.map(f64::from)) - DVec3::new(3.0, 2.0, 1.0);
        assert!(towards.normalize().dot(-DVec3::new(3.0, 2.0, 1.0).normalize()) > 1.0 - 1e-6, "{view:?}");
    }

    #[test]
    fn a_camera_that_is_not_level_is_seen_by_a_square_around_it_of_the_same_pixels() {
        let rolled = glam::Mat4::from_translation(glam::Vec3::Z * 4.0) * glam::Mat4::from_rotation_z(0.3);
        let view = view(&seen(&CameraChoice::Default, &of_file(rolled, Some(0.7))), [320, 200]).unwrap();
        assert_eq!((view.width, view.height), (378, 378), "the diagonal is 377.4");
        let pixel = |degrees: f64, height: f64| (0.5 * degrees.to_radians()).tan() / height;
        let own = pixel(0.7f64.to_degrees(), 200.0);
        assert!((pixel(view.yfov_degrees.into(), 378.0) / own - 1.0).abs() < 1e-5, "{view:?}");
    }

    #[test]
    fn without_perspective_pixels_are_world_units() {
        let camera = seen(&CameraChoice::Default, &of_file(glam::Mat4::IDENTITY, None));
        let Refinement::Tolerance(tolerance) = within(0.5, &camera, [320, 200]) else { panic!("a tolerance") };
        let Allowed::World(world) = tolerance.allowed else { panic!("{tolerance:?}") };
        assert!((world - 0.5 * 4.0 / 200.0).abs() < 1e-7, "4 units are 200 pixels: {world}");
    }
}
