//! Maps of fragments whose places are projected onto them: the passes that filter maps read points that say where.

use displace_glsl::{
    SHADERS,
    layout::raster::{MAP_NORMAL, ProjectBlendParams, ProjectParams, ProjectedFrame, SurfacePoint},
};

use std::sync::Arc;

use crate::{
    domain::{Result, image::RenderScene, projection::Projection},
    vulkan::{Device, Recorder, Stream},
};

use super::{Frame, shading::record_filter};

/// Of one projection; empty where maps are read at texture coordinates.
pub(crate) struct ProjectedStreams {
    pub(crate) points: Stream,
    pub(crate) uvs: Stream,
    frames: Stream,
    /// What a map shows.
    pub(crate) seen: Stream,
}

impl ProjectedStreams {
    pub(crate) fn new(device: &Arc<Device>, scene: &RenderScene, fragments: u64) -> Result<Self> {
        let len = if scene.projection == Projection::Uv { 0 } else { fragments };
        let new = |name: &str, bytes: usize, len: u64| Stream::new(device, name, bytes as u32, len);
        Ok(Self {
            points: new("projected points", size_of::<SurfacePoint>(), len)?,
            uvs: new("projected uvs", 8, 3 * len)?,
            frames: new("projected frames", size_of::<ProjectedFrame>(), len)?,
            seen: new("seen", 16, len)?,
        })
    }
}

/// What the maps of one kind show of the first `count` fragments, projection by projection.
pub(super) fn record_map(recorder: &mut Recorder<'_>, frame: &Frame<'_>, slot: usize, count: u64) -> Result<()> {
    let work = frame.work;
    let planes = frame.scene.projection.kind().map_or(0, |kind| kind.count());
    for index in 0..planes as u32 {
        record_places(recorder, frame, index, count)?;
        record_filter(recorder, frame, slot, count)?;
        let params = ProjectBlendParams { count: count as u32, index, is_slope: u32::from(slot == MAP_NORMAL) };
        let bound =
            [("frames", &work.projected.frames), ("seen", &work.projected.seen), ("mapped", &work.mapped[slot])];
        recorder.dispatch(&SHADERS.project_blend, count, &params, &bound)?;
    }
    Ok(())
}

fn record_places(recorder: &mut Recorder<'_>, frame: &Frame<'_>, index: u32, count: u64) -> Result<()> {
    let Frame { scene, streams, work, .. } = frame;
    let params = ProjectParams { count: count as u32, kind: scene.projection.number(), index };
    let bound = [
        ("points", &work.points),
        ("positions", &streams.positions),
        ("normals", &streams.normals),
        ("boxes", &streams.boxes),
        ("projected_points", &work.projected.points),
        ("projected_uvs", &work.projected.uvs),
        ("frames", &work.projected.frames),
    ];
    Ok(recorder.dispatch(&SHADERS.project, count, &params, &bound)?)
}
