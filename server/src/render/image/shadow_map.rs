//! Shadow maps on a Vulkan device: the visibility buffer of each side of each light, of which depths are kept.

use displace_glsl::{
    SHADERS,
    layout::shadow::{ShadowDepthsParams, ShadowFace, ShadowMapParams},
};

use crate::{
    domain::{
        Result,
        image::{ImagePlan, RenderScene},
    },
    render::shadow_map::{ShadowPlan, Side, image_plan, stopping},
    vulkan::{Recorder, Stream},
};

use super::{
    Frame, Run,
    shading::any_normal,
    slabs,
    streams::{SceneStreams, WorkStreams},
    tables::Tables,
    textures::Textures,
    visibility,
};

/// What lights see.
pub(crate) struct ShadowStreams {
    faces: Stream,
    depths: Stream,
}

/// Draws what lights see, where the scene asks for shadow maps.
pub(crate) fn make(run: &mut Run<'_>, scene: &RenderScene) -> Result<Option<ShadowStreams>> {
    let Some(plan) = ShadowPlan::new(scene)? else { return Ok(None) };
    let maps = ShadowStreams {
        faces: Stream::from_slice(run.device, "shadow faces", &plan.faces)?,
        depths: Stream::new(run.device, "shadow depths", 16, plan.texels)?,
    };
    let mut scene = stopping(scene);
    scene.camera = plan.sides[0].camera;
    let mut tables = Tables::new(&image_plan(&scene, &plan.sides[0].face)?, &scene)?;
    run.cones.put(&mut tables.relief);
    let textures = Textures::new(&scene, &mut tables.texture_uses)?;
    let mut streams = SceneStreams::upload(run.device, &scene, &tables, &textures, &[])?;
    run.record(|recorder| {
        textures.record_mips(recorder, &streams.texels)?;
        streams.relief.record_maps(recorder, &tables.relief)
    })?;
    run.cones.keep(&tables.relief, &streams.relief)?;
    let widest = plan.sides.iter().map(|side| side.face).max_by_key(|face| face.size);
    let widest = image_plan(&scene, &widest.unwrap_or_default())?;
    let work = WorkStreams::new(run.device, &widest, 1, &scene, &tables)?;
    for Side { camera, face } in &plan.sides {
        scene.camera = *camera;
        let plan = image_plan(&scene, face)?;
        let tables = Tables::new(&plan, &scene)?;
        streams.instance_rows = Stream::from_slice(run.device, "instance_rows", &tables.instance_rows)?;
        let frame = Frame {
            plan: &plan,
            side: 1,
            scene: &scene,
            tables: &tables,
            streams: &streams,
            work: &work,
            shadow_maps: None,
        };
        draw(run, &frame, &plan, face, &maps.depths)?;
    }
    Ok(Some(maps))
}

fn draw(run: &mut Run<'_>, frame: &Frame<'_>, plan: &ImagePlan, face: &ShadowFace, depths: &Stream) -> Result<()> {
    for (done, slab) in slabs(plan).into_iter().enumerate() {
        visibility::fill(run, frame, slab, done == 0)?;
        let (slab_px, slab_size_px) = slab.px();
        let count = slab.pixels() as u32;
        let params = ShadowDepthsParams { count, slab_px, slab_size_px, first: face.first, size: face.size };
        let bound = [("visibility", &frame.work.visibility), ("depths", depths)];
        run.record(|recorder| Ok(recorder.dispatch(&SHADERS.shadow_depths, slab.pixels(), &params, &bound)?))?;
    }
    Ok(())
}

/// Which share of each light reaches each of the first `count` fragments.
pub(crate) fn record(recorder: &mut Recorder<'_>, frame: &Frame<'_>, count: u64) -> Result<()> {
    let (Frame { tables, streams, work, .. }, Some(maps)) = (frame, frame.shadow_maps) else { return Ok(()) };
    let lights = tables.lights.len();
    let pairs = count * lights as u64;
    let bound = [
        ("points", &work.points),
        ("appearances", &work.appearances),
        ("lights", &streams.lights),
        ("faces", &maps.faces),
        ("depths", &maps.depths),
        ("shadows", &work.shadows),
    ];
    let params = ShadowMapParams { count: pairs as u32, lights: lights as u32, any_normal: any_normal(frame) };
    Ok(recorder.dispatch(&SHADERS.shadow_map, pairs, &params, &bound)?)
}
