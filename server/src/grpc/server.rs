//! Handlers of `displace.v1.Server`.

use displace_glsl::methods::{METHODS, MethodRow};
use displace_proto::v1::{self, server_server::Server};
use tonic::{Request, Response, Status};

use super::Services;
use crate::{
    domain::{plan::MAX_LEVEL, request::Base},
    jobs::{BUILD_ID, KindTotals},
};

pub(super) struct ServerService(pub(super) Services);

#[tonic::async_trait]
impl Server for ServerService {
    async fn get_capabilities(
        &self,
        _request: Request<v1::GetCapabilitiesRequest>,
    ) -> Result<Response<v1::GetCapabilitiesResponse>, Status> {
        Ok(Response::new(v1::GetCapabilitiesResponse {
            build_id: BUILD_ID.into(),
            apis: words(&["displace.v1"]),
            limits: Some(self.limits()),
            mesh_formats: words(&["model/gltf-binary", "model/gltf+json"]),
            map_formats: words(&["image/png", "image/jpeg", "image/tiff", "image/x-exr", "image/vnd.radiance"]),
            output_formats: words(&["model/gltf-binary", "image/png", "image/x-exr"]),
            methods: METHODS.iter().map(to_method).collect(),
            bases: words(&Base::ALL.map(Base::name)),
            devices: vec![v1::DeviceInfo {
                name: self.0.jobs.device_name().into(),
                device_class: self.0.jobs.device_class().into(),
                driver: self.0.jobs.driver().into(),
            }],
        }))
    }

    async fn get_statistics(
        &self,
        _request: Request<v1::GetStatisticsRequest>,
    ) -> Result<Response<v1::GetStatisticsResponse>, Status> {
        let snapshot = self.0.jobs.snapshot();
        let counters = snapshot.counters;
        let jobs = snapshot.kinds.into_iter().map(|(kind, method, totals)| to_statistics(kind, method, &totals));
        Ok(Response::new(v1::GetStatisticsResponse {
            uptime_secs: snapshot.uptime.as_secs_f64(),
            running_jobs: counters.running_jobs,
            queued_jobs: counters.queued_jobs,
            job_bytes: counters.job_bytes,
            resident_bytes: resident_bytes(),
            store_bytes: self.0.store.used_bytes(),
            store_limit_bytes: self.0.store.options().limit_bytes,
            cache_hits: counters.cache_hits,
            joined: counters.joined,
            cache_misses: counters.cache_misses,
            refused: counters.refused,
            jobs: jobs.collect(),
        }))
    }
}

impl ServerService {
    fn limits(&self) -> v1::Limits {
        let config = &self.0.config;
        v1::Limits {
            max_asset_bytes: config.max_asset_bytes,
            max_batch_bytes: config.max_batch_bytes,
            max_message_bytes: config.max_message_bytes,
            max_queued_jobs: config.max_queued_jobs,
            max_job_bytes: config.job_bytes,
            max_device_bytes: config.device_bytes,
            max_uniform_level: MAX_LEVEL,
            max_image_pixels: config.max_image_pixels,
            max_views: super::convert::MAX_VIEWS as u32,
            linger_secs: config.linger_secs as u32,
        }
    }
}

fn to_method(row: &MethodRow) -> v1::MethodInfo {
    v1::MethodInfo {
        name: row.name.into(),
        summary: row.summary.into(),
        represents: words(row.represents),
        cost: row.cost.into(),
    }
}

fn to_statistics(kind: &str, method: &str, totals: &KindTotals) -> v1::JobStatistics {
    v1::JobStatistics {
        kind: kind.into(),
        method: method.into(),
        succeeded: totals.succeeded,
        failed: totals.failed,
        cancelled: totals.cancelled,
        queue_secs: totals.queue.as_secs_f64(),
        compute_secs: totals.compute.as_secs_f64(),
        transfer_secs: totals.transfer.as_secs_f64(),
    }
}

/// Linux tells it in `/proc`; elsewhere it is unknown.
fn resident_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib << 10)
}

fn words(words: &[&str]) -> Vec<String> {
    words.iter().map(|word| (*word).to_owned()).collect()
}
