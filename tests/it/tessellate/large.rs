//! Triangles over many texels: the pyramids of maps, and searches through them, device against twin.

use displace_glsl::{
    layout::{
        bound::{FacetPlace, MapBlock},
        refine::UNIT,
    },
    reference::{bound::bound, place::Places},
};
use displace_server::{
    domain::{
        cancel::{Cancel, NoProgress},
        detail::{Layer, Sampling, Wrap},
    },
    render::{JobContext, tessellate::device::pyramids::Pyramids},
    vulkan::Stream,
};
use displace_tests::meshes;
use rand::{RngExt as _, SeedableRng, rngs::StdRng};

use super::{
    bounds::{AT_TEXELS, EVERYWHERE, IDENTITY, WRAPS, check, corners, found, rounding, triangles},
    *,
};
use crate::raster::device;

/// Of what f32 makes of a plane's values.
const ROUNDING: f64 = 3e-5;

/// Layers of maps of all sizes and kinds, none of them larger than `most`.
fn layers(wraps: &[(Wrap, Sampling)], most: u32) -> Vec<Layer> {
    let mut random = StdRng::seed_from_u64(u64::from(most));
    let mut layers = Vec::new();
    for (wrap, sampling) in wraps {
        for (_, at) in MAPS {
            let size = [0; 2].map(|_| random.random_range(2..most));
            layers.push(layer(map(size, *wrap, *sampling, at), 0.1, IDENTITY));
        }
    }
    layers
}

fn on_device(places: &Places<'_>) -> Vec<MapBlock> {
    let cancel = Cancel::default();
    let job = JobContext { cancel: &cancel, progress: &NoProgress };
    let layers = Stream::from_slice(device(), "layers", &places.tables.layers).expect("fits");
    let texels = Stream::of_texels(device(), &places.tables.texels).expect("fits");
    let made = Pyramids::new(&job, device(), places, &layers, &texels).expect("runs");
    made.blocks.read().expect("reads")
}

#[test]
fn pyramids_are_the_twin_s_but_for_rounding() {
    for most in [7, 30, 200] {
        let subject = Subject::new(&meshes::plane(1), 3.0, layers(&WRAPS, most));
        let places = Places::new(&subject.tables, &subject.base);
        let found = on_device(&places);
        let expected: Vec<MapBlock> = places.pyramids.iter().flat_map(|of| of[0].blocks()).copied().collect();
        assert_eq!(found.len(), expected.len());
        for (k, (found, expected)) in found.iter().zip(&expected).enumerate() {
            assert_eq!((found.value, found.range), (expected.value, expected.range), "block {k}, up to {most} texels");
            let near = |a: [f32; 2], b: [f32; 2]| (0..2).all(|k| f64::from(a[k] - b[k]).abs() < ROUNDING);
            assert!(near(found.slope, expected.slope), "block {k}: {found:?}, not {expected:?}");
            assert!(near(found.rest, expected.rest), "block {k}: {found:?}, not {expected:?}");
        }
    }
}

#[test]
fn every_texel_is_within_the_rest_of_its_blocks() {
    let subject = Subject::new(&meshes::plane(1), 3.0, layers(&[(Wrap::Clamp, Sampling::Node)], 150));
    let places = Places::new(&subject.tables, &subject.base);
    let found = on_device(&places);
    let mut first = 0;
    for (layer, pyramid) in places.tables.layers.iter().zip(&places.pyramids) {
        let cells = pyramid[0].cells();
        for (level, size) in pyramid[0].sizes().enumerate() {
            for (x, y) in (0..=cells[1]).flat_map(|y| (0..=cells[0]).map(move |x| (x, y))) {
                let at = [0, 1].map(|k| ([x, y][k] / (8 << level)).min(size[k] - 1));
                let block = &found[first + (at[1] * size[0] + at[0]) as usize];
                let [u, v] = [0, 1].map(|k| ([x, y][k] - at[k] * (8 << level)) as f64);
                let plane = f64::from(block.value) + u * f64::from(block.slope[0]) + v * f64::from(block.slope[1]);
                let value = places.tables.texels[(layer.first + y as u32 * layer.row + x as u32) as usize];
                let rest = f64::from(value) - plane;
                assert!((f64::from(block.rest[0])..=f64::from(block.rest[1])).contains(&rest), "{rest} {block:?}");
                assert!((block.range[0]..=block.range[1]).contains(&value), "{value} {block:?}");
            }
            first += (size[0] * size[1]) as usize;
        }
    }
}

#[test]
fn bounds_over_many_periods_and_beyond_borders_are_the_twin_s() {
    let wide = [[4.6, 1.4, -2.2], [-1.35, 5.1, 0.7]];
    for (wrap, sampling) in WRAPS {
        for (name, at) in MAPS {
            let layers = vec![layer(map([70, 41], wrap, sampling, at), 0.3, wide)];
            check(&format!("{name} {wrap:?} {sampling:?}"), &Subject::new(&meshes::plane(1), 3.0, layers), EVERYWHERE);
        }
    }
}

#[test]
fn a_triangle_over_millions_of_texels_is_bounded_by_the_pyramid_as_the_twin_does() {
    let spike = |x, y| if x == 77 && y == 99 { 0.75 } else { 0.5 };
    let wide = [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
    let subject = |at: fn(u32, u32) -> f32| {
        let wide = layer(map([2048, 2048], Wrap::Repeat, Sampling::Center, at), 1.0, wide);
        Subject::new(&meshes::plane(1), 3.0, vec![wide])
    };
    let whole = FacetPlace { base: 0, a: [0, 0], b: [UNIT, 0], c: [0, UNIT] };
    let quarter = FacetPlace { base: 1, a: [UNIT / 3, 0], b: [UNIT / 2, UNIT / 5], c: [UNIT / 4, UNIT / 3] };
    let small = FacetPlace { base: 0, a: [UNIT / 2, 0], b: [UNIT / 2 + 999, 0], c: [UNIT / 2, 999] };
    for (name, subject) in [("spike", subject(spike)), ("smooth", subject(smooth)), ("noise", subject(noise))] {
        let places = Places::new(&subject.tables, &subject.base);
        let facets = [whole, quarter, small];
        for (asked, cap) in [(EVERYWHERE, f32::MAX), (EVERYWHERE, 0.4), (EVERYWHERE, 2.0), (AT_TEXELS, 2.0)] {
            for (facet, found) in facets.iter().zip(found(&places, asked, &facets, cap)) {
                let expected = bound(&places, asked, facet.base, corners(facet), 1.0, f64::INFINITY);
                let (rounding, cap, found) = (rounding(&places, facet, expected), f64::from(cap), f64::from(found));
                let near = if cap < 1e9 { cap / 32.0 } else { 0.0 };
                let is_near = found >= expected - rounding && found <= expected + rounding + near;
                let right = if expected > cap { found > cap } else { is_near };
                assert!(right, "{name} {asked:?} {cap}: {found}, not {expected} ± {rounding:e}: {facet:?}");
            }
        }
    }
}

#[test]
fn lists_of_triangles_small_and_large_are_bounded_one_by_one() {
    let layers = vec![layer(map([300, 200], Wrap::Repeat, Sampling::Center, bricks), 0.3, IDENTITY)];
    let subject = Subject::new(&meshes::plane(1), 3.0, layers);
    let places = Places::new(&subject.tables, &subject.base);
    let facets = triangles(2);
    let all = found(&places, EVERYWHERE, &facets, 0.2);
    for (facet, among) in facets.iter().zip(all) {
        assert_eq!(found(&places, EVERYWHERE, &[*facet], 0.2), [among], "{facet:?}");
    }
}
