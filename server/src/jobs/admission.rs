//! Who may wait: a bounded queue and a budget of host memory.

use std::sync::{Arc, Mutex};

use super::job::lock;
use crate::domain::{Error, ErrorKind, Result};

/// What all jobs together may hold.
#[derive(Debug)]
pub(super) struct Budget {
    max_jobs: u32,
    max_bytes: u64,
    used: Mutex<Used>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Used {
    jobs: u32,
    bytes: u64,
}

/// One job's share; given back when dropped.
#[derive(Debug)]
pub(super) struct Permit {
    budget: Arc<Budget>,
    bytes: u64,
}

impl Budget {
    pub(super) fn new(max_jobs: u32, max_bytes: u64) -> Arc<Self> {
        Arc::new(Self { max_jobs, max_bytes, used: Mutex::default() })
    }

    pub(super) fn used_bytes(&self) -> u64 {
        lock(&self.used).bytes
    }

    /// `TooLarge` for what never fits, `Busy` for what does not fit now.
    pub(super) fn admit(self: &Arc<Self>, bytes: u64, retry_secs: u32) -> Result<Permit> {
        let limit = self.max_bytes;
        if bytes > limit {
            return Err(Error::too_large(
                "job_bytes",
                format!("the job needs {bytes} bytes of memory; at most {limit} are allowed"),
            ));
        }
        let mut used = lock(&self.used);
        if used.jobs >= self.max_jobs {
            let jobs = self.max_jobs;
            return Err(busy(
                "max_queued_jobs",
                format!("{jobs} jobs run or wait already, as many as are allowed"),
                retry_secs,
            ));
        }
        if used.bytes + bytes > limit {
            let free = limit - used.bytes;
            return Err(busy(
                "job_bytes",
                format!("the job needs {bytes} bytes of memory and {free} of {limit} are free"),
                retry_secs,
            ));
        }
        used.jobs += 1;
        used.bytes += bytes;
        Ok(Permit { budget: Arc::clone(self), bytes })
    }
}

impl Drop for Permit {
    fn drop(&mut self) {
        let mut used = lock(&self.budget.used);
        used.jobs -= 1;
        used.bytes -= self.bytes;
    }
}

fn busy(field: &str, message: String, retry_secs: u32) -> Error {
    Error::new(ErrorKind::Busy { retry_secs }, format!("{message}; call again in {retry_secs} s")).with_field(field)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_dropped_can_be_admitted_again() {
        let budget = Budget::new(2, 100);
        let first = budget.admit(60, 3).unwrap();
        assert_eq!(budget.admit(60, 3).unwrap_err().kind, ErrorKind::Busy { retry_secs: 3 });
        drop(first);
        assert!(budget.admit(60, 3).is_ok());
        assert_eq!(budget.used_bytes(), 0);
    }

    #[test]
    fn what_never_fits_is_not_told_to_wait() {
        assert_eq!(Budget::new(2, 100).admit(101, 3).unwrap_err().kind, ErrorKind::TooLarge);
    }

    #[test]
    fn one_job_too_many_is_busy() {
        let budget = Budget::new(1, 100);
        let _first = budget.admit(0, 3).unwrap();
        assert_eq!(budget.admit(0, 9).unwrap_err().kind, ErrorKind::Busy { retry_secs: 9 });
    }
}
