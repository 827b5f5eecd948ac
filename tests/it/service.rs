//! The service over its API, with work of the tests' own: what it does to the device does not matter here,
//! what happens to calls, bytes and jobs does.

mod assets;
mod jobs;
mod process;
mod transport;
mod uploads;

use std::{
    sync::{
        Arc, Mutex,
        atomic::{AtomicU32, Ordering},
    },
    time::{Duration, Instant},
};

use bytes::Bytes;
use displace_proto::v1::{
    self, assets_client::AssetsClient, displacement_client::DisplacementClient, job_update::Update,
    server_client::ServerClient,
};
use displace_server::{
    config::Config,
    domain::{
        Digest, Error, Result,
        chart::ChartRequest,
        describe::Description,
        detail::Detail,
        image::{ImagePlan, ImageSet, RenderScene},
        mesh::Mesh,
        plan::SurfacePlan,
        report::{Estimate, PassTime, Report, Warning},
        request::{CompareRequest, DisplaceRequest, EstimateRequest, MeasureRequest, RenderRequest, SourceRequest},
        sequence::SequenceRequest,
        surface::{Shape, Surface},
    },
    jobs::{AssetReader, JobLimits, Output, Recipes, StandardRecipes, Work, WorkContext, WorkOutput},
    render::{Executor, JobContext},
    service::{InProcess, Parts, Service},
};
use futures::StreamExt as _;
use tonic::transport::Channel;

/// A service in this process with a store of its own.
pub(crate) struct Harness {
    pub(crate) service: InProcess,
    pub(crate) channel: Channel,
    pub(crate) spy: Arc<Spy>,
    pub(crate) folder: tempfile::TempDir,
}

/// What the work of the tests saw.
#[derive(Default)]
pub(crate) struct Spy {
    pub(crate) runs: AtomicU32,
    pub(crate) stopped_at: Mutex<Option<Instant>>,
}

impl Harness {
    pub(crate) async fn start() -> Self {
        Self::with(|_| {}).await
    }

    pub(crate) async fn with(change: impl FnOnce(&mut Config)) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let mut config = test_config(&folder);
        change(&mut config);
        let spy = Arc::new(Spy::default());
        let service = Service::start(config, parts(&spy)).await.unwrap().in_process();
        Self { channel: service.channel(), service, spy, folder }
    }

    pub(crate) fn assets(&self) -> AssetsClient<Channel> {
        AssetsClient::new(self.channel.clone())
    }

    pub(crate) fn jobs(&self) -> DisplacementClient<Channel> {
        DisplacementClient::new(self.channel.clone())
    }

    pub(crate) fn server(&self) -> ServerClient<Channel> {
        ServerClient::new(self.channel.clone())
    }

    /// Stores bytes by BatchWrite.
    pub(crate) async fn put(&self, bytes: &[u8]) -> v1::Digest {
        put(&mut self.assets(), bytes).await
    }

    /// A request whose expression tells the work what to do, on a mesh that is stored.
    pub(crate) async fn request(&self, script: &str) -> v1::DisplaceRequest {
        request(self.put(b"mesh").await, script)
    }

    pub(crate) async fn displace(&self, script: &str) -> Vec<Update> {
        let request = self.request(script).await;
        updates(&mut self.jobs(), request).await
    }

    pub(crate) async fn statistics(&self) -> v1::GetStatisticsResponse {
        self.server().get_statistics(v1::GetStatisticsRequest {}).await.unwrap().into_inner()
    }

    pub(crate) fn runs(&self) -> u32 {
        self.spy.runs.load(Ordering::SeqCst)
    }

    /// Waits until a job runs.
    pub(crate) async fn until_running(&self, runs: u32) {
        until(|| self.runs() >= runs).await;
    }
}

pub(crate) fn test_config(folder: &tempfile::TempDir) -> Config {
    Config {
        store: folder.path().join("store"),
        cache: folder.path().join("cache"),
        linger_secs: 1,
        ..Config::default()
    }
}

pub(crate) fn parts(spy: &Arc<Spy>) -> Parts {
    Parts { recipes: Arc::new(TestRecipes(Arc::clone(spy))), open: Arc::new(|| Ok(Box::new(NoDevice))) }
}

pub(crate) async fn until(mut holds: impl FnMut() -> bool) {
    let started = Instant::now();
    while !holds() {
        assert!(started.elapsed() < Duration::from_secs(20), "waited too long");
        tokio::time::sleep(Duration::from_millis(2)).await;
    }
}

pub(crate) async fn put(assets: &mut AssetsClient<Channel>, bytes: &[u8]) -> v1::Digest {
    let digest = digest_of(bytes);
    let blob = v1::batch_write_request::Blob { digest: Some(digest.clone()), data: Bytes::copy_from_slice(bytes) };
    let answer = assets.batch_write(v1::BatchWriteRequest { blobs: vec![blob] }).await.unwrap().into_inner();
    assert_eq!(answer.entries[0].status.as_ref().unwrap().code, 0, "{answer:?}");
    digest
}

pub(crate) async fn updates(jobs: &mut DisplacementClient<Channel>, request: v1::DisplaceRequest) -> Vec<Update> {
    let stream = jobs.displace(request).await.unwrap().into_inner();
    stream.map(|update| update.unwrap().update.unwrap()).collect().await
}

/// The last update, which must be a result.
pub(crate) fn result(updates: &[Update]) -> &v1::JobResult {
    match updates.last() {
        Some(Update::Result(result)) => result,
        other => panic!("no result but {other:?}"),
    }
}

pub(crate) fn digest_of(bytes: &[u8]) -> v1::Digest {
    let digest = Digest::of(bytes);
    v1::Digest { hash: digest.hex(), size_bytes: digest.size_bytes }
}

pub(crate) fn name_of(digest: &v1::Digest) -> String {
    format!("assets/sha256/{}/{}", digest.hash, digest.size_bytes)
}

pub(crate) fn request(mesh: v1::Digest, script: &str) -> v1::DisplaceRequest {
    let expression = v1::layer::Source::Expression(v1::Expression { source: script.into() });
    let layer = v1::Layer { source: Some(expression), ..Default::default() };
    let refinement = Some(v1::geometry::Refinement::UniformLevel(0));
    v1::DisplaceRequest {
        mesh: Some(v1::MeshSource { asset: Some(mesh), resources: Vec::new() }),
        details: vec![v1::MaterialDetail { layers: vec![layer], ..Default::default() }],
        geometry: Some(v1::Geometry { refinement, ..Default::default() }),
        ..Default::default()
    }
}

/// Makes jobs of scripts: `ok`, `warn`, `panic`, `fail`, `run MILLISECONDS`, `make BYTES`.
struct TestRecipes(Arc<Spy>);

struct ScriptWork {
    script: String,
    request: DisplaceRequest,
    spy: Arc<Spy>,
}

impl Recipes for TestRecipes {
    fn displace(&self, request: DisplaceRequest) -> Box<dyn Work> {
        let script = match &request.details[0].layers[0].source {
            SourceRequest::Expression { source } => source.clone(),
            other => panic!("{other:?}"),
        };
        Box::new(ScriptWork { script, request, spy: Arc::clone(&self.0) })
    }

    fn render(&self, request: RenderRequest) -> Box<dyn Work> {
        self.displace(request.surface)
    }

    fn sequence(&self, request: SequenceRequest) -> Box<dyn Work> {
        StandardRecipes.sequence(request)
    }

    fn compare(&self, request: CompareRequest) -> Box<dyn Work> {
        StandardRecipes.compare(request)
    }

    fn chart(&self, request: ChartRequest) -> Box<dyn Work> {
        StandardRecipes.chart(request)
    }

    fn measure(&self, request: MeasureRequest) -> Box<dyn Work> {
        StandardRecipes.measure(request)
    }

    fn describe(&self, assets: &dyn AssetReader, mesh: &Digest, _: &[(String, Digest)]) -> Result<Description> {
        assets.read(mesh)?;
        Ok(Description { instances: 7, ..Description::default() })
    }

    fn estimate(&self, _: &dyn AssetReader, _: &JobLimits, _: &EstimateRequest) -> Result<Estimate> {
        Ok(Estimate { triangles: Some(12), ..Estimate::default() })
    }
}

impl Work for ScriptWork {
    fn kind(&self) -> &'static str {
        "displace"
    }

    fn method(&self) -> &'static str {
        "displacement"
    }

    fn canonical(&self) -> Vec<u8> {
        serde_json::to_vec(&self.request).unwrap()
    }

    fn host_bytes(&self) -> u64 {
        self.argument("make").unwrap_or(0)
    }

    fn run(&self, context: &WorkContext<'_>) -> Result<WorkOutput> {
        self.spy.runs.fetch_add(1, Ordering::SeqCst);
        context.assets.read(&self.request.mesh)?;
        context.progress.pass("displace", 0, 2);
        let mut report = Report { method: "displacement".into(), triangles: 12, ..Report::default() };
        match self.script.split(' ').next().unwrap_or_default() {
            "panic" => panic!("as the test asked"),
            "fail" => return Err(Error::invalid("details[0].layers[0]", "as the test asked")),
            "warn" => report.warnings.push(Warning::new("as_asked", "as the test asked")),
            "run" => self.spin(context)?,
            _ => {}
        }
        context.progress.pass("displace", 2, 2);
        let bytes =
            self.argument("make").map_or_else(|| self.script.clone().into_bytes(), |bytes| vec![1; bytes as usize]);
        let output = Output { name: "mesh.glb".into(), media_type: "model/gltf-binary".into(), bytes: bytes.into() };
        Ok(WorkOutput { report, outputs: vec![output] })
    }
}

impl ScriptWork {
    fn argument(&self, word: &str) -> Option<u64> {
        let (first, rest) = self.script.split_once(' ')?;
        (first == word).then(|| rest.split(' ').next().unwrap_or_default().parse().unwrap())
    }

    fn spin(&self, context: &WorkContext<'_>) -> Result<()> {
        let until = Instant::now() + Duration::from_millis(self.argument("run").unwrap_or(0));
        while Instant::now() < until {
            if context.cancel.is_cancelled() {
                *self.spy.stopped_at.lock().unwrap() = Some(Instant::now());
                return Err(Error::cancelled());
            }
            std::thread::sleep(Duration::from_millis(2));
        }
        Ok(())
    }
}

/// An executor that the work of the tests never asks for anything.
struct NoDevice;

impl Executor for NoDevice {
    fn device_name(&self) -> &str {
        "none"
    }

    fn device_class(&self) -> &str {
        "test"
    }

    fn displace(
        &self,
        _: &JobContext<'_>,
        _: &SurfacePlan,
        _: &Mesh,
        _: &[Option<Arc<Detail>>],
    ) -> Result<(Surface, Vec<PassTime>)> {
        Err(Error::internal("no device"))
    }

    fn finish(
        &self,
        _: &JobContext<'_>,
        _: &SurfacePlan,
        _: &Mesh,
        _: &[Option<Arc<Detail>>],
        _: Shape,
    ) -> Result<(Surface, Vec<PassTime>)> {
        Err(Error::internal("no device"))
    }

    fn render(&self, _: &JobContext<'_>, _: &ImagePlan, _: &RenderScene) -> Result<(ImageSet, Vec<PassTime>)> {
        Err(Error::internal("no device"))
    }
}
