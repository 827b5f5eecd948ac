//! Time against error: what is charted, and what comes of it.

mod candidate;
mod sweep;

use serde::{Deserialize, Serialize};

use super::{
    Digest,
    image::MarchCounters,
    report::{Comparison, Warning},
    request::RenderRequest,
};

pub use candidate::{Candidate, Setting};
pub use sweep::{Sweep, SweepPoint};

#[derive(Clone, Debug, Serialize)]
pub struct ChartRequest {
    /// The truth: the surface itself, by rays.
    pub truth: RenderRequest,
    /// Runs of each setting.
    pub repeats: u32,
    /// Those that the request goes with, as far as it tells.
    pub candidates: Vec<Candidate>,
    /// The others.
    pub left_out: Vec<LeftOut>,
    /// Where methods fail is asked for, in place of what they take.
    pub stability: bool,
    /// What is swept besides, in its order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sweeps: Vec<Sweep>,
}

/// A setting that a request does not go with.
#[derive(Clone, Debug, Serialize)]
pub struct LeftOut {
    pub candidate: Candidate,
    pub reason: String,
}

impl LeftOut {
    /// One for each method and reason.
    #[must_use]
    pub fn warnings(all: &[Self]) -> Vec<Warning> {
        let of = |a: &Self, b: &Self| a.candidate.method == b.candidate.method && a.reason == b.reason;
        let is_first = |k: &usize| !all[..*k].iter().any(|known| of(known, &all[*k]));
        let warning = |k: usize| {
            let settings = all.iter().filter(|other| of(other, &all[k])).map(|other| other.candidate.setting());
            let settings = settings.collect::<Vec<_>>().join(", ");
            let what = format!("{} {settings}", all[k].candidate.method.name());
            Warning::new("left_out", format!("{} is not charted: {}", what.trim_end(), all[k].reason))
        };
        (0..all.len()).filter(is_first).map(warning).collect()
    }
}

/// What came of a chart.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Chart {
    /// Of the meshes.
    pub title: String,
    pub device: String,
    /// Name and version.
    pub driver: String,
    pub width: u32,
    pub height: u32,
    /// Rays a pixel of the truth.
    pub truth_samples: u32,
    pub truth_ms: f64,
    pub points: Vec<Point>,
    /// By sweep, value and method.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sweeps: Vec<SweepPoint>,
}

impl Chart {
    /// The automatic choice, where one was made.
    #[must_use]
    pub fn chosen(&self) -> Option<&Point> {
        self.points.iter().find(|point| point.chosen)
    }

    /// What was swept, in the order of all sweeps.
    #[must_use]
    pub fn swept(&self) -> Vec<Sweep> {
        let was_swept = |sweep: &Sweep| self.sweeps.iter().any(|point| point.sweep == *sweep);
        Sweep::ALL.into_iter().filter(was_swept).collect()
    }

    /// How many times as long the automatic choice takes as the fastest setting that is as near: 1 on the front.
    #[must_use]
    pub fn times_front(&self, metric: Metric) -> Option<f64> {
        let chosen = self.chosen()?;
        let error = metric.of(&chosen.error)?;
        let is_as_near = |point: &&Point| metric.of(&point.error).is_some_and(|other| other <= error);
        let fastest = self.points.iter().filter(is_as_near).map(|point| point.ms).min_by(f64::total_cmp)?;
        Some(if fastest > 0.0 { chosen.ms / fastest } else { 1.0 })
    }
}

/// One setting that made an image.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Point {
    pub name: String,
    pub method: String,
    pub setting: String,
    pub triangles: u64,
    pub vertices: u64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub counters: Option<MarchCounters>,
    /// Of surface and maps on the device, by the plan.
    pub scene_bytes: u64,
    /// Of the median run, surface and image.
    pub ms: f64,
    /// Longest less shortest run, where there were several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ms_spread: Option<f64>,
    pub geometry_ms: f64,
    pub image_ms: f64,
    /// Besides: what its maps and light need once.
    #[serde(default)]
    pub setup_ms: f64,
    pub runs: u32,
    pub error: Comparison,
    /// Those that it is on.
    pub fronts: Vec<Metric>,
    /// At most as many pixels of hit error, before anything is drawn; absent where no bound is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub predicted_px: Option<f64>,
    /// Whether the automatic choice is this one; of all points one at most.
    #[serde(default)]
    pub chosen: bool,
}

impl Point {
    /// Method and setting, for people.
    #[must_use]
    pub fn label(&self) -> String {
        format!("{} {}", self.method, self.setting).trim_end().to_owned()
    }
}

/// An error that time is charted against.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Metric {
    Flip,
    HitPx,
    SilhouettePx,
}

impl Metric {
    pub const ALL: [Self; 3] = [Self::Flip, Self::HitPx, Self::SilhouettePx];

    /// As tables have it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Flip => "flip",
            Self::HitPx => "hit_px",
            Self::SilhouettePx => "silhouette_px",
        }
    }

    /// Absent where images show nothing in common.
    #[must_use]
    pub fn of(self, error: &Comparison) -> Option<f64> {
        match self {
            Self::Flip => Some(error.flip_mean),
            Self::HitPx => error.hit_error_px,
            Self::SilhouettePx => error.silhouette_xor_px.map(|pixels| pixels as f64),
        }
    }
}

impl ChartRequest {
    /// As [`RenderRequest::assets`].
    #[must_use]
    pub fn assets(&self) -> Vec<Digest> {
        self.truth.assets()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::request::Method;

    #[test]
    fn what_is_left_out_for_one_reason_is_told_once() {
        let left_out = |setting, reason: &str| LeftOut {
            candidate: Candidate { method: Method::Steep, setting },
            reason: reason.into(),
        };
        let all =
            [left_out(Setting::Steps(8), "a"), left_out(Setting::Steps(16), "b"), left_out(Setting::Steps(0), "a")];
        let told: Vec<String> = LeftOut::warnings(&all).into_iter().map(|warning| warning.message).collect();
        assert_eq!(told, ["steep 8, auto is not charted: a", "steep 16 is not charted: b"]);
    }
}
