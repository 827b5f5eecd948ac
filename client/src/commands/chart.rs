//! `displace chart`: time against error of every method, or where methods fail, in a folder with a page that shows it.

mod stability;

mod told;

use std::{
    fs,
    path::{Path, PathBuf},
};

use clap::ArgMatches;
use displace_proto::v1::{ChartRequest, ChartSweep, Method, Output, RenderRequest};

use super::{
    Session, blocking,
    surface::{Outcome, Surface, save},
};
use crate::{
    args::{ChartArgs, CompressArg, GeometryArgs, MethodArg, SweepArg},
    error::{Error, Kind, Result},
    jobs::{self, Job},
    options,
    output::{Progress, Target, Terminal},
    request,
};

pub(super) async fn run(
    session: &Session,
    args: &ChartArgs,
    matches: &ArgMatches,
    terminal: &mut Terminal<'_>,
) -> Result<()> {
    let Outcome { report, written } = perform(session, args, matches, terminal.progress()).await?;
    let chart = report.chart.as_ref().ok_or_else(|| Error::internal("the server's report holds no chart"))?;
    if let Some(found) = &chart.stability {
        let json = stability::as_json(&report, chart, found, &written);
        return terminal.report(&json, &stability::words(&report, found, &args.output));
    }
    terminal.report(&told::as_json(&report, chart, &written), &told::words(&report, chart, &args.output))
}

pub(super) async fn perform(
    session: &Session,
    args: &ChartArgs,
    matches: &ArgMatches,
    progress: Progress,
) -> Result<Outcome> {
    let (message, parcel) = request(session, args, matches).await?;
    let folder = folder(&args.output)?;
    let connection = session.connection().await?;
    let mut result = jobs::run(connection, &Job::Chart(Box::new(message)), &parcel.blobs, progress).await?;
    let written = save(connection, &placed(std::mem::take(&mut result.outputs), &folder)?, progress).await?;
    Ok(Outcome::new(result, &parcel.notes, written))
}

async fn request(session: &Session, args: &ChartArgs, matches: &ArgMatches) -> Result<(ChartRequest, request::Parcel)> {
    let surface = Surface {
        mesh: args.mesh.clone(),
        groups: options::groups(&args.detail, matches)?,
        geometry: GeometryArgs::default(),
        look: args.look.clone(),
        method: MethodArg::Flat,
        compress: CompressArg::None,
        lods: 0,
    };
    let (mut surface, mut parcel) = surface.request(session).await?;
    // The chart's own to choose.
    (surface.geometry, surface.method) = (None, Method::Unspecified.into());
    let environment = args.light.env.clone();
    let (parcel, environment) = blocking(move || {
        let environment = environment.map(|path| parcel.environment(&path)).transpose()?;
        Ok((parcel, environment))
    })
    .await?;
    let render = RenderRequest {
        surface: Some(surface),
        views: vec![request::view(&args.camera)],
        lighting: Some(request::lighting(&args.look, &args.light, environment)),
        ..RenderRequest::default()
    };
    let (repeats, truth_samples) = (Some(args.repeats), Some(args.truth_samples));
    let sweeps = args.sweep.iter().map(|sweep| asked_sweep(*sweep).into()).collect();
    Ok((ChartRequest { render: Some(render), repeats, truth_samples, sweeps, stability: args.stability }, parcel))
}

fn asked_sweep(sweep: SweepArg) -> ChartSweep {
    match sweep {
        SweepArg::Angle => ChartSweep::Angle,
        SweepArg::Distance => ChartSweep::Distance,
        SweepArg::Amplitude => ChartSweep::Amplitude,
    }
}

fn folder(path: &Path) -> Result<PathBuf> {
    fs::create_dir_all(path).map_err(|e| {
        let message = format!("{} cannot be made a folder: {e}; name another", path.display());
        Error::new(Kind::Usage, message).with_field("--output")
    })?;
    Ok(path.to_owned())
}

/// Each under its own name, which leads nowhere else.
fn placed(outputs: Vec<Output>, folder: &Path) -> Result<Vec<(Output, Target)>> {
    let place = |output: Output| {
        let name = Path::new(&output.name);
        if name.file_name() != Some(name.as_os_str()) {
            return Err(Error::internal(format!(
                "the server named an output '{}', which is no file name",
                output.name
            )));
        }
        let target = Target::new(&folder.join(name))?;
        Ok((output, target))
    };
    outputs.into_iter().map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_output_lies_outside_of_the_folder() {
        let folder = tempfile::tempdir().unwrap();
        let output = |name: &str| Output { name: name.into(), ..Output::default() };
        for bad in ["../x.png", "/etc/x", "a/b.png", "", ".."] {
            assert!(placed(vec![output(bad)], folder.path()).is_err(), "{bad}");
        }
        assert!(placed(vec![output("relief-16.png")], folder.path()).is_ok());
    }
}
