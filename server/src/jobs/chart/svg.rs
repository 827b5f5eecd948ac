//! A chart as SVG: time across and error up, both logarithmic, the front as a line of steps.

pub(in crate::jobs) mod axis;
mod labels;
pub(in crate::jobs) mod marks;

use std::fmt::Write as _;

use super::page::escaped;
use crate::domain::chart::{Chart, Metric, Point};
use axis::{Axis, written};
use labels::{Rect, along, mark_at, placed};
use marks::mark;

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 540.0;
/// Where points lie.
const PLOT: Rect = [78.0, 62.0, 720.0, 476.0];
/// Also where the page around it is dark.
const STYLE: &str = "\
.paper{fill:#fff}.ink{fill:#1b1f24}.soft{fill:#56606b}.grid{stroke:#d9dee4}.frame{stroke:#56606b}.front{stroke:#1b1f24}\
@media(prefers-color-scheme:dark){.paper{fill:#121518}.ink{fill:#e8ebef}.soft{fill:#9ba6b2}.grid{stroke:#323941}\
.frame{stroke:#9ba6b2}.front{stroke:#e8ebef}}";

/// A file of its own.
pub(super) fn document(chart: &Chart, metric: Metric) -> String {
    format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{}\n", element(chart, metric))
}

/// The element alone. Each point is a link to its image and has its number as `data-point`.
pub(super) fn element(chart: &Chart, metric: Metric) -> String {
    let plot = Plot::new(chart, metric);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"group\" aria-label=\"{}\" \
         font-family=\"system-ui,sans-serif\" font-size=\"12\">\n<style>{STYLE}</style>\n\
         <rect class=\"paper\" width=\"{WIDTH}\" height=\"{HEIGHT}\"/>\n",
        escaped(&plot.title())
    );
    plot.heading(&mut svg);
    plot.grid(&mut svg);
    plot.courses(&mut svg);
    plot.front(&mut svg);
    plot.points(&mut svg);
    plot.labels(&mut svg);
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
        let on_front = self.shown().filter(|(_, point, _)| point.fronts.contains(&self.metric));
        let mut front: Vec<_> = on_front.map(|(_, point, place)| (point, place)).collect();
        front.sort_by(|a, b| a.0.ms.total_cmp(&b.0.ms));
        front
    }

    fn title(&self) -> String {
        format!("{} against time: {}", what(self.metric), self.chart.title)
    }

    fn heading(&self, svg: &mut String) {
        let Chart { device, width, height, truth_samples, .. } = self.chart;
        let below = format!(
            "{device}, {width} x {height} pixels; the truth is the surface itself by {truth_samples} rays a pixel"
        );
        let title = escaped(&self.title());
        let _ = writeln!(
            svg,
            "<text class=\"ink\" x=\"{}\" y=\"26\" font-size=\"17\" font-weight=\"600\">{title}</text>",
            PLOT[0]
        );
        let _ = writeln!(svg, "<text class=\"soft\" x=\"{}\" y=\"46\">{}</text>", PLOT[0], escaped(&below));
    }

    fn grid(&self, svg: &mut String) {
        let [left, top, right, bottom] = PLOT;
        for tick in self.time.ticks() {
            let (x, text) = (self.time.at(tick), written(tick));
            let _ = writeln!(svg, "<path class=\"grid\" d=\"M{x:.1} {top}V{bottom}\"/>");
            let _ = writeln!(
                svg,
                "<text class=\"soft\" x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{text}</text>",
                bottom + 18.0
            );
        }
        let zero = self.error.has_zero().then_some(0.0);
        for tick in self.error.ticks().into_iter().chain(zero) {
            let (y, text) = (self.error.at(tick), if tick == 0.0 { "0".into() } else { written(tick) });
            let _ = writeln!(svg, "<path class=\"grid\" d=\"M{left} {y:.1}H{right}\"/>");
            let _ = writeln!(
                svg,
                "<text class=\"soft\" x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{text}</text>",
                left - 8.0,
                y + 4.0
            );
        }
        let _ = writeln!(svg, "<path class=\"frame\" fill=\"none\" d=\"M{left} {top}V{bottom}H{right}\"/>");
        let middle = 0.5 * (left + right);
        let _ = writeln!(
            svg,
            "<text class=\"ink\" x=\"{middle}\" y=\"{}\" text-anchor=\"middle\">time of surface and image, ms (log; the median run)</text>",
            bottom + 42.0
        );
        let middle = 0.5 * (top + bottom);
        let _ = writeln!(
            svg,
            "<text class=\"ink\" transform=\"translate(22 {middle}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            unit(self.metric)
        );
    }

    /// A thin line through the settings of each method, in their order.
    fn courses(&self, svg: &mut String) {
        let mut last: Option<(&Point, [f64; 2])> = None;
        for (_, point, place) in self.shown() {
            let goes_on =
                |known: &Point| known.method == point.method && sweep(known).is_some() && sweep(known) == sweep(point);
            if let Some((_, [x, y])) = last.filter(|(known, _)| goes_on(known)) {
                let (color, [to_x, to_y]) = (mark(&point.method).color, place);
                let _ = writeln!(
                    svg,
                    "<path fill=\"none\" stroke=\"{color}\" stroke-opacity=\".35\" d=\"M{x:.1} {y:.1}L{to_x:.1} {to_y:.1}\"/>"
                );
            }
            last = Some((point, place));
        }
    }

    /// Nothing lies below and left of it.
    fn front(&self, svg: &mut String) {
        let front = self.on_front();
        let Some((_, [x, y])) = front.first() else { return };
        let mut path = format!("M{x:.1} {}V{y:.1}", PLOT[1]);
        for (_, [x, y]) in &front[1..] {
            let _ = write!(path, "H{x:.1}V{y:.1}");
        }
        let _ = writeln!(
            svg,
            "<path class=\"front\" fill=\"none\" stroke-width=\"1.5\" stroke-dasharray=\"5 3\" d=\"{path}H{}\"/>",
            PLOT[2]
        );
    }

    fn points(&self, svg: &mut String) {
        for (k, point, place) in self.shown() {
            let error = self.metric.of(&point.error).unwrap_or_default();
            let told = format!("{}: {:.2} ms, {} {}", point.label(), point.ms, what(self.metric), rounded(error));
            let (told, name) = (escaped(&told), escaped(&point.name));
            let shape = shape(&point.method, place);
            let _ = writeln!(
                svg,
                "<a href=\"{name}.png\" aria-label=\"{told}\" data-point=\"{k}\"><title>{told}</title>{shape}</a>"
            );
        }
    }

    fn labels(&self, svg: &mut String) {
        let front = self.on_front();
        let mut taken: Vec<Rect> = self.shown().map(|(_, _, place)| mark_at(place)).collect();
        if let (Some((_, [x, y])), Some((_, [last_x, last_y]))) = (front.first(), front.last()) {
            taken.extend([along([*x, PLOT[1]], [*x, *y]), along([*last_x, *last_y], [PLOT[2], *last_y])]);
        }
        for pair in front.windows(2) {
            let ([x0, y0], [x1, y1]) = (pair[0].1, pair[1].1);
            taken.extend([along([x0, y0], [x1, y0]), along([x1, y0], [x1, y1])]);
        }
        let wanted = front.iter().map(|(point, place)| (point.label(), *place)).collect();
        for label in placed(wanted, taken, PLOT) {
            if let Some([x0, y0, x1, y1]) = label.leader {
                let _ =
                    writeln!(svg, "<path class=\"frame\" stroke-width=\".7\" d=\"M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}\"/>");
            }
            let (x, y) = (label.rect[0] + 1.0, label.rect[3] - 3.5);
            let _ = writeln!(svg, "<text class=\"ink\" x=\"{x:.1}\" y=\"{y:.1}\">{}</text>", escaped(&label.text));
        }
    }

    fn legend(&self, svg: &mut String) {
        let mut methods: Vec<&str> = Vec::new();
        for (_, point, _) in self.shown().filter(|(_, point, _)| !point.method.is_empty()) {
            if !methods.contains(&point.method.as_str()) {
                methods.push(&point.method);
            }
        }
        let x = PLOT[2] + 30.0;
        for (row, method) in methods.iter().enumerate() {
            let y = PLOT[1] + 12.0 + 22.0 * row as f64;
            let (shape, name) = (shape(method, [x, y]), escaped(method));
            let _ = writeln!(svg, "{shape}<text class=\"ink\" x=\"{}\" y=\"{}\">{name}</text>", x + 14.0, y + 4.0);
        }
        let y = PLOT[1] + 16.0 + 22.0 * methods.len() as f64;
        let _ = writeln!(
            svg,
            "<path class=\"front\" stroke-width=\"1.5\" stroke-dasharray=\"5 3\" d=\"M{} {y}h22\"/><text class=\"ink\" x=\"{}\" y=\"{}\">the front</text>",
            x - 9.0,
            x + 18.0,
            y + 4.0
        );
    }
}

/// What of numbers a setting is one of.
fn sweep(point: &Point) -> Option<&str> {
    point
        .setting
        .contains(|c: char| c.is_ascii_digit())
        .then(|| point.setting.trim_matches(|c: char| c.is_ascii_digit() || c == '.'))
}

fn shape(method: &str, [x, y]: [f64; 2]) -> String {
    let mark = mark(method);
    let (path, color) = (mark.path(x, y), mark.color);
    if mark.filled {
        return format!("<path fill=\"{color}\" d=\"{path}\"/>");
    }
    format!("<path class=\"paper\" stroke=\"{color}\" stroke-width=\"2\" d=\"{path}\"/>")
}

fn what(metric: Metric) -> &'static str {
    match metric {
        Metric::Flip => "FLIP",
        Metric::HitPx => "hit error",
        Metric::SilhouettePx => "outline error",
    }
}

fn unit(metric: Metric) -> &'static str {
    match metric {
        Metric::Flip => "mean FLIP, 0 to 1 (log)",
        Metric::HitPx => "hit error, pixels, 99th percentile (log)",
        Metric::SilhouettePx => "pixels inside one outline alone (log)",
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
