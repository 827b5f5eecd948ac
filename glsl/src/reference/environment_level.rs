//! Twin of `environment_level`: the map as a lobe of one roughness sees it, the viewer in the lobe's middle (the split sum's
//! first factor, Karis 2013), by filtered importance sampling (Krivanek and Colbert 2008).

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use glam::DVec3;
use rayon::prelude::*;

use super::{
    brdf::{MIN_ALPHA, visibility},
    brdf_table::hammersley,
    environment::{direction, place, trilinear},
    mip::Level,
};
use crate::layout::light::LobeLevel;

#[must_use]
pub fn environment_level(mips: &[Level], how: LobeLevel) -> Level {
    let [width, height] = how.size.map(|side| side as usize);
    let alpha = f64::from(how.roughness).powi(2).max(MIN_ALPHA);
    let lobe = lobe(alpha, &mips[0], how.samples);
    let texel = |i: usize| {
        let [u, v] = [(i % width) as f64 + 0.5, (i / width) as f64 + 0.5];
        seen(mips, &lobe, [u / width as f64, v / height as f64])
    };
    Level { width, height, texels: (0..width * height).into_par_iter().map(texel).collect(), alpha_scale: 1.0 }
}

/// A direction of light around +z, its share, and the mip level that has texels as large as what a sample stands for.
#[derive(Clone, Copy, Debug)]
struct Sample {
    light: DVec3,
    /// As a viewer in the lobe's middle sees it, masking and all.
    weight: f64,
    level: f64,
}

fn lobe(alpha: f64, map: &Level, samples: u32) -> Vec<Sample> {
    let squared = alpha * alpha;
    let texel = TAU / map.width as f64 * PI / map.height as f64;
    let sample = |i: u32| {
        let [turn, share] = hammersley(i, samples);
        let spread = 1.0 + (squared - 1.0) * share;
        let (z, radius) = (((1.0 - share) / spread).sqrt(), (squared * share / spread).sqrt());
        let (sine, cosine) = (TAU * turn).sin_cos();
        // Density over light is D / 4, since the half vector's cosines with normal and view are one.
        let density = spread * spread * FRAC_1_PI / (4.0 * squared);
        let level = 0.5 * (1.0 / (f64::from(samples) * density * texel)).log2();
        let light = DVec3::new(2.0 * z * radius * cosine, 2.0 * z * radius * sine, 2.0 * z * z - 1.0);
        Sample { light, weight: light.z * visibility(alpha, 1.0, light.z.max(0.0)), level: level + BIAS }
    };
    (0..samples).map(sample).filter(|sample| sample.light.z > 0.0).collect()
}

fn seen(mips: &[Level], lobe: &[Sample], at: [f64; 2]) -> [f64; 4] {
    let normal = direction(at[0], at[1]);
    let (east, south) = (direction(at[0] + 0.25, 0.5), direction(at[0], at[1] + 0.5));
    let (mut sum, mut total) = (DVec3::ZERO, 0.0);
    for sample in lobe {
        let l = sample.light.x * east + sample.light.y * south + sample.light.z * normal;
        sum += sample.weight * trilinear(mips, place(l), sample.level);
        total += sample.weight;
    }
    (sum / total).extend(1.0).to_array()
}

/// Levels up: samples overlap a little, so that none shows by itself.
const BIAS: f64 = 0.5;

#[cfg(test)]
mod tests;
