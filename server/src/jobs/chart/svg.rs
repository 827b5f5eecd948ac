//! A chart as SVG: time across and error up, both logarithmic, the front as a line of steps, the automatic choice as a star.

pub(in crate::jobs) mod axis;
mod curves;
mod drawn;
mod frame;
mod labels;
pub(in crate::jobs) mod marks;
mod winners;

use super::page::escaped;
use crate::domain::chart::{Chart, Metric, Point};
use axis::Axis;
use labels::Rect;

pub(super) use curves::{document as sweep_document, element as sweep_element, holds};

const WIDTH: f64 = 1060.0;
const HEIGHT: f64 = 540.0;
/// Where points lie.
const PLOT: Rect = [78.0, 62.0, 720.0, 476.0];
/// Where it is told what marks mean.
const LEGEND_X: f64 = 906.0;
/// Also where the page around it is dark.
const STYLE: &str = "\
.paper{fill:#fff}.ink{fill:#1b1f24}.soft{fill:#56606b}.grid{stroke:#d9dee4}.frame{stroke:#56606b}.front{stroke:#1b1f24}\
.chosen{fill:none;stroke:#c98a00;stroke-width:2.2;stroke-linejoin:round}\
@media(prefers-color-scheme:dark){.paper{fill:#121518}.ink{fill:#e8ebef}.soft{fill:#9ba6b2}.grid{stroke:#323941}\
.frame{stroke:#9ba6b2}.front{stroke:#e8ebef}}";

/// A file of its own: a drawing for each error that is known, one below the other.
pub(super) fn document(chart: &Chart) -> String {
    stacked(&known(chart), |metric, place| drawing(chart, metric, place))
}

/// Drawings below each other, as a file; `draw` gets the attributes that place one.
fn stacked(metrics: &[Metric], draw: impl Fn(Metric, &str) -> String) -> String {
    let height = HEIGHT * metrics.len() as f64;
    let mut svg = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\">\n"
    );
    for (row, metric) in metrics.iter().enumerate() {
        svg += &draw(*metric, &format!("y=\"{}\" height=\"{HEIGHT}\" ", HEIGHT * row as f64));
        svg.push('\n');
    }
    svg + "</svg>\n"
}

/// Errors that some point has; FLIP in any case.
pub(super) fn known(chart: &Chart) -> Vec<Metric> {
    let has = |metric: &Metric| chart.points.iter().any(|point| metric.of(&point.error).is_some());
    Metric::ALL.into_iter().filter(|metric| *metric == Metric::Flip || has(metric)).collect()
}

/// The element alone. Each point is a link to its image and has its number as `data-point`.
pub(super) fn element(chart: &Chart, metric: Metric) -> String {
    drawing(chart, metric, "")
}

/// The start of a drawing.
fn opened(place: &str, title: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" {place}viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"group\" aria-label=\"{}\" \
         font-family=\"system-ui,sans-serif\" font-size=\"12\">\n<style>{STYLE}</style>\n\
         <rect class=\"paper\" width=\"{WIDTH}\" height=\"{HEIGHT}\"/>\n",
        escaped(title)
    )
}

fn drawing(chart: &Chart, metric: Metric, place: &str) -> String {
    let plot = Plot::new(chart, metric);
    let mut svg = opened(place, &plot.title());
    plot.heading(&mut svg);
    plot.grid(&mut svg);
    plot.courses(&mut svg);
    plot.front(&mut svg);
    plot.points(&mut svg);
    plot.choice(&mut svg);
    plot.labels(&mut svg);
    plot.winners(&mut svg);
    plot.legend(&mut svg);
    svg + "</svg>"
}

struct Plot<'c> {
    chart: &'c Chart,
    metric: Metric,
    time: Axis,
    error: Axis,
}

impl<'c> Plot<'c> {
    fn new(chart: &'c Chart, metric: Metric) -> Self {
        let shown = chart.points.iter().filter(|point| metric.of(&point.error).is_some());
        let time = Axis::new(shown.clone().map(|point| point.ms), PLOT[0], PLOT[2]);
        let error = Axis::new(shown.filter_map(|point| metric.of(&point.error)), PLOT[3], PLOT[1]);
        Self { chart, metric, time, error }
    }

    /// Those that have the error, with their numbers.
    fn shown(&self) -> impl Iterator<Item = (usize, &'c Point, [f64; 2])> {
        let points = self.chart.points.iter().enumerate();
        points.filter_map(|(k, point)| {
            let error = self.metric.of(&point.error)?;
            Some((k, point, [self.time.at(point.ms), self.error.at(error)]))
        })
    }

    /// From the fastest to the nearest.
    fn on_front(&self) -> Vec<(&'c Point, [f64; 2])> {
        let place = |(point, error): (&'c Point, f64)| (point, [self.time.at(point.ms), self.error.at(error)]);
        front(self.chart, self.metric).into_iter().map(place).collect()
    }

    fn title(&self) -> String {
        format!("{} against time: {}", what(self.metric), self.chart.title)
    }
}

/// Points of a front with their errors, from the fastest to the nearest: each is the fastest that is as near, up to the error
/// of the one before it.
pub(super) fn front(chart: &Chart, metric: Metric) -> Vec<(&Point, f64)> {
    let on_front = chart.points.iter().filter(|point| point.fronts.contains(&metric));
    let mut front: Vec<_> = on_front.filter_map(|point| Some((point, metric.of(&point.error)?))).collect();
    front.sort_by(|a, b| a.0.ms.total_cmp(&b.0.ms).then(b.1.total_cmp(&a.1)));
    front
}

pub(super) fn what(metric: Metric) -> &'static str {
    match metric {
        Metric::Flip => "FLIP",
        Metric::HitPx => "hit error",
        Metric::SilhouettePx => "outline error",
    }
}

/// Three digits that count.
pub(in crate::jobs) fn rounded(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return "0".into();
    }
    let digits = (2.0 - value.abs().log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.digits$}")
}

#[cfg(test)]
mod tests;
