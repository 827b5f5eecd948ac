//! Images on a Vulkan device: a visibility buffer filled in compute, then shaded (`README.md` has the
//! passes). The image is made in slabs, so that its size does not bound the memory of the samples.

pub(crate) mod bump;
pub(crate) mod charts;
pub(crate) mod coverage;
pub mod environment;
mod layers;
pub(crate) mod light;
mod projected;
pub(crate) mod proxies;
pub(crate) mod relief;
pub(crate) mod shading;
mod shadow_map;
mod shells;
mod silhouettes;
mod streams;
pub(crate) mod tables;
mod textures;
mod visibility;

use std::sync::Arc;

use displace_glsl::layout::raster::SAMPLES;

use crate::{
    domain::{
        Error, Result,
        image::{ImagePlan, ImageSet, RenderScene},
        report::PassTime,
        request::Aov,
    },
    render::{JobContext, reflection::reflections},
    vulkan::{Device, Recorder},
};

pub use relief::KeptCones;
use streams::{SceneStreams, WorkStreams};
use tables::Tables;
use textures::Textures;

/// Renders the scene. The same plan and scene give the same bytes on the same device, whatever the size of
/// the slabs. `cones` are those of earlier renders on the same device.
pub fn render(
    device: &Arc<Device>,
    job: &JobContext<'_>,
    plan: &ImagePlan,
    scene: &RenderScene,
    cones: &KeptCones,
) -> Result<(ImageSet, Vec<PassTime>)> {
    check_plan(plan)?;
    let (side, fine) = (plan.supersample, plan.fine());
    let mut around = Vec::new();
    let reflections = reflections(scene, |plan, scene| {
        let (images, times) = render(device, job, plan, scene, cones)?;
        around.extend(times);
        Ok(images)
    })?;
    let scene = proxies::with_proxies(scene);
    let scene = scene.as_ref();
    let mut run = Run { device, job, cones, times: Vec::new() };
    around.into_iter().for_each(|time| run.add(time));
    let shadow_maps = shadow_map::make(&mut run, scene)?;
    let mut tables = Tables::new(&fine, scene)?;
    cones.put(&mut tables.relief);
    let textures = Textures::new(scene, &mut tables.texture_uses)?;
    let streams = SceneStreams::upload(device, scene, &tables, &textures, &reflections)?;
    run.record(|recorder| {
        textures.record_mips(recorder, &streams.texels)?;
        streams.relief.record_maps(recorder, &tables.relief)?;
        streams.record_light(recorder)
    })?;
    cones.keep(&tables.relief, &streams.relief)?;
    let work = WorkStreams::new(device, &fine, side, scene, &tables)?;
    let frame = Frame {
        plan: &fine,
        side,
        scene,
        tables: &tables,
        streams: &streams,
        work: &work,
        shadow_maps: shadow_maps.as_ref(),
    };
    let mut images = empty_images(plan, scene);
    let slabs = slabs(&fine);
    for (done, slab) in slabs.iter().enumerate() {
        visibility::fill(&mut run, &frame, *slab, done == 0)?;
        if scene.aovs.contains(&Aov::Overdraw) {
            visibility::count(&mut run, &frame, *slab)?;
        }
        if tables.has_layers {
            images.layers_left_out |= layers::shade(&mut run, &frame, *slab)?;
        }
        shading::shade(&mut run, &frame, *slab)?;
        shading::copy_out(&work, *slab, side, &mut images)?;
        relief::copy_costs(&frame, *slab, &mut images)?;
        job.progress.pass("image", done as u64 + 1, slabs.len() as u64);
    }
    Ok((images, run.times))
}

/// What the steps of a render share.
pub(crate) struct Frame<'a> {
    /// Of the image that is averaged.
    plan: &'a ImagePlan,
    /// Its pixels along a side of one of the image's.
    side: u32,
    scene: &'a RenderScene,
    tables: &'a Tables,
    streams: &'a SceneStreams,
    work: &'a WorkStreams,
    shadow_maps: Option<&'a shadow_map::ShadowStreams>,
}

/// A rectangle of the image, pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Slab {
    pub(crate) origin: [u32; 2],
    pub(crate) size: [u32; 2],
}

impl Slab {
    pub(crate) fn pixels(&self) -> u64 {
        u64::from(self.size[0]) * u64::from(self.size[1])
    }

    /// In pixels that are `side` times as wide and high.
    pub(crate) fn coarser(&self, side: u32) -> Self {
        Self { origin: self.origin.map(|x| x / side), size: self.size.map(|x| x / side) }
    }

    /// As push constants have it: origin and size.
    pub(crate) fn px(&self) -> ([i32; 2], [i32; 2]) {
        (self.origin.map(|x| x as i32), self.size.map(|x| x as i32))
    }
}

fn slabs(plan: &ImagePlan) -> Vec<Slab> {
    let side = plan.slab_px as usize;
    let mut slabs = Vec::new();
    for y in (0..plan.height).step_by(side) {
        for x in (0..plan.width).step_by(side) {
            let size = [plan.slab_px.min(plan.width - x), plan.slab_px.min(plan.height - y)];
            slabs.push(Slab { origin: [x, y], size });
        }
    }
    slabs
}

fn check_plan(plan: &ImagePlan) -> Result<()> {
    let sides = 1..=ImagePlan::MAX_SIDE;
    let slab_sides = 16..=ImagePlan::MAX_SLAB;
    let known = plan.samples == SAMPLES
        && plan.supersample.is_power_of_two()
        && plan.supersample <= 16
        && plan.width.max(plan.height) <= ImagePlan::MAX_SIDE / plan.supersample
        && plan.rays.is_none()
        && slab_sides.contains(&plan.slab_px)
        && plan.slab_px.is_multiple_of(16);
    if known && sides.contains(&plan.width) && sides.contains(&plan.height) {
        return Ok(());
    }
    Err(Error::internal(format!("{plan:?} is not a plan of this version")))
}

pub(crate) fn empty_images(plan: &ImagePlan, scene: &RenderScene) -> ImageSet {
    let pixels = plan.width as usize * plan.height as usize;
    let wants = |aov: Aov| scene.aovs.contains(&aov);
    ImageSet {
        width: plan.width,
        height: plan.height,
        color: vec![[0.0; 4]; pixels],
        depth: wants(Aov::Depth).then(|| vec![f32::INFINITY; pixels]),
        normal: wants(Aov::Normal).then(|| vec![[0.0; 3]; pixels]),
        position: wants(Aov::Position).then(|| vec![[0.0; 3]; pixels]),
        uv: wants(Aov::Uv).then(|| vec![[0.0; 2]; pixels]),
        triangle: wants(Aov::Triangle).then(|| vec![u32::MAX; pixels]),
        overdraw: wants(Aov::Overdraw).then(|| vec![0; pixels]),
        samples: wants(Aov::Samples).then(|| vec![0; pixels]),
        cost: wants(Aov::Cost).then(|| vec![[0.0; 3]; pixels]),
        counters: None,
        clip_from_world: Some(scene.camera.clip_from_world()),
        layers_left_out: false,
    }
}

/// A render under way: what it runs on, and what its passes took so far.
pub(crate) struct Run<'a> {
    device: &'a Arc<Device>,
    job: &'a JobContext<'a>,
    cones: &'a KeptCones,
    times: Vec<PassTime>,
}

impl Run<'_> {
    /// Records passes, runs them and waits.
    pub(crate) fn record(&mut self, passes: impl FnOnce(&mut Recorder<'_>) -> Result<()>) -> Result<()> {
        let mut recorder = self.device.recorder(self.job.cancel, &crate::domain::cancel::NoProgress);
        passes(&mut recorder)?;
        for time in recorder.finish()? {
            self.add(PassTime::from(time));
        }
        Ok(())
    }

    fn add(&mut self, time: PassTime) {
        match self.times.iter_mut().find(|known| known.name == time.name) {
            Some(known) => {
                known.ms += time.ms;
                known.bytes += time.bytes;
            }
            None => self.times.push(time),
        }
    }
}
