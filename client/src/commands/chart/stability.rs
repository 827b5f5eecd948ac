//! What `displace chart --stability` tells.

use std::{fmt::Write as _, path::Path};

use displace_proto::v1::{ChartReport, Report, StabilityCurve, StabilityReport, StabilityScenario};
use serde_json::{Value, json};

use crate::{output::duration_ms, report::Written};

pub(super) fn as_json(report: &Report, chart: &ChartReport, found: &StabilityReport, written: &[Written]) -> Value {
    let output =
        |o: &Written| json!({ "path": o.path, "digest": o.digest, "bytes": o.bytes, "media_type": o.media_type });
    let warnings: Vec<Value> =
        report.warnings.iter().map(|w| json!({ "code": w.code, "message": w.message })).collect();
    json!({
        "scenarios": found.scenarios.iter().map(scenario_json).collect::<Vec<_>>(),
        "triangles_in": report.triangles_in,
        "device": report.device,
        "driver": chart.driver,
        "warnings": warnings,
        "total_ms": report.total_ms,
        "outputs": written.iter().map(output).collect::<Vec<_>>(),
        "cached": report.cached,
    })
}

fn scenario_json(scenario: &StabilityScenario) -> Value {
    let violations: Vec<Value> =
        scenario.violations.iter().map(|v| json!({ "rule": v.rule, "count": v.count, "first": v.first })).collect();
    json!({
        "name": scenario.name,
        "parameter": scenario.parameter,
        "unit": scenario.unit,
        "metric": scenario.metric,
        "metric_unit": scenario.metric_unit,
        "line": scenario.line,
        "worse": if scenario.worse_downwards { "downwards" } else { "upwards" },
        "breakdowns": scenario.curves.iter().map(breakdown_json).collect::<Vec<_>>(),
        "checks": scenario.checks,
        "violations": violations,
    })
}

/// Where it never breaks, `at` is absent.
fn breakdown_json(curve: &StabilityCurve) -> Value {
    let values: Vec<[f64; 2]> = curve.parameters.iter().zip(&curve.values).map(|(p, v)| [*p, *v]).collect();
    let mut told = json!({ "method": curve.method, "literature": curve.literature, "values": values });
    if let Some(at) = curve.breakdown {
        told["at"] = at.into();
    }
    told
}

/// A line for each scenario, and every breakdown below it.
pub(super) fn words(report: &Report, found: &StabilityReport, folder: &Path) -> String {
    let mut text = format!("{} scenarios on {}\n", found.scenarios.len(), report.device);
    for scenario in &found.scenarios {
        let _ = writeln!(
            text,
            "\n{}: {} ({}), up to {} passes",
            scenario.title, scenario.metric, scenario.metric_unit, scenario.line
        );
        for curve in &scenario.curves {
            let at = curve.breakdown.map_or("does not break".to_owned(), |at| format!("{at:.3} {}", scenario.unit));
            let _ = writeln!(text, "  {:<34} {at}", curve.method);
        }
    }
    let checks: u64 = found.scenarios.iter().map(|scenario| scenario.checks).sum();
    let broken: u64 = found.scenarios.iter().flat_map(|scenario| &scenario.violations).map(|v| v.count).sum();
    let _ = writeln!(text, "\n{broken} of {checks} checks of what must hold anywhere failed");
    for warning in &report.warnings {
        let _ = writeln!(text, "warning: {}", warning.message);
    }
    let cached = if report.cached { ", stored before" } else { "" };
    let _ =
        writeln!(text, "{} in all{cached}. Open {}", duration_ms(report.total_ms), folder.join("index.html").display());
    text
}

#[cfg(test)]
mod tests {
    use displace_proto::v1::StabilityViolation;

    use super::*;

    #[test]
    fn breakdowns_and_what_failed_are_told() {
        let curve =
            |method: &str, breakdown| StabilityCurve { method: method.into(), breakdown, ..StabilityCurve::default() };
        let scenario = StabilityScenario {
            title: "Grazing rays".into(),
            unit: "degrees".into(),
            curves: vec![curve("flat", Some(12.5)), curve("exact", None)],
            checks: 9,
            violations: vec![StabilityViolation { count: 2, ..StabilityViolation::default() }],
            ..StabilityScenario::default()
        };
        let found = StabilityReport { scenarios: vec![scenario] };
        let text = words(&Report::default(), &found, Path::new("d"));
        for part in ["12.500 degrees", "does not break", "2 of 9 checks", "d/index.html"] {
            assert!(text.contains(part), "{part}: {text}");
        }
        let told = as_json(&Report::default(), &ChartReport::default(), &found, &[]);
        let breakdowns = &told["scenarios"][0]["breakdowns"];
        assert_eq!((breakdowns[0]["at"].as_f64(), breakdowns[1].get("at")), (Some(12.5), None));
    }
}
