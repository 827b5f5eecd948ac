//! What is around the points: title, axes, legend.

use std::fmt::Write as _;

use super::{
    LEGEND_X, PLOT, Plot,
    axis::{Axis, written},
    drawn::shape,
    marks::halo,
    rounded,
};
use crate::{
    domain::chart::{Chart, Metric},
    jobs::chart::page::escaped,
};

impl Plot<'_> {
    pub(super) fn heading(&self, svg: &mut String) {
        let Chart { device, width, height, truth_samples, .. } = self.chart;
        let below = format!(
            "{device}, {width} x {height} pixels; the truth is the surface itself by {truth_samples} rays a pixel"
        );
        heading(svg, &self.title(), &below);
    }

    pub(super) fn grid(&self, svg: &mut String) {
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
        errors(svg, &self.error, self.metric);
        let middle = 0.5 * (left + right);
        let _ = writeln!(
            svg,
            "<text class=\"ink\" x=\"{middle}\" y=\"{}\" text-anchor=\"middle\">time of surface and image, ms (log; the median run)</text>",
            bottom + 42.0
        );
    }

    pub(super) fn legend(&self, svg: &mut String) {
        let mut methods: Vec<&str> = Vec::new();
        for (_, point, _) in self.shown().filter(|(_, point, _)| !point.method.is_empty()) {
            if !methods.contains(&point.method.as_str()) {
                methods.push(&point.method);
            }
        }
        let x = LEGEND_X;
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
        self.told_choice(svg, [x, y + 30.0]);
    }
    /// What the star means, and how far it is from the front.
    fn told_choice(&self, svg: &mut String, [x, y]: [f64; 2]) {
        let Some(times) = self.chart.times_front(self.metric) else { return };
        let far = if times > 1.0 { format!("{} x the front", rounded(times)) } else { "on the front".to_owned() };
        let _ = writeln!(
            svg,
            "<path class=\"chosen\" d=\"{}\"/><text class=\"ink\" x=\"{tx}\" y=\"{}\">the automatic choice</text>\
             <text class=\"soft\" x=\"{tx}\" y=\"{}\">{far}</text>",
            halo([x, y]),
            y + 4.0,
            y + 19.0,
            tx = x + 20.0,
        );
    }
}

pub(super) fn heading(svg: &mut String, title: &str, below: &str) {
    let (title, below) = (escaped(title), escaped(below));
    let x = PLOT[0];
    let _ = writeln!(svg, "<text class=\"ink\" x=\"{x}\" y=\"26\" font-size=\"17\" font-weight=\"600\">{title}</text>");
    let _ = writeln!(svg, "<text class=\"soft\" x=\"{x}\" y=\"46\">{below}</text>");
}

/// The axis of errors, and the sides of the plot.
pub(super) fn errors(svg: &mut String, axis: &Axis, metric: Metric) {
    let [left, top, right, bottom] = PLOT;
    let zero = axis.has_zero().then_some(0.0);
    for tick in axis.ticks().into_iter().chain(zero) {
        let (y, text) = (axis.at(tick), if tick == 0.0 { "0".into() } else { written(tick) });
        let _ = writeln!(svg, "<path class=\"grid\" d=\"M{left} {y:.1}H{right}\"/>");
        let _ = writeln!(
            svg,
            "<text class=\"soft\" x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{text}</text>",
            left - 8.0,
            y + 4.0
        );
    }
    let _ = writeln!(svg, "<path class=\"frame\" fill=\"none\" d=\"M{left} {top}V{bottom}H{right}\"/>");
    let middle = 0.5 * (top + bottom);
    let _ = writeln!(
        svg,
        "<text class=\"ink\" transform=\"translate(22 {middle}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
        unit(metric)
    );
}

fn unit(metric: Metric) -> &'static str {
    match metric {
        Metric::Flip => "mean FLIP, 0 to 1 (log)",
        Metric::HitPx => "hit error, pixels, 99th percentile (log)",
        Metric::SilhouettePx => "pixels inside one outline alone (log)",
    }
}
