//! Triangles that are displaced at their corners: how far they are from the heights between.

mod grid;

use super::Seen;
use crate::domain::chart::Setting;
use grid::Grid;

/// Σ λᵢ (1 − λᵢ)² / 2 is at most this: the remainder of interpolation, over the largest second derivative between corners.
const REMAINDER: f64 = 2.0 / 9.0;

/// A tolerance is kept by what is made to it.
pub(super) fn error_px(patch: &Seen<'_>, setting: Setting) -> f64 {
    match setting {
        Setting::TolerancePx(px) => px,
        Setting::Level(level) => level_px(patch, level),
        _ => level_px(patch, 0),
    }
}

/// Of uniform subdivision: with L the triangle, X - L = (h - h_L) D + h_L (D - D_L) + (h_L D_L - (h D)_L), the last of which
/// is a mean of products of differences, at most a third of the greatest.
fn level_px(patch: &Seen<'_>, level: u32) -> f64 {
    let (view, base) = (patch.view, &patch.view.patch.base);
    let parts = 2f64.powi(level.min(30) as i32);
    let side = base.window.size() / parts;
    let window = view.window.grown(side).within(&base.window);
    let heights = patch.facts.heights(&window);
    let residual = patch.facts.residual(&window, side).min(Grid::of(patch, parts).residual());
    let curved = curved(patch, base.direction_rate * base.longest_side / parts, heights)
        + patch.facts.change(&window, side) * base.direction_rate * base.longest_side / (3.0 * parts);
    let falls = heights.iter().flat_map(|h| view.w_rise.map(|w| h * w)).fold(0.0, f64::min);
    let w = view.least_w + falls - curved * view.w_rate;
    if w <= 0.0 {
        return f64::INFINITY;
    }
    // Seen from where the triangle is, in place of the base.
    let nearer = view.least_w / w;
    let rho = view.rho + view.w_rate * patch.base_error_px();
    let rise = nearer * view.rise + view.w_rate * view.longest_direction * curved * rho / w;
    (residual * rise + curved * rho) / w
}

/// How far directions that turn by so much over a triangle are from what is interpolated, times the greatest height.
fn curved(patch: &Seen<'_>, turn: f64, [low, high]: [f64; 2]) -> f64 {
    let view = patch.view;
    let bend = if view.mitre > 0.0 { REMAINDER * 2.0 * (1.0 + view.longest_direction) } else { 1.0 / 6.0 };
    low.abs().max(high.abs()) * bend * turn * turn
}
