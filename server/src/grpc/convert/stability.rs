//! What the stability suite found.

use displace_proto::v1;

use crate::domain::stability::{Curve, Scenario, Stability, Violation, Worse};

/// A chart without points.
pub(super) fn to_stability(stability: &Stability) -> v1::ChartReport {
    let scenarios = stability.scenarios.iter().map(to_scenario).collect();
    v1::ChartReport {
        driver: stability.driver.clone(),
        stability: Some(v1::StabilityReport { scenarios }),
        ..v1::ChartReport::default()
    }
}

fn to_scenario(scenario: &Scenario) -> v1::StabilityScenario {
    v1::StabilityScenario {
        name: scenario.name.clone(),
        title: scenario.title.clone(),
        parameter: scenario.parameter.clone(),
        unit: scenario.unit.clone(),
        metric: scenario.metric.clone(),
        metric_unit: scenario.metric_unit.clone(),
        line: scenario.line,
        worse_downwards: scenario.worse == Worse::Downwards,
        curves: scenario.curves.iter().map(to_curve).collect(),
        checks: scenario.checks,
        violations: scenario.violations.iter().map(to_violation).collect(),
    }
}

fn to_curve(curve: &Curve) -> v1::StabilityCurve {
    v1::StabilityCurve {
        method: curve.method.clone(),
        parameters: curve.values.iter().map(|[parameter, _]| *parameter).collect(),
        values: curve.values.iter().map(|[_, value]| *value).collect(),
        breakdown: curve.breakdown,
        literature: curve.literature.clone(),
    }
}

fn to_violation(violation: &Violation) -> v1::StabilityViolation {
    v1::StabilityViolation { rule: violation.rule.clone(), count: violation.count, first: violation.first.clone() }
}
