//! What a job tells, and what an estimate says.

use displace_proto::v1::{self, job_update::Update};

use super::{
    chart::to_chart, choice::to_choice, measurement::to_measurement, sequence::to_sequence, stability::to_stability,
    to_digest,
};
use crate::{
    domain::{
        image::MarchCounters,
        report::{Comparison, Estimate, Fitted, Lod, NormalMap, PassTime, Report, ToleranceUnit, Warning},
    },
    grpc::status::rpc_status,
    jobs::{Finished, JobEvent},
};

pub(crate) fn to_update(event: &JobEvent) -> v1::JobUpdate {
    let update = match event {
        JobEvent::Queued { position, key } => Update::Queued(v1::Queued { position: *position, key: key.hex() }),
        JobEvent::Progress { pass, done, total } => {
            Update::Progress(v1::Progress { pass: pass.to_string(), done: *done, total: *total })
        }
        JobEvent::Warning(warning) => Update::Warning(to_warning(warning)),
        JobEvent::Done(finished) => Update::Result(to_result(finished)),
        JobEvent::Failed(error) => Update::Error(rpc_status(error)),
    };
    v1::JobUpdate { update: Some(update) }
}

pub(crate) fn to_estimate(estimate: &Estimate, seconds: Option<f64>, cached: bool) -> v1::EstimateResponse {
    v1::EstimateResponse {
        triangles: estimate.triangles,
        vertices: estimate.vertices,
        triangles_in: estimate.triangles_in,
        device_bytes: estimate.device_bytes,
        output_bytes: estimate.output_bytes,
        seconds,
        cached,
        warnings: estimate.warnings.iter().map(to_warning).collect(),
    }
}

pub(super) fn to_warning(warning: &Warning) -> v1::Warning {
    v1::Warning { code: warning.code.clone(), message: warning.message.clone() }
}

fn to_result(finished: &Finished) -> v1::JobResult {
    let outputs = finished.outputs.iter().map(|output| v1::Output {
        name: output.name.clone(),
        media_type: output.media_type.clone(),
        digest: Some(to_digest(&output.digest)),
    });
    v1::JobResult { report: Some(to_report(&finished.report)), outputs: outputs.collect() }
}

fn to_report(report: &Report) -> v1::Report {
    let seams = report.seams.as_ref();
    v1::Report {
        method: report.method.clone(),
        triangles_in: report.triangles_in,
        triangles: report.triangles,
        vertices: report.vertices,
        seams: seams.map(|seams| v1::Seams { gap_max: seams.gap_max, mismatch_max: seams.mismatch_max }),
        flipped: report.flipped,
        stretch: report.stretch.map(|stretch| v1::Stretch { p99: stretch.p99, max: stretch.max }),
        warnings: report.warnings.iter().map(to_warning).collect(),
        passes: report.passes.iter().map(to_pass).collect(),
        total_ms: report.total_ms,
        device: report.device.clone(),
        cached: report.cached,
        comparison: report.comparison.as_ref().map(to_comparison),
        measurement: report.measurement.as_ref().map(to_measurement),
        fit: report.fitted.as_ref().map(to_fit),
        lods: report.lods.iter().map(to_lod).collect(),
        normal_maps: report.normal_maps.iter().map(to_normal_map).collect(),
        counters: report.counters.map(to_counters),
        chart: report.chart.as_ref().map(to_chart).or_else(|| report.stability.as_ref().map(to_stability)),
        choices: report.choices.iter().map(to_choice).collect(),
        sequence: report.sequence.as_ref().map(to_sequence),
    }
}

fn to_fit(fitted: &Fitted) -> v1::Fit {
    let unit = match fitted.accuracy.unit {
        ToleranceUnit::Diagonal => v1::ToleranceUnit::Diagonal,
        ToleranceUnit::World => v1::ToleranceUnit::World,
        ToleranceUnit::Pixels => v1::ToleranceUnit::Pixels,
    };
    v1::Fit {
        tolerance: fitted.tolerance,
        achieved_tolerance: fitted.achieved_tolerance,
        accuracy: Some(v1::Accuracy {
            bound: fitted.accuracy.bound,
            measured: fitted.accuracy.measured,
            unit: unit.into(),
        }),
        rounds: fitted.rounds,
    }
}

pub(super) fn to_counters(counters: MarchCounters) -> v1::MarchCounters {
    let MarchCounters { rays, fetches, steps, cap_hits } = counters;
    v1::MarchCounters { rays, fetches, steps, cap_hits }
}

fn to_lod(lod: &Lod) -> v1::Lod {
    v1::Lod { triangles: lod.triangles, vertices: lod.vertices, tolerance: lod.tolerance, bound: lod.bound }
}

fn to_normal_map(map: &NormalMap) -> v1::NormalMap {
    v1::NormalMap {
        mesh: map.mesh.clone(),
        primitive: map.primitive,
        lod: map.lod,
        width: map.size[0],
        height: map.size[1],
        coverage: map.coverage,
        clamped: map.clamped,
        angle_p50_deg: map.angle_p50_deg,
        angle_p99_deg: map.angle_p99_deg,
    }
}

pub(super) fn to_comparison(comparison: &Comparison) -> v1::Comparison {
    v1::Comparison {
        flip_mean: comparison.flip_mean,
        flip_p99: comparison.flip_p99,
        rmse_linear: comparison.rmse_linear,
        ssim: comparison.ssim,
        silhouette_xor_px: comparison.silhouette_xor_px,
        hit_error_px: comparison.hit_error_px,
    }
}

fn to_pass(pass: &PassTime) -> v1::PassTime {
    v1::PassTime { name: pass.name.clone(), ms: pass.ms, bytes: pass.bytes }
}
