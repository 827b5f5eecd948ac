//! What runs took, and which of them counts.

use crate::domain::{Error, ErrorKind, Result, report::PassTime};

/// What one run took, milliseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Took {
    pub(super) geometry: f64,
    pub(super) image: f64,
    pub(super) setup: f64,
}

impl Took {
    pub(super) fn ms(&self) -> f64 {
        self.geometry + self.image
    }
}

/// Fails where one more setting like the last would take too long.
pub(super) fn refuse_slow(took_ms: f64, spent_ms: f64, most_ms: f64) -> Result<()> {
    if spent_ms + took_ms <= most_ms {
        return Ok(());
    }
    let message = format!(
        "its method has taken {:.1} s for other settings, and one more would make it more than {:.0} s: take a faster device or a smaller map",
        spent_ms / 1e3,
        most_ms / 1e3
    );
    Err(Error::new(ErrorKind::TooLarge, message))
}

/// Without setup, which the first run alone has all of.
pub(super) fn all_of(runs: &[Took]) -> f64 {
    runs.iter().map(Took::ms).sum()
}

pub(super) fn setup_of(runs: &[Took]) -> f64 {
    runs.iter().map(|took| took.setup).fold(0.0, f64::max)
}

pub(super) fn sum_of(times: &[PassTime], counts: impl Fn(&str) -> bool) -> f64 {
    times.iter().filter(|time| counts(&time.name)).map(|time| time.ms).sum()
}

/// The run in the middle, of two the faster.
pub(super) fn median(runs: &[Took]) -> Option<Took> {
    let mut runs = runs.to_vec();
    runs.sort_by(|a, b| a.ms().total_cmp(&b.ms()));
    runs.get(runs.len().saturating_sub(1) / 2).copied()
}

pub(super) fn spread(runs: &[Took]) -> Option<f64> {
    let ms = runs.iter().map(Took::ms);
    let [least, most] = ms.fold([f64::INFINITY, 0.0], |[least, most]: [f64; 2], ms| [least.min(ms), most.max(ms)]);
    (runs.len() > 1).then_some(most - least)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn took(geometry: f64, image: f64) -> Took {
        Took { geometry, image, setup: 100.0 * geometry }
    }

    #[test]
    fn the_run_in_the_middle_counts_whole() {
        assert_eq!(median(&[took(1.0, 5.0), took(4.0, 1.0), took(0.5, 9.0)]), Some(took(1.0, 5.0)));
        assert_eq!(median(&[took(1.0, 5.0), took(4.0, 1.0)]), Some(took(4.0, 1.0)));
        assert_eq!(median(&[]), None);
    }

    #[test]
    fn setup_counts_once_and_delays_nothing_else() {
        let runs = [Took { setup: 900.0, ..took(1.0, 2.0) }, Took { setup: 1.0, ..took(1.0, 3.0) }];
        assert_eq!((all_of(&runs), setup_of(&runs)), (7.0, 900.0));
    }

    #[test]
    fn one_run_has_no_spread() {
        assert_eq!(spread(&[took(1.0, 2.0)]), None);
        assert_eq!(spread(&[took(1.0, 2.0), took(1.0, 4.0), took(0.0, 2.5)]), Some(2.5));
    }

    #[test]
    fn a_method_that_takes_too_long_is_not_asked_again() {
        assert!(refuse_slow(0.0, 0.0, 8000.0).is_ok() && refuse_slow(2000.0, 6000.0, 8000.0).is_ok());
        let error = refuse_slow(5000.0, 5000.0, 8000.0).unwrap_err();
        assert!(error.message.contains("5.0 s") && error.message.contains("8 s"), "{error}");
    }
}
