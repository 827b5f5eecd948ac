//! Calling again: bounded, with growing pauses and jitter, and no sooner than the server asks.

use std::time::Duration;

use crate::error::{Error, Kind, Result};

const ATTEMPTS: u32 = 6;
const FIRST_PAUSE: Duration = Duration::from_millis(50);
/// A server that asks for more patience than this is told to the user instead.
const LONGEST_PAUSE: Duration = Duration::from_secs(10);

/// Counts the calls for one aim; progress towards it starts the count anew.
#[derive(Debug, Default)]
pub(crate) struct Attempts {
    failed: u32,
}

impl Attempts {
    /// Sleeps before the next call, or gives the error back when there is none.
    pub(crate) async fn pause_or(&mut self, error: Error, asked: Option<Duration>) -> Result<()> {
        self.failed += 1;
        if self.failed >= ATTEMPTS || asked.is_some_and(|asked| asked > LONGEST_PAUSE) {
            return Err(error);
        }
        tracing::debug!(failed = self.failed, %error, "calling again");
        tokio::time::sleep(pause(self.failed, asked)).await;
        Ok(())
    }

    pub(crate) fn reset(&mut self) {
        self.failed = 0;
    }
}

/// 50 ms doubled for each failure, of which a random half; after what the server asked for.
fn pause(failed: u32, asked: Option<Duration>) -> Duration {
    let full = FIRST_PAUSE * 2u32.pow(failed.min(10) - 1);
    asked.unwrap_or_default() + full / 2 + full.mul_f64(0.5 * rand::random::<f64>())
}

/// Repeats something idempotent while it is unavailable.
pub(crate) async fn with_retries<T, F: Future<Output = Result<T>>>(mut call: impl FnMut() -> F) -> Result<T> {
    let mut attempts = Attempts::default();
    loop {
        match call().await {
            Err(error) if error.kind == Kind::Unavailable => attempts.pause_or(error, None).await?,
            done => return done,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pauses_grow_and_heed_the_server() {
        for failed in 1..ATTEMPTS {
            let full = FIRST_PAUSE * 2u32.pow(failed - 1);
            let pause_alone = pause(failed, None);
            assert!((full / 2..=full).contains(&pause_alone), "{failed}: {pause_alone:?}");
        }
        assert!(pause(1, Some(Duration::from_secs(2))) >= Duration::from_secs(2));
    }

    #[tokio::test]
    async fn attempts_end() {
        let mut calls = 0;
        let result: Result<()> = with_retries(|| {
            calls += 1;
            async { Err(Error::new(Kind::Unavailable, "away")) }
        })
        .await;
        assert_eq!((result.map_err(|e| e.kind), calls), (Err(Kind::Unavailable), ATTEMPTS));
    }

    #[tokio::test]
    async fn a_refusal_is_not_repeated() {
        let mut calls = 0;
        let result: Result<()> = with_retries(|| {
            calls += 1;
            async { Err(Error::invalid("x", "bad")) }
        })
        .await;
        assert_eq!((result.map_err(|e| e.kind), calls), (Err(Kind::InvalidInput), 1));
    }
}
