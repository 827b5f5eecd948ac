//! The report of a job: the JSON of the contract, and the same facts in words.

use std::fmt::Write as _;

use displace_proto::v1::{EstimateResponse, Report, Warning};
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
    if let Some(seams) = &report.seams {
        value["seams"] = json!({ "gap_max": seams.gap_max, "mismatch_max": seams.mismatch_max });
    }
    if let Some(flipped) = report.flipped {
        value["flipped"] = flipped.into();
    }
    if let Some(stretch) = &report.stretch {
        value["stretch"] = json!({ "p99": stretch.p99, "max": stretch.max });
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
    let stored = if report.cached { ", stored before this call" } else { "" };
    let _ = writeln!(text, "{} on {}{stored}", duration_ms(report.total_ms), report.device);
    for pass in &report.passes {
        let _ = writeln!(text, "  {:<22} {:>10} {:>10}", pass.name, duration_ms(pass.ms), bytes(pass.bytes));
    }
    text + &warnings_words(&report.warnings)
}

pub(crate) fn warnings_words(warnings: &[Warning]) -> String {
    warnings.iter().fold(String::new(), |mut text, warning| {
        let _ = writeln!(text, "warning ({}): {}", warning.code, warning.message);
        text
    })
}

pub(crate) fn estimate_json(estimate: &EstimateResponse) -> Value {
    let mut value = json!({
        "triangles_in": estimate.triangles_in,
        "triangles": estimate.triangles,
        "vertices": estimate.vertices,
        "device_bytes": estimate.device_bytes,
        "output_bytes": estimate.output_bytes,
    });
    if let Some(seconds) = estimate.seconds {
        value["seconds"] = seconds.into();
    }
    value["cached"] = estimate.cached.into();
    value["warnings"] = warnings_json(&estimate.warnings);
    value
}

pub(crate) fn estimate_words(estimate: &EstimateResponse) -> String {
    let mut text = format!(
        "{} triangles from {}, {} vertices\ndevice memory {}, output about {}\n",
        count(estimate.triangles),
        count(estimate.triangles_in),
        count(estimate.vertices),
        bytes(estimate.device_bytes),
        bytes(estimate.output_bytes)
    );
    let _ = match (estimate.cached, estimate.seconds) {
        (true, _) => writeln!(text, "the result is stored already"),
        (false, Some(seconds)) => writeln!(text, "about {}", duration_ms(seconds * 1000.0)),
        (false, None) => writeln!(text, "time not known before a first job of this kind"),
    };
    text + &warnings_words(&estimate.warnings)
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
}
