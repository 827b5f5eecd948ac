//! `displace health`: for probes. Exit code 0 when the service serves, 3 when not.

use serde_json::json;
use tonic_health::pb::{HealthCheckRequest, health_check_response::ServingStatus};

use super::Session;
use crate::{
    args::{HealthArgs, HealthService},
    connection::{CALL_DEADLINE, failure, request},
    error::{Error, Kind, Result},
    output::Terminal,
};

pub(super) async fn run(session: &Session, args: &HealthArgs, terminal: &mut Terminal<'_>) -> Result<()> {
    let service = match args.service {
        HealthService::Live => "live",
        HealthService::Ready => "ready",
    };
    let message = HealthCheckRequest { service: service.to_owned() };
    // One call, no retries: a probe wants to know how it is now.
    let answer = session.connection().await?.health().check(request(message, CALL_DEADLINE)).await;
    let status = answer.map_err(|status| failure(&status))?.into_inner().status();
    if status == ServingStatus::Serving {
        return terminal.report(&json!({ "service": service, "status": "serving" }), &format!("{service}: serving\n"));
    }
    let name = status.as_str_name().to_ascii_lowercase().replace('_', " ");
    Err(Error::new(Kind::Unavailable, format!("{service}: {name}")))
}
