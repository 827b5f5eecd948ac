//! From curves to verdicts: where a method breaks, and which invariants did not hold.

use std::collections::BTreeMap;

use crate::domain::stability::{Violation, Worse};

/// The parameter from which on values are beyond the line: the first when the parameter gets worse, between two values by a
/// straight line. Values are in the order of the parameter; what is not finite is beyond any line.
pub(super) fn breakdown(values: &[[f64; 2]], line: f64, worse: Worse) -> Option<f64> {
    let mut values = values.to_vec();
    if worse == Worse::Downwards {
        values.reverse();
    }
    let first = values.iter().position(|[_, value]| !within(*value, line))?;
    let [at, value] = values[first];
    let Some(before) = first.checked_sub(1) else { return Some(at) };
    let [last, passed] = values[before];
    let share = if value.is_finite() { (line - passed) / (value - passed) } else { 0.0 };
    Some(last + (at - last) * share)
}

/// No NaN is.
fn within(value: f64, line: f64) -> bool {
    value <= line
}

/// What must hold anywhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Rule {
    /// No NaN and nothing infinite in any output.
    Finite,
    /// What is closed stays closed, and what is shared stays shared.
    NoCrack,
    /// No march ends because it may take no more steps, or takes more than it may.
    BoundedMarch,
    /// Or the report says what is kept.
    ToleranceKept,
    /// Made again, it is the same to the bit.
    SameBytes,
}

impl Rule {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Finite => "finite",
            Self::NoCrack => "no_crack",
            Self::BoundedMarch => "bounded_march",
            Self::ToleranceKept => "tolerance_kept",
            Self::SameBytes => "same_bytes",
        }
    }
}

/// What was asked about, and what did not hold.
#[derive(Default)]
pub(super) struct Ledger {
    checks: u64,
    broken: BTreeMap<Rule, Violation>,
}

impl Ledger {
    /// `fault` tells what is wrong, where something is.
    pub(super) fn note(&mut self, rule: Rule, fault: Option<String>) {
        self.checks += 1;
        let Some(first) = fault else { return };
        let known = self.broken.entry(rule);
        let violation = known.or_insert_with(|| Violation { rule: rule.name().into(), count: 0, first });
        violation.count += 1;
    }

    /// Both, of all rules.
    pub(super) fn told(self) -> (u64, Vec<Violation>) {
        (self.checks, self.broken.into_values().collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RISING: [[f64; 2]; 4] = [[10.0, 0.0], [20.0, 0.5], [30.0, 1.5], [40.0, 0.2]];

    #[test]
    fn a_method_breaks_where_its_line_is_crossed_first() {
        assert_eq!(breakdown(&RISING, 1.0, Worse::Upwards), Some(25.0));
        assert_eq!(breakdown(&RISING, 1.0, Worse::Downwards), Some(40.0 - 10.0 * 0.8 / 1.3));
        assert_eq!(breakdown(&RISING, 1.5, Worse::Upwards), None, "on the line it passes");
        assert_eq!(breakdown(&RISING, -1.0, Worse::Upwards), Some(10.0), "broken from the start");
        assert_eq!(breakdown(&[], 1.0, Worse::Upwards), None);
    }

    #[test]
    fn what_is_no_number_breaks_at_the_last_that_passed() {
        let values = [[1.0, 0.0], [2.0, f64::NAN], [3.0, 0.0]];
        assert_eq!(breakdown(&values, 1.0, Worse::Upwards), Some(1.0));
        assert_eq!(breakdown(&values, 1.0, Worse::Downwards), Some(3.0));
        assert_eq!(breakdown(&[[1.0, f64::INFINITY]], 1.0, Worse::Upwards), Some(1.0));
    }

    #[test]
    fn a_broken_rule_is_told_with_its_first_fault_and_counted() {
        let mut ledger = Ledger::default();
        ledger.note(Rule::Finite, None);
        ledger.note(Rule::NoCrack, Some("pixel 3".into()));
        ledger.note(Rule::NoCrack, None);
        ledger.note(Rule::NoCrack, Some("pixel 9".into()));
        let (checks, violations) = ledger.told();
        assert_eq!(checks, 4);
        assert_eq!(violations, [Violation { rule: "no_crack".into(), count: 2, first: "pixel 3".into() }]);
    }
}
