//! Error as the view or the detail changes: where each method breaks.

use serde::{Deserialize, Serialize};

use crate::domain::report::Comparison;

/// What changes while all else stays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sweep {
    /// Between the view's axis and the surface, degrees: 90 is face-on.
    Angle,
    /// From what is looked at, times that of the chart.
    Distance,
    /// Of the detail, times its scale.
    Amplitude,
}

impl Sweep {
    pub const ALL: [Self; 3] = [Self::Angle, Self::Distance, Self::Amplitude];

    /// As tables have it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Angle => "angle",
            Self::Distance => "distance",
            Self::Amplitude => "amplitude",
        }
    }
}

/// One method at one value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SweepPoint {
    pub sweep: Sweep,
    pub value: f64,
    pub method: String,
    pub setting: String,
    pub triangles: u64,
    /// Of the one run, surface and image.
    pub ms: f64,
    pub error: Comparison,
}

impl SweepPoint {
    /// Method and setting, for people.
    #[must_use]
    pub fn label(&self) -> String {
        format!("{} {}", self.method, self.setting).trim_end().to_owned()
    }
}
