//! The command line `displace`: parses flags, uploads meshes and maps, runs jobs on a Displace server (one
//! elsewhere, or one in this process), and writes what comes back.
//!
//! `args` is what was typed, `options` what it means, `request` what goes to the server; `connection`,
//! `transfer` and `jobs` speak to it; `commands` has one file per command; `output` is all the user sees.

mod args;
mod commands;
mod connection;
mod convert;
mod error;
mod jobs;
mod mesh_files;
mod options;
mod output;
mod report;
mod request;
mod transfer;

use std::{
    ffi::OsString,
    io::{IsTerminal, Write},
    process::ExitCode,
    time::Duration,
};

use args::{Cli, Global};
use clap::{ArgMatches, CommandFactory, FromArgMatches, error::ContextKind};
use commands::Session;
use error::{Error, Kind, Result};
use output::Terminal;
use tracing_subscriber::{Layer as _, filter::Targets, layer::SubscriberExt as _, util::SubscriberInitExt as _};

/// Runs the command line of this process.
pub fn main() -> ExitCode {
    let interactive = std::io::stderr().is_terminal();
    ExitCode::from(execute(std::env::args_os(), &mut std::io::stdout(), &mut std::io::stderr(), interactive))
}

/// Runs a command line as `displace` would, its name included, and returns the exit code.
pub fn run<I>(args: I, stdout: &mut (dyn Write + Send), stderr: &mut (dyn Write + Send)) -> u8
where
    I: IntoIterator,
    I::Item: Into<OsString>,
{
    execute(args.into_iter().map(Into::into), stdout, stderr, false)
}

fn execute(
    args: impl Iterator<Item = OsString>,
    stdout: &mut (dyn Write + Send),
    stderr: &mut (dyn Write + Send),
    interactive: bool,
) -> u8 {
    let args: Vec<OsString> = args.collect();
    let json = args.iter().any(|arg| arg == "--json");
    let mut terminal = Terminal { stdout, stderr, interactive, json, quiet: false };
    let outcome = match parse(&args) {
        Ok((cli, matches)) => {
            (terminal.json, terminal.quiet) = (cli.global.json, cli.global.quiet);
            dispatch(cli, &matches, &mut terminal)
        }
        Err(refusal) => return refuse(&refusal, &mut terminal),
    };
    match outcome {
        Ok(()) => 0,
        Err(error) => {
            terminal.fail(&error);
            error.exit_code()
        }
    }
}

fn parse(args: &[OsString]) -> Result<(Cli, ArgMatches), Box<clap::Error>> {
    let matches = Cli::command().try_get_matches_from(args)?;
    let cli = Cli::from_arg_matches(&matches)?;
    let matches = match matches.subcommand() {
        Some((_, matches)) => matches.clone(),
        None => matches,
    };
    Ok((cli, matches))
}

/// Version and identity of the sources, the part of every result key that says which program made it.
pub(crate) fn version() -> &'static str {
    #[cfg(feature = "local")]
    return displace_server::BUILD_ID;
    #[cfg(not(feature = "local"))]
    return env!("CARGO_PKG_VERSION");
}

/// Help and version go to stdout with exit code 0; the rest is a usage error.
fn refuse(refusal: &clap::Error, terminal: &mut Terminal<'_>) -> u8 {
    if !refusal.use_stderr() {
        let _ = terminal.data(refusal.render().to_string().as_bytes());
        return 0;
    }
    if terminal.json {
        let _ = terminal.data(format!("{}\n", usage_error(refusal).to_json()).as_bytes());
    }
    let _ = write!(terminal.stderr, "{}", refusal.render());
    Kind::Usage.exit_code()
}

fn usage_error(refusal: &clap::Error) -> Error {
    let text = refusal.render().to_string();
    let first = text.split("\n\nUsage:").next().unwrap_or_default().split("\n\nFor more").next().unwrap_or_default();
    let sentence = first.trim().trim_start_matches("error: ").split_whitespace().collect::<Vec<_>>().join(" ");
    let flag = refusal.context().find_map(|(kind, value)| match kind {
        // One of several is named as `<--eye <X,Y,Z>|--orbit ...>`.
        ContextKind::InvalidArg => {
            value.to_string().split_whitespace().next().map(|flag| flag.trim_start_matches('<').to_owned())
        }
        _ => None,
    });
    let error = Error::new(Kind::Usage, sentence);
    match flag {
        Some(flag) => error.with_field(flag),
        None => error,
    }
}

fn dispatch(cli: Cli, matches: &ArgMatches, terminal: &mut Terminal<'_>) -> Result<()> {
    log(&cli.global);
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .enable_all()
        .build()
        .map_err(|e| Error::internal(format!("no threads can be started: {e}")))?;
    let outcome = runtime.block_on(until_interrupted(cli, matches, terminal));
    // What still blocks (a read of a pipe, say) must not keep the command alive.
    runtime.shutdown_timeout(Duration::from_millis(200));
    outcome
}

/// Runs the command. Ctrl-C drops it: a job under way then says farewell to its server.
async fn until_interrupted(cli: Cli, matches: &ArgMatches, terminal: &mut Terminal<'_>) -> Result<()> {
    let session = Session::new(&cli);
    let outcome = tokio::select! {
        outcome = commands::run(&session, cli, matches, terminal) => outcome,
        () = interrupt() => Err(Error::interrupted()),
    };
    session.close().await;
    outcome
}

async fn interrupt() {
    if tokio::signal::ctrl_c().await.is_err() {
        std::future::pending::<()>().await;
    }
}

/// Logs of this command and of a service in this process, on stderr: none unless asked for, since errors are
/// told once at the end.
fn log(global: &Global) {
    let level = match global.verbose {
        0 => "off",
        1 => "displace_client=info,displace_server=info",
        2 => "displace_client=debug,displace_server=debug",
        _ => "trace",
    };
    let filter: Targets = level.parse().unwrap_or_default();
    let lines = tracing_subscriber::fmt::layer().with_writer(std::io::stderr).with_filter(filter);
    let _ = tracing_subscriber::registry().with(lines).try_init();
}
