//! A flag that asks a job to stop, and the way a job says how far it is.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

use super::{Error, Result};

/// Shared by everybody who may stop a job and everybody who works on it.
#[derive(Clone, Debug, Default)]
pub struct Cancel(Arc<AtomicBool>);

impl Cancel {
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// `Err(Cancelled)` once somebody has asked to stop.
    pub fn check(&self) -> Result<()> {
        if self.is_cancelled() { Err(Error::cancelled()) } else { Ok(()) }
    }
}

/// Told of every pass while a job runs.
pub trait Progress: Send + Sync {
    /// `done` of `total` units of the pass `name` are finished.
    fn pass(&self, name: &str, done: u64, total: u64);
}

/// For callers that do not listen.
pub struct NoProgress;

impl Progress for NoProgress {
    fn pass(&self, _name: &str, _done: u64, _total: u64) {}
}
