//! The job that looks for where methods fail: each scenario sweeps one parameter and measures one metric of every method it
//! is about, on the device or on the f64 twins of its passes.
//!
//! | file | holds |
//! |---|---|
//! | `table.rs`, `row.rs` | every scenario, and what one says of itself |
//! | `lab.rs`, `judge.rs` | where they are measured, watched for what must hold anywhere; where a method breaks |
//! | `sweep.rs`, `rays.rs` | methods that work per pixel, along the same rays as the truth |
//! | `meshes.rs`, `images.rs`, `own.rs` | what is made for scenarios, and what the request has |
//! | `page.rs`, `drawing.rs`, `written.rs` | what is written of it |
//! | the others | a scenario each, or those that sweep the same |

mod bounds;
mod cracks;
mod drawing;
mod factors;
mod foldover;
mod grazing;
mod grazing_images;
mod highlights;
mod images;
mod judge;
mod lab;
mod meshes;
mod outlines;
mod own;
mod page;
mod pops;
mod posts;
mod rays;
mod row;
mod scales;
mod seams;
mod steps;
mod sweep;
mod swimming;
mod table;
mod tangents;
mod terraces;
mod written;

use super::{Output, Work, WorkContext, WorkOutput, work::canonical};
use crate::domain::{
    Error, ErrorKind, Result,
    chart::ChartRequest,
    report::{Report, Warning},
    stability::{Curve, Scenario, Stability},
};
use lab::Lab;
use own::Own;
use row::{Asset, Row};

/// What scenarios hold at once, at most.
const HOST_BYTES: u64 = 1 << 28;

pub(super) struct StabilityWork {
    pub(super) request: ChartRequest,
}

impl Work for StabilityWork {
    fn kind(&self) -> &'static str {
        "chart"
    }

    fn method(&self) -> &'static str {
        "all"
    }

    fn canonical(&self) -> Vec<u8> {
        canonical(&self.request)
    }

    fn host_bytes(&self) -> u64 {
        let inputs: u64 = self.request.assets().iter().map(|asset| asset.size_bytes).sum();
        inputs.saturating_add(HOST_BYTES)
    }

    fn run(&self, context: &WorkContext<'_>) -> Result<WorkOutput> {
        let own = Own::load(context, &self.request.truth.surface)?;
        let mut scenarios = Vec::new();
        for (done, row) in table::TABLE.iter().enumerate() {
            context.cancel.check()?;
            context.progress.pass(row.name, done as u64, table::TABLE.len() as u64);
            scenarios.push(scenario(context, &own, row)?);
        }
        let stability = Stability {
            title: own.title.clone(),
            device: context.executor.device_name().into(),
            driver: context.executor.driver().into(),
            scenarios,
        };
        let outputs = outputs(&stability)?;
        let warnings = own.inputs.scene.warnings.iter().cloned().chain(warnings(&stability)).collect();
        let triangles_in = own.inputs.estimate().triangles_in;
        let report = Report { triangles_in, warnings, stability: Some(stability), ..Report::default() };
        Ok(WorkOutput { report, outputs })
    }
}

/// One row, measured. What the device cannot do is left out; a lost device and a cancel end the job.
fn scenario(context: &WorkContext<'_>, own: &Own, row: &Row) -> Result<Scenario> {
    let lab = Lab::new(context, own);
    let (mut curves, left_out) = match (row.run)(&lab) {
        Ok(curves) => (curves, None),
        Err(error) if super::chart::ends_the_job(&error) => return Err(error),
        Err(error) => (Vec::new(), Some(told(row, &error))),
    };
    curves.iter_mut().for_each(|curve| judged(curve, row));
    let (checks, violations) = lab.into_ledger().told();
    Ok(Scenario {
        name: row.name.into(),
        family: row.family.into(),
        title: row.title.into(),
        story: row.story.into(),
        asset: asset(row, own),
        parameter: row.parameter[0].into(),
        unit: row.parameter[1].into(),
        metric: row.metric[0].into(),
        metric_unit: row.metric[1].into(),
        line: row.line,
        worse: row.worse,
        curves,
        checks,
        violations,
        left_out,
    })
}

fn told(row: &Row, error: &Error) -> String {
    if error.kind == ErrorKind::Internal {
        tracing::error!(%error, cause = ?error.cause, scenario = row.name, "a scenario is left out");
    }
    error.to_string()
}

fn judged(curve: &mut Curve, row: &Row) {
    curve.breakdown = judge::breakdown(&curve.values, row.line, row.worse);
    let known = row.literature.iter().find(|(method, _)| *method == curve.method);
    curve.literature = known.map(|(_, says)| (*says).to_owned()).unwrap_or_default();
}

fn asset(row: &Row, own: &Own) -> String {
    match row.asset {
        Asset::Made(what) => what.into(),
        Asset::OwnHeights => own.heights_are.clone(),
        Asset::OwnSurface => "mesh and detail of the request".into(),
    }
}

/// What did not hold, and what was not measured.
fn warnings(stability: &Stability) -> Vec<Warning> {
    let of = |scenario: &Scenario| {
        let broken = scenario.violations.iter().map(|violation| {
            let message = format!(
                "{}: {} did not hold {} times, first {}",
                scenario.name, violation.rule, violation.count, violation.first
            );
            Warning::new("invariant_broken", message)
        });
        let left_out = scenario
            .left_out
            .iter()
            .map(|reason| Warning::new("left_out", format!("{} is not measured: {reason}", scenario.name)));
        broken.chain(left_out).collect::<Vec<_>>()
    };
    stability.scenarios.iter().flat_map(of).collect()
}

fn outputs(stability: &Stability) -> Result<Vec<Output>> {
    let output = |name: String, media_type: &str, text: String| Output {
        name,
        media_type: media_type.into(),
        bytes: text.into_bytes().into(),
    };
    let mut outputs = vec![
        output("stability.csv".into(), "text/csv", written::csv(stability)),
        output("stability.json".into(), "application/json", written::json(stability)?),
        output("index.html".into(), "text/html", page::html(stability)),
    ];
    for scenario in stability.scenarios.iter().filter(|scenario| !scenario.curves.is_empty()) {
        let svg = drawing::document(scenario, stability);
        outputs.push(output(format!("{}.svg", scenario.name), "image/svg+xml", svg));
    }
    Ok(outputs)
}

#[cfg(test)]
mod tests;
