//! The gRPC surface: services, health, reflection, gRPC-Web, and the layers around them.
//! Handlers parse, call, convert; nothing is decided here that is not about the transport.

use std::{sync::Arc, time::Duration};

use displace_proto::v1::{
    assets_server::AssetsServer, displacement_server::DisplacementServer, server_server::ServerServer,
};
use tonic::{
    codegen::http::HeaderName,
    service::{Routes, RoutesBuilder},
    transport::Server,
};
use tonic_health::server::{HealthReporter, health_reporter};
use tower::layer::util::{Identity, Stack};

use crate::{
    config::Config,
    domain::{Error, Result},
    jobs::{Jobs, Recipes},
    store::Store,
};

mod assets;
mod convert;
mod cors;
mod deadline;
mod displacement;
mod server;
mod status;
mod tenant;

pub use cors::CorsLayer;
pub use deadline::DeadlineLayer;

/// Everything a handler can call.
#[derive(Clone)]
pub(crate) struct Services {
    pub(crate) store: Arc<Store>,
    pub(crate) jobs: Arc<Jobs>,
    pub(crate) recipes: Arc<dyn Recipes>,
    pub(crate) config: Arc<Config>,
    /// Uploads and downloads that may run at once.
    pub(crate) transfers: Arc<tokio::sync::Semaphore>,
    /// Meshes that may be read at once by Describe and Estimate, which pass by the queue of jobs.
    pub(crate) readings: Arc<tokio::sync::Semaphore>,
}

/// Health services: `live` is the process, `ready` takes work, and the empty name is `ready`.
#[derive(Clone)]
pub(crate) struct Health(HealthReporter);

impl Health {
    pub(crate) async fn set_ready(&self, ready: bool) {
        let status = if ready { tonic_health::ServingStatus::Serving } else { tonic_health::ServingStatus::NotServing };
        for service in ["", "ready"] {
            self.0.set_service_status(service, status).await;
        }
    }
}

/// All services behind one address.
pub(crate) async fn routes(services: Services) -> Result<(Routes, Health)> {
    let (reporter, health) = health_reporter();
    reporter.set_service_status("live", tonic_health::ServingStatus::Serving).await;
    let reporter = Health(reporter);
    reporter.set_ready(true).await;

    let limit = services.config.max_message_bytes as usize;
    let mut routes = RoutesBuilder::default();
    routes
        .add_service(health)
        .add_service(reflection().build_v1().map_err(bad_descriptors)?)
        .add_service(reflection().build_v1alpha().map_err(bad_descriptors)?)
        .add_service(AssetsServer::new(assets::AssetsService(services.clone())).max_decoding_message_size(limit))
        .add_service(
            DisplacementServer::new(displacement::DisplacementService(services.clone()))
                .max_decoding_message_size(limit),
        )
        .add_service(ServerServer::new(server::ServerService(services)).max_decoding_message_size(limit));
    Ok((routes.routes(), reporter))
}

fn reflection() -> tonic_reflection::server::Builder<'static> {
    tonic_reflection::server::Builder::configure()
        .register_encoded_file_descriptor_set(displace_proto::FILE_DESCRIPTOR_SET)
        .register_encoded_file_descriptor_set(tonic_health::pb::FILE_DESCRIPTOR_SET)
        .register_encoded_file_descriptor_set(displace_proto::rpc::FILE_DESCRIPTOR_SET)
}

fn bad_descriptors(cause: tonic_reflection::server::Error) -> Error {
    Error::internal("the API's own descriptors do not fit together").with_cause(cause)
}

type Layers = Stack<tonic_web::GrpcWebLayer, Stack<DeadlineLayer, Stack<CorsLayer, Identity>>>;

/// The transport as configured: keepalive, windows, ages, and the layers.
pub(crate) fn transport(config: &Config) -> Result<Server<Layers>> {
    let secs = |secs: u64| Duration::from_secs(secs);
    let server = Server::builder()
        .accept_http1(true)
        .http2_keepalive_interval(Some(secs(config.keepalive_secs)))
        .http2_keepalive_timeout(Some(secs(config.keepalive_timeout_secs)))
        .initial_stream_window_size(config.stream_window_bytes)
        .initial_connection_window_size(config.connection_window_bytes)
        .max_concurrent_streams(config.max_streams)
        .max_connection_age(secs(config.max_connection_age_secs))
        .max_connection_age_grace(secs(config.max_connection_age_grace_secs))
        .layer(CorsLayer::new(&config.cors_origins)?)
        .layer(DeadlineLayer)
        .layer(tonic_web::GrpcWebLayer::new());
    Ok(server)
}

/// Response headers a browser may read.
pub(crate) const EXPOSED_HEADERS: [HeaderName; 3] = [
    HeaderName::from_static("grpc-status"),
    HeaderName::from_static("grpc-message"),
    HeaderName::from_static("grpc-status-details-bin"),
];
