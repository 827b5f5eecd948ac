//! Facts against the heights themselves.

use glam::DVec2;

use super::*;

struct Random(u64);

impl Random {
    fn within(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 33) as f64 / f64::from(1u32 << 31))
    }

    fn place(&mut self, reach: f64) -> DVec2 {
        DVec2::new(self.within(-reach, reach), self.within(-reach, reach))
    }
}

fn map([width, height]: [u32; 2], repeats: [bool; 2], at: impl Fn(f64, f64) -> f64) -> HeightMap {
    let heights = (0..width * height).map(|k| at(f64::from(k % width), f64::from(k / width)) as f32).collect();
    HeightMap { width, height, heights, repeats, thinnest_texels: 1.0 }
}

/// Smooth, rough, with walls, of sizes that halve and others, repeated and not.
fn maps() -> Vec<HeightMap> {
    let hills = |x: f64, y: f64| (x * 0.3).sin() + (y * 0.2).cos();
    let noise = |x: f64, y: f64| (x * 12.9898 + y * 78.233).sin() * 43758.5453 % 1.0;
    let walls = |x: f64, y: f64| f64::from(u8::from((x + 2.0 * y) % 9.0 < 4.0));
    let all: [&dyn Fn(f64, f64) -> f64; 3] = [&hills, &noise, &walls];
    let sizes = [([32, 32], [true; 2]), ([27, 14], [true; 2]), ([32, 16], [false, true]), ([21, 30], [false; 2])];
    sizes.iter().flat_map(|(size, repeats)| all.map(|at| map(*size, *repeats, at))).collect()
}

fn level(map: &HeightMap) -> HeightLevel {
    HeightLevel { size: [map.width, map.height], heights: map.heights.clone(), repeats: map.repeats }
}

fn windows(random: &mut Random, count: usize) -> Vec<Window> {
    let window = |random: &mut Random| {
        let low = random.place(50.0);
        let reach = random.within(0.01, 5.0).powi(2);
        Window { low, high: low + DVec2::new(random.within(0.0, reach), random.within(0.0, reach)) }
    };
    (0..count).map(|_| window(random)).collect()
}

fn inside(random: &mut Random, window: &Window) -> DVec2 {
    window.low + window.size() * DVec2::new(random.within(0.0, 1.0), random.within(0.0, 1.0))
}

#[test]
fn heights_and_what_they_change_by_are_within_their_bounds_anywhere() {
    let mut random = Random(1);
    for map in maps() {
        let (facts, level) = (HeightFacts::new(&map), level(&map));
        for window in windows(&mut random, 300) {
            let [low, high] = facts.heights(&window);
            for _ in 0..20 {
                let [a, b] = [inside(&mut random, &window), inside(&mut random, &window)];
                let [p, q] = [a, b].map(|at| level.height(at));
                assert!(low - 1e-9 <= p && p <= high + 1e-9, "{p} not in {low} to {high}");
                assert!((p - q).abs() <= facts.change(&window, b - a) + 1e-6, "{window:?}");
            }
        }
    }
}

#[test]
fn over_whole_texels_ranges_and_slopes_are_those_of_the_texels() {
    let map = map([16, 16], [true; 2], |x, y| x * x + 3.0 * y);
    let facts = HeightFacts::new(&map);
    let window = Window { low: DVec2::new(3.0, 2.0), high: DVec2::new(6.0, 4.0) };
    assert_eq!(facts.heights(&window), [15.0, 48.0]);
    assert_eq!(facts.slopes(&window), DVec2::new(11.0, 3.0));
}

#[test]
fn what_is_linear_between_places_is_nowhere_farther_than_the_residual() {
    let (mut random, mut tight) = (Random(2), 0.0f64);
    for map in maps() {
        let (facts, level) = (HeightFacts::new(&map), level(&map));
        for window in windows(&mut random, 300) {
            let places = [0; 3].map(|_| inside(&mut random, &window));
            let residual = facts.residual(&window, Window::around(places).size());
            for _ in 0..20 {
                let (a, b) = (random.within(0.0, 1.0), random.within(0.0, 1.0));
                let weights = if a + b > 1.0 { [a + b - 1.0, 1.0 - a, 1.0 - b] } else { [1.0 - a - b, a, b] };
                let at: DVec2 = (0..3).map(|k| places[k] * weights[k]).sum();
                let linear: f64 = (0..3).map(|k| level.height(places[k]) * weights[k]).sum();
                let apart = (level.height(at) - linear).abs();
                assert!(apart <= residual + 1e-6, "{apart} more than {residual} in {window:?} of {:?}", level.size);
                tight = tight.max(apart / (residual + 1e-6));
            }
        }
    }
    assert!(tight > 0.9, "a bound of which {tight} is the most that is seen says little");
}

#[test]
fn a_ramp_has_no_residual_but_where_it_ends() {
    let facts = HeightFacts::new(&map([64, 64], [false; 2], |x, y| 2.0 * x - y));
    let within = Window { low: DVec2::splat(3.3), high: DVec2::splat(60.2) };
    assert!(facts.residual(&within, within.size()) < 1e-4);
    assert!(facts.residual(&Window { high: DVec2::splat(70.0), ..within }, DVec2::splat(20.0)) > 1.0);
}

#[test]
fn coarser_levels_are_no_farther_than_is_told() {
    let (mut random, mut tight) = (Random(3), 0.0f64);
    for map in maps() {
        let facts = HeightFacts::new(&map);
        let chain = level(&map).chain();
        for window in windows(&mut random, 100) {
            for (k, coarse) in chain.iter().enumerate() {
                let bound = facts.level_error(&window, k);
                let ratio = DVec2::from_array(coarse.size.map(f64::from)) / facts.size();
                for _ in 0..10 {
                    let at = inside(&mut random, &window);
                    let apart = (coarse.height((at + 0.5) * ratio - 0.5) - chain[0].height(at)).abs();
                    assert!(apart <= bound + 1e-6, "level {k}: {apart} more than {bound}");
                    tight = tight.max(apart / (bound + 1e-6));
                }
            }
        }
    }
    assert!(tight > 0.9, "{tight}");
}
