//! Sequences: what is asked, and what is told of them.

use displace_proto::v1::{self, geometry::Refinement, tolerance::Allowed};

use super::{known, request::render, view, view::View};
use crate::{
    config::Config,
    domain::{
        Error, Result, request,
        sequence::{FRAMES, Frame, SequenceReport, SequenceRequest, SequenceTessellation},
    },
};

/// Of a Render that has a sequence.
pub(crate) fn sequence(mut message: v1::RenderRequest, config: &Config) -> Result<SequenceRequest> {
    let sequence = message.sequence.take().unwrap_or_default();
    refuse_in_frames(&message)?;
    let views = views(&message.views, config.max_image_pixels)?;
    message.views.truncate(1);
    let own_tolerance = stand_in(&mut message);
    let mut render = render("", message, config)?;
    if own_tolerance {
        leave_to_frames(&mut render.surface.geometry.refinement);
    }
    let tessellation = tessellation(&sequence, own_tolerance)?;
    let cameras = views.into_iter().map(|view| view.camera).collect();
    let request = SequenceRequest { render, cameras, tessellation };
    refuse_too_many(&request, config.job_bytes)?;
    Ok(request)
}

fn refuse_too_many(request: &SequenceRequest, allowed: u64) -> Result<()> {
    let (needed, count) = (request.output_bytes(), request.cameras.len() as u64);
    if needed <= allowed {
        return Ok(());
    }
    let message = format!(
        "{count} frames of {} x {} pixels may take {needed} bytes of host memory; this server gives a job {allowed}: ask for up to {} of them, or smaller ones",
        request.render.width,
        request.render.height,
        allowed / (needed / count).max(1)
    );
    Err(Error::too_large("views", message))
}

fn refuse_in_frames(message: &v1::RenderRequest) -> Result<()> {
    if message.preimage.is_some() {
        return Err(Error::unsupported("preimage", "is of one image, and a sequence has several: leave it out"));
    }
    let geometry = message.surface.as_ref().and_then(|surface| surface.geometry.as_ref());
    if matches!(geometry.and_then(|geometry| geometry.refinement.as_ref()), Some(Refinement::Exact(_))) {
        let message = "is of one image, and a sequence has several: give a tolerance or uniform_level";
        return Err(Error::unsupported("surface.geometry.exact", message));
    }
    Ok(())
}

fn views(views: &[v1::View], max_pixels: u32) -> Result<Vec<View>> {
    let (count, [least, most]) = (views.len(), [FRAMES.start(), FRAMES.end()]);
    if !FRAMES.contains(&count) {
        let message = format!("has {count} entries; allowed are {least} to {most} frames of a sequence");
        return Err(Error::invalid("views", message));
    }
    let one = |(n, view): (usize, &v1::View)| view::one(&format!("views[{n}]"), view.clone(), max_pixels);
    let views: Vec<View> = views.iter().enumerate().map(one).collect::<Result<_>>()?;
    let [width, height] = views[0].size();
    if let Some(n) = views.iter().position(|view| view.size() != [width, height]) {
        let [w, h] = views[n].size();
        let message =
            format!("{w} x {h} pixels; all frames have the size of the first, {width} x {height}: give it that");
        return Err(Error::invalid(format!("views[{n}].width"), message));
    }
    Ok(views)
}

/// A tolerance in pixels without views is that of the frames. Until they are known one view stands in for them, so that
/// everything else of it is checked as ever.
fn stand_in(message: &mut v1::RenderRequest) -> bool {
    let geometry = message.surface.as_mut().and_then(|surface| surface.geometry.as_mut());
    let Some(Refinement::Tolerance(tolerance)) = geometry.and_then(|geometry| geometry.refinement.as_mut()) else {
        return false;
    };
    let Some(Allowed::Pixels(pixels)) = &mut tolerance.allowed else { return false };
    if !pixels.views.is_empty() {
        return false;
    }
    let (eye, target) = (vec![0.0, 0.0, 1.0], vec![0.0; 3]);
    pixels.views.push(v1::ToleranceView { eye, target, yfov_degrees: None, width: 1, height: 1 });
    true
}

fn leave_to_frames(refinement: &mut request::Refinement) {
    if let request::Refinement::Tolerance(tolerance) = refinement
        && let request::Allowed::Pixels { views, .. } = &mut tolerance.allowed
    {
        views.clear();
    }
}

fn tessellation(sequence: &v1::Sequence, own_tolerance: bool) -> Result<SequenceTessellation> {
    use v1::SequenceTessellation as Asked;
    let field = "sequence.tessellation";
    let asked: Asked = known(field, sequence.tessellation)?;
    let tessellation = match asked {
        Asked::Unspecified | Asked::Frozen => SequenceTessellation::Frozen,
        Asked::PerFrame => SequenceTessellation::PerFrame,
        Asked::Hysteresis => SequenceTessellation::Hysteresis,
    };
    if tessellation == SequenceTessellation::Frozen || own_tolerance {
        return Ok(tessellation);
    }
    let message = "follows cameras, and the geometry asks for the same in all of them: give a tolerance in pixels without views (--tolerance-px), or take frozen";
    Err(Error::invalid(field, message))
}

pub(super) fn to_sequence(report: &SequenceReport) -> v1::SequenceReport {
    let frame = |frame: &Frame| v1::SequenceFrame {
        triangles: frame.triangles,
        ms: frame.ms,
        pop_px: frame.pop_px,
        tolerance_px: frame.tolerance_px,
        morph: frame.morph,
    };
    v1::SequenceReport {
        frames: report.frames.iter().map(frame).collect(),
        worst_pop_px: report.worst_pop_px,
        tessellations: report.tessellations,
    }
}
