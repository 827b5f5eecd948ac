//! One file per command.

mod answer;
mod apply;
mod assets;
mod chart;
mod compare;
mod completions;
mod demo;
mod describe;
mod health;
mod measure;
mod methods;
mod render;
mod status;
mod surface;

use clap::ArgMatches;
use tokio::sync::OnceCell;

use crate::{
    args::{Cli, Command, Global},
    connection::{Connection, Need},
    error::Result,
    output::Terminal,
};

/// What every command has at hand: the flags all take, and the way to a server, opened at first need.
pub(crate) struct Session {
    pub(crate) global: Global,
    need: Need,
    connection: OnceCell<Connection>,
}

impl Session {
    pub(crate) fn new(cli: &Cli) -> Self {
        let (global, need) = (cli.global.clone(), Need::of(&cli.command));
        Self { global, need, connection: OnceCell::new() }
    }

    pub(crate) async fn connection(&self) -> Result<&Connection> {
        self.connection.get_or_try_init(|| Connection::open(&self.global, self.need)).await
    }

    pub(crate) async fn close(self) {
        if let Some(connection) = self.connection.into_inner() {
            connection.close().await;
        }
    }
}

pub(crate) async fn run(session: &Session, cli: Cli, matches: &ArgMatches, terminal: &mut Terminal<'_>) -> Result<()> {
    match cli.command {
        Command::Demo(args) => demo::run(session, &args, terminal).await,
        Command::Apply(args) => apply::run(session, &args, matches, terminal).await,
        Command::Render(args) => render::run(session, &args, matches, terminal).await,
        Command::Measure(args) => measure::run(session, &args, matches, terminal).await,
        Command::Compare(args) => compare::run(session, &args, terminal).await,
        Command::Chart(args) => chart::run(session, &args, matches, terminal).await,
        Command::Describe(args) => describe::run(session, &args, terminal).await,
        Command::Assets(command) => assets::run(session, &command, terminal).await,
        Command::Methods => methods::run(session, terminal).await,
        Command::Status => status::run(session, terminal).await,
        Command::Health(args) => health::run(session, &args, terminal).await,
        Command::Completions(args) => completions::run(&args, terminal),
    }
}

/// Runs what blocks (hashing, conversion) beside the reactor, so that Ctrl-C still works.
async fn blocking<T: Send + 'static>(work: impl FnOnce() -> Result<T> + Send + 'static) -> Result<T> {
    tokio::task::spawn_blocking(work).await.map_err(|_| crate::error::Error::internal("a worker thread stopped"))?
}
