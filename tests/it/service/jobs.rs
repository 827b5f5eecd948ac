//! Jobs: joining, results from the store, cancellation, refusal, faults.

use std::time::{Duration, Instant};

use displace_proto::v1::{self, job_update::Update};
use futures::future::join_all;
use tonic::{Code, Request};
use tonic_types::StatusExt as _;

use super::{Harness, name_of, put, result, until, updates};

#[tokio::test(flavor = "multi_thread")]
async fn a_job_tells_its_steps_and_then_its_result() {
    let harness = Harness::start().await;
    let updates = harness.displace("warn").await;
    assert!(matches!(&updates[updates.len() - 2], Update::Warning(warning) if warning.code == "as_asked"));
    let result = result(&updates);
    let report = result.report.as_ref().unwrap();
    assert_eq!((report.triangles, report.cached, report.device.as_str()), (12, false, "none"));
    assert_eq!(result.outputs[0].name, "mesh.glb");
}

#[tokio::test(flavor = "multi_thread")]
async fn the_same_request_is_answered_from_the_store() {
    let harness = Harness::start().await;
    let first = harness.displace("ok").await;
    let second = harness.displace("ok").await;
    assert_eq!(harness.runs(), 1);
    assert_eq!(result(&first).outputs, result(&second).outputs);
    assert!(result(&second).report.as_ref().unwrap().cached);
    assert_eq!(harness.statistics().await.cache_hits, 1);
}

#[tokio::test(flavor = "multi_thread")]
async fn fresh_computes_although_the_result_is_stored() {
    let harness = Harness::start().await;
    harness.displace("ok").await;
    let request = v1::DisplaceRequest { fresh: true, ..harness.request("ok").await };
    let again = updates(&mut harness.jobs(), request).await;
    assert_eq!(harness.runs(), 2);
    assert!(!result(&again).report.as_ref().unwrap().cached);
}

#[tokio::test(flavor = "multi_thread")]
async fn the_same_request_joins_the_work_under_way() {
    let harness = Harness::start().await;
    let all = join_all((0..8).map(|_| harness.displace("run 300"))).await;
    assert_eq!(harness.runs(), 1);
    assert!(all.iter().all(|updates| result(updates).outputs == result(&all[0]).outputs));
    assert_eq!(harness.statistics().await.joined, 7);
}

#[tokio::test(flavor = "multi_thread")]
async fn sixteen_clients_at_once_are_all_answered_right() {
    let harness = Harness::start().await;
    let one = |n: usize| {
        let channel = harness.service.channel();
        async move {
            let mut assets = v1::assets_client::AssetsClient::new(channel.clone());
            let mesh = put(&mut assets, format!("mesh {n}").as_bytes()).await;
            let mut jobs = v1::displacement_client::DisplacementClient::new(channel);
            let updates = updates(&mut jobs, super::request(mesh, &format!("run 20 {n}"))).await;
            let name = name_of(result(&updates).outputs[0].digest.as_ref().unwrap());
            super::assets::read(&mut assets, &name, 0, 0).await.unwrap()
        }
    };
    let all = join_all((0..16).map(one)).await;
    for (n, bytes) in all.iter().enumerate() {
        assert_eq!(bytes, format!("run 20 {n}").as_bytes());
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn cancelling_reaches_the_work_within_250_ms() {
    let harness = Harness::start().await;
    let request = v1::DisplaceRequest { linger_secs: Some(0), ..harness.request("run 20000").await };
    let stream = harness.jobs().displace(request).await.unwrap().into_inner();
    harness.until_running(1).await;
    let left_at = Instant::now();
    drop(stream);
    until(|| harness.spy.stopped_at.lock().unwrap().is_some()).await;
    let stopped_at = harness.spy.stopped_at.lock().unwrap().unwrap();
    assert!(stopped_at - left_at < Duration::from_millis(250), "{:?}", stopped_at - left_at);
    // The device is free again.
    result(&harness.displace("ok").await);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_client_that_gives_up_ends_a_lingering_job_within_250_ms() {
    let harness = Harness::start().await;
    let request = harness.request("run 20000").await;
    let stream = harness.jobs().displace(request.clone()).await.unwrap().into_inner();
    harness.until_running(1).await;
    drop(stream);
    let left_at = Instant::now();
    let farewell = v1::DisplaceRequest { linger_secs: Some(0), ..request };
    let mut updates = harness.jobs().displace(farewell).await.unwrap().into_inner();
    updates.message().await.unwrap();
    drop(updates);
    until(|| harness.spy.stopped_at.lock().unwrap().is_some()).await;
    let stopped_at = harness.spy.stopped_at.lock().unwrap().unwrap();
    assert!(stopped_at - left_at < Duration::from_millis(250), "{:?}", stopped_at - left_at);
    assert_eq!(harness.runs(), 1);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_lingers_for_a_client_that_comes_back() {
    let harness = Harness::start().await;
    let request = harness.request("run 600").await;
    let stream = harness.jobs().displace(request).await.unwrap().into_inner();
    harness.until_running(1).await;
    drop(stream);
    tokio::time::sleep(Duration::from_millis(100)).await;
    result(&harness.displace("run 600").await);
    assert_eq!(harness.runs(), 1);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_nobody_waits_for_leaves_the_queue() {
    let harness = Harness::start().await;
    let first = harness.request("run 400").await;
    let _first = harness.jobs().displace(first).await.unwrap();
    harness.until_running(1).await;
    let second = v1::DisplaceRequest { linger_secs: Some(0), ..harness.request("ok").await };
    drop(harness.jobs().displace(second).await.unwrap());
    let started = Instant::now();
    while harness.statistics().await.queued_jobs > 0 {
        assert!(started.elapsed() < Duration::from_secs(5));
    }
    assert_eq!(harness.runs(), 1);
}

#[tokio::test(flavor = "multi_thread")]
async fn one_job_too_many_is_told_when_to_come_back() {
    let harness = Harness::with(|config| config.max_queued_jobs = 1).await;
    let mut held = Vec::new();
    for n in 0..2 {
        let request = harness.request(&format!("run 5000 {n}")).await;
        held.push(harness.jobs().displace(request).await.unwrap());
    }
    let started = Instant::now();
    let request = harness.request("run 5000 2").await;
    let status = harness.jobs().displace(request).await.unwrap_err();
    assert!(started.elapsed() < Duration::from_millis(500));
    assert_eq!(status.code(), Code::ResourceExhausted);
    assert!(status.get_details_retry_info().unwrap().retry_delay.unwrap() >= Duration::from_secs(1));
    assert_eq!(status.get_details_quota_failure().unwrap().violations[0].subject, "max_queued_jobs");
    assert_eq!(status.get_details_error_info().unwrap().reason, "BUSY");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_above_the_memory_of_all_jobs_is_refused_for_good() {
    let harness = Harness::with(|config| config.job_bytes = 1000).await;
    let request = harness.request("make 1001").await;
    let status = harness.jobs().displace(request).await.unwrap_err();
    assert_eq!(status.code(), Code::FailedPrecondition);
    assert!(status.get_details_retry_info().is_none());
}

#[tokio::test(flavor = "multi_thread")]
async fn a_panic_ends_its_own_job_only() {
    let harness = Harness::start().await;
    let Some(Update::Error(error)) = harness.displace("panic").await.pop() else { panic!("no error") };
    assert_eq!(error.code, Code::Internal as i32);
    assert!(!error.message.contains("as the test asked"), "private: {}", error.message);
    result(&harness.displace("ok").await);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_failed_job_names_the_field_and_is_not_stored() {
    let harness = Harness::start().await;
    for runs in 1..=2 {
        let Some(Update::Error(error)) = harness.displace("fail").await.pop() else { panic!("no error") };
        assert_eq!(error.code, Code::InvalidArgument as i32);
        assert!(error.details.iter().any(|detail| detail.type_url.ends_with("google.rpc.BadRequest")));
        assert_eq!(harness.runs(), runs);
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn missing_assets_are_named_before_a_job_exists() {
    let harness = Harness::start().await;
    let mesh = super::digest_of(b"never stored");
    let status = harness.jobs().displace(super::request(mesh.clone(), "ok")).await.unwrap_err();
    assert_eq!(status.code(), Code::NotFound);
    assert_eq!(status.get_details_resource_info().unwrap().resource_name, name_of(&mesh));
    assert_eq!(status.get_details_error_info().unwrap().reason, "MISSING_ASSETS");
}

#[tokio::test(flavor = "multi_thread")]
async fn what_is_out_of_range_is_named_by_its_path() {
    let harness = Harness::start().await;
    let mut request = harness.request("ok").await;
    request.geometry.as_mut().unwrap().feather_texels = Some(-1.0);
    let status = harness.jobs().displace(request).await.unwrap_err();
    assert_eq!(status.code(), Code::InvalidArgument);
    let bad = status.get_details_bad_request().unwrap();
    assert_eq!(bad.field_violations[0].field, "geometry.feather_texels");
    assert!(bad.field_violations[0].description.contains("0 to 4096"));
}

#[tokio::test(flavor = "multi_thread")]
async fn every_part_of_a_tolerance_is_part_of_the_key() {
    use v1::{ErrorAt, Quality, Tolerance, tolerance::Allowed};
    let harness = Harness::start().await;
    let request = harness.request("ok").await;
    let eye = vec![0.0, 0.0, 3.0];
    let view = v1::ToleranceView { eye, target: vec![0.0; 3], yfov_degrees: None, width: 64, height: 48 };
    let pixels = |width| {
        Allowed::Pixels(v1::PixelTolerance {
            tolerance_px: 1.0,
            views: vec![v1::ToleranceView { width, ..view.clone() }],
        })
    };
    let tolerance = |allowed| Tolerance { allowed: Some(allowed), ..Tolerance::default() };
    let one = tolerance(Allowed::Diagonal(1e-3));
    let tolerances = [
        one.clone(),
        tolerance(Allowed::Diagonal(2e-3)),
        tolerance(Allowed::World(1e-3)),
        tolerance(pixels(64)),
        tolerance(pixels(65)),
        Tolerance { error_at: ErrorAt::Texels.into(), ..one.clone() },
        Tolerance { quality: Quality::High.into(), ..one.clone() },
    ];
    // What is left out is what it stands for.
    let spelled = Tolerance { error_at: ErrorAt::Surface.into(), quality: Quality::Normal.into(), ..one };
    for (runs, tolerance) in (1..).zip(tolerances.into_iter()).chain([(7, spelled)]) {
        let mut request = request.clone();
        request.geometry.as_mut().unwrap().refinement = Some(v1::geometry::Refinement::Tolerance(tolerance.clone()));
        super::result(&super::updates(&mut harness.jobs(), request).await);
        assert_eq!(harness.runs(), runs, "{tolerance:?}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn how_a_file_is_packed_is_part_of_the_key_and_images_have_no_such_thing() {
    use v1::Compression::{Meshopt, None, Quantize, Unspecified};
    let harness = Harness::start().await;
    let request = harness.request("ok").await;
    for (compression, runs) in [(None, 1), (Quantize, 2), (Meshopt, 3), (Unspecified, 3)] {
        let request = v1::DisplaceRequest { compression: compression.into(), ..request.clone() };
        super::result(&super::updates(&mut harness.jobs(), request).await);
        assert_eq!(harness.runs(), runs, "{compression:?}");
    }
    let surface = Some(v1::DisplaceRequest { compression: Quantize.into(), ..request });
    let image = v1::RenderRequest { surface, views: vec![v1::View::default()], ..v1::RenderRequest::default() };
    refused(harness.jobs().render(image).await, "surface.compression");
}

fn refused<T>(answer: Result<tonic::Response<T>, tonic::Status>, field: &str) {
    let bad = answer.err().expect("it is refused").get_details_bad_request().unwrap();
    assert_eq!(bad.field_violations[0].field, field);
}

#[tokio::test(flavor = "multi_thread")]
async fn levels_of_detail_are_part_of_the_key_and_need_a_tolerance_and_a_file() {
    let harness = Harness::start().await;
    let mut request = harness.request("ok").await;
    refused(harness.jobs().displace(v1::DisplaceRequest { lods: 2, ..request.clone() }).await, "lods");
    let allowed = Some(v1::tolerance::Allowed::Diagonal(1e-3));
    let tolerance = v1::Tolerance { allowed, ..v1::Tolerance::default() };
    request.geometry.as_mut().unwrap().refinement = Some(v1::geometry::Refinement::Tolerance(tolerance));
    for (lods, runs) in [(1, 1), (2, 2), (3, 3), (0, 3)] {
        super::result(&super::updates(&mut harness.jobs(), v1::DisplaceRequest { lods, ..request.clone() }).await);
        assert_eq!(harness.runs(), runs, "{lods}");
    }
    let many = v1::DisplaceRequest { lods: 9, ..request.clone() };
    refused(harness.jobs().displace(many).await, "lods");
    let surface = Some(v1::DisplaceRequest { lods: 2, ..request });
    let image = v1::RenderRequest { surface, views: vec![v1::View::default()], ..v1::RenderRequest::default() };
    refused(harness.jobs().render(image).await, "surface.lods");
}

#[tokio::test(flavor = "multi_thread")]
async fn tenants_share_neither_results_nor_work() {
    let harness = Harness::start().await;
    harness.displace("ok").await;
    let mut request = Request::new(harness.request("ok").await);
    request.metadata_mut().insert(displace_proto::TENANT_METADATA, "other".parse().unwrap());
    let status = harness.jobs().displace(request).await.unwrap_err();
    assert_eq!(status.get_details_error_info().unwrap().reason, "MISSING_ASSETS");
}

#[tokio::test(flavor = "multi_thread")]
async fn describe_and_estimate_answer_without_a_job() {
    let harness = Harness::start().await;
    let mesh = harness.put(b"mesh").await;
    let mesh = Some(v1::MeshSource { asset: Some(mesh), resources: Vec::new() });
    let described = harness.jobs().describe(v1::DescribeRequest { mesh }).await.unwrap().into_inner();
    assert_eq!(described.instances, 7);
    let estimate = |request| v1::EstimateRequest { request: Some(v1::estimate_request::Request::Displace(request)) };
    let request = harness.request("ok").await;
    let before = harness.jobs().estimate(estimate(request.clone())).await.unwrap().into_inner();
    assert_eq!((before.triangles, before.cached, before.seconds), (Some(12), false, None));
    harness.displace("ok").await;
    let after = harness.jobs().estimate(estimate(request)).await.unwrap().into_inner();
    assert!(after.cached && after.seconds.is_some());
    assert_eq!(harness.runs(), 1);
}
