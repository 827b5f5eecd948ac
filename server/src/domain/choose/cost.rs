//! What methods cost on a patch, estimated: reads of a pixel, and triangles of a tolerance.

use displace_glsl::methods::Method;
use glam::DVec2;

use super::{
    facts::{HeightFacts, Window},
    patch::PatchView,
    predict::margin,
};
use crate::domain::chart::Setting;

/// As in `march.glsl`.
const LEAST_STEPS: f64 = 8.0;
const MOST_STEPS: f64 = 512.0;
const BISECTIONS: f64 = 5.0;
/// Of the exact march: with fewer lines, cell by cell.
const MOST_LINES: f64 = 12.0;

/// Bilinear values, bounds and cones that a fragment reads on average; 0 of methods that march nothing.
#[must_use]
pub fn fetches_per_pixel(method: Method, setting: Setting, view: &PatchView, facts: &HeightFacts) -> f64 {
    let way = Way::of(view, facts, setting);
    match method {
        _ if !view.is_front => 0.0,
        Method::Parallax | Method::ParallaxLimited => 1.0,
        Method::ParallaxIterative => 4.0,
        Method::Steep | Method::Occlusion => way.steps_taken() + 1.0,
        Method::Relief => way.steps_taken() + 1.0 + BISECTIONS,
        Method::Cone => way.of_cones(),
        Method::Exact => way.of_cells(),
        _ => 0.0,
    }
}

/// A ray that strikes about the mean height.
struct Way {
    /// Share of the course until then.
    share: f64,
    /// Even steps of all of it.
    steps: f64,
    /// Lattice lines that it crosses until then, and all of it; of the level that is marched.
    lines: [f64; 2],
}

impl Way {
    fn of(view: &PatchView, facts: &HeightFacts, setting: Setting) -> Self {
        let [low, high] = facts.range;
        let margin = margin(view, [low, high]);
        let all = high - low + 2.0 * margin;
        let slope = 0.5 * (view.slope.low + view.slope.high);
        let level = 2f64.powi(view.level(facts.level_count()) as i32);
        let mean = facts.mean(&view.window).clamp(low, high);
        let share = (high + margin - mean) / all;
        let steps = match setting {
            Setting::Steps(steps) if steps > 0 => f64::from(steps).min(MOST_STEPS),
            _ => (slope.length() * all / facts.thinnest_texels.max(level)).ceil().clamp(LEAST_STEPS, MOST_STEPS),
        };
        let lines = slope.abs().element_sum() * all / level;
        Self { share, steps, lines: [lines * share, lines] }
    }

    fn steps_taken(&self) -> f64 {
        (self.share * self.steps + 0.5).max(1.0)
    }

    fn of_cones(&self) -> f64 {
        2.0 * self.steps_taken().min(2.0 + 0.5 * self.lines[0]) + BISECTIONS
    }

    fn of_cells(&self) -> f64 {
        let [until, all] = self.lines;
        if all < MOST_LINES { 1.0 + until } else { 3.0 + 2.0 * until.max(1.0).log2() }
    }
}

/// Of a leaf of the quadtree, what the tessellator makes of it after it has collapsed what it could.
const TRIANGLES_OF_A_LEAF: f64 = 0.8;
/// Texels of the least leaf: less is a facet of a cell.
const LEAST_LEAF: f64 = 0.5;
/// Texels of a leaf within which heights bend evenly, so that what is left of them falls with its area.
const EVEN_LEAF: f64 = 2.0;
/// Of what is left of heights that are no steps, from a square to one twice as wide.
const LEAST_GROWTH: f64 = 1.5;

/// What displacing within a tolerance takes on a patch: leaves of a quadtree over the map, each as near to a plane as
/// allowed. A tolerance counts along any direction, so that depth alone decides. Patches of one triangle add, to one at least.
#[must_use]
pub fn triangles_for(tolerance_px: f64, view: &PatchView, facts: &HeightFacts) -> f64 {
    let allowed = tolerance_px * view.least_w / (view.rho * view.longest_direction);
    let area = |[a, b, c]: [DVec2; 3]| (b - a).perp_dot(c - a).abs();
    let own = area(view.patch.texels);
    let size = view.window.size();
    let leaf = 2.0 * size.x * size.y / own;
    let of_base = own / area(view.patch.base.texels);
    let side = view.patch.base.window.size().max_element() / size.max_element();
    let middle = 0.5 * (view.window.low + view.window.high);
    // Of what is so level that leaves hold several patches.
    let is_level = |wider: &f64| left_between(facts, middle, size.max_element() * wider) <= allowed;
    let wider = [1.0, 2.0, 4.0, 8.0].into_iter().filter(|wider| *wider <= side).take_while(is_level).last();
    let leaves = wider.map_or_else(|| leaves(facts, &view.window, allowed), |wider: f64| wider.powi(-2));
    (leaves * TRIANGLES_OF_A_LEAF / leaf).max(of_base)
}

/// About how far heights are from what is linear between some of them. Where they bend vertices are laid so that it is no more
/// than from the best plane, of which a square twice as wide leaves more. Where it leaves no more they are steps: vertices are on
/// one or the other, twice as far from what is between as the best plane is.
fn left_between(facts: &HeightFacts, middle: DVec2, side: f64) -> f64 {
    let own = facts.about(middle, side);
    let growth = facts.about(middle, 2.0 * side) / own.max(f64::MIN_POSITIVE);
    own * (2.0 - (growth - 1.0) / (LEAST_GROWTH - 1.0)).clamp(1.0, 2.0)
}

fn leaves(facts: &HeightFacts, window: &Window, allowed: f64) -> f64 {
    let size = window.size();
    let middle = 0.5 * (window.low + window.high);
    let side = size.max_element();
    let bent = left_between(facts, middle, side) / allowed;
    if bent <= 1.0 {
        return 1.0;
    }
    if side <= EVEN_LEAF {
        return bent.min((size / LEAST_LEAF).element_product()).max(1.0);
    }
    let halves = |axis: usize| {
        let mut parts = [*window; 2];
        parts[0].high[axis] = middle[axis];
        parts[1].low[axis] = middle[axis];
        parts
    };
    halves(usize::from(size.y > size.x)).iter().map(|half| leaves(facts, half, allowed)).sum()
}
