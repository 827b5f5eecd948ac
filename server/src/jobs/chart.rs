//! The job that charts time against error: the truth, then every setting of every method beside it.

mod chosen;
pub(super) mod page;
mod pareto;
mod settings;
pub(super) mod svg;
mod sweeps;
mod table;
mod truth;

use super::{Output, Work, WorkContext, WorkOutput, render::image_bytes, work::canonical};
use crate::domain::{
    Error, ErrorKind, Result,
    chart::{Candidate, Chart, ChartRequest, LeftOut},
    report::{Report, Warning},
};
use settings::{Read, Settings, Shown};
use sweeps::Stand;
use truth::{Ground, Truth};

/// Images held at once: the truth, one that is made again, and what comparing them takes.
const IMAGES: u64 = 4;
/// Triangles that uniform levels may have for each pixel.
const TRIANGLES_PER_PIXEL: u64 = 2;
const SVG: &str = "image/svg+xml";

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
        let ground = truth::ground(context, &self.request.truth)?;
        let truth = truth::take(context, &self.request.truth, &ground)?;
        let mut settings = Settings::new(context, &self.request, &truth, Read::keeping(1));
        let (shown, left_out) = self.shown(context, &ground, &mut settings)?;
        let times = std::mem::take(&mut settings.passes);
        drop(settings);
        let swept = sweeps::all(context, &self.request, &Stand::new(&ground.scene))?;
        let mut shown = shown;
        chosen::mark(context, &self.request.truth, &truth, &mut shown)?;
        let (images, mut chart) = self.charted(context, &ground.title, &truth, shown);
        chart.sweeps = swept.points;
        let mut report = report(&ground, &left_out, swept.warnings);
        for times in [truth.passes, times, swept.passes] {
            super::inputs::add_times(&mut report.passes, times);
        }
        let mut outputs = documents(&chart, &report.warnings)?;
        outputs.push(png("truth.png".into(), truth.png));
        outputs.extend(images);
        report.chart = Some(chart);
        Ok(WorkOutput { report, outputs })
    }
}

impl ChartWork {
    /// Every setting, and those that failed.
    fn shown(
        &self,
        context: &WorkContext<'_>,
        ground: &Ground,
        settings: &mut Settings<'_>,
    ) -> Result<(Vec<Shown>, Vec<LeftOut>)> {
        let candidates = self.candidates(ground);
        let (mut shown, mut left_out) = (Vec::new(), self.request.left_out.clone());
        for (done, candidate) in candidates.iter().enumerate() {
            context.cancel.check()?;
            context.progress.pass(&candidate.label(), done as u64, candidates.len() as u64);
            match settings.show(candidate) {
                Ok(one) => shown.push(one),
                Err(error) if ends_the_job(&error) => return Err(error),
                Err(error) => left_out.push(told(*candidate, &error)),
            }
        }
        Ok((shown, left_out))
    }

    fn candidates(&self, ground: &Ground) -> Vec<Candidate> {
        let ChartRequest { truth: request, candidates, .. } = &self.request;
        let most = TRIANGLES_PER_PIXEL * u64::from(request.width) * u64::from(request.height);
        let displacing = request.surface.method;
        let levels = displacing.moves_vertices().then(|| Candidate::levels(displacing, ground.triangles_in, most));
        candidates.iter().copied().chain(levels.into_iter().flatten()).collect()
    }

    fn charted(
        &self,
        context: &WorkContext<'_>,
        title: &str,
        truth: &Truth<'_>,
        shown: Vec<Shown>,
    ) -> (Vec<Output>, Chart) {
        let (mut images, mut points) = (Vec::new(), Vec::new());
        for Shown { point, image, difference, .. } in shown {
            images.push(png(format!("{}.png", point.name), image));
            images.push(png(format!("{}-difference.png", point.name), difference));
            points.push(point);
        }
        pareto::mark(&mut points);
        let chart = Chart {
            title: title.into(),
            device: context.executor.device_name().into(),
            driver: context.executor.driver().into(),
            width: self.request.truth.width,
            height: self.request.truth.height,
            truth_samples: truth.samples,
            truth_ms: truth.ms,
            points,
            sweeps: Vec::new(),
        };
        (images, chart)
    }
}

/// What a setting cannot help, and what would be the same for all others.
pub(super) fn ends_the_job(error: &Error) -> bool {
    use ErrorKind::{Busy, Cancelled, DataLoss, Missing, Unavailable};
    matches!(error.kind, Cancelled | Unavailable | DataLoss | Missing(_) | Busy { .. })
}

fn told(candidate: Candidate, error: &Error) -> LeftOut {
    if error.kind == ErrorKind::Internal {
        tracing::error!(%error, cause = ?error.cause, setting = candidate.label(), "a setting is left out of a chart");
    }
    LeftOut { candidate, reason: error.to_string() }
}

fn report(ground: &Ground, left_out: &[LeftOut], of_sweeps: Vec<Warning>) -> Report {
    let warnings = ground.warnings.iter().cloned().chain(LeftOut::warnings(left_out)).chain(of_sweeps).collect();
    Report { triangles_in: ground.triangles_in, warnings, passes: ground.passes.clone(), ..Report::default() }
}

fn png(name: String, bytes: Vec<u8>) -> Output {
    Output { name, media_type: "image/png".into(), bytes: bytes.into() }
}

/// What tells of all points.
fn documents(chart: &Chart, warnings: &[Warning]) -> Result<Vec<Output>> {
    let mut made = vec![
        ("chart.csv".to_owned(), "text/csv", table::csv(chart)),
        ("chart.json".to_owned(), "application/json", table::json(chart, warnings)?),
        ("index.html".to_owned(), "text/html", page::html(chart, warnings)),
    ];
    made.extend(drawings(chart));
    if !chart.sweeps.is_empty() {
        made.push(("errors.csv".to_owned(), "text/csv", table::errors(chart)));
    }
    let output = |(name, media_type, text): (String, &str, String)| Output {
        name,
        media_type: media_type.into(),
        bytes: text.into_bytes().into(),
    };
    Ok(made.into_iter().map(output).collect())
}

/// Every drawing of a chart: names, media types and texts.
#[must_use]
pub fn drawings(chart: &Chart) -> Vec<(String, &'static str, String)> {
    let mut drawings = vec![("chart.svg".to_owned(), SVG, svg::document(chart))];
    for sweep in chart.swept() {
        drawings.push((format!("errors-{}.svg", sweep.name()), SVG, svg::sweep_document(chart, sweep)));
    }
    drawings
}
