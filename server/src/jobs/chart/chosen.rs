//! What `Method::Auto` would choose for the image that is charted, and what is predicted of every setting.

use super::{settings::Shown, truth::Truth};
use crate::{
    domain::{
        Result,
        chart::Candidate,
        request::{Method, RenderRequest},
    },
    jobs::{
        WorkContext,
        auto::{Desk, Weighing, grounds, weigh},
        calibration,
    },
};

/// What auto is asked to keep, pixels: what `render` does by default.
const TOLERANCE_PX: f64 = 0.5;

/// Nothing is marked where materials differ in what shows them, and nothing is predicted of what is not one height map.
pub(super) fn mark(
    context: &WorkContext<'_>,
    request: &RenderRequest,
    truth: &Truth<'_>,
    shown: &mut [Shown],
) -> Result<()> {
    if !request.surface.method.moves_vertices() {
        return Ok(());
    }
    // The truth's own rays are no wish of the images.
    let asked = RenderRequest { samples: None, ..request.clone() };
    let job = context.job();
    let (assets, limits, traces_rays) = (context.assets, context.limits, context.executor.traces_rays());
    let desk = Desk { assets, limits, job: &job, model: calibration::of(context)?, traces_rays };
    let inputs = &truth.ground.inputs;
    let grounds = grounds(desk, inputs, &asked)?;
    let weighings = weigh(desk, inputs, &grounds, (&asked, &truth.camera), TOLERANCE_PX)?;
    let chosen = chosen(&weighings);
    for Shown { candidate, point, .. } in shown {
        point.predicted_px = predicted_px(&weighings, candidate);
        point.chosen = chosen.as_ref() == Some(candidate);
    }
    Ok(())
}

/// What shows all materials.
fn chosen(weighings: &[Weighing<'_>]) -> Option<Candidate> {
    let of = |weighing: &Weighing<'_>| {
        let chosen = weighing.chosen();
        Candidate { method: chosen.method, setting: chosen.setting(TOLERANCE_PX) }
    };
    let first = weighings.first().map(of)?;
    weighings.iter().all(|weighing| of(weighing) == first).then_some(first)
}

/// Of the material that is off by most; none where nothing is known of one.
fn predicted_px(weighings: &[Weighing<'_>], candidate: &Candidate) -> Option<f64> {
    let known = |weighing: &Weighing<'_>| {
        let seen = weighing.seen.as_ref()?;
        let [error_px, _] = seen.predicted(&[(candidate.method, candidate.setting)])[0];
        Some(error_px).filter(|px| px.is_finite())
    };
    let all: Option<Vec<f64>> = weighings.iter().map(known).collect();
    all?.into_iter().reduce(f64::max).filter(|_| candidate.method != Method::Vector)
}
