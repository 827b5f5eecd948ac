//! Logarithmic axes: from values to places, and which values are told.

/// One axis from `low` to `high`, both above 0, drawn from `start` to `end`.
#[derive(Clone, Copy, Debug)]
pub(in crate::jobs) struct Axis {
    low: f64,
    high: f64,
    start: f64,
    end: f64,
    /// Values of 0 lie here, at the start, apart from the others.
    zero: bool,
}

/// Room around the values.
const MARGIN: f64 = 1.18;
/// Share of the axis that is kept for values of 0.
const ZERO_SHARE: f64 = 0.08;
/// Steps within a decade, from the coarsest.
const STEPS: [&[f64]; 5] = [
    &[1.0],
    &[1.0, 3.0],
    &[1.0, 2.0, 5.0],
    &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0],
    &[1.0, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 1.8, 2.0, 2.2, 2.5, 2.8, 3.0, 3.5, 4.0, 4.5, 5.0, 6.0, 7.0, 8.0, 9.0],
];
/// Fewer say too little.
const LEAST_TICKS: usize = 4;

impl Axis {
    /// Of values that are 0 or above.
    pub(in crate::jobs) fn new(values: impl Iterator<Item = f64> + Clone, start: f64, end: f64) -> Self {
        let above = values.clone().filter(|value| *value > 0.0 && value.is_finite());
        let (low, high) = above.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), v| (low.min(v), high.max(v)));
        let (low, high) = if low <= high { (low / MARGIN, high * MARGIN) } else { (0.1, 1.0) };
        Self { low, high, start, end, zero: values.clone().any(|value| value <= 0.0) }
    }

    pub(in crate::jobs) fn at(&self, value: f64) -> f64 {
        if value <= 0.0 {
            return self.start;
        }
        let share = (value / self.low).ln() / (self.high / self.low).ln();
        let first = if self.zero { ZERO_SHARE } else { 0.0 };
        self.start + (self.end - self.start) * (first + (1.0 - first) * share.clamp(0.0, 1.0))
    }

    pub(in crate::jobs) fn has_zero(&self) -> bool {
        self.zero
    }

    /// Round values, as many as tell enough.
    pub(in crate::jobs) fn ticks(&self) -> Vec<f64> {
        let of = |steps: &&[f64]| self.multiples(steps);
        let enough = STEPS.iter().map(of).find(|ticks| ticks.len() >= LEAST_TICKS);
        enough.unwrap_or_else(|| self.multiples(STEPS[STEPS.len() - 1]))
    }

    fn multiples(&self, steps: &[f64]) -> Vec<f64> {
        let decades = self.low.log10().floor() as i32..=self.high.log10().ceil() as i32;
        let all = decades.flat_map(|decade| steps.iter().map(move |step| step * 10f64.powi(decade)));
        all.filter(|value| (self.low..=self.high).contains(value)).collect()
    }
}

/// `0.002`, `35`, `1 200`: up to two digits that count.
pub(in crate::jobs) fn written(value: f64) -> String {
    if value >= 1.0 {
        return format!("{}", (value * 10.0).round() / 10.0);
    }
    let digits = (1.0 - value.log10().floor()).clamp(0.0, 12.0) as usize;
    let text = format!("{value:.digits$}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(values: &[f64]) -> Axis {
        Axis::new(values.iter().copied(), 100.0, 500.0)
    }

    #[test]
    fn values_lie_in_their_order_within_the_axis() {
        let axis = axis(&[0.5, 80.0, 3.0]);
        let places = [0.5, 3.0, 80.0].map(|value| axis.at(value));
        assert!(100.0 < places[0] && places[0] < places[1] && places[1] < places[2] && places[2] < 500.0, "{places:?}");
    }

    #[test]
    fn zero_lies_at_the_start_and_apart() {
        let axis = axis(&[0.0, 0.01, 1.0]);
        assert!(axis.has_zero() && axis.at(0.0) == 100.0 && axis.at(0.01) > 130.0);
        assert!(!self::axis(&[1.0]).has_zero());
    }

    #[test]
    fn every_span_has_round_values_within_it() {
        for values in [[1.0, 1e6], [0.02, 0.9], [40.0, 60.0], [3.0, 3.0], [1e-7, 2e-7]] {
            let axis = axis(&values);
            let ticks = axis.ticks();
            assert!((2..=12).contains(&ticks.len()), "{values:?}: {ticks:?}");
            assert!(ticks.windows(2).all(|pair| pair[0] < pair[1]), "{ticks:?}");
        }
    }

    #[test]
    fn an_axis_of_nothing_or_of_zeros_is_still_one() {
        for values in [&[][..], &[0.0], &[f64::INFINITY]] {
            assert!(axis(values).ticks().len() >= 2, "{values:?}");
        }
    }

    #[test]
    fn values_are_written_short() {
        assert_eq!([0.002, 0.3, 0.015, 1.5, 35.0, 1e4].map(written), ["0.002", "0.3", "0.015", "1.5", "35", "10000"]);
    }
}
