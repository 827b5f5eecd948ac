//! Twin of `environment.glsl`: light from infinitely far away, by direction.
//!
//! The map is equirectangular as three.js and Khronos' viewer have it: direction d is at u = 1/2 + atan2(d.z, d.x) / 2 pi,
//! v = acos(d.y) / pi, so that its middle is +x and +z a quarter to the right of it.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use rayon::prelude::*;

use super::mip::Level;

/// Light from everywhere, linear radiance.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// The map and its mip levels.
    pub mips: Vec<Level>,
    /// See `irradiance_over_pi`.
    pub irradiance: Level,
}

/// Unit.
#[must_use]
pub fn direction(u: f64, v: f64) -> DVec3 {
    let ((sine, cosine), (up_sine, up_cosine)) = ((TAU * (u - 0.5)).sin_cos(), (PI * v).sin_cos());
    DVec3::new(up_sine * cosine, up_cosine, up_sine * sine)
}

/// Where the map shows a direction of any length.
#[must_use]
pub fn place(d: DVec3) -> [f64; 2] {
    [0.5 + d.z.atan2(d.x) / TAU, d.x.hypot(d.z).atan2(d.y) / PI]
}

/// Bilinear, texel i of n at (i + 1/2) / n. Around the map u repeats; beyond a pole the same row goes on half a turn
/// farther.
#[must_use]
pub fn lookup(level: &Level, [u, v]: [f64; 2]) -> DVec3 {
    let y = v * level.height as f64 - 0.5;
    let (top, t) = (y.floor(), y - y.floor());
    row(level, u, top as i64).lerp(row(level, u, top as i64 + 1), t)
}

fn row(level: &Level, u: f64, y: i64) -> DVec3 {
    let height = level.height as i64;
    let beyond = y < 0 || y >= height;
    let y = if y < 0 {
        -1 - y
    } else if beyond {
        2 * height - 1 - y
    } else {
        y
    };
    let x = (u + if beyond { 0.5 } else { 0.0 }) * level.width as f64 - 0.5;
    let at = |x: i64| {
        let [r, g, b, _] = level.texels[y as usize * level.width + x.rem_euclid(level.width as i64) as usize];
        DVec3::new(r, g, b)
    };
    at(x.floor() as i64).lerp(at(x.floor() as i64 + 1), x - x.floor())
}

/// By two mip levels; `level` counts from the map itself.
#[must_use]
pub fn trilinear(mips: &[Level], place: [f64; 2], level: f64) -> DVec3 {
    let level = level.clamp(0.0, (mips.len() - 1) as f64);
    let finer = level.floor() as usize;
    let coarser = (finer + 1).min(mips.len() - 1);
    lookup(&mips[finer], place).lerp(lookup(&mips[coarser], place), level - level.floor())
}

impl Environment {
    /// Of a map of `width` texels a row.
    #[must_use]
    pub fn new(width: usize, texels: &[[f32; 3]]) -> Self {
        let wide = texels.iter().map(|t| DVec3::from_array(t.map(f64::from)).extend(1.0).to_array()).collect();
        let mips = Level { width, height: texels.len() / width, texels: wide, alpha_scale: 1.0 }.chain();
        Self { mips, irradiance: irradiance_over_pi(width, texels) }
    }

    /// What arrives from `d` over `footprint` radians: the mip level has texels as high as that (Blinn and Newell 1976 see
    /// one place; Williams 1983 filters).
    #[must_use]
    pub fn mirror(&self, d: DVec3, footprint: f64) -> DVec3 {
        let texels = footprint * self.mips[0].height as f64 / PI;
        trilinear(&self.mips, place(d), texels.max(1.0).log2())
    }

    /// Irradiance over pi on a surface that faces `n`: what a white diffuse one sends out.
    #[must_use]
    pub fn diffuse(&self, n: DVec3) -> DVec3 {
        lookup(&self.irradiance, place(n))
    }
}

/// Size of the map of irradiance: cosines are so wide that values between its texels are off by less than 1/1000.
pub const IRRADIANCE_SIZE: [usize; 2] = [64, 32];
/// No more texels of a map are summed up along a row: it is averaged before.
const SUMMED_WIDTH: usize = 256;

/// Irradiance over pi by normal, of a map of `width` texels a row: sums over its texels, weighed by solid angle and cosine,
/// over the sum of the weights, so that equal light stays equal. Nine harmonics (Ramamoorthi and Hanrahan 2001) would be
/// off by up to 9 % of what a small sun gives.
#[must_use]
pub fn irradiance_over_pi(width: usize, texels: &[[f32; 3]]) -> Level {
    let suns = suns(width, texels);
    let [width, height] = IRRADIANCE_SIZE;
    let of_normal = |i: usize| {
        let n = direction(((i % width) as f64 + 0.5) / width as f64, ((i / width) as f64 + 0.5) / height as f64);
        let (mut light, mut weights) = (DVec3::ZERO, 0.0);
        for (d, radiance, solid_angle) in &suns {
            let weight = n.dot(*d).max(0.0) * solid_angle;
            light += weight * *radiance;
            weights += weight;
        }
        (light / weights).extend(1.0).to_array()
    };
    let texels = (0..width * height).into_par_iter().map(of_normal).collect();
    Level { width, height, texels, alpha_scale: 1.0 }
}

/// Directions, radiances and solid angles of a map's texels, or of squares of them.
fn suns(width: usize, texels: &[[f32; 3]]) -> Vec<(DVec3, DVec3, f64)> {
    let wide = texels.par_iter().map(|t| DVec3::from_array(t.map(f64::from)).extend(1.0).to_array()).collect();
    let mut level = Level { width, height: texels.len() / width, texels: wide, alpha_scale: 1.0 };
    while level.width > SUMMED_WIDTH {
        level = level.coarser();
    }
    let (width, height) = (level.width, level.height);
    let sun = |(i, [r, g, b, _]): (usize, &[f64; 4])| {
        let v = ((i / width) as f64 + 0.5) / height as f64;
        let d = direction(((i % width) as f64 + 0.5) / width as f64, v);
        (d, DVec3::new(*r, *g, *b), (PI * v).sin())
    };
    level.texels.iter().enumerate().map(sun).collect()
}

#[cfg(test)]
mod tests;
