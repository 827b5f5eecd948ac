//! Random maps of every kind that exact answers are held against. Values in [0, 1].

use std::sync::Arc;

use super::field::Field;
use crate::domain::detail::{Map, Sampling, Wrap};

/// Splitmix64 (Steele, Lea, Flood 2014).
pub(super) struct Random(pub(super) u64);

impl Random {
    /// In [0, 1).
    pub(super) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub(super) fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[(self.unit() * from.len() as f64) as usize]
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    Noise,
    Spikes,
    Posts,
    Bricks,
    Constant,
}

pub(super) const KINDS: [Kind; 5] = [Kind::Noise, Kind::Spikes, Kind::Posts, Kind::Bricks, Kind::Constant];
const SIZES: [[u32; 2]; 7] = [[1, 1], [1, 7], [7, 1], [2, 2], [7, 13], [16, 5], [64, 64]];
const WRAPS: [Wrap; 3] = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];

pub(super) fn map(random: &mut Random, kind: Kind, [width, height]: [u32; 2]) -> Map {
    let texel = |k: u32, random: &mut Random| match (kind, k % width, k / width) {
        (Kind::Noise, ..) => random.unit(),
        (Kind::Spikes, ..) => f64::from(u8::from(random.unit() < 0.05)),
        (Kind::Posts, x, y) => f64::from(u8::from(x % 8 < 2 && y % 8 < 2)),
        (Kind::Bricks, x, y) if y % 8 == 0 || (x + y / 8 * 4) % 8 == 0 => 0.1,
        (Kind::Bricks, ..) => 0.9,
        (Kind::Constant, ..) => 0.5,
    };
    let texels: Vec<f32> = (0..width * height).map(|k| texel(k, random) as f32).collect();
    let wrap = [random.pick(&WRAPS), random.pick(&WRAPS)];
    let sampling = random.pick(&[Sampling::Center, Sampling::Node]);
    Map { width, height, channels: 1, texels: texels.into(), wrap, sampling, source_bits: 32 }
}

/// Any kind, size, wrap and sampling.
pub(super) fn any_field(random: &mut Random) -> Field {
    let (kind, size) = (random.pick(&KINDS), random.pick(&SIZES));
    Field::new(&Arc::new(map(random, kind, size)))
}
