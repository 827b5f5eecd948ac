//! At every error the fastest setting that is as near: the fronts in words.

use std::fmt::Write as _;

use super::{escaped, grouped};
use crate::{
    domain::chart::{Chart, Metric},
    jobs::chart::svg::{front, known, rounded, what},
};

pub(super) fn html(chart: &Chart) -> String {
    let mut html = "<h2>The fastest within an error</h2>\n<div class=\"winners\">\n".to_owned();
    for metric in known(chart) {
        html += &table(chart, metric);
    }
    html + "</div>\n"
}

fn table(chart: &Chart, metric: Metric) -> String {
    let mut html = format!(
        "<table>\n<thead><tr><th scope=\"col\">{} within</th><th scope=\"col\">fastest</th><th scope=\"col\">ms</th>\
         <th scope=\"col\">triangles</th></tr></thead>\n<tbody>\n",
        what(metric)
    );
    for (point, error) in front(chart, metric).into_iter().rev() {
        let number = chart.points.iter().position(|other| other.name == point.name).unwrap_or_default();
        let _ = writeln!(
            html,
            "<tr data-point=\"{number}\"><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
            rounded(error),
            escaped(&point.label()),
            rounded(point.ms),
            grouped(point.triangles)
        );
    }
    html + "</tbody>\n</table>\n"
}
