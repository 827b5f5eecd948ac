//! Light of fragments by the model that the scene asks for, and what is behind them.

use displace_glsl::{
    SHADERS,
    layout::{
        light::{BackdropParams, LOBE_SAMPLES, ShadePbrParams, SurroundingsParams},
        raster::{NORMALS_OF_PIXELS, NORMALS_OF_TRIANGLES, NORMALS_OF_VERTICES, ShadePhongParams},
    },
    reference::backdrop::Directions,
};
use glam::{DMat4, DVec3, DVec4};

use crate::{
    domain::{
        Result,
        image::{ImagePlan, REFLECTIVITY, RenderCamera, Shading},
    },
    vulkan::{Recorder, Stream},
};

use super::{Frame, Slab, environment::EnvironmentStreams, shading::eye_and_depth, streams::ReflectionStreams};

/// Radiance of the first `count` fragments.
pub(crate) fn record(recorder: &mut Recorder<'_>, frame: &Frame<'_>, count: u64) -> Result<()> {
    record_surroundings(recorder, frame, count)?;
    match frame.scene.shading {
        Shading::Flat => record_phong(recorder, frame, NORMALS_OF_TRIANGLES, count),
        Shading::Gouraud => record_phong(recorder, frame, NORMALS_OF_VERTICES, count),
        Shading::Phong => record_phong(recorder, frame, NORMALS_OF_PIXELS, count),
        Shading::Pbr => record_pbr(recorder, frame, count),
    }
}

fn record_phong(recorder: &mut Recorder<'_>, frame: &Frame<'_>, normals: u32, count: u64) -> Result<()> {
    let Frame { scene, tables, streams, work, .. } = frame;
    let params = ShadePhongParams {
        count: count as u32,
        normals,
        lights: tables.lights.len() as u32,
        shadowed: u32::from(!work.shadows.is_empty()),
        eye: eye_and_depth(&scene.camera).0,
        ambient: scene.lighting.ambient,
        reflectivity: REFLECTIVITY,
        has_environment: u32::from(streams.has_surroundings()),
    };
    let geometry =
        [("positions", &streams.positions), ("normals", &streams.normals), ("instance_rows", &streams.instance_rows)];
    let bound = [&lit_bindings(frame)[..], &geometry].concat();
    Ok(recorder.dispatch(&SHADERS.shade_phong, count, &params, &bound)?)
}

fn record_pbr(recorder: &mut Recorder<'_>, frame: &Frame<'_>, count: u64) -> Result<()> {
    let Frame { scene, tables, streams, work, .. } = frame;
    let params = ShadePbrParams {
        count: count as u32,
        lights: tables.lights.len() as u32,
        shadowed: u32::from(!work.shadows.is_empty()),
        multiple_scattering: 1,
        eye: eye_and_depth(&scene.camera).0,
        ambient: scene.lighting.ambient,
        has_environment: u32::from(streams.has_surroundings()),
    };
    let bound = [&lit_bindings(frame)[..], &[("brdf_table", &streams.brdf_table)]].concat();
    if work.spreads.is_empty() {
        return Ok(recorder.dispatch(&SHADERS.shade_pbr, count, &params, &bound)?);
    }
    let bound = [&bound[..], &[("spreads", &work.spreads)]].concat();
    Ok(recorder.dispatch(&SHADERS.shade_pbr_moments, count, &params, &bound)?)
}

/// What every model of light reads, and where its radiance goes.
fn lit_bindings<'a>(Frame { streams, work, .. }: &'a Frame<'_>) -> [(&'static str, &'a Stream); 6] {
    [
        ("points", &work.points),
        ("appearances", &work.appearances),
        ("lights", &streams.lights),
        ("shadows", &work.shadows),
        ("surroundings", &work.surroundings),
        ("radiance", &work.radiance),
    ]
}

/// What fragments see of the environment, if there is one, and those of reflectors of their own. Phong's model mirrors
/// whatever the roughness.
fn record_surroundings(recorder: &mut Recorder<'_>, frame: &Frame<'_>, count: u64) -> Result<()> {
    let Frame { streams, work, .. } = frame;
    if streams.has_surroundings() && streams.environment.is_none() {
        recorder.fill(&work.surroundings, 0)?;
    }
    if let Some(environment) = &streams.environment {
        record_seen(recorder, frame, environment, SurroundingsParams::default(), count)?;
    }
    for ReflectionStreams { material, environment, room } in &streams.reflections {
        let room = room.map(|room| [room.centre, room.low, room.high].map(|p| p.as_vec3().to_array()));
        let [centre, low, high] = room.unwrap_or_default();
        let (of_material, has_room) = (material + 1, u32::from(room.is_some()));
        let params = SurroundingsParams { of_material, has_room, centre, low, high, ..SurroundingsParams::default() };
        record_seen(recorder, frame, environment, params, count)?;
    }
    Ok(())
}

fn record_seen(
    recorder: &mut Recorder<'_>,
    frame: &Frame<'_>,
    environment: &EnvironmentStreams,
    params: SurroundingsParams,
    count: u64,
) -> Result<()> {
    let Frame { scene, streams, work, .. } = frame;
    let params = SurroundingsParams {
        count: count as u32,
        normals: if scene.shading == Shading::Flat { NORMALS_OF_TRIANGLES } else { NORMALS_OF_PIXELS },
        mips: environment.mips,
        samples: if scene.shading == Shading::Pbr { LOBE_SAMPLES } else { 0 },
        eye: eye_and_depth(&scene.camera).0,
        ..params
    };
    let bound = [
        ("points", &work.points),
        ("appearances", &work.appearances),
        ("positions", &streams.positions),
        ("normals", &streams.normals),
        ("instance_rows", &streams.instance_rows),
        ("environment_levels", &environment.levels),
        ("environment_texels", &environment.texels),
        ("surroundings", &work.surroundings),
        ("spreads", &work.spreads),
    ];
    if work.spreads.is_empty() || scene.shading != Shading::Pbr {
        return Ok(recorder.dispatch(&SHADERS.surroundings, count, &params, &bound[..8])?);
    }
    Ok(recorder.dispatch(&SHADERS.surroundings_moments, count, &params, &bound)?)
}

/// The environment behind the pixels of a slab, if there is one.
pub(crate) fn record_backdrop(recorder: &mut Recorder<'_>, frame: &Frame<'_>, slab: Slab) -> Result<()> {
    let Some(environment) = &frame.streams.environment else { return Ok(()) };
    let (slab_px, slab_size_px) = slab.px();
    let directions = directions(&frame.scene.camera, frame.plan);
    let params = BackdropParams {
        count: slab.pixels() as u32,
        slab_px,
        slab_size_px,
        mips: environment.mips,
        direction: directions.corner.as_vec3().to_array(),
        direction_dx: directions.dx.as_vec3().to_array(),
        direction_dy: directions.dy.as_vec3().to_array(),
    };
    let bound = [
        ("environment_levels", &environment.levels),
        ("environment_texels", &environment.texels),
        ("backdrop", &frame.work.backdrop),
    ];
    Ok(recorder.dispatch(&SHADERS.backdrop, slab.pixels(), &params, &bound)?)
}

/// Where places of the image look, the middle of the image with length 1.
pub(crate) fn directions(camera: &RenderCamera, plan: &ImagePlan) -> Directions {
    let wide = |m: [f32; 16]| DMat4::from_cols_array(&m.map(f64::from));
    let (view_from_world, clip_from_view) = (wide(camera.view_from_world), wide(camera.clip_from_view));
    let world_from_view = view_from_world.inverse();
    let is_orthographic = camera.clip_from_view[11] == 0.0;
    // At clip depth 0, the far end of reversed depth, which is a direction where it is endlessly far.
    let view_from_clip = clip_from_view.inverse();
    let at = |x: f64, y: f64| {
        let far = view_from_clip * DVec4::new(x, y, 0.0, 1.0);
        // Over the distance along the axis: linear in x and y.
        let along = if is_orthographic { DVec3::NEG_Z } else { far.truncate() / -far.z };
        world_from_view.transform_vector3(along)
    };
    let corner = at(-1.0, 1.0);
    let dx = (at(1.0, 1.0) - corner) / f64::from(plan.width);
    let dy = (at(-1.0, -1.0) - corner) / f64::from(plan.height);
    Directions { corner, dx, dy }
}
