//! Images by rays: what a scene of triangles looks like, many samples a pixel, in f64, as the renderer defines
//! light, colour and filter.
//!
//! | file | holds |
//! |---|---|
//! | `image/scene.rs` | what is shown |
//! | `image/view.rs` | from pixels to rays |
//! | `image/world.rs` | from rays to points of surfaces |
//! | `image/material.rs` | what a surface looks like at a point |
//! | `image/shading.rs` | from points to colours |
//! | `image/phong.rs` | Phong's model |
//! | `image/brdf.rs` | the metallic-roughness model |
//! | `image/albedo.rs` | what facets reflect once of light from everywhere |
//! | `image/quadrature.rs` | integrals along a line |
//! | `image/environment.rs` | light from endlessly far away, by direction |
//! | `image/lobe.rs` | the integral of such light over what a surface reflects |
//! | `image/sampling.rs` | where the samples of a pixel lie |
//!
//! The filter is the renderer's own, a box over the pixel: a pixel is the mean of its samples. Maps are
//! read at their finest level. Surroundings light a place by the integral over its hemisphere, by a few directions of each
//! sample; nothing shadows them, as the renderer has it. The further outputs are those at the pixel's centre, not means.

mod albedo;
mod brdf;
mod bump;
mod environment;
mod lobe;
mod material;
mod phong;
mod projection;
mod quadrature;
mod sampling;
mod scene;
mod shading;
mod view;
mod world;

use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec3;
use rayon::prelude::{IntoParallelIterator, ParallelIterator};

use crate::domain::{
    Result,
    cancel::{Cancel, Progress},
    image::{ImageSet, Lighting, Shading},
    request::Aov,
};

pub use scene::{OracleMesh, OracleScene};

use albedo::Albedo;
use environment::Sky;
use lobe::Directions;
use sampling::Places;
use shading::{Eye, Model, arriving_from};
use view::View;
use world::{Seen, World};

use super::bvh::Segment;

/// How an image is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exposure {
    /// Pixels, at least 1.
    pub width: u32,
    pub height: u32,
    /// Of a pixel, at least 1.
    pub samples: u32,
    /// Whether surfaces take each other's light. Light from everywhere reaches everything.
    pub shadows: bool,
}

/// Takes an image of the scene; the same scene gives the same bytes. Tells the progress of the pass `image` in
/// rows. Fails when cancelled, or when the scene has too many triangles to number.
pub fn render(scene: &OracleScene, exposure: &Exposure, cancel: &Cancel, progress: &dyn Progress) -> Result<ImageSet> {
    Camera::new(scene, exposure)?.image(cancel, progress)
}

/// A scene, ready to be looked at.
pub struct Camera<'s> {
    scene: &'s OracleScene,
    exposure: Exposure,
    world: World<'s>,
    view: View,
    lighting: &'s Lighting,
    sky: Option<Sky<'s>>,
    shading: Shading,
    bounces: u32,
    wants_centre: bool,
}

impl<'s> Camera<'s> {
    /// Fails when the scene has too many triangles to number.
    pub fn new(scene: &'s OracleScene, exposure: &Exposure) -> Result<Self> {
        let view = View::new(&scene.camera, exposure.width, exposure.height);
        if scene.shading == Shading::Pbr {
            // Before the threads of the image would wait for it.
            Albedo::table();
        }
        Ok(Self {
            scene,
            exposure: *exposure,
            world: World::new(scene, view.mirrored)?,
            view,
            lighting: &scene.lighting,
            sky: scene.lighting.environment.as_deref().map(Sky::new),
            shading: scene.shading,
            bounces: scene.bounces,
            wants_centre: !scene.aovs.is_empty(),
        })
    }

    /// As [`render`].
    pub fn image(&self, cancel: &Cancel, progress: &dyn Progress) -> Result<ImageSet> {
        let Exposure { width, height, .. } = self.exposure;
        let done = AtomicU64::new(0);
        let row = |y: u32| {
            cancel.check()?;
            let row: Vec<Pixel> = (0..width).map(|x| self.pixel(x, y)).collect();
            progress.pass("image", done.fetch_add(1, Ordering::Relaxed) + 1, u64::from(height));
            Ok(row)
        };
        let rows: Vec<Vec<Pixel>> = (0..height).into_par_iter().map(row).collect::<Result<_>>()?;
        let mut images = empty_images(&self.exposure, &self.scene.aovs);
        images.clip_from_world = Some(self.scene.camera.clip_from_world());
        rows.into_iter().flatten().enumerate().for_each(|(i, pixel)| pixel.store(i, &mut images));
        Ok(images)
    }

    /// What is seen in the direction of a place, before or behind it.
    #[must_use]
    pub fn towards(&self, place: DVec3) -> Option<DVec3> {
        self.world.place(&self.view.ray(self.view.px(place)))
    }

    fn pixel(&self, x: u32, y: u32) -> Pixel {
        let corner = [f64::from(x), f64::from(y)];
        let ray = |[u, v]: [f64; 2]| self.view.ray([corner[0] + u, corner[1] + v]);
        let places = Places::of_pixel(x, y);
        let by = [places.further(0), places.further(1)];
        let eye = |ray: &Segment| self.view.eye().map_or(Eye::Towards(-ray.direction), Eye::At);
        let radiance = |sample| {
            let ray = ray(places.at(sample));
            let follow =
                Follow { eye: eye(&ray), places, directions: Directions { by, sample }, bounces: self.bounces };
            self.radiance(&ray, &follow)
        };
        let sum: DVec3 = (0..self.exposure.samples).map(radiance).sum();
        let centre = if self.wants_centre { self.world.seen(&ray([0.5; 2])) } else { None };
        let depth = centre.map_or(f64::INFINITY, |seen| self.view.depth(seen.position));
        Pixel { color: sum / f64::from(self.exposure.samples), depth, centre }
    }

    fn radiance(&self, ray: &Segment, follow: &Follow) -> DVec3 {
        let (mut color, mut passes) = (DVec3::ZERO, 1.0);
        for seen in self.world.layers(ray) {
            color += passes * seen.alpha * self.reflected(ray, &seen, follow);
            passes *= 1.0 - seen.alpha;
        }
        color + passes * self.behind(ray.direction)
    }

    /// Radiance of a point towards where the ray comes from.
    fn reflected(&self, ray: &Segment, seen: &Seen, follow: &Follow) -> DVec3 {
        if seen.look.unlit {
            return seen.look.base.truncate();
        }
        if follow.bounces > 0 && self.shading == Shading::Pbr && seen.look.is_mirror() {
            return self.mirrored(ray, seen, follow);
        }
        let model = Model::new(self.shading, seen, follow.eye);
        let of_light = |(l, light)| {
            // The first two are the surroundings'.
            let at = follow.places.further(2 + l as u32).at(follow.directions.sample);
            let color = model.direct(light, at);
            let towards = arriving_from(light, seen.position, at);
            let is_dark = color == DVec3::ZERO
                || (self.exposure.shadows && self.world.is_shadowed(seen, towards.direction, towards.distance));
            if is_dark { DVec3::ZERO } else { color }
        };
        let direct: DVec3 = self.lighting.lights.iter().enumerate().map(of_light).sum();
        direct + model.indirect(self.lighting, self.sky.as_ref(), &follow.directions)
    }

    /// What a mirror shows, by Schlick's share of it (1994): of a metal, its base colour from the front.
    fn mirrored(&self, ray: &Segment, seen: &Seen, follow: &Follow) -> DVec3 {
        let view = -ray.direction;
        let cosine = seen.look.normal.dot(view).clamp(0.0, 1.0);
        let mirrored = self.world.leaving(seen, 2.0 * seen.look.normal.dot(view) * seen.look.normal - view);
        let base = seen.look.base.truncate();
        let share = base + (1.0 - base) * (1.0 - cosine).powi(5);
        let follow = Follow { eye: Eye::At(seen.position), bounces: follow.bounces - 1, ..*follow };
        seen.look.emissive + share * self.radiance(&mirrored, &follow)
    }

    /// What is seen in a unit direction where nothing is.
    fn behind(&self, direction: DVec3) -> DVec3 {
        let background = || DVec3::from_array(self.lighting.background.map(f64::from));
        self.sky.as_ref().map_or_else(background, |sky| sky.radiance(direction))
    }
}

/// A ray under way: where its end is seen from, which samples follow it, and how many mirrors it may still meet.
#[derive(Clone, Copy)]
struct Follow {
    eye: Eye,
    places: Places,
    directions: Directions,
    bounces: u32,
}

/// What the images hold of one pixel.
struct Pixel {
    color: DVec3,
    depth: f64,
    centre: Option<Seen>,
}

impl Pixel {
    fn store(self, i: usize, images: &mut ImageSet) {
        images.color[i] = self.color.as_vec3().extend(1.0).to_array();
        let Some(seen) = self.centre else { return };
        set(&mut images.depth, i, self.depth as f32);
        set(&mut images.normal, i, seen.look.normal.as_vec3().to_array());
        set(&mut images.position, i, seen.position.as_vec3().to_array());
        set(&mut images.uv, i, seen.uv.as_vec2().to_array());
        set(&mut images.triangle, i, seen.triangle);
    }
}

fn set<T>(image: &mut Option<Vec<T>>, i: usize, value: T) {
    if let Some(image) = image {
        image[i] = value;
    }
}

fn empty_images(exposure: &Exposure, aovs: &[Aov]) -> ImageSet {
    let pixels = exposure.width as usize * exposure.height as usize;
    let wants = |aov: Aov| aovs.contains(&aov);
    let color = vec![[0.0; 4]; pixels];
    let mut images = ImageSet { width: exposure.width, height: exposure.height, color, ..ImageSet::default() };
    images.depth = wants(Aov::Depth).then(|| vec![f32::INFINITY; pixels]);
    images.normal = wants(Aov::Normal).then(|| vec![[0.0; 3]; pixels]);
    images.position = wants(Aov::Position).then(|| vec![[0.0; 3]; pixels]);
    images.uv = wants(Aov::Uv).then(|| vec![[0.0; 2]; pixels]);
    images.triangle = wants(Aov::Triangle).then(|| vec![u32::MAX; pixels]);
    images
}
