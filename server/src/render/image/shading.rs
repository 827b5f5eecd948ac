//! From the visibility buffer of a slab to its images: fragments, surface, maps, appearance, light, pixels.

use bytemuck::Pod;
use displace_glsl::{
    SHADERS,
    layout::light::LightAimsParams,
    layout::raster::{
        AppearanceParams, DownsampleParams, FragmentsParams, MAP_BASE_COLOR, MAP_EMISSIVE, MAP_METALLIC_ROUGHNESS,
        MAP_NORMAL, MAP_NORMAL_MOMENTS, MAP_OCCLUSION, MAP_SLOTS, MomentsParams, OUTPUT_DEPTH, OUTPUT_NORMAL,
        OUTPUT_POSITION, OUTPUT_SAMPLES, OUTPUT_TRIANGLE, OUTPUT_UV, PART_RELIEF, ResolveParams, ShadowRaysParams,
        SurfaceParams, TextureParams,
    },
    reference::lights,
};
use glam::{DMat4, DVec3};

use crate::{
    domain::{
        Result,
        image::{Filter, ImageSet, RenderCamera, Shading},
        projection::Projection,
        request::Aov,
    },
    vulkan::{Recorder, Stream},
};

use super::{
    Frame, Run, Slab, bump, layers, light, projected,
    relief::{self, Stage},
    shadow_map,
    streams::{OccluderStreams, WorkStreams},
    visibility::fragment_count,
};

/// Shades what is solid, and makes the images; of layers, where there are any.
pub(crate) fn shade(run: &mut Run<'_>, frame: &Frame<'_>, slab: Slab) -> Result<()> {
    let count = list_fragments(run, frame, slab, &frame.work.visibility)?;
    run.record(|recorder| {
        record_radiance(recorder, frame, slab, count)?;
        light::record_backdrop(recorder, frame, slab)?;
        if frame.tables.has_layers {
            return layers::record_composite(recorder, frame, slab, &frame.work.visibility, true);
        }
        record_images(recorder, frame, slab)
    })?;
    if frame.tables.has_layers {
        layers::show(run, frame, slab)?;
        run.record(|recorder| record_images(recorder, frame, slab))?;
    }
    Ok(())
}

/// Lists the fragments of what samples see, and tells how many there are.
pub(crate) fn list_fragments(run: &mut Run<'_>, frame: &Frame<'_>, slab: Slab, keys: &Stream) -> Result<u64> {
    let Frame { tables, streams, work, .. } = frame;
    let (slab_px, slab_size_px) = slab.px();
    let params = FragmentsParams {
        count: slab.pixels() as u32,
        slab_px,
        slab_size_px,
        part_last: tables.parts.len().saturating_sub(1) as u32,
        has_relief: u32::from(tables.parts.iter().any(|part| part.flags & PART_RELIEF != 0)),
    };
    run.record(|recorder| {
        recorder.fill(&work.fragment_count, 0)?;
        let bound = [
            ("visibility", keys),
            ("fragment_count", &work.fragment_count),
            ("fragments", &work.fragments),
            ("pixels", &work.pixels),
            ("parts", &streams.parts),
        ];
        Ok(recorder.dispatch(&SHADERS.fragments, slab.pixels(), &params, &bound)?)
    })?;
    fragment_count(work)
}

/// What the first `count` fragments look like, and their radiance.
pub(crate) fn record_radiance(recorder: &mut Recorder<'_>, frame: &Frame<'_>, slab: Slab, count: u64) -> Result<()> {
    if count == 0 {
        return Ok(());
    }
    record_appearance(recorder, frame, slab, count, false)?;
    record_moments(recorder, frame, count)?;
    record_shadows(recorder, frame, count)?;
    shadow_map::record(recorder, frame, count)?;
    relief::record_self_shadow(recorder, frame, count)?;
    light::record(recorder, frame, count)
}

/// What the first `count` fragments look like; `again`: all of them were shaded before.
pub(crate) fn record_appearance(
    recorder: &mut Recorder<'_>,
    frame: &Frame<'_>,
    slab: Slab,
    count: u64,
    again: bool,
) -> Result<()> {
    if count == 0 {
        return Ok(());
    }
    record_surface(recorder, frame, count)?;
    relief::record(recorder, frame, slab, count, Stage::Shows { again })?;
    (0..MAP_SLOTS).try_for_each(|slot| record_map(recorder, frame, slot, count))?;
    record_look(recorder, frame, count)?;
    bump::record(recorder, frame, count)?;
    relief::record_normals(recorder, frame, count)
}

fn record_images(recorder: &mut Recorder<'_>, frame: &Frame<'_>, slab: Slab) -> Result<()> {
    record_pixels(recorder, frame, slab)?;
    record_means(recorder, frame, slab)
}

/// What lies under the first `count` fragments.
pub(crate) fn record_surface(recorder: &mut Recorder<'_>, frame: &Frame<'_>, count: u64) -> Result<()> {
    let Frame { tables, streams, work, .. } = frame;
    let part_last = tables.parts.len().saturating_sub(1) as u32;
    let bound = [
        ("fragments", &work.fragments),
        ("triangles", &streams.triangles),
        ("parts", &streams.parts),
        ("instance_rows", &streams.instance_rows),
        ("positions", &streams.positions),
        ("normals", &streams.normals),
        ("points", &work.points),
    ];
    Ok(recorder.dispatch(&SHADERS.surface, count, &SurfaceParams { count: count as u32, part_last }, &bound)?)
}

/// What the maps of one kind show of the first `count` fragments; nothing where no material has any.
pub(crate) fn record_map(recorder: &mut Recorder<'_>, frame: &Frame<'_>, slot: usize, count: u64) -> Result<()> {
    if frame.work.mapped[slot].is_empty() {
        return Ok(());
    }
    match frame.scene.projection {
        Projection::Uv => record_filter(recorder, frame, slot, count),
        _ => projected::record_map(recorder, frame, slot, count),
    }
}

/// At texture coordinates, or where a projection puts them.
pub(super) fn record_filter(recorder: &mut Recorder<'_>, frame: &Frame<'_>, slot: usize, count: u64) -> Result<()> {
    let Frame { scene, streams, work, .. } = frame;
    let is_projected = scene.projection != Projection::Uv;
    let uv_channels = if is_projected { 1 } else { scene.uv_channels };
    let params = TextureParams { count: count as u32, slot: slot as u32, uv_channels };
    let place = &work.projected;
    let bound = [
        ("points", if is_projected { &place.points } else { &work.points }),
        ("maps", &streams.texture_uses),
        ("uvs", if is_projected { &place.uvs } else { &streams.uvs }),
        ("levels", &streams.levels),
        ("texels", &streams.texels),
        ("mapped", if is_projected { &place.seen } else { &work.mapped[slot] }),
    ];
    let shader = match scene.filter {
        Filter::Nearest => &SHADERS.texture_nearest,
        Filter::Bilinear => &SHADERS.texture_bilinear,
        Filter::Trilinear => &SHADERS.texture_trilinear,
        Filter::Anisotropic => &SHADERS.texture_anisotropic,
        Filter::Ewa => &SHADERS.texture_ewa,
    };
    Ok(recorder.dispatch(shader, count, &params, &bound)?)
}

fn record_look(recorder: &mut Recorder<'_>, frame: &Frame<'_>, count: u64) -> Result<()> {
    let Frame { scene, tables, streams, work, .. } = frame;
    let has_map = |slot: &usize| !work.mapped[*slot].is_empty();
    let params = AppearanceParams {
        count: count as u32,
        maps: (0..MAP_SLOTS).filter(has_map).fold(0, |bits, slot| bits | 1 << slot),
        has_colors: u32::from(tables.colored),
        is_projected: u32::from(scene.projection != Projection::Uv),
    };
    let bound = [
        ("points", &work.points),
        ("materials", &streams.materials),
        ("colors", &streams.colors),
        ("tangents", &streams.tangents),
        ("instance_rows", &streams.instance_rows),
        ("mapped_base_color", &work.mapped[MAP_BASE_COLOR]),
        ("mapped_normal", &work.mapped[MAP_NORMAL]),
        ("mapped_metallic_roughness", &work.mapped[MAP_METALLIC_ROUGHNESS]),
        ("mapped_occlusion", &work.mapped[MAP_OCCLUSION]),
        ("mapped_emissive", &work.mapped[MAP_EMISSIVE]),
        ("appearances", &work.appearances),
    ];
    Ok(recorder.dispatch(&SHADERS.appearance, count, &params, &bound)?)
}

/// How the normals of the first `count` fragments scatter; nothing without moments.
fn record_moments(recorder: &mut Recorder<'_>, frame: &Frame<'_>, count: u64) -> Result<()> {
    let Frame { scene, streams, work, .. } = frame;
    if work.spreads.is_empty() {
        return Ok(());
    }
    let params = MomentsParams { count: count as u32, uv_channels: scene.uv_channels };
    let bound = [
        ("points", &work.points),
        ("materials", &streams.materials),
        ("tangents", &streams.tangents),
        ("instance_rows", &streams.instance_rows),
        ("maps", &streams.texture_uses),
        ("uvs", &streams.uvs),
        ("levels", &streams.levels),
        ("mapped_normal", &work.mapped[MAP_NORMAL]),
        ("mapped_normal_moments", &work.mapped[MAP_NORMAL_MOMENTS]),
        ("spreads", &work.spreads),
    ];
    Ok(recorder.dispatch(&SHADERS.moments, count, &params, &bound)?)
}

/// Whether fragments take light by other normals than that of the pixel: by the triangle's, the vertices', or many.
pub(super) fn any_normal(Frame { scene, work, .. }: &Frame<'_>) -> u32 {
    u32::from(matches!(scene.shading, Shading::Flat | Shading::Gouraud) || !work.spreads.is_empty())
}

/// A ray to each light, or to one after the other of the samples of those that have a size.
fn record_shadows(recorder: &mut Recorder<'_>, frame: &Frame<'_>, count: u64) -> Result<()> {
    let Frame { tables, streams, work, .. } = frame;
    let Some(occluders) = &streams.occluders else { return Ok(()) };
    let lights = tables.lights.len() as u32;
    let rays = count * u64::from(lights);
    for k in 0..tables.lights.iter().map(lights::samples).max().unwrap_or(1) {
        let params = LightAimsParams { count: rays as u32, lights, k, any_normal: any_normal(frame) };
        let bound = [
            ("points", &work.points),
            ("appearances", &work.appearances),
            ("lights", &streams.lights),
            ("aims", &work.aims),
            ("shadows", &work.shadows),
        ];
        recorder.dispatch(&SHADERS.light_aims, rays, &params, &bound)?;
        record_rays(recorder, frame, occluders, rays, k)?;
    }
    Ok(())
}

fn record_rays(
    recorder: &mut Recorder<'_>,
    frame: &Frame<'_>,
    occluders: &OccluderStreams,
    rays: u64,
    k: u32,
) -> Result<()> {
    let Frame { scene, tables, streams, work, .. } = frame;
    let params = ShadowRaysParams {
        count: rays as u32,
        lights: tables.lights.len() as u32,
        k,
        nodes: occluders.nodes.len() as u32,
        part_last: tables.parts.len().saturating_sub(1) as u32,
        uv_channels: scene.uv_channels,
        has_colors: u32::from(tables.colored),
        offset_world: occluders.offset_world,
    };
    let bound = [
        ("points", &work.points),
        ("aims", &work.aims),
        ("nodes", &occluders.nodes),
        ("occluder_corners", &occluders.corners),
        ("occluders", &occluders.items),
        ("parts", &streams.parts),
        ("triangles", &streams.triangles),
        ("materials", &streams.materials),
        ("colors", &streams.colors),
        ("uvs", &streams.uvs),
        ("maps", &streams.texture_uses),
        ("levels", &streams.levels),
        ("texels", &streams.texels),
        ("shadows", &work.shadows),
        ("instance_rows", &streams.instance_rows),
        ("reliefs", &streams.relief.reliefs),
    ];
    Ok(recorder.dispatch(&SHADERS.shadow_rays, rays, &params, &bound)?)
}

fn record_pixels(recorder: &mut Recorder<'_>, frame: &Frame<'_>, slab: Slab) -> Result<()> {
    let Frame { scene, tables, streams, work, .. } = frame;
    let params = ResolveParams {
        count: slab.pixels() as u32,
        outputs: scene.aovs.iter().fold(0, |bits, &aov| bits | output_bit(aov)),
        view_depth: eye_and_depth(&scene.camera).1,
        background: scene.lighting.background,
        has_backdrop: u32::from(!work.backdrop.is_empty()),
        uv_channels: scene.uv_channels,
        has_layers: u32::from(tables.has_layers),
    };
    let outputs = &work.outputs;
    let bound = [
        ("pixels", &work.pixels),
        ("points", &work.points),
        ("appearances", &work.appearances),
        ("radiance", &work.radiance),
        ("uvs", &streams.uvs),
        ("maps", &streams.texture_uses),
        ("color_out", &outputs.color),
        ("depth_out", &outputs.depth),
        ("normal_out", &outputs.normal),
        ("position_out", &outputs.position),
        ("uv_out", &outputs.uv),
        ("triangle_out", &outputs.triangle),
        ("samples_out", &outputs.samples),
        ("backdrop", &work.backdrop),
        ("layered", &work.layers.layered),
        ("transmittance", &work.layers.transmittance),
    ];
    Ok(recorder.dispatch(&SHADERS.resolve, slab.pixels(), &params, &bound)?)
}

fn output_bit(aov: Aov) -> u32 {
    match aov {
        Aov::Depth => OUTPUT_DEPTH,
        Aov::Normal => OUTPUT_NORMAL,
        Aov::Position => OUTPUT_POSITION,
        Aov::Uv => OUTPUT_UV,
        Aov::Triangle => OUTPUT_TRIANGLE,
        Aov::Samples => OUTPUT_SAMPLES,
        // Counted before anything is resolved.
        Aov::Overdraw | Aov::Cost => 0,
    }
}

/// Where the viewer is (w = 1), or in which direction (w = 0), and the row that gives a place's distance
/// along the viewing axis.
pub(crate) fn eye_and_depth(camera: &RenderCamera) -> ([f32; 4], [f32; 4]) {
    let backward = DMat4::from_cols_array(&camera.view_from_world.map(f64::from)).row(2);
    let is_orthographic = camera.clip_from_view[11] == 0.0;
    let eye = DVec3::from_array(camera.eye_world.map(f64::from));
    let eye = if is_orthographic { backward.truncate().extend(0.0) } else { eye.extend(1.0) };
    (eye.as_vec4().to_array(), (-backward).as_vec4().to_array())
}

/// Means over squares of the slab, where the image is averaged.
fn record_means(recorder: &mut Recorder<'_>, frame: &Frame<'_>, slab: Slab) -> Result<()> {
    let Frame { side, work, .. } = *frame;
    if side == 1 {
        return Ok(());
    }
    let slab = slab.coarser(side);
    let params = DownsampleParams { count: slab.pixels() as u32, width: slab.size[0], side };
    let bound = [("fine", &work.outputs.color), ("color_out", &work.outputs.means)];
    Ok(recorder.dispatch(&SHADERS.downsample, slab.pixels(), &params, &bound)?)
}

/// Copies the slab's images into the whole ones, which are `side` times smaller.
pub(crate) fn copy_out(work: &WorkStreams, slab: Slab, side: u32, images: &mut ImageSet) -> Result<()> {
    let width = images.width as usize;
    let outputs = &work.outputs;
    let color = if side > 1 { &outputs.means } else { &outputs.color };
    copy_rows(color, slab.coarser(side), 1, width, &mut images.color)?;
    copy_some(&outputs.depth, slab, side, width, &mut images.depth)?;
    copy_some(&outputs.normal, slab, side, width, &mut images.normal)?;
    copy_some(&outputs.position, slab, side, width, &mut images.position)?;
    copy_some(&outputs.uv, slab, side, width, &mut images.uv)?;
    copy_some(&outputs.triangle, slab, side, width, &mut images.triangle)?;
    copy_some(&outputs.overdraw, slab, side, width, &mut images.overdraw)?;
    copy_some(&outputs.samples, slab, side, width, &mut images.samples)
}

fn copy_some<T: Pod>(stream: &Stream, slab: Slab, side: u32, width: usize, image: &mut Option<Vec<T>>) -> Result<()> {
    image.as_mut().map_or(Ok(()), |image| copy_rows(stream, slab, side, width, image))
}

/// Of each square of `side` pixels, the one right below its middle.
fn copy_rows<T: Pod>(stream: &Stream, slab: Slab, side: u32, width: usize, image: &mut [T]) -> Result<()> {
    let pixels: Vec<T> = stream.read_range(0..slab.pixels())?;
    let [x, y] = slab.coarser(side).origin.map(|o| o as usize);
    let side = side as usize;
    let rows = pixels.chunks(slab.size[0] as usize).skip(side / 2).step_by(side);
    for (row, source) in rows.enumerate() {
        let target = image[(y + row) * width + x..].iter_mut();
        source.iter().skip(side / 2).step_by(side).zip(target).for_each(|(from, to)| *to = *from);
    }
    Ok(())
}
