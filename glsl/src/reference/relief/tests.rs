//! Maps and rays that the tests of the methods share.

use glam::{DVec2, DVec4};

use super::{Course, HeightLevel, ReliefMap};

/// Numbers that look random, the same in every run (Steele, Lea and Flood 2014).
pub(super) struct Random(pub(super) u64);

impl Random {
    /// From 0 up to 1.
    pub(super) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(super) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}

pub(super) fn map(size: [u32; 2], height: impl Fn(u32, u32) -> f32) -> ReliefMap {
    let heights = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))).map(|(x, y)| height(x, y)).collect();
    let level = HeightLevel { size, heights, repeats: [true; 2] };
    ReliefMap { level, bounds: Vec::new(), cones: Vec::new(), thinnest_texels: 1.0, steps: 16 }
}

pub(super) fn flat(height: f32) -> ReliefMap {
    map([4, 4], |_, _| height)
}

/// Rises along x, and is 0 at 32 of 64 texels.
pub(super) fn slope(rise: f32) -> ReliefMap {
    map([64, 64], |x, _| rise * (x as f32 - 32.0))
}

/// Down through a range of heights at up to 80 degrees, its middle near texel (32, 32), heights being in texels.
pub(super) fn ray(random: &mut Random, [high, low]: [f64; 2]) -> Course {
    let (angle, way) = (random.within(0.0, 80f64.to_radians()), random.within(0.0, std::f64::consts::TAU));
    let across = DVec2::from_angle(way) * angle.tan() * (high - low);
    let middle = DVec2::new(random.within(30.0, 34.0), random.within(30.0, 34.0));
    let node = |place: DVec2, z: f64, t: f64| DVec4::new(place.x, place.y, z, t);
    let nodes =
        vec![node(middle - across / 2.0, high, 0.0), node(middle + across / 2.0, low, (high - low) / angle.cos())];
    Course { nodes, cosine: angle.cos() }
}
