//! `displace status`: what the server is, does, and has done.

use std::fmt::Write as _;

use displace_proto::v1::{
    GetCapabilitiesRequest, GetCapabilitiesResponse, GetStatisticsRequest, GetStatisticsResponse,
};
use serde_json::{Value, json};

use super::Session;
use crate::{
    connection::{CALL_DEADLINE, request},
    error::Result,
    output::{Terminal, bytes, duration_ms},
    transfer::unary,
};

pub(super) async fn run(session: &Session, terminal: &mut Terminal<'_>) -> Result<()> {
    let connection = session.connection().await?;
    let server = unary(|| async move {
        connection.server().get_capabilities(request(GetCapabilitiesRequest {}, CALL_DEADLINE)).await
    })
    .await?;
    let now =
        unary(
            || async move { connection.server().get_statistics(request(GetStatisticsRequest {}, CALL_DEADLINE)).await },
        )
        .await?;
    terminal.report(&as_json(&server, &now), &words(&server, &now))
}

fn as_json(server: &GetCapabilitiesResponse, now: &GetStatisticsResponse) -> Value {
    let devices: Vec<Value> = server
        .devices
        .iter()
        .map(|d| json!({ "name": d.name, "device_class": d.device_class, "driver": d.driver }))
        .collect();
    let jobs: Vec<Value> = now
        .jobs
        .iter()
        .map(|j| {
            json!({
                "kind": j.kind, "method": j.method, "succeeded": j.succeeded, "failed": j.failed,
                "cancelled": j.cancelled, "queue_secs": j.queue_secs, "compute_secs": j.compute_secs,
                "transfer_secs": j.transfer_secs,
            })
        })
        .collect();
    let mut value = json!({
        "build_id": server.build_id,
        "apis": server.apis,
        "devices": devices,
        "mesh_formats": server.mesh_formats,
        "map_formats": server.map_formats,
        "output_formats": server.output_formats,
        "bases": server.bases,
        "uptime_secs": now.uptime_secs,
        "running_jobs": now.running_jobs,
        "queued_jobs": now.queued_jobs,
        "job_bytes": now.job_bytes,
        "store_bytes": now.store_bytes,
        "store_limit_bytes": now.store_limit_bytes,
        "cache_hits": now.cache_hits,
        "joined": now.joined,
        "cache_misses": now.cache_misses,
        "refused": now.refused,
        "jobs": jobs,
    });
    if let Some(resident) = now.resident_bytes {
        value["resident_bytes"] = resident.into();
    }
    if let Some(l) = &server.limits {
        value["limits"] = json!({
            "max_asset_bytes": l.max_asset_bytes, "max_batch_bytes": l.max_batch_bytes,
            "max_message_bytes": l.max_message_bytes, "max_queued_jobs": l.max_queued_jobs,
            "max_job_bytes": l.max_job_bytes, "max_device_bytes": l.max_device_bytes,
            "max_uniform_level": l.max_uniform_level, "max_image_pixels": l.max_image_pixels,
            "max_views": l.max_views, "linger_secs": l.linger_secs,
        });
    }
    value
}

fn words(server: &GetCapabilitiesResponse, now: &GetStatisticsResponse) -> String {
    let mut text = format!("displaced {}, up {}\n", server.build_id, duration_ms(now.uptime_secs * 1000.0));
    for device in &server.devices {
        let _ = writeln!(text, "device {} (class {}) {}", device.name, device.device_class, device.driver);
    }
    let _ = writeln!(
        text,
        "jobs: {} running, {} queued, holding {}",
        now.running_jobs,
        now.queued_jobs,
        bytes(now.job_bytes)
    );
    let _ = writeln!(
        text,
        "requests: {} computed, {} from the store, {} joined, {} refused",
        now.cache_misses, now.cache_hits, now.joined, now.refused
    );
    let _ = writeln!(text, "store: {} of {}", bytes(now.store_bytes), bytes(now.store_limit_bytes));
    if let Some(resident) = now.resident_bytes {
        let _ = writeln!(text, "resident memory: {}", bytes(resident));
    }
    for job in &now.jobs {
        let _ = writeln!(
            text,
            "{} {}: {} done, {} failed, {} cancelled; waited {}, computed {}, stored {}",
            job.kind,
            job.method,
            job.succeeded,
            job.failed,
            job.cancelled,
            duration_ms(job.queue_secs * 1000.0),
            duration_ms(job.compute_secs * 1000.0),
            duration_ms(job.transfer_secs * 1000.0)
        );
    }
    text
}
