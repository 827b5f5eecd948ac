//! The job that charts time against error: the truth, then every setting of every method beside it.

pub(super) mod lens;
mod page;
mod pareto;
mod svg;
mod sweep;
mod table;
mod truth;

use super::{Output, Work, WorkContext, WorkOutput, render::image_bytes, work::canonical};
use crate::domain::{
    Error, ErrorKind, Result,
    chart::{Candidate, Chart, ChartRequest, LeftOut, Metric},
    report::{Report, Warning},
};
use sweep::{Shown, Sweep};
use truth::Truth;

/// Images held at once: the truth, one that is made again, and what comparing them takes.
const IMAGES: u64 = 4;
/// Triangles that uniform levels may have for each pixel.
const TRIANGLES_PER_PIXEL: u64 = 2;

pub(super) struct ChartWork {
    pub(super) request: ChartRequest,
}

impl Work for ChartWork {
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
        inputs.saturating_add(IMAGES * image_bytes(&self.request.truth))
    }

    fn run(&self, context: &WorkContext<'_>) -> Result<WorkOutput> {
        let truth = truth::take(context, &self.request.truth)?;
        let candidates = self.candidates(&truth);
        let mut sweep = Sweep::new(context, &self.request, &truth);
        let (mut shown, mut left_out) = (Vec::new(), self.request.left_out.clone());
        for (done, candidate) in candidates.iter().enumerate() {
            context.cancel.check()?;
            context.progress.pass(&candidate.label(), done as u64, candidates.len() as u64);
            match sweep.show(candidate) {
                Ok(one) => shown.push(one),
                Err(error) if ends_the_job(&error) => return Err(error),
                Err(error) => left_out.push(told(*candidate, &error)),
            }
        }
        let times = std::mem::take(&mut sweep.passes);
        let (images, chart) = self.charted(context, &truth, shown);
        let mut report = report(&truth, &left_out);
        super::inputs::add_times(&mut report.passes, times);
        let mut outputs = documents(&chart, &report.warnings)?;
        outputs.push(png("truth.png".into(), truth.png));
        outputs.extend(images);
        report.chart = Some(chart);
        Ok(WorkOutput { report, outputs })
    }
}

impl ChartWork {
    fn candidates(&self, truth: &Truth) -> Vec<Candidate> {
        let ChartRequest { truth: request, candidates, .. } = &self.request;
        let most = TRIANGLES_PER_PIXEL * u64::from(request.width) * u64::from(request.height);
        let displacing = request.surface.method;
        let levels = displacing.moves_vertices().then(|| Candidate::levels(displacing, truth.triangles_in, most));
        candidates.iter().copied().chain(levels.into_iter().flatten()).collect()
    }

    fn charted(&self, context: &WorkContext<'_>, truth: &Truth, shown: Vec<Shown>) -> (Vec<Output>, Chart) {
        let (mut images, mut points) = (Vec::new(), Vec::new());
        for Shown { point, image, difference, .. } in shown {
            images.push(png(format!("{}.png", point.name), image));
            images.push(png(format!("{}-difference.png", point.name), difference));
            points.push(point);
        }
        pareto::mark(&mut points);
        let chart = Chart {
            title: truth.title.clone(),
            device: context.executor.device_name().into(),
            driver: context.executor.driver().into(),
            width: self.request.truth.width,
            height: self.request.truth.height,
            truth_samples: truth.samples,
            truth_ms: truth.ms,
            points,
        };
        (images, chart)
    }
}

/// What a setting cannot help, and what would be the same for all others.
fn ends_the_job(error: &Error) -> bool {
    use ErrorKind::{Busy, Cancelled, DataLoss, Missing, Unavailable};
    matches!(error.kind, Cancelled | Unavailable | DataLoss | Missing(_) | Busy { .. })
}

fn told(candidate: Candidate, error: &Error) -> LeftOut {
    if error.kind == ErrorKind::Internal {
        tracing::error!(%error, cause = ?error.cause, setting = candidate.label(), "a setting is left out of a chart");
    }
    LeftOut { candidate, reason: error.to_string() }
}

fn report(truth: &Truth, left_out: &[LeftOut]) -> Report {
    let warnings = truth.warnings.iter().cloned().chain(LeftOut::warnings(left_out)).collect();
    Report { triangles_in: truth.triangles_in, warnings, passes: truth.passes.clone(), ..Report::default() }
}

fn png(name: String, bytes: Vec<u8>) -> Output {
    Output { name, media_type: "image/png".into(), bytes: bytes.into() }
}

/// What tells of all points.
fn documents(chart: &Chart, warnings: &[Warning]) -> Result<Vec<Output>> {
    let made = [
        ("chart.csv", "text/csv", table::csv(chart)),
        ("chart.json", "application/json", table::json(chart, warnings)?),
        ("chart.svg", "image/svg+xml", svg::document(chart, Metric::Flip)),
        ("index.html", "text/html", page::html(chart, warnings)),
    ];
    let output = |(name, media_type, text): (&str, &str, String)| Output {
        name: name.into(),
        media_type: media_type.into(),
        bytes: text.into_bytes().into(),
    };
    Ok(made.into_iter().map(output).collect())
}
