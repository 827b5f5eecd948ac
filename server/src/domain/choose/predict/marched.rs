//! Methods that march: how far what they strike is from the heights of its place.
//!
//! A place that is met is on its ray, so that nothing of it is off but what steps leave of the gap between ray and heights,
//! what coarser levels leave out, and, where the base bends, what the direction of heights changes by on the way.

use glam::DVec2;

use super::{Seen, shifted::margin};
use crate::domain::chart::Setting;

/// As in `march.glsl`.
const LEAST_STEPS: f64 = 8.0;
const MOST_STEPS: f64 = 512.0;
/// Of a step: five bisections.
const PARTS: f64 = 32.0;

/// What is made of the step that leads below the heights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Last {
    Whole,
    /// Where heights would be met, were they straight over it.
    Cut,
    Halved,
}

/// How long steps may be.
pub(super) struct Steps {
    /// Height that one comes down by.
    fall: f64,
    /// Texels that one leads over, along either axis.
    travel: DVec2,
}

impl Steps {
    pub(super) fn new(patch: &Seen<'_>, setting: Setting) -> Self {
        let [low, high] = patch.facts.range;
        let all = high - low + 2.0 * margin(patch.view, [low, high]);
        let thin = patch.facts.thinnest_texels.max(2f64.powi(patch.level as i32));
        let (least, most) = patch.slopes();
        let steps = match setting {
            Setting::Steps(steps) if steps > 0 => f64::from(steps).min(MOST_STEPS),
            _ => (least * all / thin).ceil().clamp(LEAST_STEPS, MOST_STEPS),
        };
        let fall = all / steps;
        let travel = patch.travel(fall);
        let is_told = matches!(setting, Setting::Steps(steps) if steps > 0);
        // As many as the angle asks for are no longer than the thinnest feature, unless there would be too many.
        let longest = if is_told { f64::INFINITY } else { thin.max(most * all / MOST_STEPS) };
        Self { fall, travel: travel.min(DVec2::splat(longest)) }
    }

    pub(super) fn may_miss(&self, patch: &Seen<'_>) -> bool {
        patch.hides() && self.travel.max_element() > patch.facts.thinnest_texels
    }
}

pub(super) fn stepped_px(patch: &Seen<'_>, steps: &Steps, last: Last) -> f64 {
    let [low, high] = patch.struck;
    let heights = [low - steps.fall, high];
    // The step that leads below begins above.
    let window = patch.over([low - steps.fall, high + steps.fall]);
    let read = patch.facts.read_by(&window, patch.level);
    let whole = steps.fall + patch.facts.change(&read, steps.travel);
    let gap = match last {
        Last::Whole => whole,
        Last::Cut => whole.min(patch.facts.residual(&read, steps.travel)),
        Last::Halved => steps.fall / PARTS + patch.facts.change(&read, steps.travel / PARTS),
    };
    patch.off_px(gap + patch.facts.level_error(&window, patch.level) + beyond(patch), heights)
}

pub(super) fn exact_px(patch: &Seen<'_>) -> f64 {
    patch.off_px(patch.level_error() + beyond(patch), patch.struck)
}

/// A ray that comes to a seam goes on over the height that is there.
fn beyond(patch: &Seen<'_>) -> f64 {
    let [low, high] = patch.struck;
    let way = low.abs().max(high.abs()) * patch.view.tangent;
    if way >= patch.view.patch.seam_distance { high - low } else { 0.0 }
}

/// Rays follow prisms along the directions themselves, which only are not made longer where normals blend.
pub(super) fn shell_px(patch: &Seen<'_>) -> f64 {
    let view = patch.view;
    let [low, high] = patch.struck;
    let height = low.abs().max(high.abs());
    let off = patch.level_error() * view.longest_direction + height * view.stretch;
    let w = view.least_w + patch.struck.iter().flat_map(|h| view.w_rise.map(|w| h * w)).fold(0.0, f64::min);
    let w = w - off * view.w_rate;
    if w > 0.0 { off * (view.rho + view.w_rate * patch.base_error_px()) / w } else { f64::INFINITY }
}

impl Seen<'_> {
    /// Least and most texels for each unit of height.
    fn slopes(&self) -> (f64, f64) {
        let slope = &self.view.slope;
        let least = DVec2::ZERO.clamp(slope.low, slope.high).length();
        (least, self.travel(1.0).length())
    }
}
