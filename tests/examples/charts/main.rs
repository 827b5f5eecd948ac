//! The charts of five sets under `tests/charts/sets`: error against time, and where methods break.
//!
//! `cargo chart` draws them and their page again from the figures that lie beside them; nothing is measured.
//! `cargo chart measure [SET ...]` measures all sets, or those, on this machine, and draws. Two sets are of the maps of
//! `DISPLACE_CORPUS`. `CHART_DEVICE` names the device.

#[path = "../gallery/maps.rs"]
mod maps;
mod page;
mod sets;
mod words;

use std::{
    env,
    error::Error,
    fs,
    path::{Path, PathBuf},
    process::{Command, ExitCode},
};

use displace_server::domain::chart::Chart;
use displace_tests::data::package;
use sets::{SETS, Set};

/// What went wrong, in words.
pub(crate) type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// All files together.
const MOST_BYTES: u64 = 1_500_000;
/// The word by which this program is told to be the command line.
const DISPLACE: &str = "displace";

fn main() -> ExitCode {
    let words: Vec<String> = env::args().skip(1).collect();
    if words.first().is_some_and(|word| word == DISPLACE) {
        return ExitCode::from(displace_client::run(words, &mut std::io::stdout(), &mut std::io::stderr()));
    }
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let done = match words[..] {
        [] | ["redraw"] => redraw(),
        ["measure", ref names @ ..] => measure(names).and_then(|()| redraw()),
        _ => Err("say nothing or 'redraw' to draw, 'measure [SET ...]' to measure".into()),
    };
    let Err(error) = done else { return ExitCode::SUCCESS };
    eprintln!("chart: {error}");
    ExitCode::FAILURE
}

fn folder() -> PathBuf {
    package().join("charts/sets")
}

/// Keeps of each set what nobody can compute again: the figures.
fn measure(names: &[&str]) -> Result<()> {
    let scratch = tempfile::tempdir()?;
    maps::write(scratch.path())?;
    for set in SETS.iter().filter(|set| names.is_empty() || names.contains(&set.name)) {
        sets::write(set, scratch.path())?;
        charted(set, scratch.path())?;
        let kept = folder().join(set.name);
        fs::create_dir_all(&kept)?;
        for name in ["chart.csv", "errors.csv", "chart.json"] {
            fs::copy(scratch.path().join(set.name).join(name), kept.join(name))?;
        }
        println!("{} is measured", set.name);
    }
    Ok(())
}

/// Runs the command line, with a store of its own.
fn charted(set: &Set, scratch: &Path) -> Result<()> {
    let mut command = Command::new(env::current_exe()?);
    command.env("XDG_DATA_HOME", scratch.join("data")).env_remove("DISPLACE_SERVER").current_dir(scratch);
    command.args(set.command.split_whitespace()).args(["-o", set.name]);
    if let Ok(device) = env::var("CHART_DEVICE") {
        command.args(["--device", &device]);
    }
    let done = command.output()?;
    if done.status.success() {
        return Ok(());
    }
    Err(format!("{}\n{}", set.command, String::from_utf8_lossy(&done.stderr)).into())
}

fn redraw() -> Result<()> {
    let folder = folder();
    let mut charts = Vec::new();
    for set in &SETS {
        let path = folder.join(set.name).join("chart.json");
        let text = fs::read(&path).map_err(|error| format!("{}: {error}; measure it first", path.display()))?;
        let chart: Chart = serde_json::from_slice(&text)?;
        for (name, _, svg) in displace_server::jobs::chart_drawings(&chart) {
            fs::write(folder.join(set.name).join(name), without_images(svg, &chart))?;
        }
        charts.push((set, chart));
    }
    fs::write(folder.join("index.html"), page::html(&charts))?;
    let bytes = bytes_of(&folder)?;
    if bytes > MOST_BYTES {
        return Err(format!("the charts have {bytes} bytes; at most {MOST_BYTES} are committed").into());
    }
    println!("{} has {bytes} bytes", folder.display());
    Ok(())
}

/// Images of points are not kept, so nothing leads to them.
fn without_images(svg: String, chart: &Chart) -> String {
    chart.points.iter().fold(svg, |svg, point| svg.replace(&format!("<a href=\"{}.png\"", point.name), "<a"))
}

fn bytes_of(folder: &Path) -> Result<u64> {
    let mut bytes = 0;
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        bytes += if entry.file_type()?.is_dir() { bytes_of(&entry.path())? } else { entry.metadata()?.len() };
    }
    Ok(bytes)
}
