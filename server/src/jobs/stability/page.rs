//! The page: a table of all breakdowns, then each failure with its story, its curves and what is published of it. It asks nothing
//! of a network.

use std::fmt::Write as _;

use super::{
    super::chart::{
        page::{STYLE, escaped},
        svg::rounded,
    },
    drawing,
};
use crate::domain::stability::{Scenario, Stability, Worse};

const MORE_STYLE: &str = "\
.holds{color:#2e8b57}.broken{color:#c0392b;font-weight:600}\
nav{columns:3 220px;margin:12px 0 8px}nav a{display:block;padding:2px 0}\
section{margin-top:52px;padding-top:8px;border-top:1px solid var(--line)}\
section .chart{max-width:1000px}td.says{white-space:normal;text-align:left;min-width:22rem;max-width:40rem}td.is,th.is{text-align:left}\
@media(prefers-color-scheme:dark){.holds{color:#6fd39b}.broken{color:#ff7b6b}}";

pub(super) fn html(stability: &Stability) -> String {
    let mut page = head(stability);
    page += &contents(stability);
    for scenario in &stability.scenarios {
        page += &section(scenario, stability);
    }
    page + "<footer>A breakdown is the parameter from which on the metric is beyond the line, between two values by a straight line. Files: \
            <a href=\"stability.csv\">stability.csv</a>, <a href=\"stability.json\">stability.json</a>.</footer>\n</main>\n</html>\n"
}

fn head(stability: &Stability) -> String {
    let Stability { title, device, driver, scenarios } = stability;
    let (title, device, driver) = (escaped(title), escaped(device), escaped(driver));
    let driver = if driver.is_empty() { driver } else { format!(" ({driver})") };
    let checks: u64 = scenarios.iter().map(|scenario| scenario.checks).sum();
    let verdict = match stability.violations() {
        0 => format!("<span class=\"holds\">All {checks} checks of what must hold anywhere held</span>"),
        count => format!("<span class=\"broken\">{count} of {checks} checks of what must hold anywhere failed</span>"),
    };
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n\
         <title>Where methods fail: {title}</title>\n<style>\n{STYLE}{MORE_STYLE}</style>\n<main>\n<h1>Where methods fail: {title}</h1>\n\
         <p>{} scenarios on {device}{driver}. Each sweeps one parameter past the point where a method fails; the dashed line is what still \
         passes. {verdict}: outputs are finite, closed surfaces stay closed, marches are bounded, tolerances are kept or the report says what is, \
         and what is made again is the same to the byte.</p>\n",
        scenarios.len()
    )
}

fn contents(stability: &Stability) -> String {
    let link = |scenario: &Scenario| {
        let breaks = scenario.curves.iter().filter(|curve| curve.breakdown.is_some()).count();
        format!(
            "<a href=\"#{}\">{} <small>{breaks} of {} break</small></a>",
            scenario.name,
            escaped(&scenario.title),
            scenario.curves.len()
        )
    };
    format!("<nav>{}</nav>\n", stability.scenarios.iter().map(link).collect::<String>())
}

fn section(scenario: &Scenario, stability: &Stability) -> String {
    let mut html = format!(
        "<section id=\"{}\">\n<h2>{}</h2>\n<p>{}</p>\n",
        scenario.name,
        escaped(&scenario.title),
        escaped(&scenario.story)
    );
    if let Some(reason) = &scenario.left_out {
        let _ = writeln!(html, "<p class=\"broken\">Not measured: {}</p>", escaped(reason));
        return html + "</section>\n";
    }
    let _ = writeln!(html, "<div class=\"chart\">{}</div>", drawing::element(scenario, stability));
    html += &verdicts(scenario);
    for violation in &scenario.violations {
        let text = format!("{} did not hold {} times, first: {}", violation.rule, violation.count, violation.first);
        let _ = writeln!(html, "<p class=\"broken\">{}</p>", escaped(&text));
    }
    if scenario.violations.is_empty() {
        let _ = writeln!(html, "<p class=\"holds\">{} checks of invariants held.</p>", scenario.checks);
    }
    html + "</section>\n"
}

/// What breaks where, beside what is published.
fn verdicts(scenario: &Scenario) -> String {
    let side = match scenario.worse {
        Worse::Upwards => "up to",
        Worse::Downwards => "down to",
    };
    let mut html = format!(
        "<div class=\"wide\"><table>\n<thead><tr><th scope=\"col\">method</th><th scope=\"col\" class=\"is\">holds {side}</th>\
         <th scope=\"col\" class=\"is\">published</th></tr></thead>\n<tbody>\n"
    );
    for curve in &scenario.curves {
        let at = match curve.breakdown {
            Some(_) if curve.never_passes(scenario.line) => {
                "<span class=\"broken\">nothing that was swept</span>".into()
            }
            Some(at) => format!("<span class=\"broken\">{} {}</span>", rounded(at), escaped(&scenario.unit)),
            None => "<span class=\"holds\">all that was swept</span>".into(),
        };
        let (method, says) = (escaped(&curve.method), escaped(&curve.literature));
        let _ = writeln!(html, "<tr><td>{method}</td><td class=\"is\">{at}</td><td class=\"says\">{says}</td></tr>");
    }
    html + "</tbody>\n</table></div>\n"
}
