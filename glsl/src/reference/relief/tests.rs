//! Maps and rays that the tests of the methods share.

use glam::{DVec2, DVec4, IVec2};

use super::{Course, HeightLevel, ReliefMap};

/// Numbers that look random, the same in every run (Steele, Lea and Flood 2014).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// From 0 up to 1.
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}

pub(crate) fn map(size: [u32; 2], height: impl Fn(u32, u32) -> f32) -> ReliefMap {
    let heights = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))).map(|(x, y)| height(x, y)).collect();
    let level = HeightLevel { size, heights, repeats: [true; 2] };
    ReliefMap { level, bounds: Vec::new(), cones: Vec::new(), thinnest_texels: 1.0, steps: 16 }
}

pub(crate) fn flat(height: f32) -> ReliefMap {
    map([4, 4], |_, _| height)
}

/// Rises along x, and is 0 at 32 of 64 texels.
pub(crate) fn slope(rise: f32) -> ReliefMap {
    map([64, 64], |x, _| rise * (x as f32 - 32.0))
}

/// Down through a range of heights at up to 80 degrees, its middle near texel (32, 32), heights being in texels.
pub(crate) fn ray(random: &mut Random, range: [f64; 2]) -> Course {
    let degrees = random.within(0.0, 80.0);
    ray_at(random, degrees, range)
}

/// At an angle.
pub(crate) fn ray_at(random: &mut Random, degrees: f64, [high, low]: [f64; 2]) -> Course {
    let (angle, way) = (degrees.to_radians(), random.within(0.0, std::f64::consts::TAU));
    let across = DVec2::from_angle(way) * angle.tan() * (high - low);
    let middle = DVec2::new(random.within(30.0, 34.0), random.within(30.0, 34.0));
    let node = |place: DVec2, z: f64, t: f64| DVec4::new(place.x, place.y, z, t);
    let nodes =
        vec![node(middle - across / 2.0, high, 0.0), node(middle + across / 2.0, low, (high - low) / angle.cos())];
    Course { nodes, cosine: angle.cos(), is_open: [false; 2] }
}

/// Noise of an amplitude, in [-amplitude, amplitude], 24 x 24 texels, tiling.
pub(crate) fn rough(seed: u64, amplitude: f64) -> ReliefMap {
    let mut random = Random(seed + 100);
    let heights: Vec<f32> = (0..24 * 24).map(|_| random.within(-amplitude, amplitude) as f32).collect();
    map([24, 24], |x, y| heights[(y * 24 + x) as usize])
}

impl HeightLevel {
    /// Least and greatest height.
    pub(crate) fn range(&self) -> [f64; 2] {
        self.heights
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], h| [low.min((*h).into()), high.max((*h).into())])
    }
}

/// The steepest slope of all cells.
pub(crate) fn lipschitz(level: &HeightLevel) -> f64 {
    let cells = (0..level.size[1] as i32).flat_map(|y| (0..level.size[0] as i32).map(move |x| IVec2::new(x, y)));
    let steepest = |cell| {
        let [a, b, c, d] = level.corners(cell);
        DVec2::new((b - a).abs().max((d - c).abs()), (c - a).abs().max((d - b).abs())).length()
    };
    cells.map(steepest).fold(0.0, f64::max)
}

/// s where a straight course first goes below the surface, by even steps of at most 1/256 texel and bisections.
pub(crate) fn first_met(level: &HeightLevel, course: &Course) -> f64 {
    let gap = |s: f64| course.place(s).z - level.height(course.place(s).truncate().truncate());
    let steps = (course.travel() * 256.0).max(64.0).ceil();
    let below =
        (1..=steps as u32).map(|k| f64::from(k) / steps).find(|s| gap(*s) <= 0.0).expect("the course ends below");
    let halved = |[above, below]: [f64; 2], _| {
        let middle = above.midpoint(below);
        if gap(middle) <= 0.0 { [above, middle] } else { [middle, below] }
    };
    (0..40).fold([below - 1.0 / steps, below], halved)[1]
}
