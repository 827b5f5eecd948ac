//! The service inside this process, reached by a pipe. It opens its device at once; commands that need none
//! take the reference device, which is there without a driver.

use std::time::Duration;

use displace_server::{
    config::{Config, Settings},
    domain::{self, ErrorKind},
    service::{self, InProcess},
};
use tonic::transport::Channel;

use super::Need;
use crate::{
    args::Global,
    error::{Error, Kind, Result},
};

/// Longest the end of the command waits for the device to come to rest.
const REST: Duration = Duration::from_secs(2);

pub(super) struct LocalServer {
    service: InProcess,
}

impl LocalServer {
    pub(super) async fn start(global: &Global, need: Need) -> Result<(Self, Channel)> {
        let service = service::in_process(config(global, need)?).await.map_err(|e| refused(&e))?;
        let channel = service.channel();
        Ok((Self { service }, channel))
    }

    /// Cancels what runs, and waits for the device: a driver must not be at work when the process ends.
    pub(super) async fn stop(self) {
        let stopped = tokio::task::spawn_blocking(move || self.service.stop());
        if tokio::time::timeout(REST, stopped).await.is_err() {
            tracing::warn!("the device is still at work");
        }
    }
}

/// The server's own settings: its environment variables hold here as well.
fn config(global: &Global, need: Need) -> Result<Config> {
    let mut settings = Settings::from_environment().map_err(|e| refused(&e))?;
    settings.device = match need {
        Need::Device => global.device.clone().or(settings.device),
        Need::StoreOnly => Some("reference".to_owned()),
    };
    Ok(settings.into())
}

/// The service did not start: its settings are wrong, or the device.
fn refused(error: &domain::Error) -> Error {
    let kind = match error.kind {
        ErrorKind::InvalidInput | ErrorKind::NotFound => Kind::InvalidInput,
        ErrorKind::Unsupported => Kind::Unsupported,
        ErrorKind::TooLarge => Kind::TooLarge,
        ErrorKind::Busy { .. } => Kind::Busy,
        ErrorKind::Unavailable => Kind::Unavailable,
        _ => Kind::Internal,
    };
    tracing::debug!(cause = ?error.cause, "the service did not start");
    let message = error.message.clone();
    match error.field.as_deref() {
        Some("device") => Error::new(kind, message).with_field("--device"),
        Some(field) => Error::new(kind, message).with_field(field),
        None => Error::new(kind, message),
    }
}
