//! Where methods fail: what is swept, what comes of it, and from where on it is too much.

use serde::{Deserialize, Serialize};

/// What came of the stability suite.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stability {
    /// Of the meshes.
    pub title: String,
    pub device: String,
    /// Name and version.
    pub driver: String,
    /// In the order of the table.
    pub scenarios: Vec<Scenario>,
}

impl Stability {
    /// Of all scenarios.
    #[must_use]
    pub fn violations(&self) -> u64 {
        self.scenarios.iter().flat_map(|scenario| &scenario.violations).map(|violation| violation.count).sum()
    }
}

/// One parameter swept, one metric measured.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Scenario {
    /// Stem of its drawing.
    pub name: String,
    /// Of the failure matrix.
    pub family: String,
    pub title: String,
    /// What fails and why, in two or three sentences.
    pub story: String,
    /// What it is measured on.
    pub asset: String,
    pub parameter: String,
    /// Of the parameter.
    pub unit: String,
    pub metric: String,
    pub metric_unit: String,
    /// What passes is no more.
    pub line: f64,
    pub worse: Worse,
    pub curves: Vec<Curve>,
    /// How often an invariant was asked about.
    pub checks: u64,
    /// Invariants that did not hold.
    pub violations: Vec<Violation>,
    /// Why it was not measured, where it was not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub left_out: Option<String>,
}

/// Which way the parameter makes it worse.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Worse {
    #[default]
    Upwards,
    Downwards,
}

/// One method.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    pub method: String,
    /// (parameter, metric), the parameter growing.
    pub values: Vec<[f64; 2]>,
    /// The parameter from which on the metric is beyond the line, between two values by a straight line; none where it
    /// never is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub breakdown: Option<f64>,
    /// What is published of it.
    pub literature: String,
}

impl Curve {
    /// Whether no value of it passes.
    #[must_use]
    pub fn never_passes(&self, line: f64) -> bool {
        !self.values.iter().any(|[_, value]| *value <= line)
    }
}

/// A rule that did not hold.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Violation {
    /// Snake case.
    pub rule: String,
    pub count: u64,
    /// What and where the first was.
    pub first: String,
}
