//! The thread that owns the device: runs jobs one after another, stores what they make, survives their panics.

use std::{
    any::Any,
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{Arc, Weak},
    time::{Duration, Instant},
};

use super::{
    JobLimits, StoreReader, Work, WorkContext, WorkOutput,
    job::{Finished, Job, Relay, State, lock},
    registry::{Next, Shared},
    statistics::Took,
};
use crate::{
    domain::{Error, ErrorKind, Result},
    render::Executor,
    store::StoredOutput,
};

/// Opens the device; called again when it is lost.
pub type OpenExecutor = Arc<dyn Fn() -> Result<Box<dyn Executor>> + Send + Sync>;

/// What the server tells of an open device.
#[derive(Clone, Debug)]
pub(super) struct DeviceFacts {
    pub(super) name: String,
    pub(super) class: String,
    pub(super) driver: String,
}

/// Opens the device on its own thread and starts to work. The answer comes when the device is open.
pub(super) fn start(
    open: OpenExecutor,
    limits: JobLimits,
    shared: Weak<Shared>,
    runtime: tokio::runtime::Handle,
) -> Result<(tokio::sync::oneshot::Receiver<Result<DeviceFacts>>, std::thread::JoinHandle<()>)> {
    let (opened, answer) = tokio::sync::oneshot::channel();
    let body = move || {
        let executor = match open() {
            Ok(executor) => executor,
            Err(error) => return drop(opened.send(Err(error))),
        };
        let facts = DeviceFacts {
            name: executor.device_name().into(),
            class: executor.device_class().into(),
            driver: executor.driver().into(),
        };
        // Nobody to tell: the server gave up starting, and the queue is gone with it.
        if opened.send(Ok(facts)).is_ok() {
            Owner { executor, open, limits, runtime }.work(&shared);
        }
    };
    let spawned = std::thread::Builder::new().name("device".into()).spawn(body);
    let thread = spawned.map_err(|cause| Error::internal("cannot start the device's thread").with_cause(cause))?;
    Ok((answer, thread))
}

struct Owner {
    executor: Box<dyn Executor>,
    open: OpenExecutor,
    limits: JobLimits,
    runtime: tokio::runtime::Handle,
}

impl Owner {
    fn work(mut self, shared: &Weak<Shared>) {
        while let Some(next) = Shared::next(shared) {
            let Next::Job(job) = next else { continue };
            let lost = self.run(&job, shared);
            if lost && !self.reopen(shared) {
                return;
            }
        }
    }

    /// Whether the device was lost.
    fn run(&self, job: &Arc<Job>, shared: &Weak<Shared>) -> bool {
        let span = tracing::info_span!("job", key = %job.key, kind = job.kind, method = job.method, tenant = %job.store.tenant());
        let _entered = span.enter();
        let mut took = Took { queue: job.admitted.elapsed(), ..Took::default() };
        let result = self.compute(job, &mut took).and_then(|output| self.keep(job, output, &mut took));
        if let Some(shared) = shared.upgrade() {
            shared.ended(job, took, result.as_ref().err());
        }
        log(&took, &result);
        let lost = matches!(&result, Err(Error { kind: ErrorKind::Unavailable, .. }));
        match result {
            Ok(finished) => job.end(State::Done(Arc::new(finished))),
            Err(error) => job.end(State::Failed(Arc::new(error))),
        }
        lost
    }

    fn compute(&self, job: &Arc<Job>, took: &mut Took) -> Result<WorkOutput> {
        let work = lock(&job.work).take().ok_or_else(Error::cancelled)?;
        job.cancel.check()?;
        job.set(State::Running { progress: None });
        let started = Instant::now();
        let output = self.run_caught(work.as_ref(), job);
        took.compute = started.elapsed();
        // The inputs go before the outputs are stored.
        drop(work);
        let mut output = output?;
        job.cancel.check()?;
        output.report.total_ms = took.compute.as_secs_f64() * 1e3;
        output.report.device = self.executor.device_name().into();
        output.report.cached = false;
        Ok(output)
    }

    /// A panic ends its own job only.
    fn run_caught(&self, work: &dyn Work, job: &Arc<Job>) -> Result<WorkOutput> {
        let relay = Relay::new(Arc::clone(job));
        let assets = StoreReader::new(job.store.clone(), self.runtime.clone());
        let context = WorkContext {
            executor: self.executor.as_ref(),
            assets: &assets,
            cancel: &job.cancel,
            progress: &relay,
            limits: &self.limits,
        };
        catch_unwind(AssertUnwindSafe(|| work.run(&context))).unwrap_or_else(|panic| Err(panicked(panic.as_ref())))
    }

    fn keep(&self, job: &Job, output: WorkOutput, took: &mut Took) -> Result<Finished> {
        let started = Instant::now();
        let kept = self.runtime.block_on(store_output(job, output));
        took.transfer = started.elapsed();
        kept
    }

    fn reopen(&mut self, shared: &Weak<Shared>) -> bool {
        tracing::error!(device = self.executor.device_name(), "the device is lost: opening it again");
        match (self.open)() {
            Ok(executor) => {
                self.executor = executor;
                true
            }
            Err(error) => {
                tracing::error!(%error, cause = ?error.cause, "the device does not open again: no more jobs");
                if let Some(shared) = shared.upgrade() {
                    shared.close("the server lost its device");
                }
                false
            }
        }
    }
}

async fn store_output(job: &Job, output: WorkOutput) -> Result<Finished> {
    let mut outputs = Vec::with_capacity(output.outputs.len());
    for made in output.outputs {
        let digest = job.store.put_output(made.bytes).await?;
        outputs.push(StoredOutput { name: made.name, media_type: made.media_type, digest });
    }
    let finished = Finished { report: output.report, outputs };
    job.store.put_result(&job.key.hex(), &finished).await?;
    Ok(finished)
}

fn panicked(panic: &(dyn Any + Send)) -> Error {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_default();
    Error::internal("the job failed by a fault of the server").with_cause(format!("panic: {text}"))
}

fn log(took: &Took, result: &Result<Finished>) {
    let ms = |time: Duration| time.as_secs_f64() * 1e3;
    let (queue_ms, compute_ms, transfer_ms) = (ms(took.queue), ms(took.compute), ms(took.transfer));
    match result {
        Ok(finished) => {
            tracing::info!(queue_ms, compute_ms, transfer_ms, triangles = finished.report.triangles, "job done");
        }
        Err(error) if error.kind == ErrorKind::Internal => {
            tracing::error!(queue_ms, compute_ms, %error, cause = ?error.cause, "job failed");
        }
        Err(error) => tracing::info!(queue_ms, compute_ms, %error, cause = ?error.cause, "job ended"),
    }
}
