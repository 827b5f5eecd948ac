//! Errors of sweeps: a curve for each method, over what changes.

use std::fmt::Write as _;

use super::{
    LEGEND_X, PLOT,
    axis::{Axis, written},
    drawn::shape,
    frame,
    marks::mark,
    opened, rounded, stacked, what,
};
use crate::{
    domain::chart::{Chart, Metric, Sweep, SweepPoint},
    jobs::chart::{page::escaped, sweeps::row},
};

const CHARTED: [Metric; 2] = [Metric::Flip, Metric::HitPx];
/// Hit errors above it are seen, pixels.
const SEEN_PX: f64 = 1.0;

/// A file of its own.
pub(in crate::jobs::chart) fn document(chart: &Chart, sweep: Sweep) -> String {
    stacked(&CHARTED, |metric, place| drawing(chart, sweep, metric, place))
}

/// All drawings of a sweep.
pub(in crate::jobs::chart) fn element(chart: &Chart, sweep: Sweep) -> String {
    CHARTED.map(|metric| drawing(chart, sweep, metric, "")).join("\n")
}

fn drawing(chart: &Chart, sweep: Sweep, metric: Metric, place: &str) -> String {
    let curves = Curves::new(chart, sweep, metric);
    let title = format!("{} by {}: {}", what(metric), sweep.name(), chart.title);
    let mut svg = opened(place, &title);
    let below = format!("{}; small images, each method by one setting, against the surface itself", chart.device);
    frame::heading(&mut svg, &title, &below);
    frame::errors(&mut svg, &curves.error, metric);
    curves.values(&mut svg, sweep);
    curves.seen(&mut svg, metric);
    for (row, label) in curves.labels.iter().enumerate() {
        curves.curve(&mut svg, label, [LEGEND_X - 140.0, PLOT[1] + 12.0 + 22.0 * row as f64]);
    }
    svg + "</svg>"
}

struct Curves<'c> {
    /// With their errors.
    points: Vec<(&'c SweepPoint, f64)>,
    /// Of methods, in their order.
    labels: Vec<String>,
    metric: Metric,
    value: Axis,
    error: Axis,
}

impl<'c> Curves<'c> {
    fn new(chart: &'c Chart, sweep: Sweep, metric: Metric) -> Self {
        let of_sweep = chart.sweeps.iter().filter(|point| point.sweep == sweep);
        let points: Vec<_> = of_sweep.filter_map(|point| Some((point, metric.of(&point.error)?))).collect();
        let mut labels: Vec<String> = Vec::new();
        for (point, _) in &points {
            let label = point.label();
            if !labels.contains(&label) {
                labels.push(label);
            }
        }
        let value = Axis::new(points.iter().map(|(point, _)| point.value), PLOT[0], PLOT[2]);
        let error = Axis::new(points.iter().map(|(_, error)| *error), PLOT[3], PLOT[1]);
        Self { points, labels, metric, value, error }
    }

    fn values(&self, svg: &mut String, sweep: Sweep) {
        let mut values: Vec<f64> = self.points.iter().map(|(point, _)| point.value).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        let [left, top, right, bottom] = PLOT;
        for value in values {
            let (x, text) = (self.value.at(value), written(value));
            let _ = writeln!(
                svg,
                "<path class=\"grid\" d=\"M{x:.1} {top}V{bottom}\"/><text class=\"soft\" x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{text}{}</text>",
                bottom + 18.0,
                row(sweep).unit
            );
        }
        let _ = writeln!(
            svg,
            "<text class=\"ink\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
            0.5 * (left + right),
            bottom + 42.0,
            row(sweep).label
        );
    }

    /// A line where hit errors begin to be seen.
    fn seen(&self, svg: &mut String, metric: Metric) {
        let y = self.error.at(SEEN_PX);
        if metric == Metric::HitPx && PLOT[1] < y && y < PLOT[3] {
            let _ = writeln!(
                svg,
                "<path class=\"front\" stroke-width=\"1.5\" stroke-dasharray=\"5 3\" d=\"M{} {y:.1}H{}\"/>\
                 <text class=\"soft\" x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">one pixel</text>",
                PLOT[0],
                PLOT[2],
                PLOT[2] - 4.0,
                y - 5.0
            );
        }
    }

    /// Of one method, with its row of the legend. A second setting of a method is dashed.
    fn curve(&self, svg: &mut String, label: &str, at: [f64; 2]) {
        let of = || self.points.iter().filter(|(point, _)| point.label() == label);
        let Some((first, _)) = of().next() else { return };
        let color = mark(&first.method).color;
        let place = |(point, error): &(&SweepPoint, f64)| [self.value.at(point.value), self.error.at(*error)];
        let line: Vec<String> = of().map(place).map(|[x, y]| format!("{x:.1} {y:.1}")).collect();
        let dash = if first.setting == "shell" { " stroke-dasharray=\"3 3\"" } else { "" };
        let _ = writeln!(
            svg,
            "<path fill=\"none\" stroke=\"{color}\" stroke-width=\"1.5\"{dash} d=\"M{}\"/>",
            line.join("L")
        );
        for one in of() {
            let (point, error) = one;
            let told = format!("{label} at {}: {} {}", point.value, what(self.metric), rounded(*error));
            let _ = writeln!(svg, "<g><title>{}</title>{}</g>", escaped(&told), shape(&point.method, place(one)));
        }
        let [x, y] = at;
        let _ = writeln!(
            svg,
            "<path fill=\"none\" stroke=\"{color}\" stroke-width=\"1.5\"{dash} d=\"M{} {y}h28\"/>{}<text class=\"ink\" x=\"{}\" y=\"{}\">{}</text>",
            x - 14.0,
            shape(&first.method, at),
            x + 22.0,
            y + 4.0,
            escaped(label)
        );
    }
}

/// Within a pixel: the least and the greatest value of a sweep at which a method is.
pub(in crate::jobs::chart) fn holds(chart: &Chart, sweep: Sweep, label: &str) -> Option<[f64; 2]> {
    let is_near = |point: &&SweepPoint| point.error.hit_error_px.is_some_and(|px| px <= SEEN_PX);
    let of = chart.sweeps.iter().filter(|point| point.sweep == sweep && point.label() == label);
    let values = of.filter(is_near).map(|point| point.value);
    values.fold(None, |span: Option<[f64; 2]>, value| {
        Some(span.map_or([value; 2], |[low, high]| [low.min(value), high.max(value)]))
    })
}
