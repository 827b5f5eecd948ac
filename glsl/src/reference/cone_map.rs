//! Twin of `cone_map`: for every cell of a level of heights the widest cone, up to what a window tells, in which a ray
//! that descends goes below the bilinear surface at most once, whatever place of the cell it starts above (after Policarpo
//! and Oliveira 2007 and Ban et al. 2024). A cone is how many texels wide it is for each unit of height.
//!
//! A ray comes out of the surface only where heights fall along its way. So a cell bounds the cone of another where its
//! heights fall for some way from the one to the other, by x / f of the places there: x is how far they are, f how much
//! higher than where the cone stands. Three bounds hold of that:
//! * in the cell itself, sqrt(2) / |twist|: the slope along a way changes by at most 2 |twist| over its length x, and by at
//!   most |twist| x, and heights that rise and then fall rise by less than half of the change of slope;
//! * the distance of the cells over the difference of their heights;
//! * 1 over the steepest slope of all cells that are no farther away, and 1 over the greatest difference of their slopes:
//!   where heights fall along a way at its end, its slope anywhere is at most what it differs by from there.

use glam::{DVec2, IVec2};

use super::relief::HeightLevel;

/// Texels around a cell within which others are looked at.
pub const WINDOW: i32 = 32;
/// Of cells that nothing bounds.
pub const WIDEST: f64 = 1_048_576.0;
/// More than rounding takes.
const KEPT: f64 = 0.99999;

/// What a ring of cells says.
struct Ring {
    /// Least and greatest slopes of all cells so far, height for each texel.
    slopes: [DVec2; 2],
    /// Of distance over difference of height, of cells where heights fall.
    least: f64,
}

impl Ring {
    /// The most that heights rise along a way, for each texel, before they fall at its end.
    fn rise(&self) -> f64 {
        let [low, high] = self.slopes;
        low.abs().max(high.abs()).length().min((high - low).length())
    }
}

/// Of every cell, row by row; cell (i, j) lies between texels (i, j) and (i + 1, j + 1).
#[must_use]
pub fn cones(level: &HeightLevel) -> Vec<f32> {
    let high = level.heights.iter().fold(f32::NEG_INFINITY, |high, h| high.max(*h));
    let cells = (0..level.size[1] as i32).flat_map(|y| (0..level.size[0] as i32).map(move |x| IVec2::new(x, y)));
    cells.map(|cell| cone(level, cell, f64::from(high)) as f32).collect()
}

fn cone(level: &HeightLevel, cell: IVec2, high: f64) -> f64 {
    let h = level.corners(cell);
    let low = h.into_iter().fold(f64::INFINITY, f64::min);
    let mut cone = own(h);
    let mut ring = Ring { slopes: [DVec2::INFINITY, DVec2::NEG_INFINITY], least: WIDEST };
    look_at(level, cell, IVec2::ZERO, low, &mut ring);
    let mut r = 1;
    while r <= WINDOW && f64::from(r - 1) < cone * (high - low) {
        ring.least = WIDEST;
        look_around(level, cell, r, low, &mut ring);
        if ring.least < WIDEST {
            cone = cone.min(ring.least.max(1.0 / ring.rise()));
        }
        r += 1;
    }
    if r > WINDOW {
        // What lies beyond is at least as far away.
        cone = cone.min(f64::from(WINDOW) / (high - low));
    }
    KEPT * cone
}

fn own([a, b, c, d]: [f64; 4]) -> f64 {
    let twist = (a - b - c + d).abs();
    if twist > 0.0 { (2f64.sqrt() / twist).min(WIDEST) } else { WIDEST }
}

fn look_around(level: &HeightLevel, cell: IVec2, r: i32, low: f64, ring: &mut Ring) {
    for k in 0..2 * r {
        for away in [[k - r, -r], [r, k - r], [r - k, r], [-r, r - k]] {
            look_at(level, cell, away.into(), low, ring);
        }
    }
}

fn look_at(level: &HeightLevel, cell: IVec2, away: IVec2, low: f64, ring: &mut Ring) {
    let h = level.corners(cell + away);
    let [a, b, c, d] = h;
    let (along_x, along_y) = ([b - a, d - c], [c - a, d - b]);
    let [first, second] = [0, 1].map(|k| DVec2::new(along_x[k], along_y[k]));
    ring.slopes = [ring.slopes[0].min(first.min(second)), ring.slopes[1].max(first.max(second))];
    let falls = least_product(along_x, away.x) + least_product(along_y, away.y);
    let higher = h.into_iter().fold(f64::NEG_INFINITY, f64::max) - low;
    if falls < 0.0 && higher > 0.0 {
        let apart: DVec2 = (away.abs() - 1).max(IVec2::ZERO).as_dvec2();
        ring.least = ring.least.min(apart.length() / higher);
    }
}

/// Least product of slopes and of ways between places of cells that are so many apart.
fn least_product(slopes: [f64; 2], apart: i32) -> f64 {
    let ways = [f64::from(apart - 1), f64::from(apart + 1)];
    slopes.iter().flat_map(|slope| ways.map(|way| slope * way)).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::relief::tests::{Random, map};

    /// Rough and smooth, with walls and with posts, heights in texels.
    fn levels() -> Vec<HeightLevel> {
        let mut random = Random(5);
        let noise: Vec<f32> = (0..24 * 24).map(|_| random.within(0.0, 4.0) as f32).collect();
        let hills = |x: u32, y: u32| ((x as f32 * 0.52).sin() + (y as f32 * 0.78).cos()) * 1.5;
        let bricks = |x: u32, y: u32| if x % 8 < 2 || y % 6 < 1 { 0.0 } else { 3.0 };
        let posts = |x: u32, y: u32| if x % 8 == 3 && y % 8 == 5 { 5.0 } else { 0.0 };
        let rough = |x: u32, y: u32| noise[(y * 24 + x) as usize];
        let all: [&dyn Fn(u32, u32) -> f32; 5] =
            [&rough, &hills, &bricks, &posts, &|x, y| hills(x, y) + 0.1 * rough(x, y)];
        let tiling = all.map(|height| map([24, 24], height).level);
        let cut = tiling.clone().map(|level| HeightLevel { repeats: [false, true], ..level });
        tiling.into_iter().chain(cut).collect()
    }

    /// How often a ray comes out of the surface before it leaves a cone, looked at every 1/100 of a texel.
    fn comes_out(level: &HeightLevel, from: DVec2, gap: f64, along: DVec2, descent: f64, cone: f64) -> bool {
        let apex = level.height(from);
        let reach = (cone * gap / (1.0 + cone * descent)).min(60.0);
        let mut below = false;
        (0..(reach * 100.0) as u32).map(|k| f64::from(k) * 0.01).any(|x| {
            let above = apex + gap - descent * x - level.height(from + along * x);
            below |= above < -1e-6;
            below && above > 1e-6
        })
    }

    #[test]
    fn within_a_cone_a_ray_that_descends_goes_below_the_surface_at_most_once() {
        let mut random = Random(6);
        for level in levels() {
            let cones = cones(&level);
            for _ in 0..6000 {
                let from = DVec2::new(random.within(-12.0, 36.0), random.within(-12.0, 36.0));
                let along = DVec2::from_angle(random.within(0.0, std::f64::consts::TAU));
                let (gap, descent) = (random.within(0.0, 4.0), random.within(0.0, 1.5).powi(3));
                let cone = f64::from(cones[level.index(from.floor().as_ivec2())]);
                assert!(!comes_out(&level, from, gap, along, descent, cone), "{from} {along} {gap} {descent} {cone}");
            }
        }
    }

    #[test]
    fn cones_that_are_five_times_as_wide_are_pierced_more_than_once() {
        let mut random = Random(7);
        for level in levels() {
            let cones = cones(&level);
            let pierced = (0..6000).filter(|_| {
                let from = DVec2::new(random.within(0.0, 24.0), random.within(0.0, 24.0));
                let along = DVec2::from_angle(random.within(0.0, std::f64::consts::TAU));
                let (gap, descent) = (random.within(0.0, 4.0), random.within(0.0, 0.5).powi(3));
                let cone = 5.0 * f64::from(cones[level.index(from.floor().as_ivec2())]);
                comes_out(&level, from, gap, along, descent, cone)
            });
            assert!(pierced.count() > 0);
        }
    }

    #[test]
    fn what_only_rises_bounds_nothing() {
        let mut level = map([40, 4], |x, _| x as f32 * 0.5).level;
        level.repeats = [false, true];
        // 19.5 is the greatest height and 32 texels the window, which is what bounds where the ramp is far from its top.
        let cones = cones(&level);
        assert!((f64::from(cones[0]) - 32.0 / 19.5).abs() < 1e-4, "{}", cones[0]);
        assert!(cones[39] > 1000.0);
    }

    #[test]
    fn a_post_bounds_cones_by_its_slopes_and_its_distance() {
        let level = map([32, 32], |x, y| if (x, y) == (16, 16) { 4.0 } else { 0.0 }).level;
        let cones = cones(&level);
        let cone = |x: usize| f64::from(cones[16 * 32 + x]);
        // At the foot the way up is 4 for a texel; 5 cells off, all of the post is at least 4 texels away.
        assert!((0.17..0.2501).contains(&cone(15)), "{}", cone(15));
        assert!((cone(10) - 4.0 / 4.0).abs() < 0.01, "{}", cone(10));
    }
}
