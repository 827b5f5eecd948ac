//! Cameras and sizes.

use displace_proto::v1;

use super::{join, vector, within};
use crate::domain::{
    Error, Result,
    camera::YFOV_DEGREES,
    request::{CameraChoice, RenderRequest},
};

/// Views of one Render in this version, sequences apart.
pub(crate) const MAX_VIEWS: usize = 1;

const DEFAULT_SIZE: (u32, u32) = (1280, 720);
const DEFAULT_YFOV_DEGREES: f32 = 40.0;

pub(super) struct View {
    pub(super) camera: CameraChoice,
    pub(super) width: u32,
    pub(super) height: u32,
}

impl View {
    pub(super) fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }
}

pub(super) fn parse(path: &str, views: Vec<v1::View>, max_pixels: u32) -> Result<View> {
    let count = views.len();
    if count > MAX_VIEWS {
        return Err(Error::unsupported(path, format!("has {count} entries; this version renders {MAX_VIEWS} a call")));
    }
    let view = views.into_iter().next().ok_or_else(|| Error::invalid(path, "is required; give one view"))?;
    one(&format!("{path}[0]"), view, max_pixels)
}

pub(super) fn one(path: &str, view: v1::View, max_pixels: u32) -> Result<View> {
    Ok(View {
        camera: camera(path, view.camera)?,
        width: pixels(&join(path, "width"), view.width, DEFAULT_SIZE.0, max_pixels)?,
        height: pixels(&join(path, "height"), view.height, DEFAULT_SIZE.1, max_pixels)?,
    })
}

fn camera(path: &str, camera: Option<v1::view::Camera>) -> Result<CameraChoice> {
    use v1::view::Camera;
    Ok(match camera {
        None => CameraChoice::Default,
        Some(Camera::Named(name)) => CameraChoice::Named(name),
        Some(Camera::LookAt(look_at)) => {
            let (eye, target, yfov_degrees) = self::look_at(&join(path, "look_at"), &look_at)?;
            CameraChoice::LookAt { eye, target, yfov_degrees }
        }
        Some(Camera::Orbit(orbit)) => self::orbit(&join(path, "orbit"), &orbit)?,
    })
}

/// Eye, target, and vertical field of view in degrees.
pub(super) fn look_at(path: &str, camera: &v1::LookAt) -> Result<([f32; 3], [f32; 3], f32)> {
    let eye = vector(&join(path, "eye"), &camera.eye)?;
    let target = vector(&join(path, "target"), &camera.target)?;
    if eye == target {
        return Err(Error::invalid(join(path, "target"), "is where the camera is; choose another place"));
    }
    Ok((eye, target, yfov(path, camera.yfov_degrees)?))
}

fn orbit(path: &str, camera: &v1::Orbit) -> Result<CameraChoice> {
    let distance = camera.distance.map(|distance| positive(&join(path, "distance"), distance)).transpose()?;
    Ok(CameraChoice::Orbit {
        azimuth_degrees: within(&join(path, "azimuth_degrees"), camera.azimuth_degrees, -36000.0, 36000.0)?,
        elevation_degrees: within(&join(path, "elevation_degrees"), camera.elevation_degrees, -90.0, 90.0)?,
        distance,
        yfov_degrees: yfov(path, camera.yfov_degrees)?,
    })
}

fn yfov(path: &str, degrees: Option<f32>) -> Result<f32> {
    let degrees = degrees.unwrap_or(DEFAULT_YFOV_DEGREES);
    let (low, high) = YFOV_DEGREES.into_inner();
    within(&join(path, "yfov_degrees"), degrees, low, high)
}

fn positive(field: &str, value: f32) -> Result<f32> {
    if value > 0.0 && value.is_finite() {
        return Ok(value);
    }
    Err(Error::invalid(field, format!("{value} is out of range; allowed are finite values above 0")))
}

fn pixels(field: &str, value: u32, default: u32, most: u32) -> Result<u32> {
    let value = if value == 0 { default } else { value };
    if value <= most {
        return Ok(value);
    }
    Err(Error::invalid(field, format!("{value} pixels are out of range; allowed are 1 to {most}")))
}

/// 0 stands for as many as are needed.
pub(super) fn samples(field: &str, samples: u32) -> Result<Option<u32>> {
    let allowed = RenderRequest::SAMPLES;
    if samples == 0 || allowed.contains(&samples) {
        return Ok((samples > 0).then_some(samples));
    }
    let (low, high) = allowed.into_inner();
    Err(Error::invalid(field, format!("{samples} rays a pixel are out of range; allowed are {low} to {high}")))
}
