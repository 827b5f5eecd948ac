//! The boundary between running jobs and doing them.

use bytes::Bytes;

use crate::{
    domain::{
        Digest, Result,
        cancel::{Cancel, Progress},
        chart::ChartRequest,
        describe::Description,
        report::{Estimate, Report},
        request::{CompareRequest, DisplaceRequest, EstimateRequest, MeasureRequest, RenderRequest},
        sequence::SequenceRequest,
    },
    render::{Executor, JobContext},
    store::TenantStore,
};

/// One piece of work: a pure function of what `canonical` returns and of the assets that names.
pub trait Work: Send + 'static {
    /// Word for logs and statistics: `displace`, `render`, `measure`, `compare`, `chart`, `sequence`.
    fn kind(&self) -> &'static str;

    /// Method in lower case, for statistics; what is worked on where a kind has none.
    fn method(&self) -> &'static str;

    /// The request with defaults applied and digests in it, in one fixed form: equal requests give equal bytes.
    fn canonical(&self) -> Vec<u8>;

    /// Host memory for admission: what inputs and outputs take at most, as far as the request tells.
    fn host_bytes(&self) -> u64;

    /// Does it, on the device's thread. Long loops call `context.cancel.check()`.
    fn run(&self, context: &WorkContext<'_>) -> Result<WorkOutput>;
}

/// What work has at hand.
pub struct WorkContext<'a> {
    pub executor: &'a dyn Executor,
    pub assets: &'a dyn AssetReader,
    pub cancel: &'a Cancel,
    pub progress: &'a dyn Progress,
    pub limits: &'a JobLimits,
}

impl<'a> WorkContext<'a> {
    /// The part an executor needs.
    #[must_use]
    pub fn job(&self) -> JobContext<'a> {
        JobContext { cancel: self.cancel, progress: self.progress }
    }
}

/// What work may take.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JobLimits {
    /// Host memory of all jobs together, and so of one.
    pub host_bytes: u64,
    /// Device memory of one job.
    pub device_bytes: u64,
    /// Largest width and height of an image.
    pub max_image_pixels: u32,
}

/// What work made. `report.cached` and `report.total_ms` are set by the queue.
#[derive(Clone, Debug, Default)]
pub struct WorkOutput {
    pub report: Report,
    pub outputs: Vec<Output>,
}

/// One file that work made.
#[derive(Clone, Debug)]
pub struct Output {
    /// With the file ending of its type: `mesh.glb`.
    pub name: String,
    pub media_type: String,
    pub bytes: Bytes,
}

/// Assets by digest, for code that is not async.
pub trait AssetReader: Send + Sync {
    /// All bytes, verified. `Missing` when not stored.
    fn read(&self, digest: &Digest) -> Result<Bytes>;
}

/// Turns requests into work, and answers what needs no device.
pub trait Recipes: Send + Sync + 'static {
    fn displace(&self, request: DisplaceRequest) -> Box<dyn Work>;

    fn render(&self, request: RenderRequest) -> Box<dyn Work>;

    fn sequence(&self, request: SequenceRequest) -> Box<dyn Work>;

    fn compare(&self, request: CompareRequest) -> Box<dyn Work>;

    fn chart(&self, request: ChartRequest) -> Box<dyn Work>;

    fn measure(&self, request: MeasureRequest) -> Box<dyn Work>;

    /// `resources`: external files of a .gltf by URI.
    fn describe(&self, assets: &dyn AssetReader, mesh: &Digest, resources: &[(String, Digest)]) -> Result<Description>;

    fn estimate(&self, assets: &dyn AssetReader, limits: &JobLimits, request: &EstimateRequest) -> Result<Estimate>;
}

/// The canonical form of a request. Requests serialise without maps, so the order of their fields is fixed.
pub(super) fn canonical(request: &impl serde::Serialize) -> Vec<u8> {
    let mut bytes = Vec::new();
    if let Err(fault) = serde_json::to_writer(&mut bytes, request) {
        // Only a type that JSON cannot hold gets here; such a request must not share a key with another.
        tracing::error!(%fault, "a request has no canonical form");
        bytes = uuid::Uuid::new_v4().as_bytes().to_vec();
    }
    bytes
}

/// A tenant's assets, read from threads outside the async runtime.
pub struct StoreReader {
    store: TenantStore,
    runtime: tokio::runtime::Handle,
}

impl StoreReader {
    #[must_use]
    pub fn new(store: TenantStore, runtime: tokio::runtime::Handle) -> Self {
        Self { store, runtime }
    }
}

impl AssetReader for StoreReader {
    fn read(&self, digest: &Digest) -> Result<Bytes> {
        self.runtime.block_on(self.store.get(digest))
    }
}
