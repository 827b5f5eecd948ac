//! What a chart found, as JSON and in words.

use std::{fmt::Write as _, path::Path};

use displace_proto::v1::{ChartMetric, ChartPoint, ChartReport, ChartSweep, ChartSweepPoint, Report};
use serde_json::{Value, json};

use crate::{
    output::{count, duration_ms},
    report::Written,
};

pub(super) fn as_json(report: &Report, chart: &ChartReport, written: &[Written]) -> Value {
    let outputs: Vec<Value> = written
        .iter()
        .map(|o| json!({ "path": o.path, "digest": o.digest, "bytes": o.bytes, "media_type": o.media_type }))
        .collect();
    let warnings: Vec<Value> =
        report.warnings.iter().map(|w| json!({ "code": w.code, "message": w.message })).collect();
    json!({
        "points": chart.points.iter().map(point_json).collect::<Vec<_>>(),
        "sweeps": chart.sweeps.iter().map(sweep_json).collect::<Vec<_>>(),
        "width": chart.width,
        "height": chart.height,
        "truth_samples": chart.truth_samples,
        "truth_ms": chart.truth_ms,
        "triangles_in": report.triangles_in,
        "device": report.device,
        "driver": chart.driver,
        "warnings": warnings,
        "total_ms": report.total_ms,
        "outputs": outputs,
        "cached": report.cached,
    })
}

/// What is not known is absent.
fn point_json(point: &ChartPoint) -> Value {
    let error = point.error.unwrap_or_default();
    let mut value = json!({
        "name": point.name,
        "method": point.method,
        "setting": point.setting,
        "triangles": point.triangles,
        "vertices": point.vertices,
        "scene_bytes": point.scene_bytes,
        "ms": point.ms,
        "geometry_ms": point.geometry_ms,
        "image_ms": point.image_ms,
        "setup_ms": point.setup_ms,
        "runs": point.runs,
        "flip_mean": error.flip_mean,
        "flip_p99": error.flip_p99,
        "rmse_linear": error.rmse_linear,
        "fronts": point.fronts().map(metric_name).collect::<Vec<_>>(),
    });
    let mut put = |name: &str, known: Option<Value>| {
        if let Some(known) = known {
            value[name] = known;
        }
    };
    put("ms_spread", point.ms_spread.map(Value::from));
    put("silhouette_xor_px", error.silhouette_xor_px.map(Value::from));
    put("hit_error_px", error.hit_error_px.map(Value::from));
    put("predicted_px", point.predicted_px.map(Value::from));
    put("chosen", point.chosen.then(|| Value::from(true)));
    let counters = point.counters.as_ref();
    put(
        "counters",
        counters.map(|c| json!({ "rays": c.rays, "fetches": c.fetches, "steps": c.steps, "cap_hits": c.cap_hits })),
    );
    value
}

fn sweep_json(point: &ChartSweepPoint) -> Value {
    let error = point.error.unwrap_or_default();
    let mut value = json!({
        "sweep": sweep_name(point.sweep()),
        "value": point.value,
        "method": point.method,
        "setting": point.setting,
        "triangles": point.triangles,
        "ms": point.ms,
        "flip_mean": error.flip_mean,
    });
    if let Some(px) = error.hit_error_px {
        value["hit_error_px"] = px.into();
    }
    if let Some(px) = error.silhouette_xor_px {
        value["silhouette_xor_px"] = px.into();
    }
    value
}

fn sweep_name(sweep: ChartSweep) -> &'static str {
    match sweep {
        ChartSweep::Unspecified => "",
        ChartSweep::Angle => "angle",
        ChartSweep::Distance => "distance",
        ChartSweep::Amplitude => "amplitude",
    }
}

fn metric_name(metric: ChartMetric) -> &'static str {
    match metric {
        ChartMetric::Unspecified => "",
        ChartMetric::Flip => "flip",
        ChartMetric::HitPx => "hit_px",
        ChartMetric::SilhouettePx => "silhouette_px",
    }
}

/// Where the table has it.
fn is_told(point: &ChartPoint) -> bool {
    point.chosen || point.fronts().any(|metric| metric == ChartMetric::Flip || metric == ChartMetric::HitPx)
}

/// The settings that no other beats and the automatic choice, fastest first.
pub(super) fn words(report: &Report, chart: &ChartReport, folder: &Path) -> String {
    let mut front: Vec<&ChartPoint> = chart.points.iter().filter(|point| is_told(point)).collect();
    front.sort_by(|a, b| a.ms.total_cmp(&b.ms));
    let mut text = format!(
        "{} settings at {} x {} pixels on {}; none is as fast and nearer than these:\n\n{:<22} {:>12} {:>10} {:>9} {:>9} {:>12}  front\n",
        chart.points.len(),
        chart.width,
        chart.height,
        report.device,
        "setting",
        "triangles",
        "time",
        "FLIP",
        "hit px",
        "outline px"
    );
    for point in front {
        text += &row(point);
    }
    text.push('\n');
    for warning in &report.warnings {
        let _ = writeln!(text, "warning: {}", warning.message);
    }
    let cached = if report.cached { ", stored before" } else { "" };
    let _ =
        writeln!(text, "{} in all{cached}. Open {}", duration_ms(report.total_ms), folder.join("index.html").display());
    text
}

fn row(point: &ChartPoint) -> String {
    let error = point.error.unwrap_or_default();
    let or_dash = |text: Option<String>| text.unwrap_or_else(|| "-".to_owned());
    let fronts: Vec<&str> = point
        .fronts()
        .filter_map(|metric| match metric {
            ChartMetric::Flip => Some("FLIP"),
            ChartMetric::HitPx => Some("hit"),
            _ => None,
        })
        .chain(point.chosen.then_some("auto"))
        .collect();
    format!(
        "{:<22} {:>12} {:>10} {:>9.5} {:>9} {:>12}  {}\n",
        format!("{} {}", point.method, point.setting).trim_end(),
        count(point.triangles),
        duration_ms(point.ms),
        error.flip_mean,
        or_dash(error.hit_error_px.map(|px| format!("{px:.3}"))),
        or_dash(error.silhouette_xor_px.map(count)),
        fronts.join(", "),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_has_the_fronts_alone_fastest_first() {
        let point = |method: &str, ms: f64, fronts: &[ChartMetric]| ChartPoint {
            method: method.into(),
            ms,
            fronts: fronts.iter().map(|metric| i32::from(*metric)).collect(),
            ..ChartPoint::default()
        };
        let points = vec![
            point("exact", 9.0, &[ChartMetric::HitPx]),
            point("steep", 5.0, &[ChartMetric::SilhouettePx]),
            point("flat", 1.0, &[ChartMetric::Flip]),
        ];
        let text = words(&Report::default(), &ChartReport { points, ..ChartReport::default() }, Path::new("d"));
        let rows: Vec<&str> = text.lines().skip(3).take_while(|line| !line.is_empty()).collect();
        assert!(rows.len() == 2 && rows[0].starts_with("flat") && rows[1].starts_with("exact"), "{text}");
        assert!(!text.contains("steep") && text.contains("d/index.html"), "{text}");
    }
}
