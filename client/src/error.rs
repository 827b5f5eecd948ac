//! The one error type of the client: what went wrong in words for people, a kind for programs, and the
//! exit code of the contract. Errors of the server arrive here through `connection::status`.

use std::{fmt, path::Path};

pub(crate) type Result<T, E = Error> = std::result::Result<T, E>;

/// What a caller can do about a failure; the names are those of `--json`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// The command line is wrong.
    Usage,
    /// A file, a value or an asset is wrong.
    InvalidInput,
    /// Right input, but not something this version does.
    Unsupported,
    NotFound,
    /// More than a limit allows, now and later.
    TooLarge,
    /// The server is full: try again later.
    Busy,
    /// The server cannot be reached or is going away.
    Unavailable,
    DeadlineExceeded,
    Cancelled,
    DataLoss,
    /// A file could not be read or written for reasons outside the request.
    Io,
    Internal,
    /// The person at the keyboard stopped it.
    Interrupted,
}

impl Kind {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Usage => "usage",
            Self::InvalidInput => "invalid_input",
            Self::Unsupported => "unsupported",
            Self::NotFound => "not_found",
            Self::TooLarge => "too_large",
            Self::Busy => "busy",
            Self::Unavailable => "unavailable",
            Self::DeadlineExceeded => "deadline_exceeded",
            Self::Cancelled => "cancelled",
            Self::DataLoss => "data_loss",
            Self::Io => "io",
            Self::Internal => "internal",
            Self::Interrupted => "interrupted",
        }
    }

    /// 1 the job failed, 2 usage or bad input, 3 unreachable or busy, 130 interrupted.
    pub(crate) fn exit_code(self) -> u8 {
        match self {
            Self::Usage | Self::InvalidInput | Self::Unsupported | Self::NotFound | Self::TooLarge => 2,
            Self::Busy | Self::Unavailable | Self::DeadlineExceeded => 3,
            Self::Cancelled | Self::DataLoss | Self::Io | Self::Internal => 1,
            Self::Interrupted => 130,
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Error {
    pub(crate) kind: Kind,
    /// The flag, or the path in the request or the file, that is at fault.
    pub(crate) field: Option<String>,
    pub(crate) message: String,
}

impl Error {
    pub(crate) fn new(kind: Kind, message: impl Into<String>) -> Self {
        Self { kind, field: None, message: message.into() }
    }

    pub(crate) fn usage(field: impl Into<String>, message: impl Into<String>) -> Self {
        Self::new(Kind::Usage, message).with_field(field)
    }

    pub(crate) fn invalid(field: impl Into<String>, message: impl Into<String>) -> Self {
        Self::new(Kind::InvalidInput, message).with_field(field)
    }

    pub(crate) fn internal(message: impl Into<String>) -> Self {
        Self::new(Kind::Internal, message)
    }

    pub(crate) fn interrupted() -> Self {
        Self::new(Kind::Interrupted, "interrupted")
    }

    /// A file the user named cannot be read.
    pub(crate) fn reading(path: &Path, cause: &std::io::Error) -> Self {
        let message = match cause.kind() {
            std::io::ErrorKind::NotFound => "there is no such file".to_owned(),
            std::io::ErrorKind::IsADirectory => "this is a folder; name a file in it".to_owned(),
            std::io::ErrorKind::PermissionDenied => "it may not be read: permission denied".to_owned(),
            _ => format!("it cannot be read: {cause}"),
        };
        Self::invalid(path.display().to_string(), message)
    }

    #[must_use]
    pub(crate) fn with_field(mut self, field: impl Into<String>) -> Self {
        self.field = Some(field.into());
        self
    }

    pub(crate) fn exit_code(&self) -> u8 {
        self.kind.exit_code()
    }

    /// The object of the contract: `{"error": {"kind", "message", "field"}}`, the field absent when unknown.
    pub(crate) fn to_json(&self) -> serde_json::Value {
        let mut error = serde_json::json!({ "kind": self.kind.name(), "message": self.message });
        if let Some(field) = &self.field {
            error["field"] = field.as_str().into();
        }
        serde_json::json!({ "error": error })
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.field {
            Some(field) if !self.message.starts_with(field.as_str()) => write!(f, "{field}: {}", self.message),
            _ => f.write_str(&self.message),
        }
    }
}

impl std::error::Error for Error {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_field_is_absent_from_the_json() {
        assert_eq!(
            Error::new(Kind::Busy, "full").to_json(),
            serde_json::json!({"error": {"kind": "busy", "message": "full"}})
        );
    }

    #[test]
    fn the_field_is_not_said_twice() {
        assert_eq!(Error::usage("--uniform", "--uniform is missing").to_string(), "--uniform is missing");
        assert_eq!(Error::usage("--fov", "180 is too wide").to_string(), "--fov: 180 is too wide");
    }
}
