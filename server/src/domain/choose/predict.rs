//! Upper bounds of what a method is off by on a patch, pixels (`methods.md` D.3, by the patch's own heights and slopes in
//! place of the map's).

mod displaced;
mod marched;
mod shifted;

use std::cell::OnceCell;

use displace_glsl::methods::Method;

use super::{
    facts::{HeightFacts, Window},
    patch::PatchView,
};
use crate::domain::chart::Setting;
use marched::Last;
pub(super) use shifted::margin;

/// Of one method on one patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Predicted {
    /// No pixel of the patch shows a place that is farther than this from where it is seen on the true surface, by the
    /// reprojection error of [`super`]. Infinite where nothing is known, as where the eye is within the heights.
    pub error_px: f64,
    /// The patch's part of the outline, silhouettes and open borders, is nowhere farther than this from the true one.
    pub outline_px: f64,
    /// Something that the true surface hides may be seen, or something thin missed: the method must not be used where that
    /// counts.
    pub may_show_hidden: bool,
}

/// Of f64 twins and what they round.
const ROUNDING_PX: f64 = 1e-6;

/// Fails over to infinity where a method does not show heights.
#[must_use]
pub fn predict(method: Method, setting: Setting, view: &PatchView, facts: &HeightFacts) -> Predicted {
    predict_on(&Seen::new(view, facts), method, setting)
}

/// Of each of several.
#[must_use]
pub fn predict_each(settings: &[(Method, Setting)], view: &PatchView, facts: &HeightFacts) -> Vec<Predicted> {
    let patch = Seen::new(view, facts);
    settings.iter().map(|(method, setting)| predict_on(&patch, *method, *setting)).collect()
}

fn predict_on(patch: &Seen<'_>, method: Method, setting: Setting) -> Predicted {
    let outline_px = outline(patch, setting);
    let of = |error_px: f64, may_show_hidden: bool| Predicted {
        error_px: if error_px.is_nan() { f64::INFINITY } else { error_px + ROUNDING_PX },
        outline_px,
        may_show_hidden,
    };
    let hides = patch.hides();
    match method {
        Method::Displacement => of(displaced::error_px(patch, setting), false),
        Method::Vector | Method::Auto => of(f64::INFINITY, true),
        Method::Flat | Method::Bump | Method::Normal => of(patch.base_error_px(), hides),
        _ if !patch.view.is_front => of(patch.base_error_px(), true),
        Method::Parallax => of(shifted::parallax_px(patch), hides),
        Method::ParallaxLimited => of(shifted::limited_px(patch), hides),
        Method::ParallaxIterative => of(shifted::iterative_px(patch), hides),
        Method::Exact if setting == Setting::Shell => of(marched::shell_px(patch), false),
        Method::Exact => of(marched::exact_px(patch), false),
        Method::Steep => marched_by(patch, setting, Last::Whole, of),
        Method::Occlusion => marched_by(patch, setting, Last::Cut, of),
        Method::Relief | Method::Cone => marched_by(patch, setting, Last::Halved, of),
    }
}

fn marched_by(patch: &Seen<'_>, setting: Setting, last: Last, of: impl Fn(f64, bool) -> Predicted) -> Predicted {
    let steps = marched::Steps::new(patch, setting);
    of(marched::stepped_px(patch, &steps, last), steps.may_miss(patch))
}

/// A method leaves the base's outline, or shows the true one.
fn outline(patch: &Seen<'_>, setting: Setting) -> f64 {
    let Seen { view, .. } = patch;
    let most = patch.base_error_px();
    match setting {
        Setting::Shell => marched::shell_px(patch),
        Setting::TolerancePx(px) => px.min(most),
        Setting::Level(_) => displaced::error_px(patch, setting).min(most),
        _ if !(view.patch.is_rim || patch.hides()) || most < view.outline_distance_px => 0.0,
        _ => most,
    }
}

/// A patch with the heights on it.
struct Seen<'a> {
    view: &'a PatchView,
    facts: &'a HeightFacts,
    /// That is marched at most.
    level: usize,
    /// Least and greatest height on the patch.
    own: [f64; 2],
    /// Least and greatest height of what a ray over the patch may strike.
    struck: [f64; 2],
    /// Where on the map that is.
    window: Window,
    hides: OnceCell<bool>,
    level_error: OnceCell<f64>,
}

impl<'a> Seen<'a> {
    fn new(view: &'a PatchView, facts: &'a HeightFacts) -> Self {
        let level = view.level(facts.level_count());
        let own = facts.heights(&view.window);
        let (hides, level_error) = (OnceCell::new(), OnceCell::new());
        let mut seen = Self { view, facts, level, own, struck: facts.range, window: view.window, hides, level_error };
        for _ in 0..3 {
            seen.window = seen.over(seen.struck);
            seen.struck = seen.heights(&seen.window);
        }
        seen
    }

    /// Of the finest level and of any that may be marched.
    fn heights(&self, window: &Window) -> [f64; 2] {
        self.facts.heights(&self.facts.read_by(window, self.level))
    }

    /// Where rays over the patch are at heights of a range.
    fn over(&self, [low, high]: [f64; 2]) -> Window {
        let Window { low: a, high: b } = self.view.slope;
        let ends = [a * low, a * high, b * low, b * high];
        let shift = Window::around(ends);
        Window { low: self.view.window.low + shift.low, high: self.view.window.high + shift.high }
    }

    /// Texels that a way of so many units of height leads over at most, along either axis.
    fn travel(&self, height: f64) -> glam::DVec2 {
        self.view.slope.low.abs().max(self.view.slope.high.abs()) * height
    }

    /// How much heights rise at most along a ray, for each unit that the ray does.
    fn steepest(&self, window: &Window) -> f64 {
        self.facts.slopes(&self.facts.read_by(window, self.level)).dot(self.travel(1.0))
    }

    /// Whether any of the surface may be turned away from the viewer, and so hide what is behind it.
    fn hides(&self) -> bool {
        *self.hides.get_or_init(|| !self.view.is_front || self.steepest(&self.window) >= 1.0)
    }

    /// What coarser levels leave out of what a ray may strike.
    fn level_error(&self) -> f64 {
        *self.level_error.get_or_init(|| self.facts.level_error(&self.window, self.level))
    }

    /// Where the base is shown in place of what is above or below it.
    fn base_error_px(&self) -> f64 {
        let off = |height: f64, w_rise: f64| {
            let w = self.view.least_w + height * w_rise;
            if w > 0.0 { height.abs() * self.view.rise / w } else { f64::INFINITY }
        };
        let ends = self.own.into_iter().flat_map(|height| self.view.w_rise.map(|w_rise| off(height, w_rise)));
        ends.fold(0.0, f64::max)
    }

    /// Where what is shown is at a ray's place of a height within `heights`, and the surface above that place of the map is
    /// within `gap` of it.
    fn off_px(&self, gap: f64, [low, high]: [f64; 2]) -> f64 {
        let (view, base) = (self.view, &self.view.patch.base);
        let height = low.abs().max(high.abs());
        let way = height * view.tangent;
        let turned = view.mitre + (base.direction_rate * way).min(2.0 * view.longest_direction);
        let leaves = base.bend_rate * way;
        let rise = if turned > 0.0 { view.rise_of_normal + view.rho * turned } else { view.rise };
        let w = view.least_w * (1.0 - high.max(0.0) / view.eye_height)
            - (gap * view.longest_direction + height * turned + leaves) * view.w_rate;
        if w > 0.0 { (gap * rise + view.rho * (height * turned + leaves)) / w } else { f64::INFINITY }
    }
}
