//! What any gRPC client meets: reflection, health, deadlines, limits, browsers, shutdown.

use std::time::{Duration, Instant};

use displace_proto::v1::{self, job_update::Update};
use displace_server::service::Service;
use tokio::{
    io::{AsyncReadExt as _, AsyncWriteExt as _},
    net::TcpStream,
    sync::oneshot,
};
use tokio_stream::StreamExt as _;
use tonic::{Code, Request};
use tonic_health::pb::{HealthCheckRequest, health_check_response::ServingStatus, health_client::HealthClient};
use tonic_reflection::pb::{v1 as reflection, v1alpha};
use tonic_types::StatusExt as _;

use super::{Harness, Spy, parts, test_config};

/// A service on a port of its own, which ends when told to.
struct OnPort {
    url: String,
    address: std::net::SocketAddr,
    stop: oneshot::Sender<()>,
    ended: tokio::task::JoinHandle<displace_server::domain::Result<()>>,
    _folder: tempfile::TempDir,
}

async fn on_port(change: impl FnOnce(&mut displace_server::config::Config)) -> OnPort {
    let folder = tempfile::tempdir().unwrap();
    let mut config = test_config(&folder);
    config.listen = "127.0.0.1:0".parse().unwrap();
    config.drain_secs = 0;
    change(&mut config);
    let service = Service::start(config, parts(&std::sync::Arc::<Spy>::default())).await.unwrap();
    let bound = service.bind().await.unwrap();
    let address = bound.address;
    let (stop, stopped) = oneshot::channel();
    let ended = tokio::spawn(bound.run(async move { drop(stopped.await) }));
    OnPort { url: format!("http://{address}"), address, stop, ended, _folder: folder }
}

#[tokio::test(flavor = "multi_thread")]
async fn reflection_lists_all_services_in_both_versions() {
    let harness = Harness::start().await;
    let expected = ["displace.v1.Assets", "displace.v1.Displacement", "displace.v1.Server", "grpc.health.v1.Health"];
    let list = reflection::server_reflection_request::MessageRequest::ListServices(String::new());
    let request = reflection::ServerReflectionRequest { host: String::new(), message_request: Some(list) };
    let mut client = reflection::server_reflection_client::ServerReflectionClient::new(harness.channel.clone());
    let mut answers = client.server_reflection_info(tokio_stream::once(request)).await.unwrap().into_inner();
    let answer = answers.next().await.unwrap().unwrap().message_response.unwrap();
    let reflection::server_reflection_response::MessageResponse::ListServicesResponse(list) = answer else { panic!() };
    let names: Vec<String> = list.service.into_iter().map(|service| service.name).collect();
    assert!(expected.iter().all(|name| names.iter().any(|other| other == name)), "{names:?}");

    let symbol =
        v1alpha::server_reflection_request::MessageRequest::FileContainingSymbol("google.rpc.BadRequest".into());
    let request = v1alpha::ServerReflectionRequest { host: String::new(), message_request: Some(symbol) };
    let mut client = v1alpha::server_reflection_client::ServerReflectionClient::new(harness.channel.clone());
    let mut answers = client.server_reflection_info(tokio_stream::once(request)).await.unwrap().into_inner();
    let answer = answers.next().await.unwrap().unwrap().message_response.unwrap();
    let found = matches!(answer, v1alpha::server_reflection_response::MessageResponse::FileDescriptorResponse(_));
    assert!(found, "{answer:?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn health_knows_live_and_ready() {
    let harness = Harness::start().await;
    for service in ["", "live", "ready"] {
        let request = HealthCheckRequest { service: service.into() };
        let status = HealthClient::new(harness.channel.clone()).check(request).await.unwrap().into_inner().status;
        assert_eq!(status, ServingStatus::Serving as i32, "{service}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn capabilities_tell_limits_and_build() {
    let harness = Harness::start().await;
    let told = harness.server().get_capabilities(v1::GetCapabilitiesRequest {}).await.unwrap().into_inner();
    assert_eq!(told.build_id, displace_server::BUILD_ID);
    assert_eq!(told.devices[0].device_class, "test");
    assert!(told.limits.unwrap().max_batch_bytes > 0);
    assert!(told.methods.iter().any(|method| method.name == "displacement"));
    assert_eq!(told.bases, ["flat", "pn", "phong", "loop"]);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_deadline_ends_a_stream_with_deadline_exceeded() {
    let harness = Harness::start().await;
    let mut request = Request::new(harness.request("run 5000").await);
    request.set_timeout(Duration::from_millis(300));
    let started = Instant::now();
    let mut stream = harness.jobs().displace(request).await.unwrap().into_inner();
    let status = loop {
        match stream.message().await {
            Ok(update) => assert!(!matches!(update.unwrap().update, Some(Update::Result(_)))),
            Err(status) => break status,
        }
    };
    assert_eq!(status.code(), Code::DeadlineExceeded);
    assert_eq!(status.get_details_error_info().unwrap().reason, "DEADLINE_EXCEEDED");
    assert!(started.elapsed() < Duration::from_secs(2));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_deadline_ends_an_upload_with_deadline_exceeded() {
    let harness = Harness::start().await;
    // The client keeps the same deadline, and on a busy machine it is sometimes the first to say so.
    for _ in 0..10 {
        let stalled = futures::stream::once(async {
            v1::WriteRequest { name: super::name_of(&super::digest_of(b"x")), ..Default::default() }
        });
        let mut request = Request::new(futures::StreamExt::chain(stalled, futures::stream::pending()));
        request.metadata_mut().insert("grpc-timeout", "200m".parse().unwrap());
        let status = harness.assets().write(request).await.unwrap_err();
        if status.code() == Code::DeadlineExceeded {
            return;
        }
        assert!(status.code() == Code::Cancelled && status.message() == "Timeout expired", "{status:?}");
    }
    panic!("the server never ended the upload");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_message_above_the_limit_is_refused() {
    let harness = Harness::start().await;
    let bytes = vec![0; 5 << 20];
    let part = v1::WritePartRequest {
        name: super::name_of(&super::digest_of(&bytes)),
        data: bytes.into(),
        ..Default::default()
    };
    let status = harness.assets().write_part(part).await.unwrap_err();
    assert_eq!(status.code(), Code::OutOfRange);
}

#[tokio::test(flavor = "multi_thread")]
async fn browsers_of_named_origins_get_their_preflight() {
    let server = on_port(|config| config.cors_origins = vec!["https://example.org".into()]).await;
    let ask = |origin: &'static str| async move {
        let mut socket = TcpStream::connect(server.address).await.unwrap();
        let request = format!(
            "OPTIONS /displace.v1.Server/GetStatistics HTTP/1.1\r\nhost: x\r\norigin: {origin}\r\n\
             access-control-request-method: POST\r\naccess-control-request-headers: x-grpc-web\r\nconnection: close\r\n\r\n"
        );
        socket.write_all(request.as_bytes()).await.unwrap();
        let mut answer = String::new();
        socket.read_to_string(&mut answer).await.unwrap();
        answer
    };
    let answer = ask("https://example.org").await;
    assert!(answer.contains("access-control-allow-origin: https://example.org"), "{answer}");
    assert!(!ask("https://example.com").await.contains("access-control-allow-origin"));
}

#[tokio::test(flavor = "multi_thread")]
async fn grpc_web_calls_are_answered() {
    let server = on_port(|_| {}).await;
    let mut socket = TcpStream::connect(server.address).await.unwrap();
    let head = "POST /displace.v1.Server/GetStatistics HTTP/1.1\r\nhost: x\r\ncontent-type: application/grpc-web+proto\r\n\
                content-length: 5\r\nconnection: close\r\n\r\n";
    socket.write_all(head.as_bytes()).await.unwrap();
    socket.write_all(&[0; 5]).await.unwrap();
    let mut answer = Vec::new();
    socket.read_to_end(&mut answer).await.unwrap();
    let answer = String::from_utf8_lossy(&answer);
    assert!(answer.starts_with("HTTP/1.1 200") && answer.contains("grpc-status:0"), "{answer}");
}

#[tokio::test(flavor = "multi_thread")]
async fn shutdown_finishes_what_runs_and_hands_back_what_waits() {
    let server = on_port(|_| {}).await;
    let channel = tonic::transport::Channel::from_shared(server.url.clone()).unwrap().connect().await.unwrap();
    let mut assets = v1::assets_client::AssetsClient::new(channel.clone());
    let mesh = super::put(&mut assets, b"mesh").await;
    let start = |script: &'static str| {
        let (mesh, channel) = (mesh.clone(), channel.clone());
        tokio::spawn(async move {
            let mut jobs = v1::displacement_client::DisplacementClient::new(channel);
            super::updates(&mut jobs, super::request(mesh, script)).await
        })
    };
    let running = start("run 1500");
    tokio::time::sleep(Duration::from_millis(400)).await;
    let waiting = start("run 1500 2");
    tokio::time::sleep(Duration::from_millis(200)).await;
    server.stop.send(()).unwrap();
    let Some(Update::Error(error)) = waiting.await.unwrap().pop() else { panic!("not handed back") };
    assert_eq!(error.code, Code::Unavailable as i32);
    super::result(&running.await.unwrap());
    server.ended.await.unwrap().unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_peer_that_neither_speaks_nor_leaves_does_not_hold_the_server() {
    let server = on_port(|config| config.shutdown_secs = 1).await;
    let silent = TcpStream::connect(server.address).await.unwrap();
    tokio::time::sleep(Duration::from_millis(100)).await;
    let started = Instant::now();
    server.stop.send(()).unwrap();
    server.ended.await.unwrap().unwrap();
    assert!(started.elapsed() < Duration::from_secs(3), "{:?}", started.elapsed());
    drop(silent);
}
