//! The points as CSV and as JSON.

use std::fmt::Write as _;

use serde_json::json;

use crate::domain::{
    Error, Result,
    chart::{Chart, Metric, Point, SweepPoint},
    report::Warning,
};

const COLUMNS: &str = "method,setting,triangles,fetches,ms,ms_spread,error,metric,predicted,pareto,chosen";

/// A row for each point and metric (RFC 4180, lines that end in LF). What is not known is empty.
pub(super) fn csv(chart: &Chart) -> String {
    let mut text = format!("{COLUMNS}\n");
    let is_chosen = |point: &Point| chart.chosen().map(|_| point.chosen);
    for point in &chart.points {
        for metric in Metric::ALL {
            row(&mut text, point, metric, is_chosen(point));
        }
    }
    text
}

/// `chosen` is not known where nothing was chosen, and of the errors hits alone are predicted.
fn row(text: &mut String, point: &Point, metric: Metric, chosen: Option<bool>) {
    let Point { triangles, ms, .. } = point;
    let (method, setting) = (field(&point.method), field(&point.setting));
    let fetches = known(point.counters.map(|counters| counters.fetches));
    let (spread, error) = (known(point.ms_spread), known(metric.of(&point.error)));
    let predicted = known(point.predicted_px.filter(|_| metric == Metric::HitPx));
    let (metric, pareto, chosen) = (metric.name(), point.fronts.contains(&metric), known(chosen));
    let _ = writeln!(
        text,
        "{method},{setting},{triangles},{fetches},{ms},{spread},{error},{metric},{predicted},{pareto},{chosen}"
    );
}

const ERROR_COLUMNS: &str = "sweep,value,method,setting,triangles,ms,error,metric";

/// A row for each method, value and metric of sweeps.
pub(super) fn errors(chart: &Chart) -> String {
    let mut text = format!("{ERROR_COLUMNS}\n");
    for point in &chart.sweeps {
        let SweepPoint { sweep, value, triangles, ms, .. } = point;
        let (sweep, method, setting) = (sweep.name(), field(&point.method), field(&point.setting));
        for metric in Metric::ALL {
            let (error, metric) = (known(metric.of(&point.error)), metric.name());
            let _ = writeln!(text, "{sweep},{value},{method},{setting},{triangles},{ms},{error},{metric}");
        }
    }
    text
}

fn known<T: ToString>(value: Option<T>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

fn field(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

/// All that is known.
pub(super) fn json(chart: &Chart, warnings: &[Warning]) -> Result<String> {
    let failed = |cause| Error::internal("the chart has no JSON").with_cause(cause);
    let mut value = serde_json::to_value(chart).map_err(failed)?;
    value["warnings"] = json!(warnings);
    let text = serde_json::to_string_pretty(&value).map_err(failed)?;
    Ok(text + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::{chart::Sweep, image::MarchCounters, report::Comparison};

    #[test]
    fn what_is_not_known_is_empty_and_each_metric_has_its_row() {
        let point = Point {
            method: "relief".into(),
            setting: "16".into(),
            triangles: 2,
            counters: Some(MarchCounters { fetches: 99, ..MarchCounters::default() }),
            ms: 1.5,
            error: Comparison { flip_mean: 0.25, silhouette_xor_px: Some(7), ..Comparison::default() },
            fronts: vec![Metric::Flip],
            ..Point::default()
        };
        let flat = Point { method: "flat".into(), ms_spread: Some(0.5), ..Point::default() };
        let text = csv(&Chart { points: vec![point, flat], ..Chart::default() });
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], COLUMNS);
        assert_eq!(lines[1], "relief,16,2,99,1.5,,0.25,flip,,true,");
        assert_eq!(lines[2], "relief,16,2,99,1.5,,,hit_px,,false,");
        assert_eq!(lines[3], "relief,16,2,99,1.5,,7,silhouette_px,,false,");
        assert_eq!(lines[4], "flat,,0,,0,0.5,0,flip,,false,");
        assert_eq!(lines.len(), 7);
        assert!(lines.iter().all(|line| line.matches(',').count() == COLUMNS.matches(',').count()));
    }

    #[test]
    fn what_was_predicted_and_chosen_is_told() {
        let chosen = Point { method: "exact".into(), predicted_px: Some(0.5), chosen: true, ..Point::default() };
        let text = csv(&Chart { points: vec![chosen, Point::default()], ..Chart::default() });
        let ends: Vec<&str> =
            text.lines().skip(1).map(|line| line.split_once(",0,").map_or(line, |(_, end)| end)).collect();
        assert_eq!(ends[0], ",0,,0,flip,,false,true");
        assert_eq!(ends[1], ",0,,,hit_px,0.5,false,true");
        assert_eq!(ends[4], ",0,,,hit_px,,false,false");
    }

    #[test]
    fn sweeps_have_a_row_for_each_metric() {
        let point = SweepPoint {
            sweep: Sweep::Distance,
            value: 2.0,
            method: "relief".into(),
            setting: "auto".into(),
            triangles: 2,
            ms: 1.5,
            error: Comparison { flip_mean: 0.25, hit_error_px: Some(0.5), ..Comparison::default() },
        };
        let text = errors(&Chart { sweeps: vec![point], ..Chart::default() });
        let rows: Vec<&str> = text.lines().skip(1).collect();
        let expected = ["0.25,flip", "0.5,hit_px", ",silhouette_px"];
        assert_eq!(rows, expected.map(|end| format!("distance,2,relief,auto,2,1.5,{end}")));
    }

    #[test]
    fn fields_with_commas_and_quotes_are_quoted() {
        assert_eq!(field("a,\"b\""), "\"a,\"\"b\"\"\"");
        assert_eq!(field("level 5"), "level 5");
    }
}
