//! Blended triangles of a slab, in layers: each is the nearest of what lies behind the one before (depth peeling, Everitt
//! 2001), is shaded as what is solid is, and goes behind the others. So the order is right for each sample, whatever the
//! order of the triangles.

use displace_glsl::{SHADERS, layout::raster::CompositeParams, reference::composite::MAX_LAYERS};

use crate::{
    domain::Result,
    vulkan::{Recorder, Stream},
};

use super::{Frame, Run, Slab, shading, visibility};

/// A layer's place in the visibility buffers.
#[derive(Clone, Copy)]
pub(crate) struct Layer<'a> {
    /// Keys of its samples.
    pub(crate) keys: &'a Stream,
    /// Those of the layer before it.
    pub(crate) nearer: &'a Stream,
}

/// Shades and adds up the layers before what is solid; tells whether there are more than are shown.
pub(crate) fn shade(run: &mut Run<'_>, frame: &Frame<'_>, slab: Slab) -> Result<bool> {
    let streams = &frame.work.layers;
    run.record(|recorder| {
        // No key is nearer than this one.
        recorder.fill(&streams.keys[1], u32::MAX)?;
        recorder.fill(&streams.transmittance, 1f32.to_bits())?;
        recorder.fill(&streams.layered, 0)?;
        Ok(recorder.fill(&streams.shown, 0)?)
    })?;
    for k in 0..=MAX_LAYERS {
        let layer = Layer { keys: &streams.keys[k % 2], nearer: &streams.keys[(k + 1) % 2] };
        visibility::peel(run, frame, slab, layer)?;
        let count = shading::list_fragments(run, frame, slab, layer.keys)?;
        if count == 0 || k == MAX_LAYERS {
            return Ok(count > 0);
        }
        run.record(|recorder| {
            shading::record_radiance(recorder, frame, slab, count)?;
            record_composite(recorder, frame, slab, layer.keys, false)
        })?;
    }
    Ok(false)
}

/// Puts the shaded fragments behind the layers so far.
pub(crate) fn record_composite(
    recorder: &mut Recorder<'_>,
    frame: &Frame<'_>,
    slab: Slab,
    keys: &Stream,
    solid: bool,
) -> Result<()> {
    let work = frame.work;
    let params = CompositeParams { count: slab.pixels() as u32, solid: u32::from(solid) };
    let bound = [
        ("visibility", keys),
        ("pixels", &work.pixels),
        ("points", &work.points),
        ("appearances", &work.appearances),
        ("radiance", &work.radiance),
        ("transmittance", &work.layers.transmittance),
        ("layered", &work.layers.layered),
        ("shown", &work.layers.shown),
    ];
    Ok(recorder.dispatch(&SHADERS.composite, slab.pixels(), &params, &bound)?)
}

/// Leaves in fragments and appearances what the further outputs show.
pub(crate) fn show(run: &mut Run<'_>, frame: &Frame<'_>, slab: Slab) -> Result<()> {
    if frame.scene.aovs.is_empty() {
        return Ok(());
    }
    let count = shading::list_fragments(run, frame, slab, &frame.work.layers.shown)?;
    run.record(|recorder| shading::record_appearance(recorder, frame, slab, count, true))
}
