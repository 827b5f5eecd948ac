//! Handlers of `displace.v1.Displacement`.

use std::time::Duration;

use displace_proto::v1::{self, displacement_server::Displacement};
use futures::{StreamExt as _, stream, stream::BoxStream};
use tonic::{Request, Response, Status, metadata::MetadataMap};

use super::{Services, convert, status::status, tenant};
use crate::{
    domain::{Digest, Error, ErrorKind, Result, report::Estimate, request::EstimateRequest},
    jobs::{Listener, StoreReader, Submission, Work},
    store::TenantStore,
};

pub(super) struct DisplacementService(pub(super) Services);

type Updates = BoxStream<'static, Result<v1::JobUpdate, Status>>;

impl DisplacementService {
    fn store(&self, metadata: &MetadataMap) -> Result<TenantStore> {
        Ok(self.0.store.tenant(tenant::of(metadata)?))
    }

    fn work(&self, request: EstimateRequest) -> Box<dyn Work> {
        match request {
            EstimateRequest::Displace(request) => self.0.recipes.displace(*request),
            EstimateRequest::Render(request) => self.0.recipes.render(*request),
        }
    }

    /// Joins or starts the job, and passes on what it tells.
    async fn updates(
        &self,
        assets: &[Digest],
        work: Box<dyn Work>,
        how: Submission,
        store: TenantStore,
    ) -> Result<Updates> {
        self.require(assets, &store).await?;
        let listener = self.0.jobs.submit(work, store, how).await?;
        Ok(stream::unfold(listener, next_update).boxed())
    }

    /// Refuses a job whose assets are not there, before it takes a place in the queue.
    async fn require(&self, assets: &[Digest], store: &TenantStore) -> Result<()> {
        let missing = store.missing(assets).await?;
        if missing.is_empty() {
            return Ok(());
        }
        let (count, first) = (missing.len(), missing[0].resource_name());
        let message = format!("{count} assets are not stored, first {first}; upload them and call again");
        Err(Error::new(ErrorKind::Missing(missing), message))
    }

    async fn describe(&self, request: Request<v1::DescribeRequest>) -> Result<v1::DescribeResponse> {
        let store = self.store(request.metadata())?;
        let (mesh, resources) = convert::mesh_source("mesh", request.into_inner().mesh)?;
        let assets: Vec<Digest> = resources.iter().map(|(_, asset)| *asset).chain([mesh]).collect();
        self.require(&assets, &store).await?;
        let (recipes, reader) = (self.0.recipes.clone(), StoreReader::new(store, tokio::runtime::Handle::current()));
        let described = self.read(move || recipes.describe(&reader, &mesh, &resources)).await?;
        Ok(convert::to_description(&described))
    }

    async fn estimate(&self, request: Request<v1::EstimateRequest>) -> Result<v1::EstimateResponse> {
        let store = self.store(request.metadata())?;
        let request = convert::estimate(request.into_inner(), &self.0.config)?;
        self.require(&request.assets(), &store).await?;
        let work = self.work(request.clone());
        let (key, seconds) = (self.0.jobs.key(work.as_ref(), &store), self.0.jobs.expected_secs(work.as_ref()));
        let cached = self.0.jobs.stored(&key, &store).await?.is_some();
        let estimate = self.estimate_of(request, store).await?;
        Ok(convert::to_estimate(&estimate, seconds, cached))
    }

    async fn estimate_of(&self, request: EstimateRequest, store: TenantStore) -> Result<Estimate> {
        let (recipes, limits) = (self.0.recipes.clone(), self.0.jobs.options().limits.clone());
        let reader = StoreReader::new(store, tokio::runtime::Handle::current());
        self.read(move || recipes.estimate(&reader, &limits, &request)).await
    }

    /// Runs what reads a mesh beside the async runtime, a few at a time. Callers that leave give up their place.
    async fn read<T: Send + 'static>(&self, reading: impl FnOnce() -> Result<T> + Send + 'static) -> Result<T> {
        let place = self.0.readings.clone().acquire_owned().await;
        let place = place.map_err(|cause| Error::internal("the server takes no more readings").with_cause(cause))?;
        let span = tracing::Span::current();
        let done = tokio::task::spawn_blocking(move || {
            // Held to the end of the work, even when the caller is gone.
            let _place = place;
            span.in_scope(reading)
        });
        done.await.map_err(|cause| Error::internal("the call failed by a fault of the server").with_cause(cause))?
    }
}

#[tonic::async_trait]
impl Displacement for DisplacementService {
    type DisplaceStream = Updates;
    type RenderStream = Updates;
    type ChartStream = Updates;
    type CompareStream = Updates;
    type MeasureStream = Updates;

    async fn describe(&self, request: Request<v1::DescribeRequest>) -> Result<Response<v1::DescribeResponse>, Status> {
        answer(self.describe(request).await)
    }

    async fn estimate(&self, request: Request<v1::EstimateRequest>) -> Result<Response<v1::EstimateResponse>, Status> {
        answer(self.estimate(request).await)
    }

    async fn displace(&self, request: Request<v1::DisplaceRequest>) -> Result<Response<Updates>, Status> {
        let updates = async {
            let store = self.store(request.metadata())?;
            let how = how_of_surface(request.get_ref());
            let request = convert::displace("", request.into_inner())?;
            self.updates(&request.assets(), self.0.recipes.displace(request), how, store).await
        };
        answer(updates.await)
    }

    async fn render(&self, request: Request<v1::RenderRequest>) -> Result<Response<Updates>, Status> {
        let updates = async {
            let store = self.store(request.metadata())?;
            let how = request.get_ref().surface.as_ref().map(how_of_surface).unwrap_or_default();
            let message = request.into_inner();
            if message.sequence.is_some() {
                let request = convert::sequence(message, &self.0.config)?;
                return self.updates(&request.assets(), self.0.recipes.sequence(request), how, store).await;
            }
            let request = convert::render("", message, &self.0.config)?;
            self.updates(&request.assets(), self.0.recipes.render(request), how, store).await
        };
        answer(updates.await)
    }

    async fn measure(&self, request: Request<v1::MeasureRequest>) -> Result<Response<Updates>, Status> {
        let updates = async {
            let store = self.store(request.metadata())?;
            let message = request.into_inner();
            let how = how(message.fresh, message.linger_secs);
            let request = convert::measure(message)?;
            self.updates(&request.assets(), self.0.recipes.measure(request), how, store).await
        };
        answer(updates.await)
    }

    async fn chart(&self, request: Request<v1::ChartRequest>) -> Result<Response<Updates>, Status> {
        let updates = async {
            let store = self.store(request.metadata())?;
            let surface = request.get_ref().render.as_ref().and_then(|render| render.surface.as_ref());
            let how = surface.map(how_of_surface).unwrap_or_default();
            let request = convert::chart(request.into_inner(), &self.0.config)?;
            self.updates(&request.assets(), self.0.recipes.chart(request), how, store).await
        };
        answer(updates.await)
    }

    async fn compare(&self, request: Request<v1::CompareRequest>) -> Result<Response<Updates>, Status> {
        let updates = async {
            let store = self.store(request.metadata())?;
            let message = request.get_ref();
            let request = convert::compare(message)?;
            let how = how(message.fresh, message.linger_secs);
            self.updates(&[request.a, request.b], self.0.recipes.compare(request), how, store).await
        };
        answer(updates.await)
    }
}

async fn next_update(mut listener: Listener) -> Option<(Result<v1::JobUpdate, Status>, Listener)> {
    let event = listener.next().await?;
    Some((Ok(convert::to_update(&event)), listener))
}

fn how_of_surface(request: &v1::DisplaceRequest) -> Submission {
    how(request.fresh, request.linger_secs)
}

fn how(fresh: bool, linger_secs: Option<u32>) -> Submission {
    Submission { fresh, linger: linger_secs.map(|secs| Duration::from_secs(secs.into())) }
}

fn answer<T>(result: Result<T>) -> Result<Response<T>, Status> {
    result.map(Response::new).map_err(|error| status(&error))
}
