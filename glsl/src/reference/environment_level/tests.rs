//! Levels, and the split sum with them, against quadrature of the same lobes.

use std::sync::LazyLock;

use super::*;
use crate::{
    layout::light::{LobeLevel, lobe_levels},
    reference::{
        brdf::{Reflectance, albedo, visibility},
        brdf_table::Table,
        environment::{Environment, lookup},
        surroundings::seen,
    },
};

/// Sky, ground, a sun of five degrees and a soft lamp.
fn light(d: DVec3) -> f64 {
    let (sun, lamp) = (DVec3::new(0.48, 0.67, -0.57).normalize(), DVec3::new(-0.93, -0.12, 0.35).normalize());
    let spot = |to: DVec3, narrow: f64| (narrow * (d.dot(to) - 1.0)).exp();
    0.5 + 0.3 * d.y + 0.2 * d.x * d.z + 30.0 * spot(sun, 200.0) + 4.0 * spot(lamp, 20.0)
}

static MIPS: LazyLock<Vec<Level>> = LazyLock::new(|| {
    let at = |i: usize| direction(((i % 1024) as f64 + 0.5) / 1024.0, ((i / 1024) as f64 + 0.5) / 512.0);
    let texels = (0..1024 * 512).map(|i| [light(at(i)); 4]).collect();
    Level { width: 1024, height: 512, texels, alpha_scale: 1.0 }.chain()
});

fn level(k: usize) -> Level {
    environment_level(&MIPS, lobe_levels(1024)[k - 1])
}

/// Integral over light of `term`, of a half vector and the light it mirrors, times D of the lobe around z: half vectors by
/// the share of the lobe within them, closer where facets stand upright.
fn over_lobe(alpha: f64, v: DVec3, term: impl Fn(DVec3, DVec3) -> f64) -> f64 {
    let (side, squared) = (160, alpha * alpha);
    let mut sum = 0.0;
    for (i, j) in (0..side * side).map(|k| (k / side, k % side)) {
        let left = (f64::from(j) + 0.5) / f64::from(side);
        let share = 1.0 - left * left;
        let radius = (squared * share / (1.0 + (squared - 1.0) * share)).sqrt();
        let (sine, cosine) = (TAU * (f64::from(i) + 0.5) / f64::from(side)).sin_cos();
        let h = DVec3::new(radius * cosine, radius * sine, (1.0 - radius * radius).sqrt());
        let l = 2.0 * v.dot(h) * h - v;
        if v.dot(h) > 0.0 && l.z > 0.0 {
            sum += term(h, l) * 8.0 * left * v.dot(h) / h.z;
        }
    }
    sum / f64::from(side * side)
}

/// Axes around n: what z stands for in `over_lobe`.
fn around(n: DVec3, local: DVec3) -> DVec3 {
    let t = n.any_orthonormal_vector();
    local.x * t + local.y * n.cross(t) + local.z * n
}

fn normals() -> impl Iterator<Item = DVec3> {
    (0..48u32).map(|i| {
        let [turn, y] = hammersley(i, 64);
        let (sine, cosine) = (TAU * turn).sin_cos();
        let y = 1.0 - 2.0 * y;
        let n = DVec3::new((1.0 - y * y).sqrt() * cosine, y, (1.0 - y * y).sqrt() * sine);
        // A third of them near the sun.
        if i % 3 == 0 { (n + 3.0 * DVec3::new(0.48, 0.67, -0.57)).normalize() } else { n }
    })
}

/// Root mean square of the errors, over the mean of the truths.
fn error(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (mut squares, mut sum, mut count) = (0.0, 0.0, 0.0);
    for (found, truth) in pairs {
        squares += (found - truth) * (found - truth);
        sum += truth;
        count += 1.0;
    }
    f64::sqrt(squares * count) / sum
}

#[test]
fn a_level_is_what_its_lobe_sees_head_on() {
    for k in [2, 3, 6, 9, 12] {
        let level = level(k);
        let alpha = (k as f64 / 12.0).powi(2);
        let truth = |n: DVec3| {
            let seen = |light: &dyn Fn(DVec3) -> f64| {
                over_lobe(alpha, DVec3::Z, |_, l| visibility(alpha, 1.0, l.z) * l.z * light(around(n, l)))
            };
            seen(&light) / seen(&|_| 1.0)
        };
        let off = error(normals().map(|n| (lookup(&level, place(n)).x, truth(n))));
        assert!(off < 0.02, "level {k}: {off}");
    }
}

#[test]
fn a_white_environment_stays_white_at_every_level() {
    let mips = Level { width: 8, height: 4, texels: vec![[1.0; 4]; 32], alpha_scale: 1.0 }.chain();
    for k in 1..=12 {
        let how = LobeLevel { roughness: k as f32 / 12.0, size: [8, 4], samples: 256 };
        let level = environment_level(&mips, how);
        assert!(level.texels.iter().flatten().all(|x| (x - 1.0).abs() < 1e-12));
    }
}

/// An environment that is asked for one level alone.
fn with_level(k: usize) -> Environment {
    let glossy = vec![level(k); 12];
    Environment { mips: MIPS.clone(), glossy, irradiance: MIPS[5].clone() }
}

#[test]
fn the_split_sum_is_near_the_integral_it_stands_for() {
    let table = Table::new();
    for k in [2, 3, 6, 9, 12] {
        let (environment, roughness) = (with_level(k), k as f64 / 12.0);
        let surface = Reflectance::new(DVec3::ONE, 1.0, roughness);
        // Degrees from the normal, and what the lobe's stretch towards the horizon costs where light comes from a sun.
        for (angle, allowed) in [(0.0f64, 0.02), (30.0, 0.04), (60.0, 0.11), (75.0, 0.18)] {
            let (sine, cosine) = angle.to_radians().sin_cos();
            let v = DVec3::new(sine, 0.0, cosine);
            let pair = |n: DVec3| {
                let term = |_, l: DVec3| visibility(surface.alpha, cosine, l.z) * l.z * light(around(n, l));
                let sky = seen(&environment, DVec3::ZERO, n, around(n, v).extend(0.0), roughness, 0.0);
                let found = albedo(&surface, &table, cosine, true).single * sky.specular;
                (found.x, over_lobe(surface.alpha, v, term))
            };
            let off = error(normals().map(pair));
            assert!(off < allowed, "roughness {k} / 12 from {angle} degrees: {off}");
        }
    }
}
