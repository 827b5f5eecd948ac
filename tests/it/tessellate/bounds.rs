//! The bound of triangles: device against twin.

use displace_glsl::{
    layout::{bound::FacetPlace, geometry, refine::UNIT},
    reference::{
        bound::{Asked, bound},
        map::texel_space,
        place::{Places, share_of},
    },
};
use displace_server::{
    domain::{
        cancel::{Cancel, NoProgress},
        detail::{Layer, Sampling, Wrap},
        request::SeamRule,
    },
    render::{
        JobContext,
        tessellate::device::{bounds::Bounds, tables::supports},
    },
    vulkan::Stream,
};
use displace_tests::{meshes, surfaces::expression};
use glam::DVec3;
use rand::{RngExt as _, SeedableRng, rngs::StdRng};

use super::*;
use crate::raster::device;

const TRIANGLES: usize = 200;
/// Half a unit in the last place of 1.
const EPSILON: f64 = 1.0 / (1 << 24) as f64;
pub(super) const IDENTITY: [[f32; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
const TURNED: [[f32; 3]; 2] = [[1.3, 0.4, -0.2], [-0.35, 1.1, 0.7]];

pub(super) fn found(places: &Places<'_>, asked: Asked, facets: &[FacetPlace], cap: f32) -> Vec<f32> {
    let cancel = Cancel::default();
    let job = JobContext { cancel: &cancel, progress: &NoProgress };
    let bounds = Bounds::new(&job, device(), places, asked).expect("fits");
    let stream = Stream::from_slice(device(), "facets", facets).expect("fits");
    let recorder = device().recorder(&cancel, &NoProgress);
    let (recorder, found) = bounds.record(&job, recorder, &stream, facets.len() as u64, cap).expect("records");
    recorder.finish().expect("runs");
    found.read().expect("reads")
}

/// Of all sizes, slivers among them; some with corners on coarse lattices, where sides run along rows of texels.
pub(super) fn triangles(base_triangles: u32) -> Vec<FacetPlace> {
    let mut random = StdRng::seed_from_u64(u64::from(base_triangles));
    let mut triangles = Vec::new();
    while triangles.len() < TRIANGLES {
        let base = random.random_range(0..base_triangles);
        let size = 0.5f64.powf(random.random_range(0.0..9.0));
        let step = if random.random_range(0..3) == 0 { UNIT >> random.random_range(1..9) } else { 1 };
        let from = [random.random_range(0.0..1.0), random.random_range(0.0..1.0)];
        let mut corner = || {
            let shift = [0, 1].map(|k| from[k] * (1.0 - size) + size * random.random_range(0.0..1.0));
            let b = shift.map(|x: f64| ((x * f64::from(UNIT)) as u32 / step) * step);
            if b[0] + b[1] > UNIT { [UNIT - b[0], UNIT - b[1]] } else { b }
        };
        let facet = FacetPlace { base, a: corner(), b: corner(), c: corner() };
        triangles.extend((twice_area(&facet) != 0).then_some(facet));
    }
    triangles
}

/// No triangle of a mesh has none; along one without, what is linear between its corners is not defined.
fn twice_area(facet: &FacetPlace) -> i64 {
    let [a, b, c] = [facet.a, facet.b, facet.c].map(|b| b.map(i64::from));
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

pub(super) fn corners(facet: &FacetPlace) -> [DVec3; 3] {
    [facet.a, facet.b, facet.c].map(|[b1, b2]| share_of([UNIT - b1 - b2, b1, b2]))
}

/// What rounding may make of a bound: some units in its last place, and a share of the heights for each texel of the
/// triangle's extent.
pub(super) fn rounding(places: &Places<'_>, facet: &FacetPlace, bound: f64) -> f64 {
    let heights = places.layers(places.tables.base_triangles[facet.base as usize].detail).iter();
    let of_layer = |layer: &geometry::Layer| f64::from(layer.scale.abs()) * (8.0 + extent(places, facet, layer));
    EPSILON * (16.0 * bound + 16.0 * heights.map(of_layer).sum::<f64>())
}

/// Texels across and down.
fn extent(places: &Places<'_>, facet: &FacetPlace, layer: &geometry::Layer) -> f64 {
    let tables = places.tables;
    let av = tables.base_triangles[facet.base as usize].av;
    let at = corners(facet).map(|b| {
        let of = |table: &[[f32; 4]]| b.dot(DVec3::from_array(av.map(|av| f64::from(table[av as usize][3]))));
        texel_space(layer, of(&tables.av_position_u), of(&tables.av_direction_v))
    });
    let range = |k: usize| {
        let (low, high) = at.iter().fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(p[k]), h.max(p[k])));
        high - low
    };
    range(0) + range(1)
}

pub(super) fn check(what: &str, subject: &Subject, asked: Asked) {
    let places = Places::new(&subject.tables, &subject.base);
    let facets = triangles(subject.base.triangles.len() as u32);
    for (facet, found) in facets.iter().zip(found(&places, asked, &facets, f32::MAX)) {
        let expected = bound(&places, asked, facet.base, corners(facet), 1.0, f64::INFINITY);
        let (error, allowed) = ((f64::from(found) - expected).abs(), rounding(&places, facet, expected));
        assert!(
            error <= allowed,
            "{what} {asked:?}: {found}, not {expected}: off by {error:e} of {allowed:e}: {facet:?}"
        );
    }
}

pub(super) const EVERYWHERE: Asked = Asked { at_texels: false };
pub(super) const AT_TEXELS: Asked = Asked { at_texels: true };
pub(super) const WRAPS: [(Wrap, Sampling); 4] = [
    (Wrap::Repeat, Sampling::Center),
    (Wrap::Mirror, Sampling::Center),
    (Wrap::Clamp, Sampling::Node),
    (Wrap::Mirror, Sampling::Node),
];

#[test]
fn bounds_are_the_twin_s_but_for_rounding() {
    for (mesh, feather) in [
        (meshes::plane(1), 3.0),
        (meshes::cube(), 3.0),
        (meshes::cube(), 0.0),
        (meshes::mirrored_uv_sphere(8, 4), 3.0),
        (meshes::torus(6, 4), 3.0),
    ] {
        for (name, at) in MAPS {
            for (wrap, sampling) in WRAPS {
                let layers = vec![layer(map([96, 65], wrap, sampling, at), 0.3, TURNED)];
                let what = format!("{} {name} {wrap:?} {sampling:?} feather {feather}", mesh.name);
                check(&what, &Subject::new(&mesh, feather, layers), EVERYWHERE);
            }
        }
    }
}

#[test]
fn bounds_at_seams_follow_the_rule_of_the_seams() {
    let geometry = Geometry { seams: SeamRule::Dominant, ..uniform(0) };
    let layers = vec![layer(map([96, 65], Wrap::Repeat, Sampling::Center, noise), 0.3, TURNED)];
    check("cube, dominant sides", &Subject::with(&meshes::cube(), &geometry, layers), EVERYWHERE);
}

#[test]
fn bounds_at_texels_count_those_on_the_sides() {
    for mesh in [meshes::plane(1), meshes::cube()] {
        for (name, at) in MAPS {
            let layers = vec![layer(map([65, 65], Wrap::Clamp, Sampling::Node, at), 0.3, IDENTITY)];
            check(&format!("{} {name}", mesh.name), &Subject::new(&mesh, 3.0, layers), AT_TEXELS);
        }
    }
}

#[test]
fn bounds_of_several_layers_add() {
    let layers = || {
        let fine = map([64, 32], Wrap::Repeat, Sampling::Center, noise);
        let coarse = map([33, 65], Wrap::Clamp, Sampling::Node, smooth);
        vec![layer(fine, -0.1, TURNED), layer(coarse, 0.5, IDENTITY), layer(constant(), 0.2, TURNED)]
    };
    for mesh in [meshes::cube(), meshes::torus(6, 4)] {
        check(mesh.name, &Subject::new(&mesh, 3.0, layers()), EVERYWHERE);
    }
}

fn constant() -> Map {
    map([1, 1], Wrap::Repeat, Sampling::Center, |_, _| 0.75)
}

#[test]
fn what_is_above_the_cap_is_told_from_what_is_not() {
    let subject = Subject::new(
        &meshes::torus(6, 4),
        3.0,
        vec![layer(map([96, 65], Wrap::Repeat, Sampling::Center, noise), 0.3, TURNED)],
    );
    let places = Places::new(&subject.tables, &subject.base);
    let facets = triangles(subject.base.triangles.len() as u32);
    let all = found(&places, EVERYWHERE, &facets, f32::MAX);
    for cap in [0.01, 0.1, 1.0] {
        let capped = found(&places, EVERYWHERE, &facets, cap);
        for (whole, capped) in all.iter().zip(capped) {
            // A search may stop so near the truth.
            let nearly = *whole * 0.9999..=cap.min(*whole + 1.01 * cap / 32.0);
            assert!(
                if *whole > cap { capped > cap } else { nearly.contains(&capped) },
                "{capped} for {whole}, cap {cap}"
            );
        }
    }
}

#[test]
fn small_triangles_on_large_maps_keep_their_digits() {
    // Texels are a large share of a triangle whose corners have no more digits than a place on the map takes.
    let wide = map([2048, 512], Wrap::Repeat, Sampling::Center, bricks);
    let subject =
        Subject::new(&meshes::plane(1), 3.0, vec![layer(wide, 1.0, [[16.0, 0.1, 1000.0], [-0.1, 64.0, 3000.0]])]);
    let places = Places::new(&subject.tables, &subject.base);
    let tiny: Vec<FacetPlace> = triangles(2)
        .iter()
        .map(|facet| {
            let near = |b: [u32; 2]| b.map(|b| UNIT / 3 + b / 4096);
            FacetPlace { a: near(facet.a), b: near(facet.b), c: near(facet.c), ..*facet }
        })
        .collect();
    for (facet, found) in tiny.iter().zip(found(&places, EVERYWHERE, &tiny, f32::MAX)) {
        let expected = bound(&places, EVERYWHERE, facet.base, corners(facet), 1.0, f64::INFINITY);
        assert!((f64::from(found) - expected).abs() < 40.0 * EPSILON, "{found}, not {expected}: {facet:?}");
    }
}

#[test]
fn only_height_maps_near_their_origin_are_supported() {
    let of = |source: LayerSource, map_from_uv| {
        let layers = vec![Layer { source, scale: 0.1, midlevel: 0.0, map_from_uv }];
        supports(&Subject::new(&meshes::plane(1), 3.0, layers).tables)
    };
    let height = || LayerSource::Height(Arc::new(map([512, 512], Wrap::Repeat, Sampling::Center, smooth)));
    assert!(of(height(), IDENTITY));
    assert!(!of(height(), [[1e5, 0.0, 0.0], [0.0, 1.0, 0.0]]));
    assert!(!of(expression("sin(9*u)"), IDENTITY));
}
