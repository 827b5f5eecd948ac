//! Time against error: what is charted, and what comes of it.

use serde::{Deserialize, Serialize};

use super::{
    Digest,
    image::{MarchCounters, SelfShadow, Silhouettes},
    report::{Comparison, Warning},
    request::{Aov, Method, Refinement, ReliefLook, RenderRequest, Shadows},
};

/// Steps of the marches that are charted, besides as many as the angle asks for.
const STEPS: [u32; 4] = [8, 16, 32, 64];
/// Pixels that displaced triangles may be off by.
const TOLERANCES_PX: [f64; 5] = [4.0, 2.0, 1.0, 0.5, 0.25];
/// Levels of uniform subdivision that are charted, at most.
const LEVELS: u32 = 5;

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

/// One setting of one method.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Candidate {
    pub method: Method,
    pub setting: Setting,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Setting {
    /// The method has none.
    None,
    /// 0: as many as the angle asks for.
    Steps(u32),
    /// `Silhouettes::Shell`.
    Shell,
    TolerancePx(f64),
    /// Of uniform subdivision.
    Level(u32),
}

impl Candidate {
    /// All that say nothing of the mesh, in the order in which they are charted. `displacing` is the method of the truth.
    #[must_use]
    pub fn all(displacing: Method) -> Vec<Self> {
        use Method::{Bump, Cone, Exact, Flat, Normal, Occlusion, Parallax, ParallaxIterative, ParallaxLimited};
        let of = |method: Method, setting| Self { method, setting };
        let mut all: Vec<Self> = [Flat, Bump, Normal, Parallax, ParallaxLimited, ParallaxIterative]
            .map(|method| of(method, Setting::None))
            .into();
        for method in [Method::Steep, Occlusion, Method::Relief, Cone] {
            all.extend([0].into_iter().chain(STEPS).map(|steps| of(method, Setting::Steps(steps))));
        }
        all.extend([Setting::None, Setting::Shell].map(|setting| of(Exact, setting)));
        if displacing.moves_vertices() {
            all.extend(TOLERANCES_PX.map(|px| of(displacing, Setting::TolerancePx(px))));
        }
        all
    }

    /// The finest levels that split `triangles` into no more than `most`, coarsest first; level 0 at least.
    #[must_use]
    pub fn levels(displacing: Method, triangles: u64, most: u64) -> Vec<Self> {
        let fits = |level: &u32| triangles.max(1).saturating_mul(1 << (2 * level)) <= most;
        let finest = (0..=12).rev().find(fits).unwrap_or(0);
        let levels = (finest + 1).saturating_sub(LEVELS)..=finest;
        levels.map(|level| Self { method: displacing, setting: Setting::Level(level) }).collect()
    }

    /// What shows it from where the truth is seen; a tolerance as the mesh as it is.
    #[must_use]
    pub fn request(&self, truth: &RenderRequest) -> RenderRequest {
        let finds_depth = self.method.marcher().is_some_and(|marcher| marcher.finds_depth);
        let shadowed = finds_depth && truth.look.shadows != Shadows::None;
        let mut request = truth.clone();
        request.surface.method = self.method;
        request.surface.geometry.refinement = Refinement::Uniform(match self.setting {
            Setting::Level(level) => level,
            _ => 0,
        });
        request.look.relief = ReliefLook {
            steps: if let Setting::Steps(steps) = self.setting { steps } else { 0 },
            self_shadow: if shadowed { SelfShadow::Hard } else { SelfShadow::None },
            silhouettes: if self.setting == Setting::Shell { Silhouettes::Shell } else { Silhouettes::None },
        };
        request.samples = None;
        request.aovs = vec![Aov::Depth, Aov::Position];
        request
    }

    /// As tables have it.
    #[must_use]
    pub fn setting(&self) -> String {
        match self.setting {
            Setting::None => String::new(),
            Setting::Steps(0) => "auto".into(),
            Setting::Steps(steps) => steps.to_string(),
            Setting::Shell => "shell".into(),
            Setting::TolerancePx(px) => format!("{px}px"),
            Setting::Level(level) => format!("level {level}"),
        }
    }

    /// Method and setting, for people.
    #[must_use]
    pub fn label(&self) -> String {
        format!("{} {}", self.method.name(), self.setting()).trim_end().to_owned()
    }

    /// Whether both are of one sweep: a method by steps, by tolerance, or by level.
    #[must_use]
    pub fn is_beside(&self, other: &Self) -> bool {
        let is_level = |candidate: &Self| matches!(candidate.setting, Setting::Level(_));
        self.method == other.method && is_level(self) == is_level(other)
    }

    /// Stem of its files.
    #[must_use]
    pub fn name(&self) -> String {
        self.label().replace(' ', "-")
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
}

impl Chart {
    /// The automatic choice, where one was made.
    #[must_use]
    pub fn chosen(&self) -> Option<&Point> {
        self.points.iter().find(|point| point.chosen)
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

    #[test]
    fn no_two_settings_share_a_file() {
        let mut names: Vec<String> = Candidate::all(Method::Displacement)
            .into_iter()
            .chain(Candidate::levels(Method::Displacement, 2, 1 << 17))
            .map(|candidate| candidate.name())
            .collect();
        let count = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count);
        assert!(
            names.iter().all(|name| name.chars().all(|c| c.is_ascii_alphanumeric() || "-.".contains(c))),
            "{names:?}"
        );
    }

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

    #[test]
    fn levels_are_the_finest_that_fit() {
        let levels = |triangles, most| -> Vec<String> {
            Candidate::levels(Method::Displacement, triangles, most).iter().map(Candidate::setting).collect()
        };
        assert_eq!(levels(2, 2 * 256 * 256), ["level 4", "level 5", "level 6", "level 7", "level 8"]);
        assert_eq!(levels(2, 2 * 256 * 256 - 1), ["level 3", "level 4", "level 5", "level 6", "level 7"]);
        assert_eq!(levels(100, 1700), ["level 0", "level 1", "level 2"]);
        assert_eq!(levels(u64::MAX, 1700), ["level 0"]);
    }
}
