//! What tessellating takes, whatever comes of it.

use std::{
    sync::{Mutex, PoisonError},
    time::Instant,
};

use crate::domain::{Result, report::PassTime};

/// The time of each step, those that failed or were done in vain as well.
#[derive(Debug, Default)]
pub(super) struct Times(Mutex<Vec<PassTime>>);

impl Times {
    pub(super) fn timed<T>(&self, name: &str, step: impl FnOnce() -> Result<T>) -> Result<T> {
        let start = Instant::now();
        let result = step();
        self.add(name, start.elapsed().as_secs_f64() * 1e3);
        result
    }

    /// To the row of that name.
    fn add(&self, name: &str, ms: f64) {
        let mut times = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match times.iter_mut().find(|time| time.name == name) {
            Some(time) => time.ms += ms,
            None => times.push(PassTime { name: name.into(), ms, bytes: 0 }),
        }
    }

    pub(super) fn taken(self) -> Vec<PassTime> {
        self.0.into_inner().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::Error;

    #[test]
    fn steps_that_fail_take_time_too_and_one_name_is_one_row() {
        let times = Times::default();
        assert!(times.timed("refine", || Err::<(), _>(Error::too_large("device", "full"))).is_err());
        assert_eq!(times.timed("refine (host)", || Ok(3)).ok(), Some(3));
        assert!(times.timed("refine", || Ok(())).is_ok());
        let names: Vec<String> = times.taken().into_iter().map(|time| time.name).collect();
        assert_eq!(names, ["refine", "refine (host)"]);
    }
}
