//! Where methods break: the curves of sweeps, and within what each holds.

use std::fmt::Write as _;

use super::escaped;
use crate::{
    domain::chart::{Chart, Sweep},
    jobs::chart::{
        svg::{holds, sweep_element},
        sweeps::row,
    },
};

/// Nothing where nothing was swept.
pub(super) fn html(chart: &Chart) -> String {
    let swept = chart.swept();
    if swept.is_empty() {
        return String::new();
    }
    let mut html =
        "<h2>Where methods break</h2>\n<p>The same at a small size as one thing changes. The table says where the hit \
                    error stays within a pixel.</p>\n"
            .to_owned();
    html += &table(chart, &swept);
    for sweep in swept {
        let _ = writeln!(html, "<div class=\"chart\">{}</div>", sweep_element(chart, sweep));
    }
    html + "<p>As a table: <a href=\"errors.csv\">errors.csv</a>.</p>\n"
}

fn table(chart: &Chart, swept: &[Sweep]) -> String {
    let mut html = "<div class=\"wide\"><table>\n<thead><tr><th scope=\"col\">setting</th>".to_owned();
    for sweep in swept {
        let _ = write!(html, "<th scope=\"col\">{}</th>", sweep.name());
    }
    html += "</tr></thead>\n<tbody>\n";
    let mut labels: Vec<String> = Vec::new();
    for point in &chart.sweeps {
        if !labels.contains(&point.label()) {
            labels.push(point.label());
        }
    }
    for label in labels {
        let _ = write!(html, "<tr><td>{}</td>", escaped(&label));
        for sweep in swept {
            let _ = write!(html, "<td>{}</td>", held(chart, *sweep, &label));
        }
        html += "</tr>\n";
    }
    html + "</tbody>\n</table></div>\n"
}

fn held(chart: &Chart, sweep: Sweep, label: &str) -> String {
    let unit = row(sweep).unit;
    match holds(chart, sweep, label) {
        None => "nowhere".into(),
        Some([low, high]) if low == high => format!("{low}{unit}"),
        Some([low, high]) => format!("{low}{unit} to {high}{unit}"),
    }
}
