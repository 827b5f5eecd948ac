//! What can go wrong on a device. A kind exists because some caller acts on it; `render` turns these into
//! the server's errors, so that this layer knows no other.

use std::fmt;

use ash::vk;

pub(crate) type Result<T, E = Error> = std::result::Result<T, E>;

/// What a caller can do about a failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// More bytes than the budget or the device has left. The device lives on.
    OutOfMemory,
    /// No device, driver or feature to do this with: the message says what to install.
    NotSupported,
    /// The caller asked to stop.
    Cancelled,
    /// The device no longer answers: open it anew.
    Lost,
    /// A fault of ours.
    Internal,
}

#[derive(Debug)]
pub struct Error {
    pub kind: ErrorKind,
    /// Public sentence.
    pub message: String,
    /// Private cause, for the log alone.
    pub cause: Option<Box<dyn std::error::Error + Send + Sync>>,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.cause.as_deref().map(|cause| cause as _)
    }
}

impl Error {
    pub(crate) fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        Self { kind, message: message.into(), cause: None }
    }

    pub(crate) fn internal(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Internal, message)
    }

    pub(crate) fn unsupported(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::NotSupported, message)
    }

    pub(crate) fn with_cause(mut self, cause: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        self.cause = Some(cause.into());
        self
    }
}

/// For `map_err`: a failed Vulkan call while doing `what`.
pub(crate) fn failed(what: &'static str) -> impl Fn(vk::Result) -> Error {
    move |result| {
        let (kind, message) = match result {
            vk::Result::ERROR_OUT_OF_DEVICE_MEMORY | vk::Result::ERROR_OUT_OF_HOST_MEMORY => {
                (ErrorKind::OutOfMemory, format!("the device ran out of memory: {what}"))
            }
            vk::Result::ERROR_DEVICE_LOST => (ErrorKind::Lost, format!("the device was lost: {what}")),
            _ => (ErrorKind::Internal, format!("the device refused a call: {what}")),
        };
        Error::new(kind, message).with_cause(result)
    }
}
