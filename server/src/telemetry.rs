//! Logs: human on a terminal, JSON otherwise. A span per job and per pass; faults with their private causes.

use std::io::IsTerminal as _;

use tracing_subscriber::{Layer as _, filter::Targets, fmt, layer::SubscriberExt as _, util::SubscriberInitExt as _};

use crate::{
    config::{Config, LogFormat},
    domain::{Error, Result},
};

/// Installs the subscriber of the process. Call once, from a binary.
pub fn install(config: &Config) -> Result<()> {
    let filter: Targets = config.log.parse().map_err(|cause: tracing_subscriber::filter::ParseError| {
        Error::invalid("log", format!("'{}' is not a filter: {cause}", config.log))
    })?;
    let is_human = match config.log_format {
        LogFormat::Auto => std::io::stderr().is_terminal(),
        LogFormat::Human => true,
        LogFormat::Json => false,
    };
    let lines = fmt::layer().with_writer(std::io::stderr);
    let lines = if is_human {
        lines.with_target(false).boxed()
    } else {
        lines.json().flatten_event(true).with_current_span(true).with_span_list(false).boxed()
    };
    let installed = tracing_subscriber::registry().with(lines.with_filter(filter)).try_init();
    installed.map_err(|cause| Error::internal("logging is installed already").with_cause(cause))
}
