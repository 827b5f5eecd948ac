//! Twin of `environment.glsl`: light from infinitely far away, by direction.
//!
//! The map is equirectangular as three.js and Khronos' viewer have it: direction d is at u = 1/2 + atan2(d.z, d.x) / 2 pi,
//! v = acos(d.y) / pi, so that its middle is +x and +z a quarter to the right of it.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;
use rayon::prelude::*;

use super::{environment_level::environment_level, mip::Level};
use crate::layout::light::lobe_levels;

/// Light from everywhere, linear radiance.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// The map and its mip levels.
    pub mips: Vec<Level>,
    /// The map as lobes of perceptual roughness k / `glossy.len()` see it, k from 1; see `environment_level`.
    pub glossy: Vec<Level>,
    /// See `harmonics`.
    pub harmonics: [DVec3; 9],
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
        let glossy = lobe_levels(width as u32).map(|how| environment_level(&mips, how)).into();
        Self { mips, glossy, harmonics: harmonics(width, texels) }
    }

    /// What arrives from `d` over `footprint` radians: the mip level has texels as high as that (Blinn and Newell 1976 see
    /// one place; Williams 1983 filters).
    #[must_use]
    pub fn mirror(&self, d: DVec3, footprint: f64) -> DVec3 {
        let texels = footprint * self.mips[0].height as f64 / PI;
        trilinear(&self.mips, place(d), texels.max(1.0).log2())
    }

    /// What a lobe of that roughness around `d` sees. Between the mirror and the first rough level the blend goes by the cube
    /// of roughness: where lobes are narrow they blur by less than their share of the way.
    #[must_use]
    pub fn glossy(&self, d: DVec3, roughness: f64, footprint: f64) -> DVec3 {
        let level = roughness.clamp(0.0, 1.0) * self.glossy.len() as f64;
        let Some(last) = self.glossy.len().checked_sub(1) else {
            return self.mirror(d, footprint);
        };
        let finer = (level as usize).min(last);
        let t = level - finer as f64;
        let coarse = lookup(&self.glossy[finer], place(d));
        match finer {
            0 => self.mirror(d, footprint).lerp(coarse, t * t * t),
            k => lookup(&self.glossy[k - 1], place(d)).lerp(coarse, t),
        }
    }

    /// Irradiance over pi on a surface that faces `n`: what a white diffuse one sends out.
    #[must_use]
    pub fn diffuse(&self, n: DVec3) -> DVec3 {
        irradiance_over_pi(&self.harmonics, n)
    }
}

/// Never below 0, where nine terms swing through it.
#[must_use]
pub fn irradiance_over_pi(harmonics: &[DVec3; 9], n: DVec3) -> DVec3 {
    let sum: DVec3 = harmonics.iter().zip(basis(n)).map(|(&c, y)| c * y).sum();
    sum.max(DVec3::ZERO)
}

/// Real spherical harmonics up to order 2 but for their factors, which `harmonics` has within.
fn basis(d: DVec3) -> [f64; 9] {
    let (x, y, z) = (d.x, d.y, d.z);
    [1.0, y, z, x, x * y, y * z, 3.0 * z * z - 1.0, x * z, x * x - y * y]
}

/// Squares of the factors of the real spherical harmonics.
const SQUARED_FACTORS: [f64; 9] = {
    let (one, two) = (0.75 / PI, 3.75 / PI);
    [0.25 / PI, one, one, one, two, two, two / 12.0, two, two / 4.0]
};

/// Over pi: what a cosine keeps of each order (Ramamoorthi and Hanrahan 2001).
const KEPT: [f64; 9] = [1.0, 2.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0, 0.25, 0.25, 0.25, 0.25, 0.25];

/// Factors of `irradiance_over_pi` for a map of `width` texels a row: the map's projection on each harmonic, texels by
/// their solid angle, times what a cosine keeps of it.
#[must_use]
pub fn harmonics(width: usize, texels: &[[f32; 3]]) -> [DVec3; 9] {
    let height = texels.len() / width;
    let turns: Vec<(f64, f64)> =
        (0..width).map(|x| (TAU * ((x as f64 + 0.5) / width as f64 - 0.5)).sin_cos()).collect();
    let of_row = |(y, row): (usize, &[[f32; 3]])| {
        let (sine, cosine) = (PI * (y as f64 + 0.5) / height as f64).sin_cos();
        let mut sums = [DVec3::ZERO; 9];
        for (texel, (z, x)) in row.iter().zip(&turns) {
            let texel = DVec3::from_array(texel.map(f64::from));
            let values = basis(DVec3::new(sine * x, cosine, sine * z));
            sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += texel * value);
        }
        sums.map(|sum| sum * sine)
    };
    let rows: Vec<[DVec3; 9]> = texels.par_chunks(width).enumerate().map(of_row).collect();
    // A texel covers the solid angle of a turn's share times the difference of its rows' cosines, over their mean's sine.
    let solid_angle = TAU / width as f64 * 2.0 * (FRAC_PI_2 / height as f64).sin();
    std::array::from_fn(|k| {
        let sum: DVec3 = rows.iter().map(|row| row[k]).sum();
        sum * (solid_angle * SQUARED_FACTORS[k] * KEPT[k])
    })
}

#[cfg(test)]
mod tests;
