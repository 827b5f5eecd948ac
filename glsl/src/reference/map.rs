//! Bilinear maps and their slopes. The twin of `map.glsl` and `map_jet.glsl`, from the definitions.

use crate::{
    layout::geometry::{Layer, MapAxis, kind},
    tables::Tables,
};

/// Texel number of lattice coordinate `i`.
#[must_use]
pub fn wrapped(axis: &MapAxis, i: i64) -> u64 {
    let i = i.clamp(i64::from(axis.low), i64::from(axis.high));
    let r = if (0..=i64::from(axis.top)).contains(&i) { i } else { i.rem_euclid(i64::from(axis.period)) };
    r.min(i64::from(axis.fold) - r) as u64
}

/// Texel space is cut off where f32 tells no more than halves of texels apart.
const FARTHEST_TEXEL: f64 = 4_194_303.0;

/// Texel-space coordinates; texel i lies at i.
#[must_use]
pub fn texel_space(layer: &Layer, u: f64, v: f64) -> [f64; 2] {
    [layer.texel_from_u, layer.texel_from_v].map(|row| {
        let [a, b, c] = row.map(f64::from);
        (a * u + b * v + c).clamp(-FARTHEST_TEXEL, FARTHEST_TEXEL)
    })
}

/// Bilinear value of one channel at texel-space p.
#[must_use]
pub fn bilinear(tables: &Tables, layer: &Layer, channel: u64, p: [f64; 2]) -> f64 {
    let channels = if layer.kind == kind::HEIGHT { 1 } else { 3 };
    let corner = p.map(f64::floor);
    let f = [p[0] - corner[0], p[1] - corner[1]];
    let texel = |dx: i64, dy: i64| {
        let x = wrapped(&layer.across, corner[0] as i64 + dx);
        let y = wrapped(&layer.down, corner[1] as i64 + dy);
        let at = u64::from(layer.first) + channels * (y * u64::from(layer.row) + x) + channel;
        f64::from(tables.texels[at as usize])
    };
    let across = |dy: i64| texel(0, dy) * (1.0 - f[0]) + texel(1, dy) * f[0];
    across(0) * (1.0 - f[1]) + across(1) * f[1]
}

/// Value, and the slopes by p: central differences over one texel.
#[must_use]
pub fn with_slopes(tables: &Tables, layer: &Layer, channel: u64, p: [f64; 2]) -> [f64; 3] {
    let at = |dx: f64, dy: f64| bilinear(tables, layer, channel, [p[0] + dx, p[1] + dy]);
    [at(0.0, 0.0), at(0.5, 0.0) - at(-0.5, 0.0), at(0.0, 0.5) - at(0.0, -0.5)]
}
