//! `displaced`: arguments, logs, service, end.

use std::{process::ExitCode, time::Duration};

use clap::Parser as _;
use displace_server::{args::Args, domain::ErrorKind, service, telemetry};

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("displaced: {error}");
            let mut cause = error.cause.as_deref().map(|cause| cause as &dyn std::error::Error);
            while let Some(deeper) = cause {
                eprintln!("  because: {deeper}");
                cause = deeper.source();
            }
            ExitCode::from(if error.kind == ErrorKind::InvalidInput { 2 } else { 1 })
        }
    }
}

fn run() -> displace_server::domain::Result<()> {
    let config = Args::parse().into_config()?;
    // While this is the only thread: a software driver without a home folder would compile anew at each start.
    displace_server::vulkan::keep_driver_cache_in(&config.cache.join("driver"));
    telemetry::install(&config)?;
    let runtime = tokio::runtime::Runtime::new().map_err(|cause| {
        displace_server::domain::Error::internal("cannot start the async runtime").with_cause(cause)
    })?;
    let served = runtime.block_on(service::serve(config));
    // Peers that neither speak nor leave do not keep the process.
    runtime.shutdown_timeout(Duration::from_millis(100));
    served
}
