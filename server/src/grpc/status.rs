//! The only error table: what each kind of error is on the wire.

use std::{collections::HashMap, time::Duration};

use displace_proto::{ERROR_DOMAIN, rpc};
use prost::Message as _;
use tonic::{Code, Status};
use tonic_types::{
    BadRequest, ErrorDetail, ErrorInfo, QuotaFailure, QuotaViolation, ResourceInfo, RetryInfo, StatusExt as _,
};

use crate::domain::{Digest, Error, ErrorKind};

/// Details travel in a header, and some proxies allow 8 KiB of those.
const MAX_MISSING_NAMED: usize = 24;

/// Code, reason word.
fn row(kind: &ErrorKind) -> (Code, &'static str) {
    match kind {
        ErrorKind::InvalidInput => (Code::InvalidArgument, "INVALID_INPUT"),
        ErrorKind::Unsupported => (Code::Unimplemented, "UNSUPPORTED"),
        ErrorKind::Missing(_) => (Code::NotFound, "MISSING_ASSETS"),
        ErrorKind::NotFound => (Code::NotFound, "NOT_FOUND"),
        ErrorKind::TooLarge => (Code::FailedPrecondition, "TOO_LARGE"),
        ErrorKind::Busy { .. } => (Code::ResourceExhausted, "BUSY"),
        ErrorKind::Cancelled => (Code::Cancelled, "CANCELLED"),
        ErrorKind::Unavailable => (Code::Unavailable, "UNAVAILABLE"),
        ErrorKind::DataLoss => (Code::DataLoss, "DATA_LOSS"),
        ErrorKind::Internal => (Code::Internal, "INTERNAL"),
    }
}

/// The status of a call that failed before it had anything else to say. Faults of ours are logged here.
pub(super) fn status(error: &Error) -> Status {
    if matches!(error.kind, ErrorKind::Internal | ErrorKind::DataLoss) {
        tracing::error!(%error, cause = ?error.cause, "a call failed by a fault of the server");
    }
    unlogged(error)
}

fn unlogged(error: &Error) -> Status {
    let (code, reason) = row(&error.kind);
    Status::with_error_details_vec(code, shortened(&error.to_string()), details(error, reason))
}

/// Statuses travel as headers, of which clients take some KiB; texts may quote what was sent.
fn shortened(text: &str) -> String {
    const MOST_BYTES: usize = 1024;
    if text.len() <= MOST_BYTES {
        return text.to_owned();
    }
    let end = (0..=MOST_BYTES).rev().find(|end| text.is_char_boundary(*end)).unwrap_or(0);
    format!("{} [...]", &text[..end])
}

/// The same as a message, for `JobUpdate.error`, whose error the job has logged, and the entries of a batch.
pub(super) fn rpc_status(error: &Error) -> rpc::Status {
    let status = unlogged(error);
    // Our own details always decode; without them code and message still stand.
    rpc::Status::decode(status.details()).unwrap_or_else(|_| rpc::Status {
        code: status.code() as i32,
        message: status.message().into(),
        details: Vec::new(),
    })
}

/// The deadline of a call has passed.
pub(super) fn deadline_exceeded() -> Status {
    let message = "the deadline passed; the job lingers, so that calling again joins it";
    Status::with_error_details_vec(Code::DeadlineExceeded, message, [info("DEADLINE_EXCEEDED", HashMap::new()).into()])
}

fn details(error: &Error, reason: &str) -> Vec<ErrorDetail> {
    let field = error.field.as_deref().map(shortened);
    let message = shortened(&error.message);
    let metadata = field.clone().map(|field| ("field".to_owned(), field)).into_iter().collect();
    let mut details: Vec<ErrorDetail> = vec![info(reason, metadata).into()];
    match &error.kind {
        ErrorKind::InvalidInput | ErrorKind::Unsupported => {
            details.push(BadRequest::with_violation(field.unwrap_or_default(), &message).into());
        }
        ErrorKind::Missing(digests) => details.extend(digests.iter().take(MAX_MISSING_NAMED).map(missing)),
        ErrorKind::TooLarge => details.push(quota(field, &message)),
        ErrorKind::Busy { retry_secs } => {
            details.push(RetryInfo::new(Some(Duration::from_secs((*retry_secs).into()))).into());
            details.push(quota(field, &message));
        }
        _ => {}
    }
    details
}

fn info(reason: &str, metadata: HashMap<String, String>) -> ErrorInfo {
    ErrorInfo::new(reason, ERROR_DOMAIN, metadata)
}

fn quota(field: Option<String>, message: &str) -> ErrorDetail {
    QuotaFailure::new([QuotaViolation::new(field.unwrap_or_default(), message)]).into()
}

fn missing(digest: &Digest) -> ErrorDetail {
    ResourceInfo::new("displace.v1.Asset", digest.resource_name(), "", "not stored").into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_error_names_reason_and_domain() {
        let status = status(&Error::invalid("geometry.uniform", "level 13 is above the limit"));
        let info = status.get_details_error_info().unwrap();
        assert_eq!((info.reason.as_str(), info.domain.as_str()), ("INVALID_INPUT", "displace"));
        let bad = status.get_details_bad_request().unwrap();
        assert_eq!(bad.field_violations[0].field, "geometry.uniform");
    }

    #[test]
    fn busy_says_when_to_come_back_and_what_is_full() {
        let status = status(&Error::new(ErrorKind::Busy { retry_secs: 7 }, "full").with_field("job_bytes"));
        assert_eq!(status.code(), Code::ResourceExhausted);
        assert_eq!(status.get_details_retry_info().unwrap().retry_delay, Some(Duration::from_secs(7)));
        assert_eq!(status.get_details_quota_failure().unwrap().violations[0].subject, "job_bytes");
    }

    #[test]
    fn missing_assets_are_named_within_the_size_of_a_header() {
        let digests = (0..1000u32).map(|n| Digest::of(&n.to_le_bytes())).collect();
        let status = status(&Error::new(ErrorKind::Missing(digests), "1000 assets are not stored"));
        assert_eq!(status.get_error_details_vec().len(), 1 + MAX_MISSING_NAMED);
        assert!(status.details().len() * 4 / 3 < 8 << 10);
    }

    #[test]
    fn the_private_cause_stays_private() {
        let status = status(&Error::internal("a fault").with_cause("password=1234"));
        assert!(!format!("{status:?}").contains("1234"));
    }
}
