//! What the model promises, found by its own samples, by quadrature, and beside the renderer's twin.

use std::f64::consts::PI;

use displace_glsl::reference as twin;

use super::{
    super::{
        environment::Sky,
        lobe::{Directions, reflected},
        sampling::Places,
    },
    *,
};
use crate::domain::environment::Environment;

const ROUGHNESSES: [f64; 6] = [0.0, 0.1, 0.25, 0.5, 0.8, 1.0];
const COSINES: [f64; 6] = [0.002, 0.02, 0.1, 0.4, 0.8, 1.0];

/// Seen under a cosine, with a normal that is no axis.
fn seen(base: DVec3, metallic: f64, roughness: f64, cosine: f64) -> (Microfacets, DVec3) {
    let normal = DVec3::new(0.48, 0.6, 0.64);
    let side = normal.any_orthonormal_vector();
    let view = cosine * normal + (1.0 - cosine * cosine).sqrt() * side;
    (Microfacets::new(base, metallic, roughness, normal, view), normal)
}

/// Mean over samples of the lobe, which lie at the middles of a grid.
fn mean_of_samples(surface: &Microfacets, of: impl Fn(DVec3) -> DVec3) -> DVec3 {
    let side = 256;
    let middle = |k: u32| (f64::from(k) + 0.5) / f64::from(side);
    let places = (0..side * side).map(|k| [middle(k / side), middle(k % side)]);
    places.map(|place| of(surface.sample(place))).sum::<DVec3>() / f64::from(side * side)
}

#[test]
fn samples_and_the_table_agree_on_what_is_reflected_of_a_white_furnace() {
    let white = Environment { width: 4, height: 2, texels: vec![[1.0; 3]; 8] };
    let sky = Sky::new(&white);
    for (metallic, roughness, cosine) in cases() {
        let (surface, _) = seen(DVec3::new(1.0, 0.5, 0.1), metallic, roughness, cosine);
        let by = [0, 1].map(|number| Places::of_pixel(0, 0).further(number));
        let samples = 1 << 12;
        let sum: DVec3 = (0..samples).map(|sample| reflected(&sky, &surface, &Directions { by, sample })).sum();
        let (found, expected) = (sum / f64::from(samples), surface.share_of_everywhere());
        let off = (found - expected).abs().max_element();
        // Smooth metals seen from the side pass most light on where it grazes, too: few samples find that.
        assert!(
            off < if cosine < 0.1 { 3e-3 } else { 3e-4 },
            "{metallic} {roughness} {cosine}: {found} for {expected}"
        );
        assert!((expected.x - 1.0).abs() < 1e-12, "what is white, of both, reflects all");
    }
}

fn cases() -> impl Iterator<Item = (f64, f64, f64)> {
    let all = ROUGHNESSES.iter().flat_map(|roughness| COSINES.map(|cosine| (*roughness, cosine)));
    all.flat_map(|(roughness, cosine)| [0.0, 0.5, 1.0].map(|metallic| (metallic, roughness, cosine)))
}

#[test]
fn white_metals_vanish_in_a_white_furnace() {
    for (_, roughness, cosine) in cases() {
        let (surface, _) = seen(DVec3::ONE, 1.0, roughness, cosine);
        assert!((surface.share_of_everywhere() - 1.0).abs().max_element() < 1e-12, "{roughness} {cosine}");
    }
}

#[test]
fn samples_lie_as_densely_as_the_density_says() {
    for (metallic, roughness, cosine) in cases().filter(|case| case.1 >= 0.25) {
        let (surface, normal) = seen(DVec3::splat(0.5), metallic, roughness, cosine);
        // Shares of samples in two parts of the hemisphere, and the density's integrals.
        let side = normal.any_orthonormal_vector();
        let part = |light: DVec3| match (light.dot(normal) > 0.0, light.dot(side) > 0.3) {
            (false, _) => DVec3::ZERO,
            (true, false) => DVec3::X,
            (true, true) => DVec3::Y,
        };
        let found = mean_of_samples(&surface, part);
        let steps = 512;
        let middle = |k: u32| (f64::from(k) + 0.5) / f64::from(steps);
        let mut expected = DVec3::ZERO;
        for (i, j) in (0..steps * steps).map(|k| (k % steps, k / steps)) {
            let (turn, up) = (TAU * middle(i), 2.0 * middle(j) - 1.0);
            let out = (1.0 - up * up).sqrt();
            let light = DVec3::new(out * turn.cos(), out * turn.sin(), up);
            expected += part(light) * surface.density(light) * 4.0 * PI / f64::from(steps * steps);
        }
        let off = (found - expected).abs().max_element();
        assert!(off < 4e-3, "{metallic} {roughness} {cosine}: {found} for {expected}");
    }
}

#[test]
fn view_and_light_can_be_exchanged() {
    let (base, normal) = (DVec3::new(0.9, 0.5, 0.1), DVec3::Z);
    for k in 0..64 {
        let [v, l] = [k, k + 7].map(|k| by_cosine([(f64::from(k) + 0.5) / 71.0, f64::from(k * 29 % 71) / 71.0]));
        let [there, back] = [(v, l), (l, v)].map(|(v, l)| Microfacets::new(base, 0.4, 0.5, normal, v).value(l) / l.z);
        assert!((there - back).abs().max_element() < 1e-12 * there.max_element(), "{v} {l}: {there} {back}");
    }
}

#[test]
fn nothing_is_undefined_where_normals_face_away_or_are_missing_or_surfaces_are_smooth_or_black() {
    let axes = [DVec3::X, DVec3::Z, -DVec3::Z, DVec3::ZERO, DVec3::new(1.0, 0.0, -1e-9)];
    for (normal, base) in axes.into_iter().flat_map(|normal| [(normal, DVec3::ZERO), (normal, DVec3::ONE)]) {
        for (metallic, roughness) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
            let surface = Microfacets::new(base, metallic, roughness, normal.normalize_or_zero(), DVec3::Z);
            for at in [[0.0, 0.0], [0.5, 0.25], [1.0 - 1e-10, 0.999]] {
                let light = surface.sample(at);
                let value = surface.value(light);
                assert!(value.is_finite() && value.min_element() >= 0.0, "{normal} {roughness} {metallic}: {value}");
                assert!(value == DVec3::ZERO || surface.density(light) > 0.0);
            }
            assert!(surface.value(-DVec3::Z).is_finite());
        }
    }
}

#[test]
fn the_model_is_that_of_the_renderer() {
    let table = twin::brdf_table::Table::new();
    let (base, normal, view) = (DVec3::new(0.9, 0.5, 0.1), DVec3::Y, DVec3::new(0.6, 0.48, 0.64));
    for (metallic, roughness, _) in cases().filter(|case| case.2 == 1.0) {
        let surface = Microfacets::new(base, metallic, roughness, normal, view);
        let twin = twin::brdf::Reflectance::new(base, metallic, roughness);
        for k in 0..64 {
            let at = [(f64::from(k) + 0.5) / 64.0, f64::from(k * 29 % 64) / 64.0];
            for light in [surface.sample(at), DMat3::from_cols(DVec3::X, -DVec3::Z, DVec3::Y) * by_cosine(at)] {
                let expected = twin::brdf::brdf(&twin, &table, normal, view, light, true) * light.y.max(0.0);
                let off = (surface.value(light) - expected).abs() / (expected + 0.1);
                // Its table is read along lines, of means of 1024 samples.
                assert!(off.max_element() < 2e-3, "{metallic} {roughness} {light}: {off} of {expected}");
            }
        }
    }
}
