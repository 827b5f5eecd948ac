//! Error as one thing changes and all else stays: a small chart at every value, of each method by one setting.
//!
//! | file | what changes |
//! |---|---|
//! | `sweeps/angle.rs` | the angle at which the surface is seen |
//! | `sweeps/distance.rs` | how far away it is |
//! | `sweeps/amplitude.rs` | the scale of the detail |
//!
//! A further sweep is a file, its row in `ROWS`, and its name in `domain/chart/sweep.rs` and the API.

mod amplitude;
mod angle;
mod distance;
mod stand;

use super::{
    ends_the_job,
    settings::{Read, Settings},
    truth,
};
use crate::{
    domain::{
        Result,
        cancel::NoProgress,
        chart::{Candidate, ChartRequest, Sweep, SweepPoint},
        report::{PassTime, Warning},
        request::RenderRequest,
    },
    jobs::{WorkContext, inputs},
};
pub(super) use stand::Stand;

/// The longer side of the images, pixels, and rays a pixel of the truth, at most: sweeps are many images.
const MOST_PX: u32 = 128;
const MOST_SAMPLES: u32 = 16;

/// How one sweep is made.
pub(super) struct Row {
    pub(super) sweep: Sweep,
    /// Of its axis.
    pub(super) label: &'static str,
    /// What a value is followed by.
    pub(super) unit: &'static str,
    /// What is tried, in rising order.
    values: &'static [f64],
    /// Whether only the view changes, so that what was read is read once.
    keeps_surface: bool,
    vary: fn(&mut RenderRequest, &Stand, f64),
}

const ROWS: [Row; 3] = [angle::ROW, distance::ROW, amplitude::ROW];

pub(super) fn row(sweep: Sweep) -> &'static Row {
    ROWS.iter().find(|row| row.sweep == sweep).unwrap_or(&ROWS[0])
}

/// What came of sweeps.
#[derive(Default)]
pub(super) struct Swept {
    pub(super) points: Vec<SweepPoint>,
    pub(super) warnings: Vec<Warning>,
    pub(super) passes: Vec<PassTime>,
}

/// All that the request asks for, around where the chart is taken from.
pub(super) fn all(context: &WorkContext<'_>, request: &ChartRequest, stand: &Stand) -> Result<Swept> {
    let mut swept = Swept::default();
    for sweep in &request.sweeps {
        swept.sweep(context, request, stand, row(*sweep))?;
    }
    Ok(swept)
}

impl Swept {
    fn sweep(
        &mut self,
        context: &WorkContext<'_>,
        request: &ChartRequest,
        stand: &Stand,
        row: &'static Row,
    ) -> Result<()> {
        let kinds = if row.keeps_surface { usize::MAX } else { 1 };
        let mut read = Read::keeping(kinds);
        for (done, value) in row.values.iter().enumerate() {
            context.cancel.check()?;
            context.progress.pass(row.sweep.name(), done as u64, row.values.len() as u64);
            let varied = varied(request, stand, row, *value);
            read = match self.value(context, &varied, row, *value, read) {
                Ok(read) if row.keeps_surface => read,
                Ok(_) => Read::keeping(kinds),
                Err(error) if ends_the_job(&error) => return Err(error),
                Err(error) => {
                    let message = format!("{} is not charted: {error}", told(row, *value));
                    self.warnings.push(Warning::new("left_out", message));
                    Read::keeping(kinds)
                }
            };
        }
        Ok(())
    }

    /// Every method at one value; those that fail are left out here.
    fn value(
        &mut self,
        context: &WorkContext<'_>,
        request: &ChartRequest,
        row: &Row,
        value: f64,
        read: Read,
    ) -> Result<Read> {
        // What one value's passes tell is not the job's.
        let context = &WorkContext { progress: &NoProgress, ..*context };
        let ground = truth::ground(context, &request.truth)?;
        let truth = truth::take(context, &request.truth, &ground)?;
        let mut settings = Settings::new(context, request, &truth, read);
        let mut left_out = Vec::new();
        for candidate in &request.candidates {
            context.cancel.check()?;
            match settings.show(candidate) {
                Ok(shown) => self.points.push(point(row.sweep, value, shown.point)),
                Err(error) if ends_the_job(&error) => return Err(error),
                Err(error) => left_out.push(super::told(*candidate, &error)),
            }
        }
        let told =
            |warning: Warning| Warning { message: format!("{}: {}", told(row, value), warning.message), ..warning };
        self.warnings.extend(super::LeftOut::warnings(&left_out).into_iter().map(told));
        for times in [ground.passes.clone(), truth.passes.clone(), std::mem::take(&mut settings.passes)] {
            inputs::add_times(&mut self.passes, times);
        }
        Ok(settings.into_read())
    }
}

fn point(sweep: Sweep, value: f64, point: crate::domain::chart::Point) -> SweepPoint {
    let crate::domain::chart::Point { method, setting, triangles, ms, error, .. } = point;
    SweepPoint { sweep, value, method, setting, triangles, ms, error }
}

fn told(row: &Row, value: f64) -> String {
    format!("{} {value}", row.sweep.name())
}

/// The chart's own request, small, once each, and with what the sweep changes.
fn varied(request: &ChartRequest, stand: &Stand, row: &Row, value: f64) -> ChartRequest {
    let mut truth = request.truth.clone();
    let share = (f64::from(MOST_PX) / f64::from(truth.width.max(truth.height))).min(1.0);
    [truth.width, truth.height] = [truth.width, truth.height].map(|px| (f64::from(px) * share).round().max(1.0) as u32);
    truth.samples = truth.samples.map(|samples| samples.min(MOST_SAMPLES));
    (row.vary)(&mut truth, stand, value);
    let candidates = request.candidates.iter().copied().filter(Candidate::is_swept).collect();
    ChartRequest { truth, repeats: 1, candidates, left_out: Vec::new(), sweeps: Vec::new(), stability: false }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sweep_has_a_row_of_rising_values() {
        for sweep in Sweep::ALL {
            let row = row(sweep);
            assert_eq!(row.sweep, sweep);
            assert!(row.values.is_sorted_by(|a, b| 0.0 < *a && a < b), "{}", sweep.name());
        }
    }
}
