//! A scenario as SVG: the parameter across, the metric up, a curve for each method, and the line that passes.

use std::fmt::Write as _;

use super::super::chart::{
    page::escaped,
    svg::{
        axis::{Axis, written},
        marks::{Mark, mark},
        rounded,
    },
};
use crate::domain::stability::{Curve, Scenario, Stability, Worse};

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 460.0;
/// Left, top, right, bottom.
const PLOT: [f64; 4] = [78.0, 62.0, 620.0, 396.0];
/// Values below such a share of the line are drawn as none; where the line is none, of the greatest.
const LEAST: f64 = 1e-3;
/// Parameters that span more than this are drawn by their logarithm.
const LOGARITHMIC: f64 = 20.0;
/// Also where the page around it is dark.
const STYLE: &str = "\
.paper{fill:#fff}.ink{fill:#1b1f24}.soft{fill:#56606b}.grid{stroke:#d9dee4}.frame{stroke:#56606b}.line{stroke:#c0392b}.fail{fill:#c0392b}\
.halo{stroke:#fff;stroke-width:4;paint-order:stroke}\
@media(prefers-color-scheme:dark){.paper{fill:#121518}.ink{fill:#e8ebef}.soft{fill:#9ba6b2}.grid{stroke:#323941}\
.frame{stroke:#9ba6b2}.line{stroke:#ff7b6b}.fail{fill:#ff7b6b}.halo{stroke:#121518}}";

/// A file of its own.
pub(super) fn document(scenario: &Scenario, stability: &Stability) -> String {
    format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{}\n", element(scenario, stability))
}

/// The element alone.
pub(super) fn element(scenario: &Scenario, stability: &Stability) -> String {
    let plot = Plot::new(scenario);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{}\" \
         font-family=\"system-ui,sans-serif\" font-size=\"12\">\n<style>{STYLE}</style>\n\
         <rect class=\"paper\" width=\"{WIDTH}\" height=\"{HEIGHT}\"/>\n",
        escaped(&scenario.title)
    );
    plot.heading(&mut svg, stability);
    plot.across(&mut svg);
    plot.up(&mut svg);
    plot.curves(&mut svg);
    plot.line(&mut svg);
    svg + "</svg>"
}

/// Straight, or logarithmic with its zeros apart.
enum Scale {
    Straight { low: f64, high: f64, start: f64, end: f64 },
    Logarithmic(Axis),
}

impl Scale {
    fn across(values: &[f64], start: f64, end: f64) -> Self {
        let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
        let least = values.iter().copied().filter(|v| *v > 0.0).fold(f64::INFINITY, f64::min);
        if low >= 0.0
            && high > LOGARITHMIC * least
            && low < LOGARITHMIC * least
            && values.len() > 2
            && !spread_evenly(values)
        {
            return Self::Logarithmic(Axis::new(values.iter().copied(), start, end));
        }
        let room = if high > low { 0.03 * (high - low) } else { 1.0 };
        Self::Straight { low: low - room, high: high + room, start, end }
    }

    fn at(&self, value: f64) -> f64 {
        match self {
            Self::Straight { low, high, start, end } => start + (end - start) * (value - low) / (high - low),
            Self::Logarithmic(axis) => axis.at(value),
        }
    }

    /// With what they are called.
    fn ticks(&self) -> Vec<(f64, String)> {
        match self {
            Self::Straight { low, high, .. } => round_values(*low, *high).into_iter().map(|v| (v, plain(v))).collect(),
            Self::Logarithmic(axis) => {
                let zero = axis.has_zero().then(|| (0.0, "0".to_owned()));
                zero.into_iter().chain(axis.ticks().into_iter().map(|v| (v, short(v)))).collect()
            }
        }
    }
}

/// Steps that hardly grow, as those of angles.
fn spread_evenly(values: &[f64]) -> bool {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values.dedup();
    let steps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let [least, most] = steps.iter().fold([f64::INFINITY, 0.0], |[a, b]: [f64; 2], s| [a.min(*s), b.max(*s)]);
    most <= 5.0 * least
}

fn round_values(low: f64, high: f64) -> Vec<f64> {
    let rough = (high - low) / 6.0;
    let decade = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|s| s * decade).into_iter().find(|s| *s >= rough).unwrap_or(10.0 * decade);
    let first = (low / step).ceil() as i64;
    (first..=(high / step).floor() as i64).map(|k| k as f64 * step).collect()
}

fn plain(value: f64) -> String {
    format!("{}", (value * 1e6).round() / 1e6)
}

/// Powers of ten where numbers would be long.
fn short(value: f64) -> String {
    if (1e-3..1e5).contains(&value) { written(value) } else { format!("{value:.0e}") }
}

struct Plot<'s> {
    scenario: &'s Scenario,
    parameter: Scale,
    metric: Scale,
    /// What is less is drawn as none.
    least: f64,
}

impl<'s> Plot<'s> {
    fn new(scenario: &'s Scenario) -> Self {
        let values = || scenario.curves.iter().flat_map(|curve| &curve.values);
        let parameters: Vec<f64> = values().map(|[parameter, _]| *parameter).collect();
        let metrics: Vec<f64> = values().map(|[_, metric]| *metric).filter(|m| m.is_finite()).collect();
        let greatest = metrics.iter().copied().fold(0.0, f64::max);
        let least = LEAST * if scenario.line > 0.0 { scenario.line } else { greatest };
        let drawn = metrics.into_iter().chain([scenario.line]).map(|value| at_least(value, least));
        let metric = Scale::Logarithmic(Axis::new(drawn.collect::<Vec<_>>().iter().copied(), PLOT[3], PLOT[1]));
        Self { scenario, parameter: Scale::across(&parameters, PLOT[0], PLOT[2]), metric, least }
    }

    fn heading(&self, svg: &mut String, stability: &Stability) {
        let (title, asset) = (escaped(&self.scenario.title), escaped(&self.scenario.asset));
        let device = if stability.driver.is_empty() { &stability.device } else { &stability.driver };
        let _ = writeln!(
            svg,
            "<text class=\"ink\" x=\"{x}\" y=\"26\" font-size=\"17\" font-weight=\"600\">{title}</text>\n\
             <text class=\"soft\" x=\"{x}\" y=\"46\">{asset}</text>\n\
             <text class=\"soft\" x=\"{}\" y=\"{}\" font-size=\"10\" text-anchor=\"end\">{}</text>",
            WIDTH - 14.0,
            HEIGHT - 12.0,
            escaped(device),
            x = PLOT[0]
        );
    }

    fn across(&self, svg: &mut String) {
        let [left, top, right, bottom] = PLOT;
        for (tick, text) in self.parameter.ticks() {
            let x = self.parameter.at(tick);
            let _ = writeln!(
                svg,
                "<path class=\"grid\" d=\"M{x:.1} {top}V{bottom}\"/><text class=\"soft\" x=\"{x:.1}\" y=\"{}\" \
                 text-anchor=\"middle\">{text}</text>",
                bottom + 18.0
            );
        }
        let Scenario { parameter, unit, .. } = self.scenario;
        let name = if parameter == unit { parameter.clone() } else { format!("{parameter}, {unit}") };
        let _ = writeln!(
            svg,
            "<text class=\"ink\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
            0.5 * (left + right),
            bottom + 42.0,
            escaped(&name)
        );
    }

    fn up(&self, svg: &mut String) {
        let [left, top, right, bottom] = PLOT;
        for (tick, text) in self.metric.ticks() {
            let y = self.metric.at(tick);
            let _ = writeln!(
                svg,
                "<path class=\"grid\" d=\"M{left} {y:.1}H{right}\"/><text class=\"soft\" x=\"{}\" y=\"{:.1}\" \
                 text-anchor=\"end\">{text}</text>",
                left - 8.0,
                y + 4.0
            );
        }
        let name = format!("{}, {} (log)", self.scenario.metric, self.scenario.metric_unit);
        let _ = writeln!(
            svg,
            "<path class=\"frame\" fill=\"none\" d=\"M{left} {top}V{bottom}H{right}\"/>\n\
             <text class=\"ink\" transform=\"translate(20 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            0.5 * (top + bottom),
            escaped(&name)
        );
    }

    fn line(&self, svg: &mut String) {
        let y = self.metric.at(self.scenario.line);
        // Where curves are below it.
        let (x, anchor) = match self.scenario.worse {
            Worse::Upwards => (PLOT[0] + 6.0, "start"),
            Worse::Downwards => (PLOT[2] - 6.0, "end"),
        };
        let _ = writeln!(
            svg,
            "<path class=\"line\" stroke-width=\"1.5\" stroke-dasharray=\"6 3\" d=\"M{} {y:.1}H{}\"/>\
             <text class=\"fail halo\" x=\"{x}\" y=\"{:.1}\" text-anchor=\"{anchor}\">passes up to {}</text>",
            PLOT[0],
            PLOT[2],
            y - 6.0,
            rounded(self.scenario.line)
        );
    }

    fn curves(&self, svg: &mut String) {
        for (k, (curve, look)) in self.scenario.curves.iter().zip(looks(&self.scenario.curves)).enumerate() {
            self.course(svg, curve, &look);
            let (x, y) = (PLOT[2] + 26.0, PLOT[1] + 12.0 + 34.0 * k as f64);
            let verdict = match curve.breakdown {
                Some(_) if curve.never_passes(self.scenario.line) => "broken throughout".into(),
                Some(at) => format!("breaks at {} {}", rounded(at), self.scenario.unit),
                None => "does not break".into(),
            };
            let class = if curve.breakdown.is_some() { "fail" } else { "soft" };
            let _ = writeln!(
                svg,
                "{}<text class=\"ink\" x=\"{tx}\" y=\"{}\">{}</text><text class=\"{class}\" x=\"{tx}\" y=\"{}\" \
                 font-size=\"11\">{}</text>",
                shape(&look, [x, y]),
                y + 4.0,
                escaped(&curve.method),
                y + 18.0,
                escaped(&verdict),
                tx = x + 14.0,
            );
        }
    }

    fn course(&self, svg: &mut String, curve: &Curve, look: &Mark) {
        let shown = curve.values.iter().filter(|[_, metric]| metric.is_finite());
        let places: Vec<[f64; 2]> =
            shown.map(|[p, m]| [self.parameter.at(*p), self.metric.at(at_least(*m, self.least))]).collect();
        let path: Vec<String> = places.iter().map(|[x, y]| format!("{x:.1} {y:.1}")).collect();
        let _ = writeln!(
            svg,
            "<g><title>{}</title><path fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\" stroke-opacity=\".7\" d=\"M{}\"/>{}</g>",
            escaped(&curve.method),
            look.color,
            path.join("L"),
            places.iter().map(|place| shape(look, *place)).collect::<String>()
        );
    }
}

/// Or none.
fn at_least(value: f64, least: f64) -> f64 {
    if value < least { 0.0 } else { value }
}

/// A method has the look that it has in charts, so has what begins with its name; others have what is left.
fn looks(curves: &[Curve]) -> Vec<Mark> {
    const LEFT: [&str; 6] = ["bump", "steep", "parallax-limited", "cone", "flat", "relief"];
    let known = |name: &str| displace_glsl::methods::METHODS.iter().find(|row| row.name == name).map(|row| row.name);
    let mut taken: Vec<&str> = curves.iter().filter_map(|curve| known(&curve.method)).collect();
    let mut of_curve = |curve: &Curve| {
        if let Some(own) = known(&curve.method) {
            return mark(own);
        }
        let begun = curve.method.split([',', ' ']).next().and_then(known);
        let free = begun.into_iter().chain(LEFT).find(|name| !taken.contains(name)).unwrap_or("flat");
        taken.push(free);
        mark(free)
    };
    curves.iter().map(&mut of_curve).collect()
}

fn shape(look: &Mark, [x, y]: [f64; 2]) -> String {
    let (path, color) = (look.path(x, y), look.color);
    if look.filled {
        return format!("<path fill=\"{color}\" d=\"{path}\"/>");
    }
    format!("<path class=\"paper\" stroke=\"{color}\" stroke-width=\"2\" d=\"{path}\"/>")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_straight_where_steps_are_even_and_logarithmic_where_they_grow() {
        let of = |values: &[f64]| matches!(Scale::across(values, 0.0, 100.0), Scale::Logarithmic(_));
        assert!(!of(&[0.0, 10.0, 20.0, 89.0]) && !of(&[0.5, 1.0, 1.5]));
        assert!(of(&[4.0, 8.0, 16.0, 256.0]) && of(&[1e-4, 1.0, 1e5]));
    }

    #[test]
    fn no_two_curves_look_the_same() {
        let curves = ["exact", "exact, shell", "relief, shell", "exact, quadric", "displacement, a", "displacement, b"]
            .map(|method| Curve { method: method.into(), ..Curve::default() });
        let paths: Vec<(String, bool)> = looks(&curves).iter().map(|look| (look.path(0.0, 0.0), look.filled)).collect();
        for (k, path) in paths.iter().enumerate() {
            assert!(!paths[..k].contains(path), "{k}");
        }
    }

    #[test]
    fn round_values_lie_within() {
        assert_eq!(round_values(-2.0, 91.0), [0.0, 20.0, 40.0, 60.0, 80.0]);
        assert_eq!(round_values(0.45, 1.55), [0.6, 0.8, 1.0, 1.2, 1.4].map(|v| (v * 5.0f64).round() * 0.2));
    }
}
