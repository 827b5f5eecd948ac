//! The queue: answers from the store, joins, admits, and hands jobs to the owner thread in order.

use std::{
    collections::{HashMap, VecDeque},
    sync::{Arc, Condvar, Mutex, PoisonError, Weak},
    time::Duration,
};

use super::{
    JobLimits, ResultKey, Work,
    admission::Budget,
    job::{Abandoned, Finished, Job, Listener, State, lock},
    owner::{self, DeviceFacts, OpenExecutor},
    statistics::{Snapshot, Statistics, Took, count},
};
use crate::{
    domain::{Error, ErrorKind, Result},
    store::TenantStore,
};

/// How many, how much, how long.
#[derive(Clone, Debug)]
pub struct JobOptions {
    /// Jobs that may wait, besides the one that runs.
    pub max_queued: u32,
    pub limits: JobLimits,
    /// How long a job goes on when nobody listens, at most.
    pub linger: Duration,
}

/// How a request wants to be worked on; not part of the result key.
#[derive(Clone, Copy, Debug, Default)]
pub struct Submission {
    /// Compute even if the result is stored.
    pub fresh: bool,
    /// Less than the server's linger. The last call that joined decides.
    pub linger: Option<Duration>,
}

/// All jobs of one device.
pub struct Jobs {
    shared: Arc<Shared>,
    device: DeviceFacts,
    options: JobOptions,
    owner: Mutex<Option<std::thread::JoinHandle<()>>>,
}

/// What the handlers and the owner thread share.
pub(super) struct Shared {
    queue: Mutex<Queue>,
    changed: Condvar,
    budget: Arc<Budget>,
    statistics: Statistics,
}

#[derive(Default)]
struct Queue {
    waiting: VecDeque<Arc<Job>>,
    running: Option<Arc<Job>>,
    /// Jobs that a request with the same key may join.
    by_key: HashMap<ResultKey, Arc<Job>>,
    /// Why nothing is admitted any more.
    closed: Option<&'static str>,
}

/// What the owner thread does next.
pub(super) enum Next {
    Job(Arc<Job>),
    LookAgain,
}

impl Jobs {
    /// Opens the device, which may take seconds, and starts its thread.
    pub async fn start(open: OpenExecutor, options: JobOptions) -> Result<Self> {
        let shared = Arc::new(Shared {
            queue: Mutex::default(),
            changed: Condvar::new(),
            budget: Budget::new(options.max_queued.saturating_add(1), options.limits.host_bytes),
            statistics: Statistics::default(),
        });
        let runtime = tokio::runtime::Handle::current();
        let (opened, owner) = owner::start(open, options.limits.clone(), Arc::downgrade(&shared), runtime)?;
        let device =
            opened.await.map_err(|cause| Error::internal("the device's thread ended early").with_cause(cause))??;
        Ok(Self { shared, device, options, owner: Mutex::new(Some(owner)) })
    }

    #[must_use]
    pub fn device_name(&self) -> &str {
        &self.device.name
    }

    #[must_use]
    pub fn device_class(&self) -> &str {
        &self.device.class
    }

    /// Name and version of the device's driver.
    #[must_use]
    pub fn driver(&self) -> &str {
        &self.device.driver
    }

    #[must_use]
    pub fn options(&self) -> &JobOptions {
        &self.options
    }

    /// Answers from the store, joins, or starts a job.
    pub async fn submit(&self, work: Box<dyn Work>, store: TenantStore, how: Submission) -> Result<Listener> {
        let key = self.key(work.as_ref(), &store);
        let linger = how.linger.unwrap_or(self.options.linger).min(self.options.linger);
        if !how.fresh {
            if let Some(listener) = self.shared.join(&key, linger) {
                return Ok(listener);
            }
            if let Some(result) = self.stored(&key, &store).await? {
                count(&self.shared.statistics.cache_hits);
                return Ok(Listener::of_result(Arc::new(result)));
            }
        }
        self.shared.admit(key, work, store, linger, how.fresh)
    }

    /// What work is known by.
    #[must_use]
    pub fn key(&self, work: &dyn Work, store: &TenantStore) -> ResultKey {
        ResultKey::of(work, &self.device.class, store.tenant())
    }

    /// The result under a key, if it is stored.
    pub async fn stored(&self, key: &ResultKey, store: &TenantStore) -> Result<Option<Finished>> {
        let mut result = store.result(&key.hex()).await?;
        if let Some(result) = &mut result {
            result.report.cached = true;
        }
        Ok(result)
    }

    /// Mean seconds of earlier jobs like this.
    #[must_use]
    pub fn expected_secs(&self, work: &dyn Work) -> Option<f64> {
        self.shared.statistics.mean_compute(work.kind(), work.method()).map(|mean| mean.as_secs_f64())
    }

    #[must_use]
    pub fn snapshot(&self) -> Snapshot {
        let queue = lock(&self.shared.queue);
        let (running, waiting) = (u32::from(queue.running.is_some()), queue.waiting.len() as u32);
        self.shared.statistics.snapshot(running, waiting, self.shared.budget.used_bytes())
    }

    #[must_use]
    pub fn is_open(&self) -> bool {
        lock(&self.shared.queue).closed.is_none()
    }

    /// Admits nothing more, and hands back what has not begun. The job that runs goes on.
    pub fn close(&self) {
        self.shared.close("the server is shutting down");
    }

    /// Stops the job that runs.
    pub fn abort(&self) {
        if let Some(job) = &lock(&self.shared.queue).running {
            job.cancel.cancel();
        }
    }
}

impl Jobs {
    /// Closes, stops what runs, and waits until the device is closed: a driver must not be at work when the
    /// process ends. Blocks.
    pub fn finish(&self) {
        self.close();
        self.abort();
        let owner = lock(&self.owner).take();
        if owner.is_some_and(|owner| owner.join().is_err()) {
            tracing::error!("the device's thread panicked");
        }
    }
}

impl Drop for Jobs {
    fn drop(&mut self) {
        self.close();
        self.abort();
    }
}

impl Shared {
    fn join(self: &Arc<Self>, key: &ResultKey, linger: Duration) -> Option<Listener> {
        let job = lock(&self.queue).by_key.get(key).cloned()?;
        let listener = job.listen(linger, self.on_abandoned())?;
        count(&self.statistics.joined);
        Some(listener)
    }

    fn admit(
        self: &Arc<Self>,
        key: ResultKey,
        work: Box<dyn Work>,
        store: TenantStore,
        linger: Duration,
        fresh: bool,
    ) -> Result<Listener> {
        let mut queue = lock(&self.queue);
        if let Some(reason) = queue.closed {
            return Err(unavailable(reason));
        }
        let mut joinable = queue.by_key.get(&key).filter(|_| !fresh).cloned();
        // Between the look at the store and here, somebody may have asked the same.
        if let Some(listener) = joinable.take().and_then(|job| job.listen(linger, self.on_abandoned())) {
            count(&self.statistics.joined);
            return Ok(listener);
        }
        let waiting = queue.waiting.len() as u32 + u32::from(queue.running.is_some());
        let admitted = self.budget.admit(work.host_bytes(), self.statistics.retry_secs(waiting));
        let permit = admitted.inspect_err(|_| count(&self.statistics.refused))?;
        let job = Job::new(key, work, store, permit);
        // Listens to a new job, which nobody can have given up.
        let listener = job.listen(linger, self.on_abandoned()).ok_or_else(Error::cancelled)?;
        count(&self.statistics.cache_misses);
        job.set(State::Queued { position: waiting });
        queue.by_key.insert(key, Arc::clone(&job));
        queue.waiting.push_back(job);
        self.changed.notify_all();
        Ok(listener)
    }

    /// Waits for the next job; `None` when the queue is closed and empty, or gone.
    pub(super) fn next(shared: &Weak<Self>) -> Option<Next> {
        let shared = shared.upgrade()?;
        let mut queue = lock(&shared.queue);
        if let Some(job) = queue.waiting.pop_front() {
            queue.running = Some(Arc::clone(&job));
            queue.tell_positions();
            return Some(Next::Job(job));
        }
        if queue.closed.is_some() {
            return None;
        }
        // Wakes now and then, to notice that the server is gone.
        let waited = shared.changed.wait_timeout(queue, Duration::from_secs(1));
        drop(waited.unwrap_or_else(PoisonError::into_inner));
        Some(Next::LookAgain)
    }

    /// The job is over: nobody joins it any more.
    pub(super) fn ended(&self, job: &Arc<Job>, took: Took, error: Option<&Error>) {
        self.statistics.ended(job.kind, job.method, took, error);
        let mut queue = lock(&self.queue);
        queue.running = None;
        queue.forget(job);
    }

    /// Takes a job that waits out of the queue; one that runs stops by its cancel flag.
    fn abandoned(&self, job: &Arc<Job>) {
        let mut queue = lock(&self.queue);
        let before = queue.waiting.len();
        queue.waiting.retain(|other| !Arc::ptr_eq(other, job));
        let was_waiting = queue.waiting.len() < before;
        queue.forget(job);
        queue.tell_positions();
        drop(queue);
        if was_waiting {
            let error = Error::cancelled();
            self.statistics.ended(
                job.kind,
                job.method,
                Took { queue: job.admitted.elapsed(), ..Took::default() },
                Some(&error),
            );
            job.end(State::Failed(Arc::new(error)));
        }
    }

    fn on_abandoned(self: &Arc<Self>) -> Abandoned {
        let shared = Arc::downgrade(self);
        Arc::new(move |job| {
            if let Some(shared) = shared.upgrade() {
                shared.abandoned(job);
            }
        })
    }

    pub(super) fn close(&self, reason: &'static str) {
        let mut queue = lock(&self.queue);
        queue.closed.get_or_insert(reason);
        let handed_back = std::mem::take(&mut queue.waiting);
        queue.by_key.clear();
        drop(queue);
        self.changed.notify_all();
        for job in handed_back {
            job.end(State::Failed(Arc::new(unavailable(reason))));
        }
    }
}

impl Queue {
    fn forget(&mut self, job: &Arc<Job>) {
        if self.by_key.get(&job.key).is_some_and(|other| Arc::ptr_eq(other, job)) {
            self.by_key.remove(&job.key);
        }
    }

    fn tell_positions(&self) {
        let before = u32::from(self.running.is_some());
        for (index, job) in self.waiting.iter().enumerate() {
            job.set(State::Queued { position: index as u32 + before });
        }
    }
}

fn unavailable(reason: &str) -> Error {
    Error::new(ErrorKind::Unavailable, format!("{reason}; call again, here or elsewhere"))
}
