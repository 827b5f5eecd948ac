//! Lobes against quadrature of the same, and footprints against differences.

use std::{f64::consts::TAU, sync::LazyLock};

use super::*;
use crate::reference::{
    brdf::{Reflectance, albedo},
    brdf_table::{Table, hammersley},
    environment::direction,
    mip::Level,
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

/// Integral over light of `term`, of a half vector and the light it mirrors, times D of the lobe around z: half vectors by
/// the share of the lobe within them, closer where facets stand upright.
fn over_half_vectors(alpha: f64, v: DVec3, term: impl Fn(DVec3, DVec3) -> f64) -> f64 {
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

/// Axes around n: what z stands for in `over_half_vectors`.
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
fn lobes_are_near_the_integral_they_stand_for() {
    let table = Table::new();
    let environment = Environment { mips: MIPS.clone(), irradiance: MIPS[4].clone() };
    for k in [1, 2, 3, 6, 9, 12] {
        let roughness = f64::from(k) / 12.0;
        let surface = Reflectance::new(DVec3::ONE, 1.0, roughness);
        for angle in [0.0f64, 30.0, 60.0, 75.0] {
            let (sine, cosine) = angle.to_radians().sin_cos();
            let v = DVec3::new(sine, 0.0, cosine);
            let pair = |n: DVec3| {
                let term = |_, l: DVec3| visibility(surface.alpha, cosine, l.z) * l.z * light(around(n, l));
                let sky = seen(
                    Around { environment: &environment, room: None },
                    DVec3::ZERO,
                    n,
                    around(n, v).extend(0.0),
                    Some(roughness),
                    0.0,
                );
                let seen = albedo(&surface, &table, cosine, true);
                let found = (seen.single - seen.grazing) * sky.facing + seen.grazing * sky.grazing;
                (found.x, over_half_vectors(surface.alpha, v, term))
            };
            let off = error(normals().map(pair));
            // 32 samples of a lobe that a sun of five degrees lies in.
            assert!(off < 0.06, "roughness {k} / 12 from {angle} degrees: {off}");
        }
    }
}

#[test]
fn a_white_environment_stays_white() {
    let mips = Level { width: 8, height: 4, texels: vec![[1.0; 4]; 32], alpha_scale: 1.0 }.chain();
    let environment = Environment { irradiance: mips[0].clone(), mips };
    for (roughness, z) in [(0.0, 1.0), (0.0, 0.01), (0.3, 0.5), (1.0, 1.0), (1.0, 0.001)] {
        let eye = DVec4::new(f64::sqrt(1.0 - z * z), 0.0, z, 0.0);
        let sky =
            seen(Around { environment: &environment, room: None }, DVec3::ZERO, DVec3::Z, eye, Some(roughness), 0.0);
        for light in [sky.diffuse, sky.facing, sky.grazing] {
            assert!((light - 1.0).abs().max_element() < 1e-12, "{roughness} {z}: {sky:?}");
        }
    }
}

#[test]
fn the_footprint_is_how_far_the_mirrored_direction_moves() {
    let eye = DVec4::new(0.3, 0.2, 4.0, 1.0);
    // A unit ball: its normals are its places.
    let place = |x: f64, y: f64| DVec3::new(x, y, (1.0 - x * x - y * y).sqrt());
    let mirrored = |p: DVec3| {
        let v = (eye.truncate() - p).normalize();
        2.0 * p.dot(v) * p - v
    };
    let (at, step) = ([0.4, -0.3], 1e-6);
    let centre = place(at[0], at[1]);
    let sides = [place(at[0] + step, at[1]), place(at[0], at[1] + step)];
    let moved = sides.map(|p| (p - centre) / step);
    let change = Change { normal: moved, position: moved };
    let expected = sides.map(|p| (mirrored(p) - mirrored(centre)).length() / step);
    let found = mirrored_footprint(&change, centre, centre, eye);
    assert!((found - expected[0].max(expected[1])).abs() < 1e-4 * found, "{found} {expected:?}");
}

#[test]
fn in_a_box_every_ray_is_looked_up_where_it_meets_the_wall() {
    let room =
        Room { centre: DVec3::new(0.2, -0.3, 0.5), low: DVec3::new(-2.0, -1.0, -3.0), high: DVec3::new(1.0, 2.0, 4.0) };
    let position = DVec3::new(-0.7, 0.4, 1.5);
    for k in 0..200 {
        let d = direction(f64::from(k) * 0.618_034 % 1.0, (f64::from(k) + 0.5) / 200.0);
        let (wall, share) = room.looked_up(position, d);
        let place = room.centre + wall;
        let off = (place - position).normalize() - d;
        let inside = (place - room.low).min(room.high - place);
        assert!(off.length() < 1e-12 && inside.min_element().abs() < 1e-12, "{d}: {place}");
        assert!((share * wall.length() - place.distance(position)).abs() < 1e-12);
    }
}

#[test]
fn an_environment_taken_for_endlessly_far_is_off_by_the_way_to_the_centre_over_the_distance() {
    let room = Room { centre: DVec3::ZERO, low: DVec3::splat(-5.0), high: DVec3::splat(5.0) };
    for (x, d) in [(DVec3::new(0.0, 0.5, 0.0), DVec3::X), (DVec3::new(0.01, 0.0, 0.2), DVec3::new(0.6, 0.8, 0.0))] {
        let (wall, _) = room.looked_up(x, d);
        let angle = wall.normalize().cross(d).length().asin();
        let across = x.reject_from_normalized(d).length();
        assert!((angle.sin() - across / wall.length()).abs() < 1e-12);
        assert!(angle < x.length() / 5.0 + 1e-9);
    }
}
