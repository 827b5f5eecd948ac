//! What facets of GGX reflect once of light from everywhere: directional albedo and its means, by Gauss's quadrature.
//!
//! Facets are met by their slopes (Walter et al. 2007; height-correlated masking: Heitz 2014): those that send light
//! below the horizon end at a slope that has a formula, so that what is integrated is smooth.

use std::{
    f64::consts::{FRAC_2_PI, FRAC_PI_2},
    sync::LazyLock,
};

use glam::DVec2;

use super::quadrature::gauss;

/// The lowest roughness of the table: that of `MIN_ALPHA`.
const SMOOTHEST: f64 = 1.0 / 32.0;
/// Roughness from `SMOOTHEST` to 1, and cosines of the angle of view from 0 to 1 as `column` has them.
const ROWS: usize = 48;
const COLUMNS: usize = 128;
/// Of slopes' sizes, and of each quarter of their directions.
const NODES: usize = 32;

/// Albedo of reflection by one facet is f0 * x + y: x and y by roughness and angle of view.
pub(super) struct Albedo {
    cells: Vec<DVec2>,
    /// Of each row: cosine-weighted means over the angle of view.
    means: Vec<DVec2>,
}

impl Albedo {
    /// Made when first asked for.
    pub(super) fn table() -> &'static Self {
        static TABLE: LazyLock<Albedo> = LazyLock::new(Albedo::new);
        &TABLE
    }

    fn new() -> Self {
        let nodes = gauss(NODES);
        let of_row = |row: usize| {
            let alpha = roughness(row).powi(2);
            let cosine = |column: usize| cosine(column as f64 / (COLUMNS - 1) as f64, alpha);
            (0..COLUMNS).map(|column| once(alpha, cosine(column), &nodes)).collect::<Vec<_>>()
        };
        let rows: Vec<Vec<DVec2>> = (0..ROWS).map(of_row).collect();
        let means = rows.iter().enumerate().map(|(row, cells)| mean(cells, roughness(row).powi(2), &nodes)).collect();
        Self { cells: rows.concat(), means }
    }

    /// `roughness`: perceptual, from that of `MIN_ALPHA` on.
    pub(super) fn at(&self, roughness: f64, cosine: f64) -> DVec2 {
        let place = column(cosine, roughness * roughness);
        cubic(row(roughness), ROWS, |row| cubic(place, COLUMNS, |column| self.cells[row * COLUMNS + column]))
    }

    /// Cosine-weighted mean over the angle of view.
    pub(super) fn mean(&self, roughness: f64) -> DVec2 {
        cubic(row(roughness), ROWS, |row| self.means[row])
    }
}

/// Evenly by its logarithm.
fn roughness(row: usize) -> f64 {
    SMOOTHEST.powf(1.0 - row as f64 / (ROWS - 1) as f64)
}

/// Place of a roughness among the rows, 0 to 1.
fn row(roughness: f64) -> f64 {
    1.0 - roughness.ln() / SMOOTHEST.ln()
}

/// Place of a cosine in a row, 0 to 1: by its logarithm where it is over alpha, and closest where light grazes.
fn column(cosine: f64, alpha: f64) -> f64 {
    ((cosine / alpha).ln_1p() / alpha.recip().ln_1p()).sqrt()
}

/// The inverse of `column`.
fn cosine(column: f64, alpha: f64) -> f64 {
    alpha * (column * column * alpha.recip().ln_1p()).exp_m1()
}

/// The cubic through the four nodes of `count` around a place of [0, 1], first and last node at its ends (Lagrange).
fn cubic(at: f64, count: usize, value: impl Fn(usize) -> DVec2) -> DVec2 {
    let p = at.clamp(0.0, 1.0) * (count - 1) as f64;
    let first = (p.floor() as usize).clamp(1, count - 3) - 1;
    let t = p - first as f64;
    let weights = [
        (t - 1.0) * (t - 2.0) * (t - 3.0) / -6.0,
        t * (t - 2.0) * (t - 3.0) / 2.0,
        t * (t - 1.0) * (t - 3.0) / -2.0,
        t * (t - 1.0) * (t - 2.0) / 6.0,
    ];
    weights.into_iter().enumerate().map(|(k, weight)| weight * value(first + k)).sum()
}

/// Mean of a row, weighed by 2 cosines.
fn mean(cells: &[DVec2], alpha: f64, nodes: &[[f64; 2]]) -> DVec2 {
    let log = alpha.recip().ln_1p();
    let term = |&[x, weight]: &[f64; 2]| {
        let cosine = cosine(x, alpha);
        let step = 2.0 * x * (cosine + alpha) * log;
        2.0 * weight * step * cosine * cubic(x, COLUMNS, |column| cells[column])
    };
    nodes.iter().map(term).sum()
}

/// The cell for a viewer under `vz`: slopes have the direction a quarter turn and `turn` away from the viewer's, and
/// the size alpha tan(t).
fn once(alpha: f64, vz: f64, nodes: &[[f64; 2]]) -> DVec2 {
    let vx = (1.0 - vz * vz).max(0.0).sqrt();
    let mut sum = DVec2::ZERO;
    for [x, weight] in nodes {
        // Seen from the side, all changes where slopes begin to lean towards the viewer.
        let turn = FRAC_PI_2 * x.powi(3);
        let weight = 3.0 * x * x * FRAC_PI_2 * weight;
        sum += weight * (along(alpha, [vx * turn.sin(), vz], nodes) + along(alpha, [-vx * turn.sin(), vz], nodes));
    }
    FRAC_2_PI * sum
}

/// Over slopes of one direction: `vx` is the viewer's part in it.
fn along(alpha: f64, [vx, vz]: [f64; 2], nodes: &[[f64; 2]]) -> DVec2 {
    let last = steepest(alpha, [vx, vz]);
    let masked = (alpha * alpha + (1.0 - alpha * alpha) * vz * vz).sqrt();
    let mut sum = DVec2::ZERO;
    for [x, weight] in nodes {
        // Closest towards the steepest slope, where narrow lobes change.
        let (sine, cosine) = (last * (1.0 - x * x)).sin_cos();
        // The facet's normal is (alpha sine, cosine) over the root of `squared`.
        let squared = cosine * cosine + (alpha * sine).powi(2);
        let met = alpha * sine * vx + cosine * vz;
        let light = 2.0 * cosine * met / squared - vz;
        if light > 0.0 {
            let masked_light = (alpha * alpha + (1.0 - alpha * alpha) * light * light).sqrt();
            let seen = 2.0 * light / (light * masked + vz * masked_light);
            let schlick = (1.0 - met / squared.sqrt()).max(0.0).powi(5);
            sum += weight * 2.0 * x * last * sine * met * seen * DVec2::new(1.0 - schlick, schlick);
        }
    }
    sum
}

/// Light leaves along the horizon from slopes of the size alpha tan of this angle.
fn steepest(alpha: f64, [vx, vz]: [f64; 2]) -> f64 {
    let length = vx.hypot(vz);
    if vx < 0.0 { vz.atan2(alpha * (length - vx)) } else { (vx + length).atan2(alpha * vz) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROUGHNESSES: [f64; 8] = [SMOOTHEST, 0.06, 0.1, 0.21, 0.36, 0.51, 0.76, 1.0];
    const COSINES: [f64; 10] = [0.0, 0.0005, 0.002, 0.005, 0.01, 0.03, 0.1, 0.3, 0.6, 1.0];

    #[test]
    fn the_table_is_the_quadrature_with_four_times_the_nodes() {
        let (table, nodes) = (Albedo::table(), gauss(4 * NODES));
        for (roughness, cosine) in ROUGHNESSES.iter().flat_map(|r| COSINES.map(|c| (*r, c))) {
            let expected = once(roughness * roughness, cosine, &nodes);
            let off = (table.at(roughness, cosine) - expected).abs().max_element();
            assert!(off < 3e-5, "{roughness} {cosine}: {off} of {expected}");
        }
    }

    #[test]
    fn the_means_are_those_of_the_quadrature() {
        let (table, nodes) = (Albedo::table(), gauss(NODES));
        for roughness in ROUGHNESSES {
            let alpha = roughness * roughness;
            // By the cube root of the cosine: closest where light grazes.
            let term = |[x, w]: &[f64; 2]| 6.0 * w * x.powi(5) * once(alpha, x.powi(3), &nodes);
            let expected: DVec2 = nodes.iter().map(term).sum();
            let off = (table.mean(roughness) - expected).abs().max_element();
            assert!(off < 2e-5, "{roughness}: {off} of {expected}");
        }
    }

    #[test]
    fn a_smooth_surface_reflects_by_schlicks_formula() {
        // Lobes as narrow as 1/1024: what they reflect is that of a mirror up to the square of that, over the cosine's.
        for cosine in [0.2f64, 0.5, 1.0] {
            let schlick = (1.0 - cosine).powi(5);
            let off = Albedo::table().at(SMOOTHEST, cosine) - DVec2::new(1.0 - schlick, schlick);
            assert!(off.abs().max_element() < 2e-4, "{cosine}: {off}");
        }
    }

    #[test]
    fn seen_head_on_the_widest_lobe_reflects_its_closed_form() {
        // D is 1 / pi and V is 1 / (2 + 2 l): over light they come to the integral of l / (1 + l) from 0 to 1.
        let both = Albedo::table().at(1.0, 1.0).element_sum();
        assert!((both - (1.0 - std::f64::consts::LN_2)).abs() < 1e-6, "{both}");
    }
}
