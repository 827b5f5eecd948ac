//! Methods that shift maps: how far the height that they take is from that of the place that they show.
//!
//! A ray that is shifted to height z shows the place of the map under itself there, so that it is off by what lies between z
//! and the height of that place.

use super::{Seen, Window};
use crate::domain::choose::patch::PatchView;

/// Beyond the least and the greatest height, of their distance, and at least of the longest side: as courses have it.
const MARGIN: f64 = 1.0 / 64.0;
const LEAST_MARGIN: f64 = 1.0 / 4096.0;
const TURNS: i32 = 4;

/// What a course leads over beyond all heights.
pub(in crate::domain::choose) fn margin(view: &PatchView, [low, high]: [f64; 2]) -> f64 {
    ((high - low) * MARGIN).max(view.patch.base.longest_side * LEAST_MARGIN)
}

/// Where a shift begins: at height 0, or where the course is nearest to it.
struct Start {
    height: f64,
    /// Where on the map.
    window: Window,
    /// Of the level that is read there.
    heights: [f64; 2],
}

impl Start {
    fn of(patch: &Seen<'_>) -> Self {
        let [low, high] = patch.facts.range;
        let margin = margin(patch.view, [low, high]);
        let height = 0.0f64.clamp(low - margin, high + margin);
        let window = patch.over([height; 2]);
        Self { height, window, heights: patch.heights(&window) }
    }

    /// Of the shift.
    fn most(&self) -> f64 {
        self.heights.iter().fold(0.0, |most: f64, z| most.max((z - self.height).abs()))
    }
}

/// Kaneko et al. 2001: min(range, steepest slope times the shift).
pub(super) fn parallax_px(patch: &Seen<'_>) -> f64 {
    let start = Start::of(patch);
    shifted_px(patch, &start, [1.0; 2])
}

/// Welsh 2004: the shift times the cosine, and range (1 - cos) more.
pub(super) fn limited_px(patch: &Seen<'_>) -> f64 {
    let start = Start::of(patch);
    shifted_px(patch, &start, patch.view.cosine)
}

/// To a share of the height.
fn shifted_px(patch: &Seen<'_>, start: &Start, share: [f64; 2]) -> f64 {
    let reached = |height: f64| share.map(|share| start.height + (height - start.height) * share);
    let ends = start.heights.map(reached);
    let low = ends.iter().flatten().fold(f64::INFINITY, |low: f64, z| low.min(*z));
    let high = ends.iter().flatten().fold(f64::NEG_INFINITY, |high: f64, z| high.max(*z));
    let window = patch.over([low, high]);
    let [least, greatest] = patch.facts.heights(&window);
    let apart = (greatest - low).max(high - least);
    let both = hull(&window, &start.window);
    let change = patch.facts.change(&both, patch.travel(start.most() * share[1]));
    let short = start.most() * (1.0 - share[0]);
    let gap = apart.min(change + short + patch.facts.level_error(&start.window, patch.level));
    patch.off_px(gap, [low, high])
}

/// Premecz 2006: each turn goes on by a share a of what is missing, which changes by at most m times as much on the way, and
/// so leaves 1 - a (1 - m) of it.
pub(super) fn iterative_px(patch: &Seen<'_>) -> f64 {
    let start = Start::of(patch);
    let [low, high] = patch.facts.range;
    let mut ends = [low.min(start.height), high.max(start.height)];
    let mut window = patch.over(ends);
    for _ in 0..2 {
        let [low, high] = patch.heights(&window);
        ends = [low.min(start.height), high.max(start.height)];
        window = patch.over(ends);
    }
    let [least, greatest] = patch.facts.heights(&window);
    let apart = (greatest - ends[0]).max(ends[1] - least);
    let left =
        patch.facts.level_error(&window, patch.level) + start.most() * left_of_a_turn(patch, &window).powi(TURNS);
    patch.off_px(apart.min(left), ends)
}

fn left_of_a_turn(patch: &Seen<'_>, window: &Window) -> f64 {
    let m = patch.steepest(window);
    let slope = patch.facts.slopes(&patch.facts.read_by(window, patch.level)).length() * patch.view.most_texels;
    let [least, most] = patch.view.cosine;
    let share = if m < 1.0 { least / slope.hypot(1.0) } else { most };
    1.0 - share * (1.0 - m)
}

fn hull(a: &Window, b: &Window) -> Window {
    Window { low: a.low.min(b.low), high: a.high.max(b.high) }
}
