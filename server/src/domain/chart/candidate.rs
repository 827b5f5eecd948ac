//! The settings that are charted: which there are, and what each asks for.

use serde::Serialize;

use crate::domain::{
    image::{SelfShadow, Silhouettes},
    request::{Aov, Method, Refinement, ReliefLook, RenderRequest, Shadows},
};

/// Steps of the marches that are charted, besides as many as the angle asks for.
const STEPS: [u32; 4] = [8, 16, 32, 64];
/// Pixels that displaced triangles may be off by.
const TOLERANCES_PX: [f64; 5] = [4.0, 2.0, 1.0, 0.5, 0.25];
/// Levels of uniform subdivision that are charted, at most.
const LEVELS: u32 = 5;

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
        request.aovs = vec![Aov::Depth, Aov::Position, Aov::Uv];
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

    /// Whether sweeps show it: of each method what it takes by itself, and displacement within half a pixel.
    #[must_use]
    pub fn is_swept(&self) -> bool {
        match self.setting {
            Setting::None | Setting::Steps(0) | Setting::Shell => true,
            Setting::TolerancePx(px) => px == 0.5,
            Setting::Steps(_) | Setting::Level(_) => false,
        }
    }

    /// Stem of its files.
    #[must_use]
    pub fn name(&self) -> String {
        self.label().replace(' ', "-")
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
