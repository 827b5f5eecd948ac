//! The page: all sets one below the other, in drawings and in words.

use std::fmt::Write as _;

use displace_server::domain::chart::{Chart, Metric, Sweep};

use crate::{sets::Set, words::winners};

const STYLE: &str = "\
:root{color-scheme:light dark;--ink:#1b1f24;--soft:#56606b;--line:#d9dee4;--paper:#fff}
@media(prefers-color-scheme:dark){:root{--ink:#e8ebef;--soft:#9ba6b2;--line:#323941;--paper:#121518}}
*{box-sizing:border-box}body{margin:0;background:var(--paper);color:var(--ink);font:16px/1.55 system-ui,sans-serif}
main{max-width:1120px;margin:0 auto;padding:36px 20px 80px}h1{margin:0 0 8px;font-size:2rem}h2{margin:56px 0 4px}
p,li{max-width:60rem}.soft{color:var(--soft)}img{display:block;width:100%;height:auto;border:1px solid var(--line);border-radius:8px;margin:10px 0}
pre{overflow-x:auto;font-size:.82rem;border:1px solid var(--line);border-radius:8px;padding:10px}a{color:inherit}
details{margin:8px 0}summary{cursor:pointer;color:var(--soft)}";

pub(crate) fn html(charts: &[(&Set, Chart)]) -> String {
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n\
         <title>Speed against accuracy: five sets</title>\n<style>\n{STYLE}\n</style>\n<main>\n<h1>Speed against accuracy: five sets</h1>\n\
         <p>Every method and setting of <code>displace chart</code> on five surfaces, each against the surface itself by rays in f64. \
         Below and left is better; nothing lies below and left of the dashed line. The strip beside a chart names the winner at every error: go \
         to the error that is allowed, and read across. Times hold for the device that is named, as busy as it was; errors hold \
         anywhere. <code>cargo chart</code> draws the page from the tables beside it, <code>cargo chart measure</code> measures anew.</p>\n{}",
        measured_on(charts)
    );
    for (set, chart) in charts {
        page += &section(set, chart);
    }
    page + "</main>\n</html>\n"
}

fn measured_on(charts: &[(&Set, Chart)]) -> String {
    let mut devices: Vec<String> = charts.iter().map(|(_, c)| format!("{} ({})", c.device, c.driver)).collect();
    devices.dedup();
    format!("<p>Measured on {}.</p>\n", escaped(&devices.join("; ")))
}

fn section(set: &Set, chart: &Chart) -> String {
    let Set { name, text, command, .. } = set;
    let mut html = format!(
        "<section>\n<h2>{name}</h2>\n<p>{text} {} settings, {} x {} pixels, {} rays a pixel of the truth.</p>\n<ul>\n",
        chart.points.len(),
        chart.width,
        chart.height,
        chart.truth_samples
    );
    for (title, metric, unit) in
        [("FLIP", Metric::Flip, ""), ("Hit error", Metric::HitPx, " px"), ("Outline", Metric::SilhouettePx, " px")]
    {
        let _ = writeln!(html, "<li>{title}: {}</li>", winners(chart, metric, unit));
    }
    let _ = writeln!(html, "</ul>\n<img src=\"{name}/chart.svg\" alt=\"{name}: errors against time\">");
    html += &swept(name, chart);
    let _ = writeln!(
        html,
        "<details><summary>Command and tables</summary>\n<pre>{command} -o {name}</pre>\n\
         <p><a href=\"{name}/chart.csv\">chart.csv</a>, <a href=\"{name}/errors.csv\">errors.csv</a>, \
         <a href=\"{name}/chart.json\">chart.json</a></p></details>\n</section>"
    );
    html
}

/// Where methods break.
fn swept(name: &str, chart: &Chart) -> String {
    let drawing = |sweep: Sweep| {
        let sweep = sweep.name();
        format!("<img src=\"{name}/errors-{sweep}.svg\" alt=\"{name}: errors by {sweep}\">\n")
    };
    let drawings: String = chart.swept().into_iter().map(drawing).collect();
    if drawings.is_empty() {
        drawings
    } else {
        format!("<details open><summary>Where methods break</summary>\n{drawings}</details>\n")
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
