//! Charts: what is asked, which settings go with it, and what is told of them.

use displace_proto::v1::{self, geometry::Refinement, layer::Source};

use super::{
    join, relief,
    request::{refuse_under_projection, render},
    update::{to_comparison, to_counters},
};
use crate::{
    config::Config,
    domain::{
        Error, Result,
        chart::{Candidate, Chart, ChartRequest, LeftOut, Metric, Point, Sweep, SweepPoint},
        request::{Method, RenderRequest},
    },
};

const DEFAULT_REPEATS: u32 = 3;
const MOST_REPEATS: u32 = 100;

pub(crate) fn chart(request: v1::ChartRequest, config: &Config) -> Result<ChartRequest> {
    let stability = request.stability;
    let render = request.render.ok_or_else(|| Error::invalid("render", "is required"))?;
    refuse_what_is_charted("render", &render)?;
    let repeats = within("repeats", request.repeats, DEFAULT_REPEATS, MOST_REPEATS)?;
    let most_samples = *RenderRequest::SAMPLES.end();
    let samples = within("truth_samples", request.truth_samples, RenderRequest::DEFAULT_SAMPLES, most_samples)?;
    let truth = self::render("render", of_truth(render, samples), config)?;
    let (mut candidates, mut left_out) = (Vec::new(), Vec::new());
    for candidate in Candidate::all(truth.surface.method) {
        match check(&candidate, &truth) {
            Ok(()) => candidates.push(candidate),
            Err(error) => left_out.push(LeftOut { candidate, reason: error.to_string() }),
        }
    }
    let sweeps = sweeps(&request.sweeps)?;
    Ok(ChartRequest { truth, repeats, candidates, left_out, sweeps, stability })
}

/// In the order of all sweeps, each once.
fn sweeps(asked: &[i32]) -> Result<Vec<Sweep>> {
    for (k, sweep) in asked.iter().enumerate() {
        if !Sweep::ALL.iter().any(|known| *sweep == i32::from(to_sweep(*known))) || asked[..k].contains(sweep) {
            let message = format!("{sweep} is unknown or there twice; give each of ANGLE, DISTANCE and AMPLITUDE once");
            return Err(Error::invalid(format!("sweeps[{k}]"), message));
        }
    }
    Ok(Sweep::ALL.into_iter().filter(|sweep| asked.contains(&to_sweep(*sweep).into())).collect())
}

fn to_sweep(sweep: Sweep) -> v1::ChartSweep {
    match sweep {
        Sweep::Angle => v1::ChartSweep::Angle,
        Sweep::Distance => v1::ChartSweep::Distance,
        Sweep::Amplitude => v1::ChartSweep::Amplitude,
    }
}

fn within(field: &str, asked: Option<u32>, default: u32, most: u32) -> Result<u32> {
    match asked {
        None => Ok(default),
        Some(number) => super::at_most(field, number, 1, most),
    }
}

/// What a chart varies by itself.
fn refuse_what_is_charted(path: &str, render: &v1::RenderRequest) -> Result<()> {
    let surface = render.surface.as_ref();
    let refinement = surface.and_then(|s| s.geometry.as_ref()).is_some_and(|g| g.refinement.is_some());
    let set = [
        ("surface.method", surface.is_some_and(|s| s.method != 0), "every method is charted"),
        ("surface.geometry.refinement", refinement, "tolerances and levels are charted"),
        ("lighting.relief", render.lighting.as_ref().is_some_and(|l| l.relief.is_some()), "steps are charted"),
        ("aovs", !render.aovs.is_empty(), "a chart's images show colour alone"),
        ("format", render.format != 0, "a chart's images are PNG"),
        ("samples", render.samples != 0, "methods are charted by 4, and truth_samples is for the truth"),
        ("preimage", render.preimage.is_some(), "a chart draws none"),
    ];
    let Some((field, _, why)) = set.into_iter().find(|(_, set, _)| *set) else { return Ok(()) };
    Err(Error::invalid(join(path, field), format!("is set, and {why}: leave it out")))
}

/// The same by rays, of the surface itself.
fn of_truth(mut render: v1::RenderRequest, samples: u32) -> v1::RenderRequest {
    if let Some(surface) = &mut render.surface {
        surface.method = method_of_truth(&surface.details).into();
        surface.geometry.get_or_insert_default().refinement = Some(Refinement::Exact(true));
    }
    render.samples = samples;
    render.aovs = [v1::Aov::Depth, v1::Aov::Position].map(i32::from).into();
    render
}

/// What realises all of the details; the file's own are heights.
fn method_of_truth(details: &[v1::MaterialDetail]) -> v1::Method {
    let sources = || details.iter().flat_map(|detail| &detail.layers).filter_map(|layer| layer.source.as_ref());
    if sources().any(|source| matches!(source, Source::Vector(_) | Source::Direction(_))) {
        return v1::Method::Vector;
    }
    let bends_alone = sources().next().is_some() && sources().all(|source| matches!(source, Source::Normal(_)));
    if bends_alone { v1::Method::Normal } else { v1::Method::Displacement }
}

/// Whether the request goes with a setting, by the checks that a Render makes.
fn check(candidate: &Candidate, truth: &RenderRequest) -> Result<()> {
    let sources = || truth.surface.details.iter().flat_map(|detail| &detail.layers).map(|layer| &layer.source);
    if candidate.method == Method::Normal && !sources().any(crate::domain::request::SourceRequest::is_normal) {
        let message = "the request has no normal map: give one to chart it";
        return Err(Error::invalid("surface.details", message));
    }
    let request = candidate.request(truth);
    refuse_under_projection("", &request.surface, &request.look)?;
    relief::check("", &request)
}

pub(super) fn to_chart(chart: &Chart) -> v1::ChartReport {
    v1::ChartReport {
        points: chart.points.iter().map(to_point).collect(),
        width: chart.width,
        height: chart.height,
        truth_samples: chart.truth_samples,
        truth_ms: chart.truth_ms,
        driver: chart.driver.clone(),
        stability: None,
        sweeps: chart.sweeps.iter().map(to_sweep_point).collect(),
    }
}

fn to_sweep_point(point: &SweepPoint) -> v1::ChartSweepPoint {
    v1::ChartSweepPoint {
        sweep: to_sweep(point.sweep).into(),
        value: point.value,
        method: point.method.clone(),
        setting: point.setting.clone(),
        triangles: point.triangles,
        ms: point.ms,
        error: Some(to_comparison(&point.error)),
    }
}

fn to_point(point: &Point) -> v1::ChartPoint {
    v1::ChartPoint {
        name: point.name.clone(),
        method: point.method.clone(),
        setting: point.setting.clone(),
        triangles: point.triangles,
        vertices: point.vertices,
        counters: point.counters.map(to_counters),
        scene_bytes: point.scene_bytes,
        ms: point.ms,
        ms_spread: point.ms_spread,
        geometry_ms: point.geometry_ms,
        image_ms: point.image_ms,
        setup_ms: point.setup_ms,
        runs: point.runs,
        error: Some(to_comparison(&point.error)),
        fronts: point.fronts.iter().map(|metric| to_metric(*metric).into()).collect(),
        predicted_px: point.predicted_px,
        chosen: point.chosen,
    }
}

fn to_metric(metric: Metric) -> v1::ChartMetric {
    match metric {
        Metric::Flip => v1::ChartMetric::Flip,
        Metric::HitPx => v1::ChartMetric::HitPx,
        Metric::SilhouettePx => v1::ChartMetric::SilhouettePx,
    }
}

#[cfg(test)]
mod tests;
