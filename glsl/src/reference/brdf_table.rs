//! Twin of `brdf_table` and `brdf_averages`: what a surface reflects of light from everywhere, by roughness and angle of
//! view (the split sum's second factor, Karis 2013).

use rayon::prelude::*;

use super::brdf::{MIN_ALPHA, grazing, visibility};
use crate::layout::light::{TABLE_SAMPLES, TABLE_SIDE};

/// Rows of equal roughness, `TABLE_SIDE` cells by the square root of the cosine of the angle of view, since most happens
/// at grazing angles; texel centres at (i + 1/2) / side.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Directional albedo of single reflection is f0 * cell[0] + cell[1]; cell[2] is the cosine-weighted mean over light of
    /// (1 - v.h)^5, whatever the roughness.
    pub cells: Vec<[f64; 3]>,
    /// Cosine-weighted means over the row: of cell[0], of cell[1], and of what both leave of 1.
    pub averages: Vec<[f64; 3]>,
}

/// Point i of `count` of the Hammersley set, moved to the middle of its cells.
#[must_use]
pub fn hammersley(i: u32, count: u32) -> [f64; 2] {
    let half = 0.5 / f64::from(count);
    [f64::from(i) / f64::from(count) + half, f64::from(i.reverse_bits()) / 2f64.powi(32) + half]
}

impl Table {
    #[must_use]
    pub fn new() -> Self {
        let side = TABLE_SIDE as usize;
        let centre = |i: usize| (i as f64 + 0.5) / side as f64;
        let cells: Vec<[f64; 3]> =
            (0..side * side).into_par_iter().map(|i| cell(centre(i / side), centre(i % side).powi(2))).collect();
        let averages = cells.chunks(side).map(average).collect();
        Self { cells, averages }
    }

    #[must_use]
    pub fn at(&self, roughness: f64, cosine: f64) -> [f64; 3] {
        let ((row, t), (column, s)) = (between(roughness), between(cosine.sqrt()));
        let side = TABLE_SIDE as usize;
        let mix = |row: usize| blend(self.cells[row * side + column], self.cells[row * side + column + 1], s);
        blend(mix(row), mix(row + 1), t)
    }

    #[must_use]
    pub fn average(&self, roughness: f64) -> [f64; 3] {
        let (row, t) = between(roughness);
        blend(self.averages[row], self.averages[row + 1], t)
    }
}

impl Default for Table {
    fn default() -> Self {
        Self::new()
    }
}

/// The texel centre at or below x, and how far x is on the way to the next: half a cell beyond the outermost the table
/// goes on as a line, so that a roughness of 1 is not that of the last texel.
fn between(x: f64) -> (usize, f64) {
    let p = x.clamp(0.0, 1.0) * f64::from(TABLE_SIDE) - 0.5;
    let low = p.floor().clamp(0.0, f64::from(TABLE_SIDE - 2));
    (low as usize, p - low)
}

fn blend<const N: usize>(a: [f64; N], b: [f64; N], t: f64) -> [f64; N] {
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * t)
}

/// The cosine is x squared, so its cosine-weighted measure is that of x cubed.
fn average(row: &[[f64; 3]]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    let mut total = 0.0;
    for (i, [scale, bias, _]) in row.iter().enumerate() {
        let weight = ((i as f64 + 0.5) / row.len() as f64).powi(3);
        sum = [sum[0] + weight * scale, sum[1] + weight * bias, sum[2] + weight * (1.0 - scale - bias)];
        total += weight;
    }
    sum.map(|s| s / total)
}

/// Facets are drawn as the viewer sees them (Dupuy and Benyoub 2023), so that a sample's weight is G2 / G1.
fn cell(roughness: f64, nv: f64) -> [f64; 3] {
    let alpha = (roughness * roughness).max(MIN_ALPHA);
    let view = [(1.0 - nv * nv).sqrt(), nv];
    let mut sum = [0.0; 3];
    for i in 0..TABLE_SAMPLES {
        let point = hammersley(i, TABLE_SAMPLES);
        let (weight, vh) = single(alpha, view, point);
        let share = grazing(vh);
        let terms = [weight * (1.0 - share), weight * share, below(view, point)];
        sum.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
    }
    sum.map(|s| s / f64::from(TABLE_SAMPLES))
}

/// Weight of a facet, and the cosine that light meets it under.
fn single(alpha: f64, [vx, vz]: [f64; 2], [a, b]: [f64; 2]) -> (f64, f64) {
    let length = (alpha * alpha * vx * vx + vz * vz).sqrt();
    let (wx, wz) = (alpha * vx / length, vz / length);
    let z = 1.0 - b * (1.0 + wz);
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let (sine, cosine) = (std::f64::consts::TAU * a).sin_cos();
    let h = glam::DVec3::new(alpha * (radius * cosine + wx), alpha * radius * sine, z + wz).normalize();
    let vh = (vx * h.x + vz * h.z).max(0.0);
    let nl = 2.0 * vh * h.z - vz;
    if nl <= 0.0 {
        return (0.0, vh);
    }
    let squared = alpha * alpha;
    (visibility(alpha, vz, nl) * 2.0 * nl * (vz + (squared + (1.0 - squared) * vz * vz).sqrt()), vh)
}

/// (1 - v.h)^5 for light drawn by its cosine.
fn below([vx, vz]: [f64; 2], [a, b]: [f64; 2]) -> f64 {
    let vl = vx * b.sqrt() * (std::f64::consts::TAU * a).cos() + vz * (1.0 - b).sqrt();
    grazing((0.5 + 0.5 * vl).max(0.0).sqrt())
}
