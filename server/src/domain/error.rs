//! One error type for the whole server. A kind exists because some caller acts on it; the message is
//! public (field, value, allowed range, fix); the source is private and goes to the log.

use std::fmt;

use super::Digest;

pub type Result<T, E = Error> = std::result::Result<T, E>;

/// What a caller can do about a failure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// The request or an asset is wrong: mend it; sending it again does not help.
    InvalidInput,
    /// The input is right but asks for something this version does not do.
    Unsupported,
    /// Assets the request names are not stored: upload them and call again.
    Missing(Vec<Digest>),
    /// Something named in the request does not exist (a material, a camera).
    NotFound,
    /// More than a limit or a budget allows, now and later.
    TooLarge,
    /// The queue or the memory budget is full now: call again after `retry_secs`.
    Busy { retry_secs: u32 },
    /// Nobody listens any more, or the client cancelled.
    Cancelled,
    /// The server drains, or its device is lost: call again, here or elsewhere.
    Unavailable,
    /// Stored bytes no longer match their digest.
    DataLoss,
    /// A fault of ours.
    Internal,
}

#[derive(Debug, thiserror::Error)]
pub struct Error {
    pub kind: ErrorKind,
    /// Path of the offending field in the request or the file, such as `details[0].height.scale`.
    pub field: Option<String>,
    /// Public sentence.
    pub message: String,
    /// Private cause, for the log alone.
    #[source]
    pub cause: Option<Box<dyn std::error::Error + Send + Sync>>,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.field {
            Some(field) => write!(f, "{field}: {}", self.message),
            None => f.write_str(&self.message),
        }
    }
}

impl Error {
    pub fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        Self { kind, field: None, message: message.into(), cause: None }
    }

    pub fn invalid(field: impl Into<String>, message: impl Into<String>) -> Self {
        Self::new(ErrorKind::InvalidInput, message).with_field(field)
    }

    pub fn unsupported(field: impl Into<String>, message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Unsupported, message).with_field(field)
    }

    pub fn too_large(field: impl Into<String>, message: impl Into<String>) -> Self {
        Self::new(ErrorKind::TooLarge, message).with_field(field)
    }

    pub fn internal(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Internal, message)
    }

    pub fn cancelled() -> Self {
        Self::new(ErrorKind::Cancelled, "the job was cancelled")
    }

    #[must_use]
    pub fn with_field(mut self, field: impl Into<String>) -> Self {
        self.field = Some(field.into());
        self
    }

    #[must_use]
    pub fn with_cause(mut self, cause: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        self.cause = Some(cause.into());
        self
    }
}
