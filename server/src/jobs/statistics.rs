//! What jobs took, by kind and method, since the server started.

use std::{
    collections::BTreeMap,
    sync::{
        Mutex,
        atomic::{AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};

use super::job::lock;
use crate::domain::{Error, ErrorKind};

/// Counts while the server runs.
#[derive(Debug)]
pub(super) struct Statistics {
    started: Instant,
    pub(super) cache_hits: AtomicU64,
    pub(super) joined: AtomicU64,
    pub(super) cache_misses: AtomicU64,
    pub(super) refused: AtomicU64,
    kinds: Mutex<BTreeMap<(&'static str, &'static str), KindTotals>>,
}

/// What jobs of one kind with one method took together.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct KindTotals {
    pub succeeded: u64,
    pub failed: u64,
    pub cancelled: u64,
    pub queue: Duration,
    pub compute: Duration,
    pub transfer: Duration,
}

/// Counts that do not depend on the kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    pub cache_hits: u64,
    pub joined: u64,
    pub cache_misses: u64,
    pub refused: u64,
    pub running_jobs: u32,
    pub queued_jobs: u32,
    pub job_bytes: u64,
}

/// All at one moment.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    pub uptime: Duration,
    pub counters: Counters,
    pub kinds: Vec<(&'static str, &'static str, KindTotals)>,
}

/// What one job took.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Took {
    pub(super) queue: Duration,
    pub(super) compute: Duration,
    pub(super) transfer: Duration,
}

impl Default for Statistics {
    fn default() -> Self {
        Self {
            started: Instant::now(),
            cache_hits: AtomicU64::new(0),
            joined: AtomicU64::new(0),
            cache_misses: AtomicU64::new(0),
            refused: AtomicU64::new(0),
            kinds: Mutex::default(),
        }
    }
}

pub(super) fn count(counter: &AtomicU64) {
    counter.fetch_add(1, Ordering::Relaxed);
}

impl Statistics {
    pub(super) fn ended(&self, kind: &'static str, method: &'static str, took: Took, error: Option<&Error>) {
        let mut kinds = lock(&self.kinds);
        let totals = kinds.entry((kind, method)).or_default();
        match error.map(|error| &error.kind) {
            None => totals.succeeded += 1,
            Some(ErrorKind::Cancelled) => totals.cancelled += 1,
            Some(_) => totals.failed += 1,
        }
        totals.queue += took.queue;
        totals.compute += took.compute;
        totals.transfer += took.transfer;
    }

    /// Mean time of work of one kind and method, once there is one.
    pub(super) fn mean_compute(&self, kind: &str, method: &str) -> Option<Duration> {
        let kinds = lock(&self.kinds);
        let of_kind = |(key, totals): (&(&'static str, &'static str), &KindTotals)| {
            (*key == (kind, method) && totals.succeeded > 0).then(|| totals.compute / totals.ended())
        };
        kinds.iter().find_map(of_kind)
    }

    /// When to call again if `waiting` jobs are in the way, seconds.
    pub(super) fn retry_secs(&self, waiting: u32) -> u32 {
        let kinds = lock(&self.kinds);
        let jobs: u32 = kinds.values().map(KindTotals::ended).sum();
        let compute: Duration = kinds.values().map(|totals| totals.compute).sum();
        let mean_secs = if jobs == 0 { 1.0 } else { compute.as_secs_f64() / f64::from(jobs) };
        (mean_secs * f64::from(waiting) / 2.0).ceil().clamp(1.0, 60.0) as u32
    }

    pub(super) fn snapshot(&self, running_jobs: u32, queued_jobs: u32, job_bytes: u64) -> Snapshot {
        let read = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        let counters = Counters {
            cache_hits: read(&self.cache_hits),
            joined: read(&self.joined),
            cache_misses: read(&self.cache_misses),
            refused: read(&self.refused),
            running_jobs,
            queued_jobs,
            job_bytes,
        };
        let kinds = lock(&self.kinds).iter().map(|((kind, method), totals)| (*kind, *method, *totals)).collect();
        Snapshot { uptime: self.started.elapsed(), counters, kinds }
    }
}

impl KindTotals {
    fn ended(&self) -> u32 {
        u32::try_from(self.succeeded + self.failed + self.cancelled).unwrap_or(u32::MAX).max(1)
    }
}
