//! One job, and those who listen to it.

use std::{
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};

use tokio::sync::watch;

use super::{ResultKey, Work, admission::Permit};
use crate::{
    domain::{
        Error,
        cancel::{Cancel, Progress},
        report::Warning,
    },
    store::{StoredResult, TenantStore},
};

/// What a job left, and whether it was there before the call.
pub type Finished = StoredResult;

/// One step of a job's life, as a listener sees it. `Done` or `Failed` is the last.
#[derive(Clone, Debug)]
pub enum JobEvent {
    Queued { position: u32, key: ResultKey },
    Progress { pass: Arc<str>, done: u64, total: u64 },
    Warning(Warning),
    Done(Arc<Finished>),
    Failed(Arc<Error>),
}

/// Where a job is. Listeners see samples of this: a slow one misses steps and costs nothing.
#[derive(Clone, Debug)]
pub(super) enum State {
    Queued { position: u32 },
    Running { progress: Option<(Arc<str>, u64, u64)> },
    Done(Arc<Finished>),
    Failed(Arc<Error>),
}

/// A job from admission to its end.
pub(super) struct Job {
    pub(super) key: ResultKey,
    pub(super) kind: &'static str,
    pub(super) method: &'static str,
    pub(super) store: TenantStore,
    pub(super) cancel: Cancel,
    pub(super) admitted: Instant,
    /// Taken by the owner thread.
    pub(super) work: Mutex<Option<Box<dyn Work>>>,
    /// Given back when the job ends, whoever still listens.
    pub(super) permit: Mutex<Option<Permit>>,
    state: watch::Sender<State>,
    listening: Mutex<Listening>,
}

#[derive(Debug)]
struct Listening {
    count: usize,
    /// As the last call wants it: a client that gives up says so by calling with 0 and leaving.
    linger: Duration,
    /// Rises whenever somebody comes, so that an old timer does not fire.
    epoch: u64,
    abandoned: bool,
}

impl Job {
    pub(super) fn new(key: ResultKey, work: Box<dyn Work>, store: TenantStore, permit: Permit) -> Arc<Self> {
        Arc::new(Self {
            key,
            kind: work.kind(),
            method: work.method(),
            store,
            cancel: Cancel::default(),
            admitted: Instant::now(),
            work: Mutex::new(Some(work)),
            permit: Mutex::new(Some(permit)),
            state: watch::Sender::new(State::Queued { position: 0 }),
            listening: Mutex::new(Listening { count: 0, linger: Duration::ZERO, epoch: 0, abandoned: false }),
        })
    }

    /// Adds a listener; `None` if the job was given up or cancelled just before.
    pub(super) fn listen(self: &Arc<Self>, linger: Duration, on_abandoned: Abandoned) -> Option<Listener> {
        let mut listening = lock(&self.listening);
        if listening.abandoned || self.cancel.is_cancelled() {
            return None;
        }
        listening.count += 1;
        listening.epoch += 1;
        listening.linger = linger;
        Some(Listener::of_job(Arc::clone(self), on_abandoned))
    }

    fn leave(self: &Arc<Self>, on_abandoned: &Abandoned) {
        let mut listening = lock(&self.listening);
        listening.count -= 1;
        if listening.count > 0 || self.is_over() {
            return;
        }
        let (job, epoch, linger) = (Arc::clone(self), listening.epoch, listening.linger);
        drop(listening);
        let on_abandoned = Arc::clone(on_abandoned);
        match tokio::runtime::Handle::try_current() {
            Ok(runtime) if !linger.is_zero() => {
                runtime.spawn(async move {
                    tokio::time::sleep(linger).await;
                    job.abandon(epoch, &on_abandoned);
                });
            }
            _ => job.abandon(epoch, &on_abandoned),
        }
    }

    fn abandon(self: &Arc<Self>, epoch: u64, on_abandoned: &Abandoned) {
        let mut listening = lock(&self.listening);
        if listening.count > 0 || listening.epoch != epoch || self.is_over() {
            return;
        }
        listening.abandoned = true;
        drop(listening);
        tracing::info!(key = %self.key, "nobody listens any more: cancelled");
        self.cancel.cancel();
        on_abandoned(self);
    }

    pub(super) fn set(&self, state: State) {
        self.state.send_replace(state);
    }

    /// The last state, and the end of what the job holds of the budgets.
    pub(super) fn end(&self, state: State) {
        drop(lock(&self.permit).take());
        self.set(state);
    }

    fn is_over(&self) -> bool {
        matches!(*self.state.borrow(), State::Done(_) | State::Failed(_))
    }
}

/// Told of a job that has lost its last listener and is now cancelled.
pub(super) type Abandoned = Arc<dyn Fn(&Arc<Job>) + Send + Sync>;

/// Follows one job, or a result that was there already. Dropping it is leaving.
pub struct Listener {
    source: Source,
    seen: Seen,
}

enum Source {
    Stored(Arc<Finished>),
    Job { job: Arc<Job>, state: watch::Receiver<State>, on_abandoned: Abandoned },
}

#[derive(Default)]
struct Seen {
    position: Option<u32>,
    progress: Option<(Arc<str>, u64, u64)>,
    warnings: usize,
    over: bool,
}

impl Listener {
    pub(super) fn of_result(result: Arc<Finished>) -> Self {
        Self { source: Source::Stored(result), seen: Seen::default() }
    }

    fn of_job(job: Arc<Job>, on_abandoned: Abandoned) -> Self {
        let state = job.state.subscribe();
        Self { source: Source::Job { job, state, on_abandoned }, seen: Seen::default() }
    }

    /// The next step; `None` after the last.
    pub async fn next(&mut self) -> Option<JobEvent> {
        if self.seen.over {
            return None;
        }
        let (job, state) = match &mut self.source {
            Source::Stored(result) => {
                let result = Arc::clone(result);
                return Some(self.seen.finish(result));
            }
            Source::Job { job, state, .. } => (job, state),
        };
        loop {
            let now = state.borrow_and_update().clone();
            if let Some(event) = self.seen.step(now, job.key) {
                return Some(event);
            }
            state.changed().await.ok()?;
        }
    }
}

impl Seen {
    fn step(&mut self, state: State, key: ResultKey) -> Option<JobEvent> {
        match state {
            State::Queued { position } if self.position != Some(position) => {
                self.position = Some(position);
                Some(JobEvent::Queued { position, key })
            }
            State::Running { progress: Some(progress) } if self.progress.as_ref() != Some(&progress) => {
                self.progress = Some(progress.clone());
                let (pass, done, total) = progress;
                Some(JobEvent::Progress { pass, done, total })
            }
            State::Queued { .. } | State::Running { .. } => None,
            State::Done(result) => Some(self.finish(result)),
            State::Failed(error) => {
                self.over = true;
                Some(JobEvent::Failed(error))
            }
        }
    }

    /// The warnings one by one, then the result.
    fn finish(&mut self, result: Arc<Finished>) -> JobEvent {
        if let Some(warning) = result.report.warnings.get(self.warnings) {
            self.warnings += 1;
            return JobEvent::Warning(warning.clone());
        }
        self.over = true;
        JobEvent::Done(result)
    }
}

impl Drop for Listener {
    fn drop(&mut self) {
        if let Source::Job { job, on_abandoned, .. } = &self.source {
            job.leave(on_abandoned);
        }
    }
}

/// Passes progress on to the listeners, at most every 50 ms within a pass, and keeps a span per pass.
pub(super) struct Relay {
    job: Arc<Job>,
    started: Instant,
    last_ms: AtomicU64,
    pass: Mutex<Option<(Arc<str>, tracing::Span, Instant)>>,
}

const RELAY_EVERY_MS: u64 = 50;

impl Relay {
    pub(super) fn new(job: Arc<Job>) -> Self {
        Self { job, started: Instant::now(), last_ms: AtomicU64::new(0), pass: Mutex::default() }
    }

    /// The shared name of the pass, and whether it has just begun.
    fn enter(&self, name: &str) -> (Arc<str>, bool) {
        let mut pass = lock(&self.pass);
        if let Some((current, _, _)) = pass.as_ref().filter(|(current, _, _)| **current == *name) {
            return (Arc::clone(current), false);
        }
        close(pass.take());
        let name: Arc<str> = name.into();
        *pass = Some((Arc::clone(&name), tracing::debug_span!("pass", name = %name), Instant::now()));
        (name, true)
    }
}

fn close(pass: Option<(Arc<str>, tracing::Span, Instant)>) {
    if let Some((_, span, since)) = pass {
        span.in_scope(|| tracing::debug!(ms = since.elapsed().as_secs_f64() * 1e3, "pass done"));
    }
}

impl Progress for Relay {
    fn pass(&self, name: &str, done: u64, total: u64) {
        let (pass, is_new) = self.enter(name);
        let now_ms = self.started.elapsed().as_millis() as u64;
        let is_due = now_ms >= self.last_ms.load(Ordering::Relaxed) + RELAY_EVERY_MS;
        if is_new || is_due || done == total {
            self.last_ms.store(now_ms, Ordering::Relaxed);
            self.job.set(State::Running { progress: Some((pass, done, total)) });
        }
    }
}

impl Drop for Relay {
    fn drop(&mut self) {
        close(lock(&self.pass).take());
    }
}

/// A poisoned lock is a panic told of elsewhere; what these locks guard is whole at every step.
pub(super) fn lock<T: ?Sized>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
