//! The whole service, put together: store, jobs, gRPC. Over TCP for `displaced`, over a pipe for the command
//! line: both run the same router.

use std::{future::Future, net::SocketAddr, sync::Arc, time::Duration};

use tokio::{net::TcpListener, sync::mpsc};
use tokio_stream::wrappers::UnboundedReceiverStream;
use tonic::{
    service::Routes,
    transport::{Channel, Endpoint, Uri, server::TcpIncoming},
};

use crate::{
    config::Config,
    domain::{Error, Result},
    grpc::{self, Health, Services},
    jobs::{JobLimits, JobOptions, Jobs, OpenExecutor, Recipes, StandardRecipes},
    render::{self, ExecutorOptions},
    store::{Store, StoreOptions},
};

/// Bytes a pipe holds in each direction.
const PIPE_BYTES: usize = 1 << 20;

/// How jobs are made and on what they run; tests bring their own.
#[derive(Clone)]
pub struct Parts {
    pub recipes: Arc<dyn Recipes>,
    pub open: OpenExecutor,
}

impl Parts {
    /// The real ones: all jobs of this version, on the device the configuration names.
    #[must_use]
    pub fn standard(config: &Config) -> Self {
        Self::on(executor_options(config))
    }

    fn on(options: ExecutorOptions) -> Self {
        Self { recipes: Arc::new(StandardRecipes), open: Arc::new(move || render::open(&options)) }
    }
}

fn executor_options(config: &Config) -> ExecutorOptions {
    ExecutorOptions {
        device: Some(config.device.clone()).filter(|device| !device.is_empty()),
        validation: config.validation,
        cache: config.cache.clone(),
        device_bytes: config.device_bytes,
        warm_up: false,
    }
}

/// Serves until SIGTERM or SIGINT, then drains and returns.
pub async fn serve(config: Config) -> Result<()> {
    let parts = Parts::on(ExecutorOptions { warm_up: true, ..executor_options(&config) });
    let signal = shutdown_signal()?;
    Service::start(config, parts).await?.bind().await?.run(signal).await
}

/// Starts the service inside this process, without a port. Call within a tokio runtime.
pub async fn in_process(config: Config) -> Result<InProcess> {
    let parts = Parts::standard(&config);
    Ok(Service::start(config, parts).await?.in_process())
}

/// The service, ready to be given a transport.
pub struct Service {
    config: Arc<Config>,
    jobs: Arc<Jobs>,
    routes: Routes,
    health: Health,
}

impl Service {
    /// Opens store and device.
    pub async fn start(config: Config, parts: Parts) -> Result<Self> {
        let config = Arc::new(config.check()?);
        let store = Store::open(store_options(&config)).await?;
        let jobs = Arc::new(Jobs::start(parts.open, job_options(&config)).await?);
        let services = Services {
            store,
            jobs: Arc::clone(&jobs),
            recipes: parts.recipes,
            transfers: Arc::new(tokio::sync::Semaphore::new(config.max_transfers as usize)),
            readings: Arc::new(tokio::sync::Semaphore::new(
                std::thread::available_parallelism().map_or(2, usize::from),
            )),
            config: Arc::clone(&config),
        };
        let (routes, health) = grpc::routes(services).await?;
        Ok(Self { config, jobs, routes, health })
    }

    /// Takes the configured address.
    pub async fn bind(self) -> Result<Bound> {
        let wanted = self.config.listen;
        let cannot = |cause| Error::invalid("listen", format!("cannot listen on {wanted}: {cause}"));
        let listener = TcpListener::bind(wanted).await.map_err(cannot)?;
        let address = listener.local_addr().map_err(cannot)?;
        Ok(Bound { service: self, listener, address })
    }

    /// Serves pipes to callers in this process.
    #[must_use]
    pub fn in_process(self) -> InProcess {
        let (pipes, incoming) = mpsc::unbounded_channel::<std::io::Result<tokio::io::DuplexStream>>();
        let incoming = UnboundedReceiverStream::new(incoming);
        let jobs = Arc::clone(&self.jobs);
        let served = grpc::transport(&self.config).map(|transport| {
            tokio::spawn(async move { transport.serve_with_incoming(self.routes.prepare(), incoming).await })
        });
        InProcess { pipes, jobs, _served: served.ok() }
    }
}

/// How long the device may take to stop: a submission, and the last of a host step.
const DEVICE_SHUTDOWN: Duration = Duration::from_secs(5);

/// The service with its address.
pub struct Bound {
    service: Service,
    listener: TcpListener,
    /// The address taken, its port known.
    pub address: SocketAddr,
}

impl Bound {
    /// Serves until `signal`; then: not ready, `drain_secs`, no new work, `shutdown_secs` at most.
    pub async fn run(self, signal: impl Future<Output = ()>) -> Result<()> {
        let Service { config, jobs, routes, health } = self.service;
        let (device, store) = (jobs.device_name().to_owned(), config.store.display().to_string());
        tracing::info!(address = %self.address, device, store, build_id = crate::jobs::BUILD_ID, "ready");
        let stop = Arc::new(tokio::sync::Notify::new());
        let stopped = Arc::clone(&stop);
        let incoming = TcpIncoming::from(self.listener).with_nodelay(Some(true));
        let transport = grpc::transport(&config)?;
        let serving =
            transport.serve_with_incoming_shutdown(routes.prepare(), incoming, async move { stopped.notified().await });
        let draining = drain(&config, &jobs, &health, signal, &stop);
        let served = tokio::select! {
            served = serving => served.map_err(|cause| Error::internal("the transport failed").with_cause(cause)),
            () = draining => Ok(()),
        };
        // A driver must not be at work when the process ends.
        let finished = tokio::task::spawn_blocking(move || jobs.finish());
        if tokio::time::timeout(DEVICE_SHUTDOWN, finished).await.is_err() {
            tracing::warn!("the device did not stop in time");
        }
        served
    }
}

/// Ends when the time is up; when all calls end before that, nobody waits for it.
async fn drain(
    config: &Config,
    jobs: &Jobs,
    health: &Health,
    signal: impl Future<Output = ()>,
    stop: &tokio::sync::Notify,
) {
    tokio::select! {
        () = signal => {}
        () = device_lost(jobs) => {}
    }
    tracing::info!(drain_secs = config.drain_secs, shutdown_secs = config.shutdown_secs, "shutting down");
    health.set_ready(false).await;
    tokio::time::sleep(Duration::from_secs(config.drain_secs)).await;
    jobs.close();
    stop.notify_one();
    tokio::time::sleep(Duration::from_secs(config.shutdown_secs)).await;
    tracing::warn!("calls under way did not finish in time: cut off");
    jobs.abort();
}

/// A server whose device does not come back is of no use; whatever runs it starts it anew.
async fn device_lost(jobs: &Jobs) {
    while jobs.is_open() {
        tokio::time::sleep(Duration::from_secs(1)).await;
    }
}

/// The service in this process. Dropping it cancels what runs.
pub struct InProcess {
    pipes: mpsc::UnboundedSender<std::io::Result<tokio::io::DuplexStream>>,
    jobs: Arc<Jobs>,
    _served: Option<tokio::task::JoinHandle<Result<(), tonic::transport::Error>>>,
}

impl InProcess {
    /// One end of a new connection.
    #[must_use]
    pub fn connect(&self) -> tokio::io::DuplexStream {
        connect(&self.pipes)
    }

    /// A channel to the service. It connects anew by itself, and needs this value to live.
    #[must_use]
    pub fn channel(&self) -> Channel {
        let pipes = self.pipes.clone();
        let connector = tower::service_fn(move |_: Uri| {
            let pipe = connect(&pipes);
            async move { Ok::<_, std::io::Error>(hyper_util::rt::TokioIo::new(pipe)) }
        });
        // The address is a name for the authority header; nothing is resolved.
        Endpoint::from_static("http://displace.in-process")
            .initial_stream_window_size(4 << 20)
            .initial_connection_window_size(8 << 20)
            .connect_with_connector_lazy(connector)
    }

    /// Name of the device that runs jobs.
    #[must_use]
    pub fn device_name(&self) -> &str {
        self.jobs.device_name()
    }
}

impl InProcess {
    /// Cancels what runs and waits until the device is closed. Blocks.
    pub fn stop(self) {
        self.jobs.finish();
    }
}

impl Drop for InProcess {
    fn drop(&mut self) {
        self.jobs.close();
        self.jobs.abort();
    }
}

fn connect(pipes: &mpsc::UnboundedSender<std::io::Result<tokio::io::DuplexStream>>) -> tokio::io::DuplexStream {
    let (ours, theirs) = tokio::io::duplex(PIPE_BYTES);
    // If the service is gone its end is dropped here, and the caller sees a closed connection.
    drop(pipes.send(Ok(theirs)));
    ours
}

fn store_options(config: &Config) -> StoreOptions {
    StoreOptions {
        root: config.store.clone(),
        limit_bytes: config.store_bytes,
        max_asset_bytes: config.max_asset_bytes,
        keep: Duration::from_secs(config.store_keep_secs),
        upload_ttl: Duration::from_secs(config.upload_ttl_secs),
    }
}

fn job_options(config: &Config) -> JobOptions {
    JobOptions {
        max_queued: config.max_queued_jobs,
        limits: JobLimits {
            host_bytes: config.job_bytes,
            device_bytes: config.device_bytes,
            max_image_pixels: config.max_image_pixels,
        },
        linger: Duration::from_secs(config.linger_secs),
    }
}

/// SIGTERM or SIGINT.
fn shutdown_signal() -> Result<impl Future<Output = ()>> {
    use tokio::signal::unix::{SignalKind, signal};
    let install = |kind| signal(kind).map_err(|cause| Error::internal("cannot wait for signals").with_cause(cause));
    let (mut terminate, mut interrupt) = (install(SignalKind::terminate())?, install(SignalKind::interrupt())?);
    Ok(async move {
        tokio::select! {
            _ = terminate.recv() => {}
            _ = interrupt.recv() => {}
        }
    })
}
