//! From the visibility buffer of a slab to its images: fragments, surface, base colour, light.

use bytemuck::Pod;
use displace_glsl::{
    SHADERS,
    layout::raster::{
        BaseColorParams, FragmentsParams, OUTPUT_DEPTH, OUTPUT_NORMAL, OUTPUT_POSITION, OUTPUT_TRIANGLE, OUTPUT_UV,
        ShadeParams, SurfaceParams,
    },
};
use glam::{DMat4, DVec3};

use crate::{
    domain::{
        Result,
        image::{ImageSet, RenderCamera, RenderScene},
        request::Aov,
    },
    vulkan::{Recorder, Stream},
};

use super::{
    Run, Slab,
    streams::{SceneStreams, WorkStreams},
    tables::Tables,
    visibility::fragment_count,
};

pub(crate) fn shade(
    run: &mut Run<'_>,
    tables: &Tables,
    streams: &SceneStreams,
    work: &WorkStreams,
    scene: &RenderScene,
    slab: Slab,
) -> Result<()> {
    let (slab_px, slab_size_px) = slab.px();
    let params = FragmentsParams { count: slab.pixels() as u32, slab_px, slab_size_px };
    run.record(|recorder| {
        recorder.fill(&work.fragment_count, 0)?;
        let bound = [
            ("visibility", &work.visibility),
            ("fragment_count", &work.fragment_count),
            ("fragments", &work.fragments),
            ("pixels", &work.pixels),
        ];
        Ok(recorder.dispatch(&SHADERS.fragments, slab.pixels(), &params, &bound)?)
    })?;
    let count = fragment_count(work)?;
    let part_last = tables.parts.len().saturating_sub(1) as u32;
    run.record(|recorder| {
        if count > 0 {
            record_surface(recorder, streams, work, part_last, count)?;
        }
        record_light(recorder, work, scene, slab)
    })
}

/// What lies under the first `count` fragments: points and their base colours.
pub(crate) fn record_surface(
    recorder: &mut Recorder<'_>,
    streams: &SceneStreams,
    work: &WorkStreams,
    part_last: u32,
    count: u64,
) -> Result<()> {
    let bound = [
        ("fragments", &work.fragments),
        ("triangles", &streams.triangles),
        ("parts", &streams.parts),
        ("instance_rows", &streams.instance_rows),
        ("positions", &streams.positions),
        ("normals", &streams.normals),
        ("uvs", &streams.uvs),
        ("colors", &streams.colors),
        ("points", &work.points),
        ("point_colors", &work.point_colors),
    ];
    recorder.dispatch(&SHADERS.surface, count, &SurfaceParams { count: count as u32, part_last }, &bound)?;
    let bound = [
        ("points", &work.points),
        ("materials", &streams.materials),
        ("levels", &streams.levels),
        ("texels", &streams.texels),
        ("point_colors", &work.point_colors),
    ];
    recorder.dispatch(&SHADERS.base_color, count, &BaseColorParams { count: count as u32 }, &bound)?;
    Ok(())
}

fn record_light(recorder: &mut Recorder<'_>, work: &WorkStreams, scene: &RenderScene, slab: Slab) -> Result<()> {
    let light = &scene.light;
    let (eye, view_depth) = eye_and_depth(&scene.camera);
    let params = ShadeParams {
        count: slab.pixels() as u32,
        outputs: scene.aovs.iter().fold(0, |bits, &aov| bits | output_bit(aov)),
        eye,
        view_depth,
        light_direction: light.direction_world,
        light_color: light.color,
        background: light.background,
        ambient: light.ambient,
    };
    let outputs = &work.outputs;
    let bound = [
        ("pixels", &work.pixels),
        ("points", &work.points),
        ("point_colors", &work.point_colors),
        ("color_out", &outputs.color),
        ("depth_out", &outputs.depth),
        ("normal_out", &outputs.normal),
        ("position_out", &outputs.position),
        ("uv_out", &outputs.uv),
        ("triangle_out", &outputs.triangle),
    ];
    recorder.dispatch(&SHADERS.shade, slab.pixels(), &params, &bound)?;
    Ok(())
}

fn output_bit(aov: Aov) -> u32 {
    match aov {
        Aov::Depth => OUTPUT_DEPTH,
        Aov::Normal => OUTPUT_NORMAL,
        Aov::Position => OUTPUT_POSITION,
        Aov::Uv => OUTPUT_UV,
        Aov::Triangle => OUTPUT_TRIANGLE,
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

/// Copies the slab's images into the whole ones.
pub(crate) fn copy_out(work: &WorkStreams, slab: Slab, images: &mut ImageSet) -> Result<()> {
    let width = images.width as usize;
    let outputs = &work.outputs;
    copy_rows(&outputs.color, slab, width, &mut images.color)?;
    copy_some(&outputs.depth, slab, width, &mut images.depth)?;
    copy_some(&outputs.normal, slab, width, &mut images.normal)?;
    copy_some(&outputs.position, slab, width, &mut images.position)?;
    copy_some(&outputs.uv, slab, width, &mut images.uv)?;
    copy_some(&outputs.triangle, slab, width, &mut images.triangle)
}

fn copy_some<T: Pod>(stream: &Stream, slab: Slab, width: usize, image: &mut Option<Vec<T>>) -> Result<()> {
    image.as_mut().map_or(Ok(()), |image| copy_rows(stream, slab, width, image))
}

fn copy_rows<T: Pod>(stream: &Stream, slab: Slab, width: usize, image: &mut [T]) -> Result<()> {
    let pixels: Vec<T> = stream.read_range(0..slab.pixels())?;
    let [x, y] = slab.origin.map(|o| o as usize);
    for (row, source) in pixels.chunks(slab.size[0] as usize).enumerate() {
        let first = (y + row) * width + x;
        image[first..first + source.len()].copy_from_slice(source);
    }
    Ok(())
}
