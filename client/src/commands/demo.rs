//! `displace demo`: the sample data through the same commands a user would type, and a page that shows what
//! came out. Everything lies in one folder: `input/`, meshes, images, `index.html`.

mod input;
mod page;
mod scenes;

use std::{
    fs,
    path::{Path, PathBuf},
    time::Instant,
};

use clap::{ArgMatches, CommandFactory as _, FromArgMatches as _};
use serde_json::{Value, json};

use super::{Session, apply, chart, render, surface::Outcome};
use crate::{
    args::{Cli, Command, DemoArgs},
    error::{Error, Kind, Result},
    output::{Progress, Target, Terminal, bytes, duration_ms},
    report::{self, Written},
};
use scenes::{CHART, SCENES};

/// One command of the demo, done.
struct Step {
    /// As a user in the demo's folder would type it.
    typed: String,
    outcome: Outcome,
}

pub(super) async fn run(session: &Session, args: &DemoArgs, terminal: &mut Terminal<'_>) -> Result<()> {
    let started = Instant::now();
    let folder = prepare(&args.out)?;
    let mut scenes = Vec::with_capacity(SCENES.len());
    for scene in &SCENES {
        let mut steps = Vec::with_capacity(scene.commands.len());
        for typed in scene.commands {
            steps.push(step(session, typed, &folder, terminal.progress()).await?);
        }
        scenes.push(steps);
    }
    let chart = step(session, CHART.commands[0], &folder, terminal.progress()).await?;
    let total_ms = started.elapsed().as_secs_f64() * 1e3;
    let page = folder.join("index.html");
    Target::new(&page)?.write(page::html(&scenes, &chart, total_ms).as_bytes())?;
    scenes.push(vec![chart]);
    tell(&scenes, &page, total_ms, terminal)
}

/// Makes the folder and writes the inputs.
fn prepare(out: &Path) -> Result<PathBuf> {
    let inputs = out.join("input");
    let failed = |path: &Path, e: &std::io::Error| {
        Error::new(Kind::Usage, format!("{} cannot be made a folder: {e}; name another", path.display()))
            .with_field("--out")
    };
    fs::create_dir_all(&inputs).map_err(|e| failed(&inputs, &e))?;
    for (name, content) in input::files()? {
        Target::new(&inputs.join(name))?.write(&content)?;
    }
    out.canonicalize().map_err(|e| failed(out, &e))
}

async fn step(session: &Session, typed: &str, folder: &Path, progress: Progress) -> Result<Step> {
    let (cli, matches) = parse(typed, folder)?;
    let outcome = match &cli.command {
        Command::Apply(args) => apply::perform(session, args, &matches, progress).await,
        Command::Render(args) => render::perform(session, args, &matches, progress).await,
        Command::Chart(args) => chart::perform(session, args, &matches, progress).await,
        _ => Err(Error::internal(format!("the demo has no step '{typed}'"))),
    };
    let outcome =
        outcome.map_err(|e| Error { message: format!("{} (in the demo's step: {typed})", e.message), ..e })?;
    Ok(Step { typed: typed.to_owned(), outcome })
}

impl Step {
    /// What is worth naming: of a chart its page, which leads to all else.
    fn named(&self) -> impl Iterator<Item = &Written> {
        let is_chart = self.outcome.report.chart.is_some();
        self.outcome.written.iter().filter(move |written| !is_chart || written.media_type == "text/html")
    }
}

/// Reads a step as the command line would, its files being those of the demo's folder.
fn parse(typed: &str, folder: &Path) -> Result<(Cli, ArgMatches)> {
    let words = typed.split_whitespace().map(|word| {
        let is_file = scenes::FILE_ENDINGS.iter().any(|ending| word.ends_with(ending));
        let word = word.trim_matches('\'');
        if is_file { folder.join(word).into_os_string() } else { word.into() }
    });
    let broken = |e: clap::Error| Error::internal(format!("the demo's step '{typed}' is wrong: {e}"));
    let matches = Cli::command().try_get_matches_from(words).map_err(broken)?;
    let cli = Cli::from_arg_matches(&matches).map_err(broken)?;
    let matches = matches.subcommand().map(|(_, matches)| matches.clone()).unwrap_or_default();
    Ok((cli, matches))
}

/// Ends by naming the files.
fn tell(scenes: &[Vec<Step>], page: &Path, total_ms: f64, terminal: &mut Terminal<'_>) -> Result<()> {
    let steps = || scenes.iter().flatten();
    let reports: Vec<Value> = steps()
        .map(|step| {
            let mut value = report::json(&step.outcome.report, &step.outcome.written);
            value["command"] = step.typed.as_str().into();
            value
        })
        .collect();
    let mut files: Vec<String> = steps().flat_map(Step::named).map(|written| written.path.clone()).collect();
    files.push(page.display().to_string());
    let mut words = String::new();
    for written in steps().flat_map(Step::named) {
        words += &format!("{}  {}\n", written.path, bytes(written.bytes));
    }
    words += &format!("\n{} commands in {}. Open {}\n", steps().count(), duration_ms(total_ms), page.display());
    terminal.report(&json!({ "files": files, "reports": reports, "total_ms": total_ms }), &words)
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use crate::options;

    #[test]
    fn every_step_is_a_command_line_whose_inputs_are_there() {
        let folder = tempfile::tempdir().unwrap();
        let folder = prepare(&folder.path().join("new/demo")).unwrap();
        let mut outputs = HashSet::new();
        for typed in SCENES.iter().chain([&CHART]).flat_map(|scene| scene.commands) {
            let (cli, matches) = parse(typed, &folder).unwrap();
            let (mesh, output, detail) = match &cli.command {
                Command::Apply(args) => (&args.mesh, args.output.clone().unwrap(), &args.detail),
                Command::Render(args) => (&args.mesh, args.output.clone(), &args.detail),
                Command::Chart(args) => (&args.mesh, args.output.clone(), &args.detail),
                other => panic!("{other:?}"),
            };
            assert!(mesh.is_file(), "{typed}");
            assert!(outputs.insert(output), "{typed} writes a file twice");
            let groups = options::groups(detail, &matches).unwrap();
            let mut parcel = crate::request::Parcel::default();
            parcel.details(&groups).unwrap();
            parcel.mesh(mesh).unwrap();
        }
        assert!(outputs.iter().all(|path| path.starts_with(&folder)), "{outputs:?}");
        let count = |ending: &str| outputs.iter().filter(|path| path.extension().is_some_and(|e| e == ending)).count();
        assert!(count("glb") >= 3 && count("png") >= 5);
    }
}
