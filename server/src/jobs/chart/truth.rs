//! What is right: the surface itself, by rays, and the camera that all else is seen by.

use std::time::Instant;

use glam::DVec3;
use rayon::prelude::*;

use crate::{
    domain::{
        Error, Result,
        cancel::Progress,
        encode,
        image::{ImageSet, RenderCamera},
        report::{PassTime, Warning},
        request::{ImageFormat, RenderRequest, Shadows},
    },
    jobs::{
        WorkContext, exact,
        inputs::{self, Inputs},
        render::planned,
    },
    oracle::{
        self,
        image::{Exposure, OracleScene},
        metrics::picture::Picture,
        reprojection::{p99_px, reprojected},
        surface::{SeamChoice, Surface},
    },
};

/// How far it may be from the surface, pixels: a quarter of what the finest setting is allowed, since what it takes grows with
/// its inverse.
const RESIDUAL_PX: f64 = 1.0 / 16.0;

pub(super) struct Truth<'s> {
    pub(super) picture: Picture,
    pub(super) png: Vec<u8>,
    pub(super) camera: RenderCamera,
    /// With what it is made of.
    pub(super) ms: f64,
    /// Rays a pixel.
    pub(super) samples: u32,
    pub(super) ground: &'s Ground,
    seen: oracle::image::Camera<'s>,
    surfaces: Vec<Surface<'s>>,
    pub(super) passes: Vec<PassTime>,
}

/// What it is made of: triangles for the surface, from where it is seen.
pub(super) struct Ground {
    pub(super) scene: OracleScene,
    pub(super) inputs: Inputs,
    choice: SeamChoice,
    /// Of the meshes.
    pub(super) title: String,
    pub(super) triangles_in: u64,
    pub(super) warnings: Vec<Warning>,
    pub(super) passes: Vec<PassTime>,
    ms: f64,
}

pub(super) fn ground(context: &WorkContext<'_>, request: &RenderRequest) -> Result<Ground> {
    let start = Instant::now();
    let mut inputs = Inputs::load(context.assets, context.limits, &context.job(), &request.surface)?;
    planned(&inputs, context.limits, request)?;
    let mut passes = inputs.take_passes();
    let scene = inputs::timed(context.progress, "dice", &mut passes, || {
        exact::scene(context, &mut inputs, request, RESIDUAL_PX)
    })?;
    let (title, triangles_in) = (title(&inputs), inputs.estimate().triangles_in);
    let ms = start.elapsed().as_secs_f64() * 1e3;
    let (warnings, choice) = (inputs.scene.warnings.clone(), SeamChoice::from(&request.surface.geometry));
    Ok(Ground { scene, inputs, choice, title, triangles_in, warnings, passes, ms })
}

pub(super) fn take<'s>(context: &WorkContext<'_>, request: &RenderRequest, ground: &'s Ground) -> Result<Truth<'s>> {
    let start = Instant::now();
    let rays = request.rays().ok_or_else(|| Error::internal("a truth without rays"))?;
    let shadows = rays.shadows != Shadows::None;
    let exposure = Exposure { width: request.width, height: request.height, samples: rays.samples, shadows };
    let progress = Named { progress: context.progress, name: "truth" };
    let mut passes = Vec::new();
    let (seen, images) = inputs::timed(context.progress, "truth", &mut passes, || {
        let seen = oracle::image::Camera::new(&ground.scene, &exposure)?;
        let images = seen.image(context.cancel, &progress)?;
        Ok((seen, images))
    })?;
    let Inputs { scene, details, .. } = &ground.inputs;
    let pairs = scene.meshes.iter().zip(details);
    Ok(Truth {
        ground,
        surfaces: pairs.map(|(m, details)| Surface::new(&m.mesh, details, ground.choice)).collect(),
        picture: Picture::of_images("render", &images)?,
        png: png(&images)?,
        camera: ground.scene.camera,
        ms: ground.ms + start.elapsed().as_secs_f64() * 1e3,
        samples: rays.samples,
        seen,
        passes,
    })
}

impl Truth<'_> {
    /// What 99 of 100 covered pixels of an image with texture coordinates are off by (`oracle::reprojection`).
    pub(super) fn reprojected_px(&self, images: &ImageSet) -> Option<f64> {
        let pixels = reprojected(&self.ground.inputs.scene, &self.surfaces, images, usize::MAX);
        p99_px(&pixels).filter(|error_px| error_px.is_finite())
    }

    /// What it shows on the rays on which another image took its places, which need not be those of the centres of pixels.
    pub(super) fn towards(&self, other: &Picture) -> Picture {
        let (Some(covered), Some(positions)) = (&other.covered, &other.positions) else { return Picture::default() };
        let place = |(covered, position): (&bool, &[f32; 3])| {
            covered.then(|| self.seen.towards(DVec3::from_array(position.map(f64::from)))).flatten()
        };
        let places: Vec<Option<DVec3>> = covered.par_iter().zip(positions).map(place).collect();
        Picture {
            width: other.width,
            height: other.height,
            covered: Some(places.iter().map(Option::is_some).collect()),
            positions: Some(places.iter().map(|p| p.unwrap_or_default().as_vec3().to_array()).collect()),
            clip_from_world: self.picture.clip_from_world,
            ..Picture::default()
        }
    }
}

/// The colours alone.
pub(super) fn png(images: &ImageSet) -> Result<Vec<u8>> {
    let (width, height) = (images.width, images.height);
    let color = ImageSet { width, height, color: images.color.clone(), ..ImageSet::default() };
    let mut files = encode::encode(&color, ImageFormat::Png)?;
    Ok(files.swap_remove(0).bytes)
}

/// The first name, and how many meshes there are besides.
fn title(inputs: &Inputs) -> String {
    let meshes = &inputs.scene.meshes;
    let named = meshes.iter().map(|m| m.mesh.name.as_str()).find(|name| !name.is_empty());
    match (named.unwrap_or("mesh without a name"), meshes.len()) {
        (name, 0 | 1) => name.to_owned(),
        (name, count) => format!("{name} and {} more", count - 1),
    }
}

/// Tells what it is told under one name.
struct Named<'p> {
    progress: &'p dyn Progress,
    name: &'static str,
}

impl Progress for Named<'_> {
    fn pass(&self, _name: &str, done: u64, total: u64) {
        self.progress.pass(self.name, done, total);
    }
}
