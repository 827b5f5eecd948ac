//! Who uses a buffer now: the host or the device, never both.

use std::sync::atomic::{AtomicI32, Ordering};

use super::error::{Error, Result};

/// Counts submissions in flight above zero and host readers below it.
#[derive(Debug, Default)]
pub(crate) struct Access(AtomicI32);

impl Access {
    /// For the host, until the guard is dropped.
    pub(crate) fn host(&self) -> Result<AccessGuard<'_>> {
        self.enter(-1)
    }

    /// For a submission, until `leave_device`.
    pub(crate) fn enter_device(&self) -> Result<()> {
        std::mem::forget(self.enter(1)?);
        Ok(())
    }

    /// Ends what `enter_device` began.
    pub(crate) fn leave_device(&self) {
        self.0.fetch_sub(1, Ordering::AcqRel);
    }

    fn enter(&self, step: i32) -> Result<AccessGuard<'_>> {
        let entered = self.0.fetch_update(Ordering::AcqRel, Ordering::Acquire, |users| {
            (users.signum() != -step.signum()).then_some(users + step)
        });
        match entered {
            Ok(_) => Ok(AccessGuard { access: self, step }),
            Err(_) => Err(Error::internal("a stream was used by the host and the device at the same time")),
        }
    }
}

pub(crate) struct AccessGuard<'a> {
    access: &'a Access,
    step: i32,
}

impl Drop for AccessGuard<'_> {
    fn drop(&mut self) {
        self.access.0.fetch_sub(self.step, Ordering::AcqRel);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn host_and_device_exclude_each_other() {
        let access = Access::default();
        let reader = access.host().expect("free");
        let second = access.host().expect("several may read");
        access.enter_device().expect_err("the host reads");
        drop((reader, second));
        access.enter_device().expect("free again");
        access.enter_device().expect("several submissions");
        assert!(access.host().is_err());
        access.leave_device();
        access.leave_device();
        assert!(access.host().is_ok());
    }
}
