//! The job that makes images one after the other: cameras first, then what their triangles are, then frame by frame.

mod cameras;
mod film;
mod pop;
mod stock;

use super::{Output, Work, WorkContext, WorkOutput, inputs::Inputs, reliefs, render::image_bytes, work::canonical};
use crate::domain::{
    Result,
    report::{Report, Warning},
    request::ImageFormat,
    sequence::{Frame, SequenceReport, SequenceRequest},
};
use film::Film;

/// Warnings of one kind that are told; every tessellation may have its own.
const MOST_ALIKE: usize = 4;

pub(super) struct SequenceWork {
    pub(super) request: SequenceRequest,
}

impl Work for SequenceWork {
    fn kind(&self) -> &'static str {
        "sequence"
    }

    fn method(&self) -> &'static str {
        self.request.render.surface.method.name()
    }

    fn canonical(&self) -> Vec<u8> {
        canonical(&self.request)
    }

    fn host_bytes(&self) -> u64 {
        let inputs: u64 = self.request.assets().iter().map(|asset| asset.size_bytes).sum();
        inputs.saturating_add(image_bytes(&self.request.render)).saturating_add(self.request.output_bytes())
    }

    fn run(&self, context: &WorkContext<'_>) -> Result<WorkOutput> {
        let request = &self.request;
        let mut inputs = Inputs::load(context.assets, context.limits, &context.job(), &request.render.surface)?;
        reliefs::check(&inputs, &request.render, context)?;
        let device = context.executor.device_name().to_owned();
        let mut report = Report { method: self.method().into(), device, ..Report::default() };
        inputs.count(&mut report);
        report.passes = inputs.take_passes();
        let cameras = cameras::of(context, &mut inputs, request, &mut report)?;
        let count = cameras.each.len();
        let mut film = Film::new(context, request, cameras, inputs, report);
        let (mut frames, mut outputs) = (Vec::new(), Vec::new());
        for number in 0..count {
            context.cancel.check()?;
            context.progress.pass("frame", number as u64, count as u64);
            let (frame, files) = film.frame(number)?;
            frames.push(frame);
            outputs.extend(files.into_iter().map(|file| output(number, request.render.format, file)));
        }
        Ok(WorkOutput { report: told(film, frames), outputs })
    }
}

fn output(number: usize, format: ImageFormat, file: crate::domain::encode::EncodedImage) -> Output {
    let ending = match format {
        ImageFormat::Png => "png",
        ImageFormat::Exr => "exr",
    };
    let name = format!("{number:04}.{}.{ending}", file.name);
    Output { name, media_type: file.media_type.into(), bytes: file.bytes.into() }
}

fn told(film: Film<'_>, frames: Vec<Frame>) -> Report {
    let (mut report, warnings, tessellations) = film.finished();
    report.warnings = gathered(warnings);
    report.triangles = frames.iter().map(|frame| frame.triangles).max().unwrap_or(0);
    let worst_pop_px = frames.iter().map(|frame| frame.pop_px).fold(0.0, f64::max);
    report.sequence = Some(SequenceReport { frames, worst_pop_px, tessellations });
    report
}

/// Each once, and a few of each kind.
fn gathered(warnings: Vec<Warning>) -> Vec<Warning> {
    let mut kept: Vec<Warning> = Vec::new();
    for warning in warnings {
        let alike = kept.iter().filter(|other| other.code == warning.code).count();
        if alike < MOST_ALIKE && !kept.contains(&warning) {
            kept.push(warning);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_warnings_that_every_tessellation_has_a_few_are_told() {
        let warning = |code: &str, n: u32| Warning::new(code, n.to_string());
        let all = (0..50).flat_map(|n| [warning("clamped", n), warning("other", 7)]).collect();
        let kept = gathered(all);
        assert_eq!(kept.len(), MOST_ALIKE + 1);
        assert_eq!(kept.iter().filter(|w| w.code == "other").count(), 1);
    }
}
