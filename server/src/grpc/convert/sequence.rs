//! Sequences: what is asked, and what is told of them.

use displace_proto::v1::{self, geometry::Refinement};

use super::{known, request::render, view, view::View};
use crate::{
    config::Config,
    domain::{
        Error, Result,
        request::CameraChoice,
        sequence::{CameraAnimation, FRAMES, Frame, Pace, SequenceReport, SequenceRequest, SequenceTessellation},
    },
};

const FPS: std::ops::RangeInclusive<f64> = 0.001..=1000.0;

/// Of a Render that has a sequence.
pub(crate) fn sequence(mut message: v1::RenderRequest, config: &Config) -> Result<SequenceRequest> {
    let sequence = message.sequence.take().unwrap_or_default();
    refuse_in_frames(&message)?;
    let views = views(&message.views, config.max_image_pixels)?;
    message.views.truncate(1);
    let render = render("", message, config)?;
    let tessellation = tessellation(&sequence, render.own_camera_px().is_some())?;
    let cameras = views.into_iter().map(|view| view.camera).collect();
    let animation = sequence.animation.as_ref().map(animation).transpose()?;
    let request = SequenceRequest { render, cameras, animation, tessellation };
    refuse_contradictions(&request)?;
    request.check(config.job_bytes)?;
    Ok(request)
}

fn animation(asked: &v1::CameraAnimation) -> Result<CameraAnimation> {
    use v1::camera_animation::{Pace as Asked, Which};
    let animation = match &asked.which {
        Some(Which::Name(name)) => name.clone(),
        Some(Which::Index(index)) => index.to_string(),
        None => return Err(Error::invalid("sequence.animation.which", "is required; give name or index")),
    };
    let pace = match asked.pace {
        Some(Asked::Frames(frames)) => {
            let [least, most] = [FRAMES.start(), FRAMES.end()].map(|end| *end as u32);
            Pace::Frames(super::at_most("sequence.animation.frames", frames, least, most)?)
        }
        Some(Asked::Fps(fps)) if FPS.contains(&fps) => Pace::Fps(fps),
        Some(Asked::Fps(fps)) => {
            let (least, most) = FPS.into_inner();
            let message = format!("{fps} is out of range; allowed are {least} to {most} frames a second");
            return Err(Error::invalid("sequence.animation.fps", message));
        }
        None => return Err(Error::invalid("sequence.animation.pace", "is required; give frames or fps")),
    };
    Ok(CameraAnimation { animation, pace })
}

/// An animation moves one camera, and that of the file.
fn refuse_contradictions(request: &SequenceRequest) -> Result<()> {
    if request.animation.is_none() {
        return Ok(());
    }
    match &request.cameras[..] {
        [CameraChoice::Default | CameraChoice::Named(_)] => Ok(()),
        [_] => {
            let message =
                "stands still, and an animation moves a camera of the file: name one, or leave the camera out";
            Err(Error::invalid("views[0]", message))
        }
        all => {
            let message = format!("has {} entries; an animation makes frames of one view: give one", all.len());
            Err(Error::invalid("views", message))
        }
    }
}

fn refuse_in_frames(message: &v1::RenderRequest) -> Result<()> {
    if message.preimage.is_some() {
        return Err(Error::unsupported("preimage", "is of one image, and a sequence has several: leave it out"));
    }
    if message.surface.as_ref().is_some_and(|surface| surface.method == i32::from(v1::Method::Auto)) {
        let message = "is auto, which chooses for one image, and a sequence has several: name a method";
        return Err(Error::unsupported("surface.method", message));
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
