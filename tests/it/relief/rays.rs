//! Random courses over random maps of every kind.

use std::f64::consts::TAU;

use displace_glsl::reference::relief::{Course, HeightLevel, ReliefMap, exact::bounds};
use displace_tests::march::{map, straight};
use rand::{RngExt as _, rngs::StdRng};

/// Heights of random maps.
const LOW: f64 = -0.5;
const HIGH: f64 = 7.5;

#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    Noise,
    /// Sums of waves: smooth hills of a few texels and more.
    Hills,
    Spikes,
    Bricks,
    Posts,
    Constant,
}

pub(super) const KINDS: [Kind; 6] = [Kind::Noise, Kind::Hills, Kind::Spikes, Kind::Bricks, Kind::Posts, Kind::Constant];
const SIZES: [[u32; 2]; 6] = [[1, 7], [2, 2], [7, 13], [33, 16], [64, 64], [200, 123]];

/// With bounds; it repeats or is clamped, along either axis.
pub(super) fn any_map(random: &mut StdRng, kind: Kind) -> ReliefMap {
    let size = pick(random, &SIZES);
    let share = |k: u32, random: &mut StdRng| match (kind, k % size[0], k / size[0]) {
        (Kind::Noise, ..) => random.random(),
        (Kind::Hills, x, y) => hills(f64::from(x) / f64::from(size[0]), f64::from(y) / f64::from(size[1])),
        (Kind::Spikes, ..) => f64::from(u8::from(random.random_bool(0.05))),
        (Kind::Bricks, x, y) if y % 8 == 0 || (x + y / 8 * 4) % 8 == 0 => 0.1,
        (Kind::Bricks, ..) => 0.9,
        (Kind::Posts, x, y) => f64::from(u8::from(x % 8 == 0 && y % 8 == 0)),
        (Kind::Constant, ..) => 0.5,
    };
    let heights = (0..size[0] * size[1]).map(|k| (LOW + (HIGH - LOW) * share(k, random)) as f32).collect();
    let level = HeightLevel { size, heights, repeats: [random.random_bool(0.6), random.random_bool(0.6)] };
    ReliefMap { bounds: bounds(&level), ..map(level) }
}

/// From 0 to 1, once around in u and v.
fn hills(u: f64, v: f64) -> f64 {
    let wave = |a: f64, b: f64, phase: f64| (TAU * (a * u + b * v) + phase).sin();
    0.5 + 0.2 * wave(1.0, 2.0, 0.3)
        + 0.15 * wave(3.0, -2.0, 1.1)
        + 0.1 * wave(-5.0, 4.0, 2.0)
        + 0.05 * wave(7.0, 9.0, 3.0)
}

fn pick<T: Copy>(random: &mut StdRng, from: &[T]) -> T {
    from[random.random_range(0..from.len())]
}

/// From above all heights to `end`, so many degrees from the vertical, near the origin's tile or some way off.
pub(super) fn course(random: &mut StdRng, degrees: f64, end: f64) -> Course {
    let start = 8.0;
    let run = degrees.to_radians().tan() * (start - end);
    let turns = if random.random_bool(0.1) { pick(random, &[0.0, 0.125, 0.25, 0.5, 0.75]) } else { random.random() };
    let (sin, cos) = (TAU * turns).sin_cos();
    let [x, y] = [0; 2].map(|_| random.random_range(-60.0..250.0));
    let [x, y] = if random.random_bool(0.1) { [f64::round(x), f64::round(y)] } else { [x, y] };
    straight([x, y, start], [x + run * cos, y + run * sin, end])
}
