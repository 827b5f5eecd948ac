//! One job from call to result: shows its updates, calls again after a lost connection (the same request
//! joins the same job), and uploads again what the server has let go meanwhile.

use displace_proto::{
    rpc,
    v1::{
        ChartRequest, CompareRequest, DisplaceRequest, JobResult, JobUpdate, MeasureRequest, RenderRequest,
        displacement_client::DisplacementClient, job_update::Update,
    },
};
use prost::Message as _;
use tonic::{Code, Response, Status, Streaming, transport::Channel};

use crate::{
    connection::{Attempts, Connection, STREAM_DEADLINE, failure, is_transient, missing_assets, request},
    error::{Error, Result},
    output::{Bar, Progress},
    transfer::{Blob, upload},
};

/// Uploads made again before a server that keeps losing them is believed.
const UPLOADS: u32 = 3;

/// What can be asked for.
#[derive(Clone, Debug)]
pub(crate) enum Job {
    Displace(DisplaceRequest),
    Render(Box<RenderRequest>),
    Measure(MeasureRequest),
    Compare(CompareRequest),
    Chart(Box<ChartRequest>),
}

impl Job {
    /// The same job for a caller who waits no longer.
    fn given_up(mut self) -> Self {
        let how = match &mut self {
            Self::Displace(request) => Some((&mut request.linger_secs, &mut request.fresh)),
            Self::Render(request) => request.surface.as_mut().map(|s| (&mut s.linger_secs, &mut s.fresh)),
            Self::Measure(request) => Some((&mut request.linger_secs, &mut request.fresh)),
            Self::Compare(request) => Some((&mut request.linger_secs, &mut request.fresh)),
            Self::Chart(request) => {
                let surface = request.render.as_mut().and_then(|render| render.surface.as_mut());
                surface.map(|s| (&mut s.linger_secs, &mut s.fresh))
            }
        };
        if let Some((linger_secs, fresh)) = how {
            (*linger_secs, *fresh) = (Some(0), false);
        }
        self
    }

    async fn call(&self, client: &mut DisplacementClient<Channel>) -> Result<Response<Streaming<JobUpdate>>, Status> {
        match self.clone() {
            Self::Displace(message) => client.displace(request(message, STREAM_DEADLINE)).await,
            Self::Render(message) => client.render(request(*message, STREAM_DEADLINE)).await,
            Self::Measure(message) => client.measure(request(message, STREAM_DEADLINE)).await,
            Self::Compare(message) => client.compare(request(message, STREAM_DEADLINE)).await,
            Self::Chart(message) => client.chart(request(*message, STREAM_DEADLINE)).await,
        }
    }
}

/// Uploads what the job names and runs it to its end.
pub(crate) async fn run(connection: &Connection, job: &Job, blobs: &[Blob], progress: Progress) -> Result<JobResult> {
    for _ in 0..UPLOADS {
        upload(connection, blobs, &progress).await?;
        match to_the_end(connection, job, progress).await? {
            Outcome::Done(result) => return Ok(*result),
            Outcome::Missing(error) => tracing::debug!(%error, "uploading again"),
        }
    }
    Err(Error::internal("the server lost uploaded assets three times; its store may be full: see `displace status`"))
}

enum Outcome {
    Done(Box<JobResult>),
    Missing(Error),
}

/// Calls, and calls again while the way to the server breaks.
async fn to_the_end(connection: &Connection, job: &Job, progress: Progress) -> Result<Outcome> {
    let mut attempts = Attempts::default();
    let bar = progress.passes();
    loop {
        let status = match listen(connection, job, &bar, &mut attempts).await {
            Ok(result) => return Ok(Outcome::Done(Box::new(result))),
            Err(status) => status,
        };
        if missing_assets(&status) {
            return Ok(Outcome::Missing(failure(&status)));
        }
        match is_transient(&status) {
            Some(asked) => attempts.pause_or(failure(&status), asked).await?,
            None => return Err(failure(&status)),
        }
    }
}

async fn listen(connection: &Connection, job: &Job, bar: &Bar, attempts: &mut Attempts) -> Result<JobResult, Status> {
    let mut updates = job.call(&mut connection.displacement()).await?.into_inner();
    let mut presence = Presence { connection, job, over: false };
    let result = follow(&mut updates, bar, attempts).await;
    presence.over = true;
    result
}

/// Dropped before the job is over when the user gives up. A stream that merely ends looks like a lost
/// connection, and the job lingers; joining once more without lingering ends it.
struct Presence<'a> {
    connection: &'a Connection,
    job: &'a Job,
    over: bool,
}

impl Drop for Presence<'_> {
    fn drop(&mut self) {
        if self.over || self.connection.linger_secs == 0 {
            return;
        }
        let (mut client, job) = (self.connection.displacement(), self.job.clone().given_up());
        self.connection.farewell(async move {
            if let Ok(updates) = job.call(&mut client).await {
                // The first update tells that the server has joined it.
                let _ = updates.into_inner().message().await;
            }
        });
    }
}

async fn follow(updates: &mut Streaming<JobUpdate>, bar: &Bar, attempts: &mut Attempts) -> Result<JobResult, Status> {
    while let Some(JobUpdate { update }) = updates.message().await? {
        match update {
            Some(Update::Queued(queued)) => bar.queued(queued.position),
            Some(Update::Progress(progress)) => {
                attempts.reset();
                bar.pass(&progress.pass, progress.done, progress.total);
            }
            // Warnings are in the report as well, and are told with it.
            Some(Update::Warning(_)) | None => {}
            Some(Update::Result(result)) => return Ok(result),
            Some(Update::Error(status)) => return Err(status_of(&status)),
        }
    }
    Err(Status::new(Code::Unavailable, "the server ended the job's updates without a result"))
}

/// The gRPC status that carries the same error, details included.
pub(crate) fn status_of(status: &rpc::Status) -> Status {
    Status::with_details(Code::from(status.code), status.message.clone(), status.encode_to_vec().into())
}
