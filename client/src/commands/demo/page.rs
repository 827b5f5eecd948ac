//! The page: plain HTML beside its images, no script, nothing from the network.

use std::{fmt::Write as _, path::Path};

use super::{
    Step,
    scenes::{CHART, SCENES},
};
use crate::output::{bytes, count, duration_ms};

const STYLE: &str = "\
:root{color-scheme:light dark;--ink:#1d2126;--soft:#5b6570;--line:#d8dde3;--paper:#fff;--panel:#f5f7f9}
@media(prefers-color-scheme:dark){:root{--ink:#e7eaee;--soft:#9aa5b1;--line:#333a42;--paper:#14171a;--panel:#1d2126}}
*{box-sizing:border-box}body{margin:0;background:var(--paper);color:var(--ink);font:16px/1.55 system-ui,sans-serif}
main{max-width:1080px;margin:0 auto;padding:40px 20px 80px}h1{font-size:2.1rem;margin:0}h2{margin:56px 0 4px}
p{margin:6px 0 16px;color:var(--soft);max-width:46rem}.figures{display:grid;gap:16px;grid-template-columns:repeat(auto-fit,minmax(300px,1fr))}
figure{margin:0;border:1px solid var(--line);border-radius:8px;overflow:hidden;background:var(--panel)}
img{display:block;width:100%;height:auto}figcaption{padding:8px 12px;font-size:.86rem;color:var(--soft)}
.downloads{margin:14px 0}.downloads a{display:inline-block;margin:0 8px 8px 0;padding:5px 12px;border:1px solid var(--line);border-radius:6px;color:inherit;text-decoration:none}
.downloads a:hover{border-color:currentColor}pre{overflow-x:auto;padding:12px;border-radius:8px;background:var(--panel);border:1px solid var(--line);font-size:.82rem;line-height:1.5}
details{margin:10px 0}summary{cursor:pointer;color:var(--soft)}.wide{overflow-x:auto}table{border-collapse:collapse;font-size:.85rem;margin:10px 0;width:100%}
th,td{padding:4px 10px;text-align:right;border-bottom:1px solid var(--line);white-space:nowrap}th:first-child,td:first-child{text-align:left}
footer{margin-top:64px;padding-top:16px;border-top:1px solid var(--line);color:var(--soft);font-size:.86rem}";

pub(super) fn html(scenes: &[Vec<Step>], chart: &Step, total_ms: f64) -> String {
    let device = scenes.iter().flatten().next().map_or("", |step| &step.outcome.report.device);
    let commands = scenes.iter().flatten().count() + 1;
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n\
         <title>Displace: demo</title>\n<style>\n{STYLE}\n</style>\n<main>\n<h1>Displace</h1>\n\
         <p>Meshes and maps went in; displaced geometry and images came out: {commands} commands in {}, on {}. \
         Run any of them in this folder.</p>\n",
        duration_ms(total_ms),
        escaped(device),
    );
    for (scene, steps) in SCENES.iter().zip(scenes) {
        let _ = writeln!(page, "<section>\n<h2>{}</h2>\n<p>{}</p>", escaped(scene.title), escaped(scene.text));
        page += &figures(steps);
        page += &downloads(steps);
        page += &reports(steps);
        page += "</section>\n";
    }
    page + &charted(chart) + FOOTER
}

/// The chart's own page tells the rest.
fn charted(step: &Step) -> String {
    let settings = step.outcome.report.chart.as_ref().map_or(0, |chart| chart.points.len());
    format!(
        "<section>\n<h2>{}</h2>\n<p>{}</p>\n<figure><a href=\"chart/index.html\"><img src=\"chart/chart.svg\" alt=\"error against time\" \
         loading=\"lazy\"></a><figcaption>{settings} settings; <a href=\"chart/index.html\">the page</a> shows each one's image and \
         difference</figcaption></figure>\n<pre>{}</pre>\n</section>\n",
        escaped(CHART.title),
        escaped(CHART.text),
        escaped(&step.typed)
    )
}

const FOOTER: &str = "\
<footer>Samples: rock by ambientCG (CC0), Suzanne by Norbert Nopper (CC0), abstract map by 3dtextures.me (CC0), \
scales and the other meshes made by Displace.</footer>\n</main>\n</html>\n";

fn figures(steps: &[Step]) -> String {
    let mut html = "<div class=\"figures\">\n".to_owned();
    for step in steps {
        for written in step.outcome.written.iter().filter(|w| w.media_type.starts_with("image/")) {
            let (name, report) = (file_name(&written.path), &step.outcome.report);
            let _ = writeln!(
                html,
                "<figure><a href=\"{name}\"><img src=\"{name}\" alt=\"{name}\" loading=\"lazy\"></a><figcaption>{name}: {}, {} triangles</figcaption></figure>",
                escaped(&report.method),
                count(report.triangles),
            );
        }
    }
    html + "</div>\n"
}

fn downloads(steps: &[Step]) -> String {
    let mut html = "<div class=\"downloads\">".to_owned();
    for written in steps.iter().flat_map(|step| &step.outcome.written).filter(|w| w.media_type.starts_with("model/")) {
        let name = file_name(&written.path);
        let _ = write!(html, "<a href=\"{name}\" download>{name} ({})</a>", bytes(written.bytes));
    }
    html + "</div>\n"
}

fn reports(steps: &[Step]) -> String {
    let mut html = "<details>\n<summary>Commands and reports</summary>\n<pre>".to_owned();
    for step in steps {
        let _ = writeln!(html, "{}", escaped(&step.typed));
    }
    html += "</pre>\n<div class=\"wide\"><table>\n<tr><th>output</th><th>method</th><th>triangles in</th><th>triangles</th><th>vertices</th>\
             <th>largest gap</th><th>flipped</th><th>time</th><th>passes</th></tr>\n";
    for step in steps {
        html += &report_row(step);
    }
    html + "</table></div>\n</details>\n"
}

fn report_row(step: &Step) -> String {
    let report = &step.outcome.report;
    let first = step.outcome.written.first().map(|written| file_name(&written.path)).unwrap_or_default();
    let or_dash = |text: Option<String>| text.unwrap_or_else(|| "–".to_owned());
    let passes: Vec<String> = report.passes.iter().map(|p| format!("{} {}", p.name, duration_ms(p.ms))).collect();
    let cached = if report.cached { " (stored before)" } else { "" };
    format!(
        "<tr><td>{first}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}{cached}</td><td>{}</td></tr>\n",
        escaped(&report.method),
        count(report.triangles_in),
        count(report.triangles),
        count(report.vertices),
        or_dash(report.seams.as_ref().map(|seams| seams.gap_max.to_string())),
        or_dash(report.flipped.map(count)),
        duration_ms(report.total_ms),
        escaped(&passes.join(", ")),
    )
}

fn file_name(path: &str) -> String {
    escaped(&Path::new(path).file_name().map(|name| name.to_string_lossy()).unwrap_or_default())
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_from_outside_cannot_become_markup() {
        assert_eq!(escaped("<a href=\"x\">&"), "&lt;a href=&quot;x&quot;&gt;&amp;");
    }
}
