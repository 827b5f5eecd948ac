//! The page: the charts, what is seen of the point under the pointer or the focus, and a table of all. It lies beside
//! its images and asks nothing of a network.

mod sweeps;
mod winners;

use std::fmt::Write as _;

use serde_json::json;

use super::svg::{self, rounded};
use crate::domain::{
    chart::{Chart, Metric, Point},
    report::Warning,
};

pub(in crate::jobs) const STYLE: &str = include_str!("page/style.css");
const SCRIPT: &str = include_str!("page/script.js");

pub(super) fn html(chart: &Chart, warnings: &[Warning]) -> String {
    let mut page = head(chart);
    page += "<div class=\"board\">\n<div>\n";
    for metric in svg::known(chart) {
        let _ = writeln!(page, "<div class=\"chart\">{}</div>", svg::element(chart, metric));
    }
    page += "</div>\n";
    page += &seen(chart);
    page += "</div>\n";
    page += &winners::html(chart);
    page += &sweeps::html(chart);
    page += &table(chart);
    page += &told(warnings);
    let facts = json!(chart.points.iter().map(facts).collect::<Vec<_>>());
    // Nothing in it may end the element that holds it.
    let facts = facts.to_string().replace('<', "\\u003c");
    page + FOOTER
        + &format!(
            "<script type=\"application/json\" id=\"points\">{facts}</script>\n<script>\n{SCRIPT}</script>\n</html>\n"
        )
}

const FOOTER: &str = "\
<footer>FLIP: Andersson et al. 2020, at 67 pixels per degree. Time is that of surface and image; what maps need once, \
such as cones, is told apart. Hit error: how far apart the places are that both images show at a \
pixel, as many pixels as that looks long face-on, the 99th percentile. Files: <a href=\"chart.csv\">chart.csv</a>, <a href=\"chart.json\">chart.json</a>, \
<a href=\"chart.svg\">chart.svg</a>.</footer>\n</main>\n";

fn head(chart: &Chart) -> String {
    let Chart { title, device, driver, width, height, truth_samples, points, .. } = chart;
    let (title, device, driver) = (escaped(title), escaped(device), escaped(driver));
    let driver = if driver.is_empty() { driver } else { format!(" ({driver})") };
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n\
         <title>Speed against accuracy: {title}</title>\n<style>\n{STYLE}</style>\n<main>\n<h1>Speed against accuracy: {title}</h1>\n\
         <p>{} settings on {device}{driver}, {width} x {height} pixels, each against the surface itself by {truth_samples} rays a pixel. \
         Lower is nearer, left is faster; no setting lies below and left of the dashed line. {}Point at one, or reach it by Tab, to see \
         what it shows.</p>\n",
        points.len(),
        if chart.chosen().is_some() { "The star is the automatic choice. " } else { "" },
    )
}

/// As it is before anything is pointed at: the automatic choice, else the nearest by FLIP.
fn seen(chart: &Chart) -> String {
    let nearest = || chart.points.iter().min_by(|a, b| a.error.flip_mean.total_cmp(&b.error.flip_mean));
    let Some(point) = chart.chosen().or_else(nearest) else { return String::new() };
    let (name, label) = (escaped(&point.name), escaped(&point.label()));
    let mut list = String::new();
    for [term, told] in figures(point) {
        let _ = write!(list, "<dt>{}</dt><dd>{}</dd>", escaped(&term), escaped(&told));
    }
    format!(
        "<section class=\"seen-box\" id=\"seen\" aria-live=\"polite\">\n<h3>{label}</h3>\n\
         <figure><img id=\"image\" src=\"{name}.png\" alt=\"{label}: image\"><figcaption>image</figcaption></figure>\n\
         <div class=\"pair\"><figure><img id=\"difference\" src=\"{name}-difference.png\" alt=\"{label}: difference\">\
         <figcaption>difference: FLIP, black is none</figcaption></figure>\
         <figure><img src=\"truth.png\" alt=\"truth\"><figcaption>truth</figcaption></figure></div>\n<dl>{list}</dl>\n</section>\n"
    )
}

fn facts(point: &Point) -> serde_json::Value {
    json!({ "name": point.name, "label": point.label(), "facts": figures(point) })
}

fn figures(point: &Point) -> Vec<[String; 2]> {
    let error = &point.error;
    let known: [[&str; 2]; 7] = [
        ["triangles", &grouped(point.triangles)],
        ["time", &format!("{} ms", rounded(point.ms))],
        ["of the surface", &format!("{} ms", rounded(point.geometry_ms))],
        ["of the image", &format!("{} ms", rounded(point.image_ms))],
        ["of maps, once", &format!("{} ms", rounded(point.setup_ms))],
        ["mean FLIP", &rounded(error.flip_mean)],
        ["RMSE, linear light", &rounded(error.rmse_linear)],
    ];
    let mut figures: Vec<[String; 2]> = known.map(|pair| pair.map(str::to_owned)).into();
    let mut more = |name: &str, told: Option<String>| figures.extend(told.map(|told| [name.to_owned(), told]));
    more("hit error", error.hit_error_px.map(|px| format!("{} px", rounded(px))));
    more("hit error predicted, at most", point.predicted_px.map(|px| format!("{} px", rounded(px))));
    more("outline error", error.silhouette_xor_px.map(|px| format!("{px} px")));
    more("chosen", point.chosen.then(|| "automatically".to_owned()));
    more("fetches a ray", point.counters.map(|c| format!("{:.1}", c.fetches as f64 / c.rays.max(1) as f64)));
    figures
}

fn table(chart: &Chart) -> String {
    let mut html = "<h2>Every setting</h2>\n<div class=\"wide\"><table>\n<thead><tr>".to_owned();
    for name in COLUMNS {
        let _ = write!(html, "<th scope=\"col\">{name}</th>");
    }
    html += "</tr></thead>\n<tbody>\n";
    for (k, point) in chart.points.iter().enumerate() {
        let [name, label] = [&point.name, &point.label()].map(|text| escaped(text));
        let star = if point.chosen { "<span class=\"star\" title=\"the automatic choice\">★</span> " } else { "" };
        let _ = write!(html, "<tr data-point=\"{k}\"><td>{star}<a href=\"{name}.png\">{label}</a></td>");
        for cell in cells(point) {
            let _ = write!(html, "<td>{cell}</td>");
        }
        html += "</tr>\n";
    }
    html + "</tbody>\n</table></div>\n"
}

const COLUMNS: [&str; 15] = [
    "setting",
    "triangles",
    "fetches a ray",
    "ms",
    "spread",
    "surface ms",
    "image ms",
    "maps ms",
    "MiB",
    "FLIP",
    "FLIP p99",
    "hit px",
    "predicted px",
    "outline px",
    "front",
];

/// All but the first.
fn cells(point: &Point) -> [String; COLUMNS.len() - 1] {
    let or_dash = |text: Option<String>| text.unwrap_or_else(|| "–".to_owned());
    let error = &point.error;
    let fronts: Vec<&str> = point.fronts.iter().map(|metric| short(*metric)).collect();
    [
        grouped(point.triangles),
        or_dash(point.counters.map(|c| format!("{:.1}", c.fetches as f64 / c.rays.max(1) as f64))),
        rounded(point.ms),
        or_dash(point.ms_spread.map(rounded)),
        rounded(point.geometry_ms),
        rounded(point.image_ms),
        rounded(point.setup_ms),
        format!("{:.1}", point.scene_bytes as f64 / f64::from(1 << 20)),
        rounded(error.flip_mean),
        rounded(error.flip_p99),
        or_dash(error.hit_error_px.map(rounded)),
        or_dash(point.predicted_px.map(rounded)),
        or_dash(error.silhouette_xor_px.map(|px| px.to_string())),
        fronts.join(", "),
    ]
}

fn short(metric: Metric) -> &'static str {
    match metric {
        Metric::Flip => "FLIP",
        Metric::HitPx => "hit",
        Metric::SilhouettePx => "outline",
    }
}

fn told(warnings: &[Warning]) -> String {
    if warnings.is_empty() {
        return String::new();
    }
    let items: String = warnings.iter().map(|warning| format!("<li>{}</li>\n", escaped(&warning.message))).collect();
    format!("<h2>What else there is to know</h2>\n<ul>\n{items}</ul>\n")
}

/// `12 345`.
fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let group = |(k, digit): (usize, char)| {
        let starts = k > 0 && (digits.len() - k).is_multiple_of(3);
        [starts.then_some('\u{a0}'), Some(digit)]
    };
    digits.chars().enumerate().flat_map(group).flatten().collect()
}

/// For text and attributes of HTML and XML; what XML cannot hold becomes a question mark.
pub(in crate::jobs) fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => safe += "&amp;",
            '<' => safe += "&lt;",
            '>' => safe += "&gt;",
            '"' => safe += "&quot;",
            '\'' => safe += "&#39;",
            '\u{fffe}' | '\u{ffff}' => safe.push('?'),
            letter if letter.is_control() => safe.push('?'),
            letter => safe.push(letter),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_from_outside_cannot_become_markup() {
        assert_eq!(escaped("<a b='c' d=\"e\">&\u{1}"), "&lt;a b=&#39;c&#39; d=&quot;e&quot;&gt;&amp;?");
        let point = Point { name: "x".into(), method: "</script><b>".into(), ..Point::default() };
        let chart = Chart { title: "<i>".into(), device: "<u>".into(), points: vec![point], ..Chart::default() };
        let page = html(&chart, &[Warning::new("a", "<s>")]);
        for markup in ["<i>", "<u>", "<s>", "</script><b>", "<b>"] {
            assert!(!page.contains(markup), "{markup}");
        }
    }

    #[test]
    fn the_page_asks_nothing_of_a_network() {
        let page = html(&Chart::default(), &[]);
        assert!(!page.contains("src=\"http") && !page.contains("href=\"http") && !page.contains("@import"));
    }

    #[test]
    fn large_numbers_are_grouped() {
        assert_eq!([0, 999, 1000, 1_234_567].map(grouped), ["0", "999", "1\u{a0}000", "1\u{a0}234\u{a0}567"]);
    }
}
