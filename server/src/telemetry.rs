//! Logs: human on a terminal, JSON otherwise. A span per job and per pass; faults with their private causes.

use std::io::IsTerminal as _;

use tracing_subscriber::{EnvFilter, fmt};

use crate::{
    config::{Config, LogFormat},
    domain::{Error, Result},
};

/// Installs the subscriber of the process. Call once, from a binary.
pub fn install(config: &Config) -> Result<()> {
    let filter = EnvFilter::try_new(&config.log)
        .map_err(|cause| Error::invalid("log", format!("'{}' is not a filter: {cause}", config.log)))?;
    let is_human = match config.log_format {
        LogFormat::Auto => std::io::stderr().is_terminal(),
        LogFormat::Human => true,
        LogFormat::Json => false,
    };
    let base = fmt().with_env_filter(filter).with_writer(std::io::stderr);
    let installed = if is_human {
        base.with_target(false).try_init()
    } else {
        base.json().flatten_event(true).with_current_span(true).with_span_list(false).try_init()
    };
    installed.map_err(|cause| Error::internal("logging is installed already").with_cause(cause))
}
