//! Heights to march over and rays to march along. Lengths are texels.

use std::{f64::consts::TAU, sync::Arc};

use displace_glsl::reference::{
    cone_map,
    relief::{Course, HeightLevel, ReliefMap, exact},
};
use glam::{DVec2, DVec4};
use rayon::prelude::*;

use crate::{
    domain::detail::{Map, Sampling, Wrap},
    oracle::{bvh::Segment, field::Field, height_field::walk_cells},
};

/// Above and below all heights, where a course begins and ends.
pub(super) const BEYOND: f64 = 0.01;

/// A map with what every method needs of it, that repeats.
pub(super) fn map(size: [u32; 2], height: impl Fn(u32, u32) -> f64) -> ReliefMap {
    let heights = (0..size[0] * size[1]).map(|k| height(k % size[0], k / size[0]) as f32).collect();
    let level = HeightLevel { size, heights, repeats: [true; 2] };
    let (bounds, cones) = (exact::bounds(&level), cone_map::cones(&level));
    ReliefMap { bounds, cones, thinnest_texels: 1.0, steps: 0, level }
}

/// Smooth, from 0 to `amplitude`, 32 texels from top to top.
pub(super) fn hills(amplitude: f64) -> ReliefMap {
    let wave = |x: u32| (f64::from(x) * TAU / 32.0).sin();
    map([64, 64], |x, y| amplitude * (2.0 + wave(x) + wave(y)) / 4.0)
}

/// Least and greatest height.
pub(super) fn range(map: &ReliefMap) -> [f64; 2] {
    let heights = map.level.heights.iter().map(|height| f64::from(*height));
    heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], h| [low.min(h), high.max(h)])
}

/// Numbers that look random, the same in every run (Steele, Lea and Flood 2014).
pub(super) struct Random(u64);

impl Random {
    pub(super) fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// 0 to 1.
    pub(super) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(super) fn way(&mut self) -> DVec2 {
        DVec2::from_angle(TAU * self.next())
    }

    /// In the map.
    pub(super) fn place(&mut self, map: &ReliefMap) -> DVec2 {
        let [x, y] = map.level.size.map(|n| f64::from(n) * self.next());
        DVec2::new(x, y)
    }
}

/// Through a place at a height, down through all heights of the map; nodes are rounded to f32, as the device has them.
pub(super) fn through(map: &ReliefMap, place: DVec2, z: f64, way: DVec2, degrees: f64) -> Course {
    let [low, high] = range(map);
    let slope = way * degrees.to_radians().tan();
    let node = |height: f64, t: f64| {
        let at = place + slope * (z - height);
        DVec4::new(at.x, at.y, height, t).as_vec4().as_dvec4()
    };
    let nodes = vec![node(high.max(0.0) + BEYOND, 0.0), node(low.min(0.0) - BEYOND, 1.0)];
    Course { nodes, cosine: degrees.to_radians().cos(), is_open: [false; 2] }
}

/// Anywhere on the base and any way round.
pub(super) fn anywhere(map: &ReliefMap, count: usize, degrees: f64) -> Vec<Course> {
    let mut random = Random::new(7);
    let mut one = |_| {
        let (place, way) = (random.place(map), random.way());
        through(map, place, 0.0, way, degrees)
    };
    (0..count).map(&mut one).collect()
}

/// Where a course is at a height that it passes.
pub(super) fn at_height(course: &Course, z: f64) -> DVec2 {
    let [from, to] = [course.nodes[0], course.nodes[1]];
    let place = from.lerp(to, (z - from.z) / (to.z - from.z));
    DVec2::new(place.x, place.y)
}

/// Where they meet the surface: cell by cell, by code that shares nothing with the methods. Height beside the place.
pub(super) fn truth(map: &ReliefMap, courses: &[Course]) -> Vec<(DVec2, f64)> {
    let ([width, height], texels) = (map.level.size, map.level.heights.clone().into());
    let (wrap, sampling) = ([Wrap::Repeat; 2], Sampling::Center);
    let field = Field::new(&Arc::new(Map { width, height, channels: 1, texels, wrap, sampling, source_bits: 32 }));
    let one = |course: &Course| {
        let [from, to] = [course.nodes[0], course.nodes[1]].map(DVec4::truncate);
        let ray = Segment { origin: from, direction: to - from, from: 0.0, to: 1.0 };
        let met = walk_cells(&field, 0, &ray).hit.map_or(to, |hit| from + (to - from) * hit.t);
        (met.truncate(), met.z)
    };
    courses.par_iter().map(one).collect()
}

/// The value that a share of all do not exceed.
pub(super) fn percentile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let last = values.len().saturating_sub(1);
    values.get((share * last as f64).ceil() as usize).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use displace_glsl::methods::Method;

    use super::*;

    #[test]
    fn the_truth_of_a_level_surface_is_where_the_ray_comes_to_its_height() {
        let level = map([8, 8], |_, _| 2.0);
        let courses = anywhere(&level, 50, 60.0);
        for (course, (place, z)) in courses.iter().zip(truth(&level, &courses)) {
            assert!((z - 2.0).abs() < 1e-9 && place.distance(at_height(course, 2.0)) < 1e-9, "{place} {z}");
        }
    }

    #[test]
    fn exact_finds_what_the_truth_is() {
        let hills = hills(8.0);
        let courses = anywhere(&hills, 200, 75.0);
        let twin = Method::Exact.marcher().unwrap().twin;
        for (course, (place, _)) in courses.iter().zip(truth(&hills, &courses)) {
            assert!(twin(&hills, course, 0.0).place.distance(place) < 1e-4);
        }
    }

    #[test]
    fn a_percentile_is_one_of_the_values() {
        assert_eq!(percentile(vec![3.0, 1.0, 2.0], 0.5), 2.0);
        assert_eq!(percentile(vec![1.0, 2.0], 0.99), 2.0);
        assert_eq!(percentile(vec![], 0.5), 0.0);
    }
}
