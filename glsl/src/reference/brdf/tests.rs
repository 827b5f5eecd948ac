//! What the model promises, found by quadrature over its own lobe.

use std::{f64::consts::TAU, sync::LazyLock};

use super::*;

static TABLE: LazyLock<Table> = LazyLock::new(Table::new);

fn seen_under(cosine: f64) -> DVec3 {
    DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine)
}

/// The share reflected of light from everywhere by single facets: half vectors by the share of the lobe that is within
/// them, closer where facets stand upright.
fn single(surface: &Reflectance, cosine: f64, side: usize) -> DVec3 {
    let (v, squared) = (seen_under(cosine), surface.alpha * surface.alpha);
    let mut sum = DVec3::ZERO;
    for (i, j) in (0..side * side).map(|k| (k / side, k % side)) {
        let left = (j as f64 + 0.5) / side as f64;
        let share = 1.0 - left * left;
        let radius = (squared * share / (1.0 + (squared - 1.0) * share)).sqrt();
        let (sine, turn) = (TAU * (i as f64 + 0.5) / side as f64).sin_cos();
        let h = DVec3::new(radius * turn, radius * sine, (1.0 - radius * radius).sqrt());
        let (vh, nl) = (v.dot(h), 2.0 * v.dot(h) * h.z - cosine);
        if vh > 0.0 && nl > 0.0 {
            let fresnel = surface.f0 + (DVec3::ONE - surface.f0) * grazing(vh);
            sum += fresnel * visibility(surface.alpha, cosine, nl) * 8.0 * left * vh * nl / h.z;
        }
    }
    sum / (side * side) as f64
}

/// The rest, which is even around the normal: cosines as fourth powers, closest where light grazes.
fn the_rest(surface: &Reflectance, cosine: f64) -> DVec3 {
    let steps = 4096;
    let term = |i: usize| {
        let x = (i as f64 + 0.5) / f64::from(steps);
        around(surface, &TABLE, cosine, x.powi(4)) * x.powi(7)
    };
    (0..steps as usize).map(term).sum::<DVec3>() * 8.0 * PI / f64::from(steps)
}

const ROUGHNESSES: [f64; 8] = [0.0, 0.05, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0];
const COSINES: [f64; 10] = [0.0005, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.3, 0.6, 1.0];

fn white(metallic: f64, roughness: f64) -> Reflectance {
    Reflectance::new(DVec3::ONE, metallic, roughness)
}

fn every_case(check: impl Fn(f64, f64)) {
    ROUGHNESSES.iter().for_each(|&roughness| COSINES.iter().for_each(|&cosine| check(roughness, cosine)));
}

#[test]
fn white_metals_and_white_dielectrics_and_their_mixtures_reflect_all_light_of_a_white_furnace() {
    for metallic in [0.0, 0.5, 1.0] {
        every_case(|roughness, cosine| {
            let surface = white(metallic, roughness);
            let all = single(&surface, cosine, 512) + the_rest(&surface, cosine);
            // Lobes of a few thousandths, seen from a few thousandths, are finer than the table and this quadrature.
            let allowed = if roughness < 0.1 { 0.01 } else { 0.0015 };
            assert!((all - 1.0).abs().max_element() < allowed, "{metallic} {roughness} {cosine}: {all}");
        });
    }
}

#[test]
fn the_table_is_what_single_facets_reflect() {
    every_case(|roughness, cosine| {
        for metallic in [0.0, 1.0] {
            let surface = white(metallic, roughness);
            let off = albedo(&surface, &TABLE, cosine, true).single - single(&surface, cosine, 512);
            let allowed = if roughness < 0.1 { 0.01 } else { 0.0015 };
            assert!(off.abs().max_element() < allowed, "{metallic} {roughness} {cosine}: {off}");
        }
    });
}

#[test]
fn without_multiple_scattering_the_diffuse_share_is_that_of_the_formula() {
    let surface = white(0.0, 0.6);
    for cosine in COSINES {
        let v = seen_under(cosine);
        let mut sum = 0.0;
        for (i, j) in (0..256 * 256).map(|k| (k / 256, k % 256)) {
            let (sine, turn) = (TAU * (f64::from(i) + 0.5) / 256.0).sin_cos();
            let share = (f64::from(j) + 0.5) / 256.0;
            let l = DVec3::new(share.sqrt() * turn, share.sqrt() * sine, (1.0 - share).sqrt());
            sum += 0.96 * (1.0 - grazing(v.dot((v + l).normalize())));
        }
        let expected = sum / f64::from(256 * 256);
        let found = albedo(&surface, &TABLE, cosine, false).around(&surface).x;
        assert!((found - expected).abs() < 0.001, "{cosine}: {found} for {expected}");
    }
}

/// A few hundred directions above the surface.
fn directions() -> impl Iterator<Item = DVec3> {
    (0..200u32).map(|i| {
        let [turn, share] = crate::reference::brdf_table::hammersley(i, 256);
        let (sine, cosine) = (TAU * turn).sin_cos();
        DVec3::new(share.sqrt() * cosine, share.sqrt() * sine, (1.0 - share).sqrt())
    })
}

#[test]
fn view_and_light_can_be_exchanged() {
    let surface = Reflectance::new(DVec3::new(0.9, 0.5, 0.1), 0.4, 0.5);
    for (v, l) in directions().zip(directions().skip(7)) {
        for multiple in [false, true] {
            let (there, back) =
                (brdf(&surface, &TABLE, DVec3::Z, v, l, multiple), brdf(&surface, &TABLE, DVec3::Z, l, v, multiple));
            assert!((there - back).abs().max_element() < 1e-12 * there.max_element(), "{v} {l}: {there} {back}");
        }
    }
}

#[test]
fn without_multiple_scattering_the_model_is_that_of_appendix_b() {
    let (base, metallic, roughness) = (DVec3::new(0.9, 0.5, 0.1), 0.3, 0.7);
    let surface = Reflectance::new(base, metallic, roughness);
    for (v, l) in directions().zip(directions().skip(11)) {
        let h = (v + l).normalize();
        let squared = f64::powi(roughness, 4);
        let d = squared / (PI * (h.z * h.z * (squared - 1.0) + 1.0).powi(2));
        let mask = |c: f64| 2.0 * c / (c + (squared + (1.0 - squared) * c * c).sqrt());
        // G of the appendix, 2 / (1 + L(v) + 1 + L(l)) in terms of each G1 = 2 / (1 + L).
        let g = 1.0 / (1.0 / mask(v.z) + 1.0 / mask(l.z) - 1.0);
        let schlick = |f0: DVec3| f0 + (1.0 - f0) * (1.0 - v.dot(h)).powi(5);
        let (f, facets) = (schlick(DVec3::splat(0.04)), d * g / (4.0 * v.z * l.z));
        let expected = ((1.0 - f) * base / PI + f * facets).lerp(schlick(base) * facets, metallic);
        let found = brdf(&surface, &TABLE, DVec3::Z, v, l, false);
        assert!((found - expected).abs().max_element() < 1e-12 * expected.max_element(), "{v} {l}: {found} {expected}");
    }
}

#[test]
fn nothing_is_undefined_where_light_grazes_or_normals_face_away_or_surfaces_are_black_or_smooth() {
    let directions =
        [DVec3::X, DVec3::new(1.0, 0.0, 1e-9).normalize(), DVec3::new(-1.0, 0.0, 1e-9).normalize(), DVec3::Z];
    for (n, v) in directions.iter().flat_map(|n| [(*n, DVec3::Z), (-*n, DVec3::Z), (DVec3::ZERO, *n), (*n, DVec3::X)]) {
        let n = visible_normal(n, v);
        assert!((n.length() - 1.0).abs() < 1e-12 && n.dot(v) > 0.99 * MIN_COSINE, "{n} {v}");
        for (l, roughness, base) in
            directions.iter().flat_map(|l| [(*l, 0.0, 0.0), (*l, 1.0, 0.0), (*l, 0.0, 1.0), (*l, 1.0, 1.0)])
        {
            for (metallic, multiple) in [(0.0, true), (1.0, true), (0.0, false), (1.0, false)] {
                let surface = Reflectance::new(DVec3::splat(base), metallic, roughness);
                let found = brdf(&surface, &TABLE, n, v, l, multiple);
                assert!(found.is_finite() && found.min_element() >= 0.0, "{n} {v} {l} {roughness} {metallic}: {found}");
            }
        }
    }
}
