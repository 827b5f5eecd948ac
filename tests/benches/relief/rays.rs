//! Rays from above all heights to below them.

use std::{f64::consts::TAU, sync::Arc};

use displace_glsl::reference::relief::{Course, HeightLevel};
use displace_server::{
    domain::detail::{Map, Sampling, Wrap},
    oracle::{bvh::Segment, field::Field, height_field::walk_cells},
};
use displace_tests::march::straight;
use glam::{DVec2, DVec4};
use rand::{RngExt as _, SeedableRng, rngs::StdRng};
use rayon::prelude::*;

use crate::maps::AMPLITUDE;

/// So far above and below.
const BEYOND: f64 = 0.001 * AMPLITUDE;

fn ray(from: [f64; 2], turns: f64, degrees: f64) -> Course {
    let (sin, cos) = (TAU * turns).sin_cos();
    let run = degrees.to_radians().tan() * (AMPLITUDE + 2.0 * BEYOND);
    straight([from[0], from[1], AMPLITUDE + BEYOND], [from[0] + run * cos, from[1] + run * sin, -BEYOND])
}

/// Anywhere and any way round.
pub(crate) fn random(count: u32, degrees: f64) -> Vec<Course> {
    let mut random = StdRng::seed_from_u64(7);
    let mut one = |_| ray([0; 2].map(|_| random.random_range(0.0..512.0)), random.random(), degrees);
    (0..count).map(&mut one).collect()
}

/// As the pixels of an image have them: side by side, half a texel apart, all one way.
pub(crate) fn side_by_side(side: u32, degrees: f64) -> Vec<Course> {
    let place = |k: u32| [k % side, k / side].map(|i| 0.5 * f64::from(i) + 0.2);
    (0..side * side).map(|k| ray(place(k), 0.08, degrees)).collect()
}

/// Where they meet the surface, cell by cell in f64.
pub(crate) fn met(level: &HeightLevel, courses: &[Course]) -> Vec<DVec2> {
    let ([width, height], texels) = (level.size, level.heights.clone().into());
    let (wrap, sampling) = ([Wrap::Repeat; 2], Sampling::Center);
    let field = Field::new(&Arc::new(Map { width, height, channels: 1, texels, wrap, sampling, source_bits: 32 }));
    let one = |course: &Course| {
        let [from, to] = [course.nodes[0], course.nodes[1]].map(DVec4::truncate);
        let ray = Segment { origin: from, direction: to - from, from: 0.0, to: 1.0 };
        let hit = walk_cells(&field, 0, &ray).hit.expect("it goes through");
        (from + (to - from) * hit.t).truncate()
    };
    courses.par_iter().map(one).collect()
}
