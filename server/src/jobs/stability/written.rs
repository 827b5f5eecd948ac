//! The suite as CSV and as JSON.

use std::fmt::Write as _;

use crate::domain::{Error, Result, stability::Stability};

const COLUMNS: &str = "scenario,method,parameter,unit,metric,value,line,breakdown";

/// A row for each value (RFC 4180, lines that end in LF); a breakdown that is none is empty.
pub(super) fn csv(stability: &Stability) -> String {
    let mut text = format!("{COLUMNS}\n");
    for scenario in &stability.scenarios {
        let metric = format!("{} ({})", scenario.metric, scenario.metric_unit);
        for curve in &scenario.curves {
            let breakdown = curve.breakdown.map_or_else(String::new, digits);
            for [parameter, value] in &curve.values {
                let _ = writeln!(
                    text,
                    "{},{},{},{},{},{},{},{breakdown}",
                    scenario.name,
                    field(&curve.method),
                    digits(*parameter),
                    field(&scenario.unit),
                    field(&metric),
                    digits(*value),
                    scenario.line
                );
            }
        }
    }
    text
}

/// Six that count.
fn digits(value: f64) -> String {
    let text = format!("{value:.5e}");
    text.parse::<f64>().map_or(text, |value| value.to_string())
}

fn field(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

/// All that is known.
pub(super) fn json(stability: &Stability) -> Result<String> {
    let text = serde_json::to_string_pretty(stability);
    text.map(|text| text + "\n").map_err(|cause| Error::internal("the suite has no JSON").with_cause(cause))
}
