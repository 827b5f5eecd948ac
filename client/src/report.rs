//! The report of a job: the JSON of the contract, and the same facts in words.

mod choice;

use std::fmt::Write as _;

use displace_proto::v1::{
    Accuracy, EstimateResponse, Fit, Lod, MarchCounters, NormalMap, Report, SequenceReport, ToleranceUnit, Warning,
};
use serde_json::{Value, json};

use crate::output::{bytes, count, duration_ms};

/// One file written.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Written {
    pub(crate) path: String,
    /// `HASH/SIZE`.
    pub(crate) digest: String,
    pub(crate) bytes: u64,
    pub(crate) media_type: String,
}

/// What the user should know of a conversion, as a warning among the service's.
pub(crate) fn conversion_warnings(notes: &[String]) -> impl Iterator<Item = Warning> + '_ {
    notes.iter().map(|note| Warning { code: "conversion".into(), message: note.clone() })
}

pub(crate) fn json(report: &Report, outputs: &[Written]) -> Value {
    let mut value = json!({
        "method": report.method,
        "triangles_in": report.triangles_in,
        "triangles": report.triangles,
        "vertices": report.vertices,
    });
    if let Some(fit) = &report.fit {
        put(&mut value, "tolerance", Some(fit.tolerance));
        put(&mut value, "achieved_tolerance", Some(fit.achieved_tolerance));
        let accuracy = fit.accuracy.as_ref();
        put(&mut value, "accuracy", accuracy.map(accuracy_json));
        put(&mut value, "rounds", Some(fit.rounds));
    }
    if let Some(seams) = &report.seams {
        value["seams"] = json!({ "gap_max": seams.gap_max, "mismatch_max": seams.mismatch_max });
    }
    put(&mut value, "flipped", report.flipped);
    if let Some(stretch) = &report.stretch {
        value["stretch"] = json!({ "p99": stretch.p99, "max": stretch.max });
    }
    if !report.lods.is_empty() {
        value["lods"] = report.lods.iter().map(lod_json).collect();
    }
    if !report.normal_maps.is_empty() {
        value["normal_maps"] = report.normal_maps.iter().map(normal_map_json).collect();
    }
    if !report.choices.is_empty() {
        value["choices"] = report.choices.iter().map(choice::json).collect();
    }
    put(&mut value, "counters", report.counters.as_ref().map(counters_json));
    if let Some(sequence) = &report.sequence {
        put_sequence(&mut value, sequence);
    }
    value["warnings"] = warnings_json(&report.warnings);
    value["passes"] =
        report.passes.iter().map(|pass| json!({ "name": pass.name, "ms": pass.ms, "bytes": pass.bytes })).collect();
    value["total_ms"] = report.total_ms.into();
    value["outputs"] = outputs
        .iter()
        .map(|o| json!({ "path": o.path, "digest": o.digest, "bytes": o.bytes, "media_type": o.media_type }))
        .collect();
    value["device"] = report.device.as_str().into();
    value["cached"] = report.cached.into();
    value
}

fn accuracy_json(accuracy: &Accuracy) -> Value {
    json!({ "bound": accuracy.bound, "measured": accuracy.measured, "unit": unit(accuracy.unit()).0 })
}

fn counters_json(counters: &MarchCounters) -> Value {
    let MarchCounters { rays, fetches, steps, cap_hits } = counters;
    json!({ "rays": rays, "fetches": fetches, "steps": steps, "cap_hits": cap_hits })
}

fn put_sequence(value: &mut Value, sequence: &SequenceReport) {
    let frame = |(view, frame): (usize, &displace_proto::v1::SequenceFrame)| {
        let mut value = json!({
            "view": view,
            "triangles": frame.triangles,
            "ms": frame.ms,
            "pop_px": frame.pop_px,
            "morph": frame.morph,
        });
        put(&mut value, "tolerance_px", frame.tolerance_px);
        value
    };
    value["frames"] = sequence.frames.iter().enumerate().map(frame).collect();
    value["worst_pop_px"] = sequence.worst_pop_px.into();
    value["tessellations"] = sequence.tessellations.into();
}

fn sequence_words(sequence: &SequenceReport) -> String {
    let frames = &sequence.frames;
    let mean = frames.iter().map(|frame| frame.triangles).sum::<u64>() / frames.len().max(1) as u64;
    let (tessellations, pop) = (count(sequence.tessellations.into()), sequence.worst_pop_px);
    format!(
        "{} frames of {} triangles on average, {tessellations} tessellations; from frame to frame nothing jumps by more than {pop:.3} pixels\n",
        frames.len(),
        count(mean)
    )
}

fn counters_words(counters: &MarchCounters) -> String {
    let MarchCounters { rays, fetches, steps, cap_hits } = *counters;
    let each = |of: u64| of as f64 / rays.max(1) as f64;
    format!(
        "marched {} rays: {:.1} fetches and {:.1} steps each, {} ended by their bound on steps\n",
        count(rays),
        each(fetches),
        each(steps),
        count(cap_hits)
    )
}

fn lod_json(lod: &Lod) -> Value {
    json!({ "triangles": lod.triangles, "vertices": lod.vertices, "tolerance": lod.tolerance, "bound": lod.bound })
}

fn normal_map_json(map: &NormalMap) -> Value {
    json!({
        "mesh": map.mesh,
        "primitive": map.primitive,
        "lod": map.lod,
        "width": map.width,
        "height": map.height,
        "coverage": map.coverage,
        "clamped": map.clamped,
        "angle_deg": { "p50": map.angle_p50_deg, "p99": map.angle_p99_deg },
    })
}

fn normal_map_words(map: &NormalMap) -> String {
    let (p50, p99) = (map.angle_p50_deg, map.angle_p99_deg);
    format!(
        "normal map of '{}' primitive {} level {}: {} x {}, {:.1} % covered, {} clamped, off by {p50:.2} degrees, 99 % at most {p99:.2}\n",
        map.mesh,
        map.primitive,
        map.lod,
        map.width,
        map.height,
        100.0 * map.coverage,
        count(map.clamped)
    )
}

/// A field that is not known is absent.
fn put(value: &mut Value, key: &str, known: Option<impl Into<Value>>) {
    if let Some(known) = known {
        value[key] = known.into();
    }
}

/// In JSON, and in words.
fn unit(unit: ToleranceUnit) -> (&'static str, &'static str) {
    match unit {
        ToleranceUnit::Unspecified => ("", ""),
        ToleranceUnit::Diagonal => ("diagonal", "of the diagonal"),
        ToleranceUnit::World => ("world", "world units"),
        ToleranceUnit::Pixels => ("px", "pixels"),
    }
}

pub(crate) fn warnings_json(warnings: &[Warning]) -> Value {
    warnings.iter().map(|w| json!({ "code": w.code, "message": w.message })).collect()
}

pub(crate) fn words(report: &Report, outputs: &[Written]) -> String {
    let mut text = String::new();
    for output in outputs {
        let _ = writeln!(text, "{}  {}  {}", output.path, bytes(output.bytes), output.media_type);
    }
    let _ = writeln!(
        text,
        "{}: {} triangles from {}, {} vertices",
        report.method,
        count(report.triangles),
        count(report.triangles_in),
        count(report.vertices)
    );
    text.extend(report.choices.iter().map(choice::words));
    text += &report.fit.as_ref().map(fit_words).unwrap_or_default();
    for (level, lod) in report.lods.iter().enumerate() {
        let (triangles, tolerance, bound) = (count(lod.triangles), lod.tolerance, lod.bound);
        let _ = writeln!(text, "level {level}: {triangles} triangles, tolerance {tolerance:.3e}, bound {bound:.3e}");
    }
    text.extend(report.normal_maps.iter().map(normal_map_words));
    if let Some(seams) = &report.seams {
        let _ = writeln!(
            text,
            "seams: largest gap {}, mismatch before reconciling {:.3e}",
            seams.gap_max, seams.mismatch_max
        );
    }
    if let Some(flipped) = report.flipped {
        let _ = writeln!(text, "flipped triangles: {}", count(flipped));
    }
    if let Some(stretch) = &report.stretch {
        let _ = writeln!(text, "stretch: 99 % at most {:.3}, largest {:.3}", stretch.p99, stretch.max);
    }
    text += &report.counters.as_ref().map(counters_words).unwrap_or_default();
    text += &report.sequence.as_ref().map(sequence_words).unwrap_or_default();
    let stored = if report.cached { ", stored before this call" } else { "" };
    let _ = writeln!(text, "{} on {}{stored}", duration_ms(report.total_ms), report.device);
    for pass in &report.passes {
        let _ = writeln!(text, "  {:<22} {:>10} {:>10}", pass.name, duration_ms(pass.ms), bytes(pass.bytes));
    }
    text + &warnings_words(&report.warnings)
}

fn fit_words(fit: &Fit) -> String {
    let (asked, kept) = (fit.tolerance, fit.achieved_tolerance);
    let accuracy = fit.accuracy.unwrap_or_default();
    let (_, unit) = unit(accuracy.unit());
    let kept = if kept > asked { format!("not kept, but {kept:.3e}") } else { "kept".to_owned() };
    let rounds = count(fit.rounds.into());
    let Accuracy { bound, measured, .. } = accuracy;
    format!(
        "tolerance {asked:.3e} {kept}: nothing farther than {bound:.3e} {unit}, {measured:.3e} found, after {rounds} rounds\n"
    )
}

pub(crate) fn warnings_words(warnings: &[Warning]) -> String {
    warnings.iter().fold(String::new(), |mut text, warning| {
        let _ = writeln!(text, "warning ({}): {}", warning.code, warning.message);
        text
    })
}

pub(crate) fn estimate_json(estimate: &EstimateResponse) -> Value {
    let mut value = json!({ "triangles_in": estimate.triangles_in });
    put(&mut value, "triangles", estimate.triangles);
    put(&mut value, "vertices", estimate.vertices);
    put(&mut value, "device_bytes", estimate.device_bytes);
    put(&mut value, "output_bytes", estimate.output_bytes);
    put(&mut value, "seconds", estimate.seconds);
    value["cached"] = estimate.cached.into();
    value["warnings"] = warnings_json(&estimate.warnings);
    value
}

pub(crate) fn estimate_words(estimate: &EstimateResponse) -> String {
    let mut text = sizes_words(estimate);
    let _ = match (estimate.cached, estimate.seconds) {
        (true, _) => writeln!(text, "the result is stored already"),
        (false, Some(seconds)) => writeln!(text, "about {}", duration_ms(seconds * 1000.0)),
        (false, None) => writeln!(text, "time not known before a first job of this kind"),
    };
    text + &warnings_words(&estimate.warnings)
}

fn sizes_words(estimate: &EstimateResponse) -> String {
    let triangles_in = count(estimate.triangles_in);
    let sizes = (estimate.triangles, estimate.vertices, estimate.device_bytes, estimate.output_bytes);
    let (Some(triangles), Some(vertices), Some(device_bytes), Some(output_bytes)) = sizes else {
        return format!("{triangles_in} triangles or more: how many a tolerance takes shows when they are made\n");
    };
    format!(
        "{} triangles from {triangles_in}, {} vertices\ndevice memory {}, output about {}\n",
        count(triangles),
        count(vertices),
        bytes(device_bytes),
        bytes(output_bytes)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_report_cannot_know_is_absent() {
        let value = json(&Report { method: "flat".into(), ..Report::default() }, &[]);
        let keys: Vec<&String> = value.as_object().unwrap().keys().collect();
        assert_eq!(
            keys,
            [
                "method",
                "triangles_in",
                "triangles",
                "vertices",
                "warnings",
                "passes",
                "total_ms",
                "outputs",
                "device",
                "cached"
            ]
        );
    }

    fn kept(tolerance: f64, achieved_tolerance: f64, unit: ToleranceUnit) -> Report {
        let accuracy = Some(Accuracy { bound: 0.25, measured: 0.125, unit: unit.into() });
        Report { fit: Some(Fit { tolerance, achieved_tolerance, accuracy, rounds: 17 }), ..Report::default() }
    }

    #[test]
    fn a_tolerance_is_told_in_its_unit() {
        let report = kept(0.5, 0.5, ToleranceUnit::Pixels);
        let value = json(&report, &[]);
        assert_eq!(value["accuracy"], json!({ "bound": 0.25, "measured": 0.125, "unit": "px" }));
        assert_eq!(
            (&value["tolerance"], &value["achieved_tolerance"], &value["rounds"]),
            (&json!(0.5), &json!(0.5), &json!(17))
        );
        let text = words(&report, &[]);
        assert!(
            text.contains(
                "tolerance 5.000e-1 kept: nothing farther than 2.500e-1 pixels, 1.250e-1 found, after 17 rounds"
            ),
            "{text}"
        );
        let text = words(&kept(0.125, 0.25, ToleranceUnit::World), &[]);
        assert!(
            text.contains("tolerance 1.250e-1 not kept, but 2.500e-1: nothing farther than 2.500e-1 world"),
            "{text}"
        );
        assert_eq!(json(&kept(1.0, 1.0, ToleranceUnit::Diagonal), &[])["accuracy"]["unit"], "diagonal");
    }

    #[test]
    fn what_marching_took_is_told_for_each_ray() {
        let counters = Some(MarchCounters { rays: 1000, fetches: 12_500, steps: 8000, cap_hits: 3 });
        let report = Report { counters, ..Report::default() };
        let expected = json!({ "rays": 1000, "fetches": 12500, "steps": 8000, "cap_hits": 3 });
        assert_eq!(json(&report, &[])["counters"], expected);
        let text = words(&report, &[]);
        assert!(text.contains("12.5 fetches and 8.0 steps each, 3 ended"), "{text}");
    }

    #[test]
    fn an_estimate_is_silent_of_what_only_the_work_tells() {
        let unknown = EstimateResponse { triangles_in: 12, ..EstimateResponse::default() };
        let value = estimate_json(&unknown);
        assert_eq!(value.as_object().unwrap().keys().collect::<Vec<_>>(), ["triangles_in", "cached", "warnings"]);
        assert!(estimate_words(&unknown).starts_with("12 triangles or more:"));
        let sizes = (Some(48), Some(30), Some(1 << 20), Some(1 << 10));
        let (triangles, vertices, device_bytes, output_bytes) = sizes;
        let known = EstimateResponse { triangles, vertices, device_bytes, output_bytes, ..unknown };
        assert_eq!(estimate_json(&known)["device_bytes"], 1 << 20);
        assert!(estimate_words(&known).starts_with("48 triangles from 12, 30 vertices"));
    }
}
