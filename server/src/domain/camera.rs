//! From what the request says of the camera, and what the file has, to the matrices of a render.

use glam::{DMat4, DVec3};

use super::{Error, ErrorKind, Result, image::RenderCamera, request::CameraChoice, scene::Camera, scene::Scene};

/// Field of view of the camera that frames the scene, degrees.
pub const DEFAULT_YFOV_DEGREES: f32 = 40.0;
pub const DEFAULT_AZIMUTH_DEGREES: f32 = 30.0;
pub const DEFAULT_ELEVATION_DEGREES: f32 = 20.0;
/// Allowed fields of view, degrees.
pub const YFOV_DEGREES: std::ops::RangeInclusive<f32> = 0.1..=179.0;
/// The near plane as a share of the distance to the farthest point: depth is reversed floating point, whose
/// relative precision does not depend on it.
const NEAR_SHARE: f64 = 1e-5;
/// Room left around a framed scene.
const FRAME_MARGIN: f64 = 1.05;

/// The camera of a render of `width` x `height` pixels. `bounds` is the box of what is shown, world units.
pub fn render_camera(
    choice: &CameraChoice,
    scene: &Scene,
    bounds: [[f32; 3]; 2],
    width: u32,
    height: u32,
) -> Result<RenderCamera> {
    let view = View::new(bounds, width, height);
    match choice {
        CameraChoice::Default => match scene.cameras.first() {
            Some(camera) => view.of_file(camera),
            None => view.orbit(DEFAULT_AZIMUTH_DEGREES, DEFAULT_ELEVATION_DEGREES, None, DEFAULT_YFOV_DEGREES),
        },
        CameraChoice::Named(name) => view.of_file(named(scene, name)?),
        CameraChoice::LookAt { eye, target, yfov_degrees } => view.look_at(*eye, *target, *yfov_degrees),
        CameraChoice::Orbit { azimuth_degrees, elevation_degrees, distance, yfov_degrees } => {
            view.orbit(*azimuth_degrees, *elevation_degrees, *distance, *yfov_degrees)
        }
    }
}

/// Whether the choice can be made at all, before anything is worked out for it.
pub fn check(choice: &CameraChoice, scene: &Scene) -> Result<()> {
    match choice {
        CameraChoice::Named(name) => named(scene, name).map(|_| ()),
        _ => Ok(()),
    }
}

/// As [`render_camera`], of a camera as files have them.
pub fn file_camera(camera: &Camera, bounds: [[f32; 3]; 2], width: u32, height: u32) -> Result<RenderCamera> {
    View::new(bounds, width, height).of_file(camera)
}

fn named<'s>(scene: &'s Scene, name: &str) -> Result<&'s Camera> {
    scene.cameras.iter().find(|camera| camera.name.as_deref() == Some(name)).ok_or_else(|| {
        let names: Vec<_> = scene.cameras.iter().filter_map(|c| c.name.as_deref()).map(|n| format!("'{n}'")).collect();
        let known =
            if names.is_empty() { "no named camera".into() } else { format!("the cameras {}", names.join(", ")) };
        let message = format!("the file has no camera '{name}' in its default scene; it has {known}");
        Error::new(ErrorKind::NotFound, message).with_field("camera.name")
    })
}

/// What is shown, and the shape of the image.
struct View {
    centre: DVec3,
    radius: f64,
    aspect: f64,
}

impl View {
    fn new(bounds: [[f32; 3]; 2], width: u32, height: u32) -> Self {
        let [low, high] = bounds.map(|corner| DVec3::from_array(corner.map(f64::from)));
        let usable = low.is_finite() && high.is_finite() && (high - low).min_element() >= 0.0;
        let (low, high) = if usable { (low, high) } else { (DVec3::splat(-0.5), DVec3::splat(0.5)) };
        let radius = 0.5 * (high - low).length();
        let aspect = f64::from(width.max(1)) / f64::from(height.max(1));
        Self { centre: 0.5 * (low + high), radius: if radius > 0.0 { radius } else { 1.0 }, aspect }
    }

    fn orbit(&self, azimuth: f32, elevation: f32, distance: Option<f32>, yfov: f32) -> Result<RenderCamera> {
        in_range("camera.azimuth", azimuth, -36000.0..=36000.0, "degrees about +Y, from +Z towards +X")?;
        in_range("camera.elevation", elevation, -90.0..=90.0, "degrees above the horizon")?;
        in_range("camera.fov", yfov, YFOV_DEGREES, "degrees, vertical")?;
        let yfov = f64::from(yfov).to_radians();
        let distance = match distance {
            Some(distance) if distance.is_finite() && distance > 0.0 => f64::from(distance),
            Some(distance) => {
                let message = format!("{distance} is not a distance; any number of world units above 0 is allowed");
                return Err(Error::invalid("camera.distance", message));
            }
            None => self.framing_distance(yfov),
        };
        let (sin_az, cos_az) = f64::from(azimuth).to_radians().sin_cos();
        let (sin_el, cos_el) = f64::from(elevation).to_radians().sin_cos();
        let outward = DVec3::new(sin_az * cos_el, sin_el, cos_az * cos_el);
        // The meridian's direction: also right straight above and below, where +Y is not.
        let up = DVec3::new(-sin_az * sin_el, cos_el, -cos_az * sin_el);
        Ok(self.perspective(self.centre + outward * distance, outward, up, yfov))
    }

    /// From where the sphere around the scene just fits both ways.
    fn framing_distance(&self, yfov: f64) -> f64 {
        let half_y = 0.5 * yfov;
        let half_x = (half_y.tan() * self.aspect).atan();
        FRAME_MARGIN * self.radius / half_y.min(half_x).sin()
    }

    fn look_at(&self, eye: [f32; 3], target: [f32; 3], yfov: f32) -> Result<RenderCamera> {
        in_range("camera.fov", yfov, YFOV_DEGREES, "degrees, vertical")?;
        finite("camera.eye", eye)?;
        finite("camera.look_at", target)?;
        let [eye, target] = [eye, target].map(|place| DVec3::from_array(place.map(f64::from)));
        let (backward, up) = axes(eye, target).ok_or_else(|| {
            Error::invalid("camera.look_at", "the camera looks at the place it stands on; move one of the two")
        })?;
        Ok(self.perspective(eye, backward, up, f64::from(yfov).to_radians()))
    }

    fn perspective(&self, eye: DVec3, backward: DVec3, up: DVec3, yfov: f64) -> RenderCamera {
        let near = NEAR_SHARE * ((eye - self.centre).length() + self.radius);
        camera(view_from_world(eye, backward, up), perspective(yfov, self.aspect, near, None), eye)
    }

    fn of_file(&self, camera_: &Camera) -> Result<RenderCamera> {
        let world_from_camera = DMat4::from_cols_array(&camera_.world_from_camera.map(f64::from));
        let eye = world_from_camera.w_axis.truncate();
        // Scale on a camera's node changes nothing (glTF 2.0, 3.10).
        let axes =
            (world_from_camera.z_axis.truncate().try_normalize(), world_from_camera.y_axis.truncate().try_normalize());
        let (Some(backward), Some(up)) = axes else { return Err(unusable(camera_, "its node has no orientation")) };
        if !eye.is_finite() || backward.cross(up).length() < 1e-6 {
            return Err(unusable(camera_, "its node has no orientation"));
        }
        Ok(camera(view_from_world(eye, backward, up), self.file_projection(camera_)?, eye))
    }

    fn file_projection(&self, camera: &Camera) -> Result<DMat4> {
        let (near, far) = (f64::from(camera.znear), camera.zfar.map(f64::from));
        if far.is_some_and(|far| far <= near) {
            return Err(unusable(camera, "its zfar is not beyond its znear"));
        }
        match camera.yfov_radians.map(f64::from) {
            Some(yfov) if yfov > 0.0 && yfov < std::f64::consts::PI && near > 0.0 => {
                Ok(perspective(yfov, self.aspect, near, far))
            }
            Some(_) => Err(unusable(camera, "its yfov must lie in (0, pi) and its znear above 0")),
            None if camera.ymag > 0.0 => {
                let far = far.ok_or_else(|| unusable(camera, "an orthographic camera needs zfar"))?;
                Ok(orthographic(f64::from(camera.ymag), self.aspect, near, far))
            }
            None => Err(unusable(camera, "its ymag must be above 0")),
        }
    }
}

fn unusable(camera: &Camera, why: &str) -> Error {
    let name = camera.name.as_deref().unwrap_or("without a name");
    Error::invalid("camera", format!("the file's camera '{name}' cannot be used: {why}; name another or give an eye"))
}

fn in_range(field: &str, value: f32, allowed: std::ops::RangeInclusive<f32>, unit: &str) -> Result<()> {
    if allowed.contains(&value) {
        return Ok(());
    }
    let (low, high) = (allowed.start(), allowed.end());
    Err(Error::invalid(field, format!("{value} is out of range; {low} to {high} is allowed ({unit})")))
}

fn finite(field: &str, point: [f32; 3]) -> Result<()> {
    if point.iter().all(|x| x.is_finite()) {
        return Ok(());
    }
    Err(Error::invalid(field, format!("{point:?} is not a place: give three finite numbers")))
}

/// View space (x to the right, y up, the view along -z) from world space; `None` where the target is the eye.
#[must_use]
pub fn looking_at(eye: DVec3, target: DVec3) -> Option<DMat4> {
    axes(eye, target).map(|(backward, up)| view_from_world(eye, backward, up))
}

/// The direction backward, unit length, and a direction up.
fn axes(eye: DVec3, target: DVec3) -> Option<(DVec3, DVec3)> {
    let backward = (eye - target).try_normalize()?;
    // Looking straight up or down, the top of the image is -Z or +Z.
    let up = if backward.y.abs() > 1.0 - 1e-9 { DVec3::Z * -backward.y.signum() } else { DVec3::Y };
    Some((backward, up))
}

/// `backward` is unit length and not parallel to `up`.
fn view_from_world(eye: DVec3, backward: DVec3, up: DVec3) -> DMat4 {
    let right = up.cross(backward).normalize();
    let up = backward.cross(right);
    let world_from_view = DMat4::from_cols(right.extend(0.0), up.extend(0.0), backward.extend(0.0), eye.extend(1.0));
    world_from_view.inverse()
}

/// Reversed depth: 1 at the near plane, 0 at the far plane or at infinity.
fn perspective(yfov: f64, aspect: f64, near: f64, far: Option<f64>) -> DMat4 {
    let cotangent = 1.0 / (0.5 * yfov).tan();
    let (scale, offset) = far.map_or((0.0, near), |far| (near / (far - near), near * far / (far - near)));
    DMat4::from_cols_array_2d(&[
        [cotangent / aspect, 0.0, 0.0, 0.0],
        [0.0, cotangent, 0.0, 0.0],
        [0.0, 0.0, scale, -1.0],
        [0.0, 0.0, offset, 0.0],
    ])
}

fn orthographic(ymag: f64, aspect: f64, near: f64, far: f64) -> DMat4 {
    DMat4::from_cols_array_2d(&[
        [1.0 / (ymag * aspect), 0.0, 0.0, 0.0],
        [0.0, 1.0 / ymag, 0.0, 0.0],
        [0.0, 0.0, 1.0 / (far - near), 0.0],
        [0.0, 0.0, far / (far - near), 1.0],
    ])
}

fn camera(view_from_world: DMat4, clip_from_view: DMat4, eye: DVec3) -> RenderCamera {
    RenderCamera {
        view_from_world: view_from_world.as_mat4().to_cols_array(),
        clip_from_view: clip_from_view.as_mat4().to_cols_array(),
        eye_world: eye.as_vec3().to_array(),
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec4;

    use super::*;

    const BOX: [[f32; 3]; 2] = [[-1.0, -2.0, -3.0], [3.0, 2.0, 1.0]];

    fn clip(camera: &RenderCamera, world: [f64; 3]) -> DVec4 {
        let view = DMat4::from_cols_array(&camera.view_from_world.map(f64::from));
        let projection = DMat4::from_cols_array(&camera.clip_from_view.map(f64::from));
        projection * view * DVec3::from_array(world).extend(1.0)
    }

    #[test]
    fn the_default_camera_shows_the_whole_box() {
        for (width, height) in [(512, 512), (64, 1024), (1024, 64)] {
            let camera = render_camera(&CameraChoice::Default, &Scene::default(), BOX, width, height).unwrap();
            for corner in 0..8 {
                let pick = |axis: usize| f64::from(BOX[corner >> axis & 1][axis]);
                let h = clip(&camera, [pick(0), pick(1), pick(2)]);
                assert!(h.w > 0.0 && h.x.abs() <= h.w && h.y.abs() <= h.w && h.z > 0.0 && h.z < h.w, "{h}");
            }
        }
    }

    #[test]
    fn an_orbit_may_stand_straight_above() {
        let choice = CameraChoice::Orbit {
            azimuth_degrees: 0.0,
            elevation_degrees: 90.0,
            distance: Some(9.0),
            yfov_degrees: 40.0,
        };
        let camera = render_camera(&choice, &Scene::default(), BOX, 8, 8).unwrap();
        assert!((camera.eye_world[1] - 9.0).abs() < 1e-5);
        assert!(clip(&camera, [1.0, 0.0, -2.0]).y > 0.0, "-Z is at the top of the image");
    }

    #[test]
    fn a_camera_that_looks_at_its_own_place_is_refused_by_name() {
        let choice = CameraChoice::LookAt { eye: [1.0; 3], target: [1.0; 3], yfov_degrees: 40.0 };
        let error = render_camera(&choice, &Scene::default(), BOX, 8, 8).unwrap_err();
        assert_eq!(error.field.as_deref(), Some("camera.look_at"));
    }

    #[test]
    fn a_missing_camera_is_refused_with_the_names_there_are() {
        let camera = Camera {
            name: Some("front".into()),
            world_from_camera: glam::Mat4::IDENTITY.to_cols_array(),
            yfov_radians: Some(1.0),
            ymag: 0.0,
            znear: 0.1,
            zfar: Some(100.0),
        };
        let scene = Scene { cameras: vec![camera], ..Scene::default() };
        let error = render_camera(&CameraChoice::Named("back".into()), &scene, BOX, 8, 8).unwrap_err();
        assert!(error.message.contains("'front'"), "{}", error.message);
        assert!(render_camera(&CameraChoice::Named("front".into()), &scene, BOX, 8, 8).is_ok());
    }

    #[test]
    fn depth_is_one_at_the_near_plane_and_zero_at_the_far_one() {
        for matrix in [perspective(1.0, 1.5, 0.5, Some(20.0)), orthographic(2.0, 1.5, 0.5, 20.0)] {
            let depth = |z: f64| {
                let h = matrix * DVec4::new(0.0, 0.0, z, 1.0);
                h.z / h.w
            };
            assert!((depth(-0.5) - 1.0).abs() < 1e-12 && depth(-20.0).abs() < 1e-12);
        }
    }
}
