//! The cheapest method that is good enough, of those that are weighed.

use displace_glsl::methods::Method;
use serde::{Deserialize, Serialize};

use super::{
    chart::{self, Setting},
    cost::Work,
};

/// What `Method::Auto` chose for one material.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Choice {
    /// Empty where it has none, and of primitives without one.
    pub material: String,
    /// Pixels allowed.
    pub tolerance_px: f64,
    pub chosen: Weighed,
    /// The cheapest of those nearer than `chosen`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub next_better: Option<Weighed>,
    /// The nearest of those cheaper than `chosen`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub next_cheaper: Option<Weighed>,
    /// What 99 of 100 pixels that show the material are off by in the image made; none where it was not measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measured_px: Option<f64>,
    /// It is displaced, and what is finer than its triangles bends normals.
    #[serde(default)]
    pub shades_rest: bool,
    /// Why nothing else was weighed, or why what was chosen first was not kept; else empty.
    #[serde(default)]
    pub reason: String,
}

/// A method with its setting, and what is predicted of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Weighed {
    /// In lower case.
    pub method: String,
    /// `shell`, `0.5px`; empty where the method has none.
    pub setting: String,
    /// Upper bound of what 99 of 100 covered pixels are off by; ∞, which is written as none, where there is no bound.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub predicted_px: Option<f64>,
    /// Upper bound of how far the outline is off.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub predicted_outline_px: Option<f64>,
    pub cost_ms: f64,
    pub work: Work,
}

/// One way to show a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    pub method: Method,
    /// Whether outlines are those of the heights, which only a method that finds depth knows.
    pub shell: bool,
    /// ∞ where there is no bound.
    pub error_px: f64,
    pub outline_px: f64,
    pub cost_ms: f64,
    pub work: Work,
}

/// Which of some candidates is chosen, and what stands beside it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Picked {
    pub chosen: usize,
    pub next_better: Option<usize>,
    pub next_cheaper: Option<usize>,
}

impl Choice {
    /// Whether what was measured, if it was, is within the tolerance.
    #[must_use]
    pub fn is_kept(&self) -> bool {
        self.measured_px.is_none_or(|error_px| error_px <= self.tolerance_px)
    }
}

impl Weighed {
    /// Whether its vertices move.
    #[must_use]
    pub fn is_displaced(&self) -> bool {
        [Method::Displacement, Method::Vector].iter().any(|method| method.name() == self.method)
    }
}

impl Candidate {
    /// The larger of both errors.
    #[must_use]
    pub fn worst_px(&self) -> f64 {
        self.error_px.max(self.outline_px)
    }

    #[must_use]
    pub fn is_within(&self, tolerance_px: f64) -> bool {
        self.worst_px() <= tolerance_px
    }

    /// As charts name it.
    #[must_use]
    pub fn setting(&self, tolerance_px: f64) -> Setting {
        match self.method {
            method if method.moves_vertices() => Setting::TolerancePx(tolerance_px),
            _ if self.shell => Setting::Shell,
            _ => Setting::None,
        }
    }

    #[must_use]
    pub fn weighed(&self, tolerance_px: f64) -> Weighed {
        let known = |px: f64| px.is_finite().then_some(px);
        let named = chart::Candidate { method: self.method, setting: self.setting(tolerance_px) };
        Weighed {
            method: self.method.name().into(),
            setting: named.setting(),
            predicted_px: known(self.error_px),
            predicted_outline_px: known(self.outline_px),
            cost_ms: self.cost_ms,
            work: self.work,
        }
    }
}

/// The cheapest that is within the tolerance, of equals the nearest; the nearest where none is. None of nothing.
#[must_use]
pub fn pick(candidates: &[Candidate], tolerance_px: f64) -> Option<Picked> {
    let of = |keep: &dyn Fn(&Candidate) -> bool, key: fn(&Candidate) -> [f64; 2]| {
        let kept = candidates.iter().enumerate().filter(|(_, candidate)| keep(candidate));
        let least = kept.min_by(|(_, a), (_, b)| {
            let ([a, tie_a], [b, tie_b]) = (key(a), key(b));
            a.total_cmp(&b).then(tie_a.total_cmp(&tie_b))
        });
        least.map(|(index, _)| index)
    };
    let by_cost = |candidate: &Candidate| [candidate.cost_ms, candidate.worst_px()];
    let by_error = |candidate: &Candidate| [candidate.worst_px(), candidate.cost_ms];
    let within = of(&|candidate| candidate.is_within(tolerance_px), by_cost);
    let chosen = within.or_else(|| of(&|_| true, by_error))?;
    let Candidate { cost_ms, .. } = candidates[chosen];
    let worst_px = candidates[chosen].worst_px();
    Some(Picked {
        chosen,
        next_better: of(&|candidate| candidate.worst_px() < worst_px, by_cost),
        next_cheaper: of(&|candidate| candidate.cost_ms < cost_ms, by_error),
    })
}

/// Whether nothing else that costs at least so much changes what is picked of these, nor what stands beside it.
#[must_use]
pub fn is_settled(known: &[Candidate], cost_ms: f64, tolerance_px: f64) -> bool {
    let Some(Picked { chosen, next_better: Some(better), .. }) = pick(known, tolerance_px) else { return false };
    let is_cheaper = |k: usize| known[k].cost_ms < cost_ms;
    known[chosen].is_within(tolerance_px) && is_cheaper(chosen) && is_cheaper(better)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn candidate(error_px: f64, outline_px: f64, cost_ms: f64) -> Candidate {
        let work = Work::default();
        Candidate { method: Method::Exact, shell: false, error_px, outline_px, cost_ms, work }
    }

    #[test]
    fn the_cheapest_that_is_near_enough_is_chosen_and_its_neighbours_are_told() {
        let all = [
            candidate(9.0, 9.0, 1.0),
            candidate(0.7, 0.0, 3.0),
            candidate(0.0, 2.0, 4.0),
            candidate(0.4, 0.1, 5.0),
            candidate(0.1, 0.0, 50.0),
        ];
        let picked = |tolerance_px| pick(&all, tolerance_px).unwrap();
        assert_eq!(picked(0.5), Picked { chosen: 3, next_better: Some(4), next_cheaper: Some(1) });
        assert_eq!(picked(1.0), Picked { chosen: 1, next_better: Some(3), next_cheaper: Some(0) });
        assert_eq!(picked(0.01), Picked { chosen: 4, next_better: None, next_cheaper: Some(3) });
        assert_eq!(pick(&[], 1.0), None);
    }

    proptest! {
        #[test]
        fn what_is_settled_is_what_is_picked_of_all(
            figures in prop::collection::vec((0u8..6, 0u8..6, 0u8..6), 2..12),
            known in 1usize..11,
            tolerance in 0u8..6,
        ) {
            let of = |(error, outline, cost): &(u8, u8, u8)| candidate(f64::from(*error), f64::from(*outline), f64::from(*cost));
            let mut all: Vec<Candidate> = figures.iter().map(of).collect();
            all.sort_by(|a, b| a.cost_ms.total_cmp(&b.cost_ms));
            let (known, tolerance_px) = (&all[..known.min(all.len() - 1)], f64::from(tolerance));
            if is_settled(known, all[known.len()].cost_ms, tolerance_px) {
                prop_assert_eq!(pick(known, tolerance_px), pick(&all, tolerance_px));
            }
        }

        #[test]
        fn nothing_cheaper_is_near_enough(
            figures in prop::collection::vec((0u8..6, 0u8..6, 0u8..6), 1..12),
            tolerance in 0u8..6,
        ) {
            let of = |(error, outline, cost): &(u8, u8, u8)| candidate(f64::from(*error), f64::from(*outline), f64::from(*cost));
            let all: Vec<Candidate> = figures.iter().map(of).collect();
            let tolerance_px = f64::from(tolerance);
            let Picked { chosen, next_better, next_cheaper } = pick(&all, tolerance_px).unwrap();
            let chosen = all[chosen];
            let enough = || all.iter().filter(|c| c.is_within(tolerance_px));
            prop_assert!(enough().all(|c| c.cost_ms >= chosen.cost_ms));
            prop_assert!(chosen.is_within(tolerance_px) || enough().count() == 0);
            prop_assert!(next_better.is_none_or(|k| all[k].worst_px() < chosen.worst_px()));
            prop_assert!(next_cheaper.is_none_or(|k| all[k].cost_ms < chosen.cost_ms));
        }
    }
}
