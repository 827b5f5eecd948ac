//! gRPC status to error: the reason of the service decides, the code where a proxy or the transport spoke.

use std::time::Duration;

use displace_proto::ERROR_DOMAIN;
use tonic::{Code, Status};
use tonic_types::StatusExt as _;

use crate::error::{Error, Kind};

/// What a failed call or job means for the user.
pub(crate) fn failure(status: &Status) -> Error {
    let kind = reason(status).map_or_else(|| kind_of_code(status.code()), |reason| kind_of_reason(&reason));
    let violation = status.get_details_bad_request().and_then(|bad| bad.field_violations.into_iter().next());
    let message = match status.message() {
        "" => format!("the server answered {:?} without a word", status.code()),
        message => message.to_owned(),
    };
    let error = Error::new(kind, message);
    match violation {
        Some(violation) if !violation.field.is_empty() => error.with_field(violation.field),
        _ => error,
    }
}

/// Whether the same call may succeed now or soon, and how long the server asks to wait before. Anything that
/// ends a connection counts: which code that gives depends on proxies and on the moment.
pub(crate) fn is_transient(status: &Status) -> Option<Option<Duration>> {
    let asked = status.get_details_retry_info().and_then(|info| info.retry_delay);
    match reason(status).as_deref() {
        Some("BUSY" | "UNAVAILABLE") => Some(asked),
        Some(_) => None,
        None => matches!(status.code(), Code::Unavailable | Code::Unknown | Code::Internal | Code::Cancelled)
            .then_some(asked),
    }
}

/// Whether the job needs uploads again.
pub(crate) fn missing_assets(status: &Status) -> bool {
    reason(status).as_deref() == Some("MISSING_ASSETS")
}

/// The service's own reason; absent when something in between answered.
fn reason(status: &Status) -> Option<String> {
    status.get_details_error_info().filter(|info| info.domain == ERROR_DOMAIN).map(|info| info.reason)
}

fn kind_of_reason(reason: &str) -> Kind {
    match reason {
        "INVALID_INPUT" => Kind::InvalidInput,
        "UNSUPPORTED" => Kind::Unsupported,
        "MISSING_ASSETS" | "NOT_FOUND" => Kind::NotFound,
        "TOO_LARGE" => Kind::TooLarge,
        "BUSY" => Kind::Busy,
        "CANCELLED" => Kind::Cancelled,
        "UNAVAILABLE" => Kind::Unavailable,
        "DATA_LOSS" => Kind::DataLoss,
        "DEADLINE_EXCEEDED" => Kind::DeadlineExceeded,
        _ => Kind::Internal,
    }
}

fn kind_of_code(code: Code) -> Kind {
    match code {
        Code::InvalidArgument | Code::OutOfRange => Kind::InvalidInput,
        Code::Unimplemented => Kind::Unsupported,
        Code::NotFound => Kind::NotFound,
        Code::FailedPrecondition => Kind::TooLarge,
        Code::ResourceExhausted => Kind::Busy,
        Code::Unavailable | Code::Unknown | Code::Cancelled => Kind::Unavailable,
        Code::DeadlineExceeded => Kind::DeadlineExceeded,
        Code::DataLoss => Kind::DataLoss,
        _ => Kind::Internal,
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use tonic_types::ErrorDetails;

    use super::*;

    fn status(code: Code, reason: &str) -> Status {
        let mut details = ErrorDetails::with_error_info(reason, ERROR_DOMAIN, HashMap::new());
        details.add_bad_request_violation("details[0].layers[0].scale", "finite");
        details.set_retry_info(Some(Duration::from_secs(2)));
        Status::with_error_details(code, "a sentence", details)
    }

    #[test]
    fn the_reason_decides_and_the_field_is_kept() {
        let error = failure(&status(Code::InvalidArgument, "INVALID_INPUT"));
        assert_eq!((error.kind, error.exit_code()), (Kind::InvalidInput, 2));
        assert_eq!(error.field.as_deref(), Some("details[0].layers[0].scale"));
        assert_eq!(failure(&status(Code::ResourceExhausted, "BUSY")).exit_code(), 3);
        assert_eq!(failure(&status(Code::Internal, "INTERNAL")).exit_code(), 1);
    }

    #[test]
    fn a_broken_connection_is_transient_whatever_its_code() {
        for code in [Code::Unavailable, Code::Unknown, Code::Internal, Code::Cancelled] {
            assert_eq!(is_transient(&Status::new(code, "h2 protocol error")), Some(None), "{code:?}");
        }
        assert_eq!(is_transient(&Status::new(Code::InvalidArgument, "")), None);
    }

    #[test]
    fn what_the_service_says_itself_is_final_unless_it_is_full_or_leaving() {
        assert_eq!(is_transient(&status(Code::Internal, "INTERNAL")), None);
        assert_eq!(is_transient(&status(Code::Cancelled, "CANCELLED")), None);
        assert_eq!(is_transient(&status(Code::ResourceExhausted, "BUSY")), Some(Some(Duration::from_secs(2))));
        assert!(missing_assets(&status(Code::NotFound, "MISSING_ASSETS")));
    }
}
