//! The same over the corpus: its models, windows of its maps, every base.

use std::{path::Path, sync::Arc};

use bytes::Bytes;
use displace_server::domain::{
    detail::{LayerSource, Map, Sampling, Wrap},
    gltf::{Limits, load},
    mesh::{Attribute, Mesh},
    request::{Allowed, Base, ErrorAt, Geometry, Quality, Refinement, SeamRule, Tolerance},
};
use displace_tests::{
    corpus::{Corpus, Expect, corpus},
    surfaces::{detail, expression, uniform},
};
use rand::{RngExt as _, SeedableRng, rngs::StdRng};

use super::{cases::Case, share_of_tolerance};

const COMBINATIONS: u64 = 200;
/// Base triangles of a mesh: results are judged at some 150 places of every triangle.
const MOST_TRIANGLES: usize = 1000;
/// Texels of a side of a window.
const WINDOW: u32 = 24;
const MAPS: [&str; 4] = [
    "maps/ambientcg_Tiles036/Tiles036_1K_Displacement.jpg",
    "maps/ambientcg_Rock020/Rock020_1K_Displacement.jpg",
    "maps/3dtextures_Abstract_008/Abstract_008_height.png",
    "maps/babylon_hexMap/hexMap_height.png",
];

/// Where more than two triangles meet, sheets may lie on each other, and their places count as one: those are left out.
fn meshes(corpus: &Corpus) -> Vec<Mesh> {
    let accepted = corpus.models().into_iter().filter(|model| model.expect == Expect::Accept);
    let small = |mesh: &Mesh| !mesh.triangles.is_empty() && mesh.triangles.len() <= MOST_TRIANGLES;
    accepted
        .flat_map(|model| of_file(&model.path))
        .filter(|mesh| small(mesh) && mesh.health.non_manifold_edges == 0)
        .collect()
}

fn of_file(path: &Path) -> Vec<Mesh> {
    let bytes = std::fs::read(path).unwrap_or_else(|error| panic!("cannot read {}: {error}", path.display()));
    let beside = |uri: &str| std::fs::read(path.parent()?.join(uri)).ok().map(Bytes::from);
    let scene = load(&bytes.into(), &beside, &Limits::default()).expect("the corpus says that it is accepted");
    scene.meshes.into_iter().map(|mesh| mesh.mesh).collect()
}

fn maps(corpus: &Corpus) -> Vec<image::RgbImage> {
    let open = |path: &&str| image::open(corpus.path(path)).expect("a map of the corpus can be read").to_rgb8();
    MAPS.iter().map(open).collect()
}

/// Part of a map, as heights or as vectors.
fn window(image: &image::RgbImage, random: &mut StdRng, channels: u32) -> Arc<Map> {
    let [x, y] = [image.width(), image.height()].map(|size| random.random_range(0..size - WINDOW));
    let texel = |k: u32| (k / channels % WINDOW + x, k / channels / WINDOW + y, (k % channels) as usize);
    let value = |k: u32| {
        let (x, y, channel) = texel(k);
        f32::from(image.get_pixel((x + 3 * channel as u32) % image.width(), y)[channel]) / 255.0
    };
    Arc::new(Map {
        width: WINDOW,
        height: WINDOW,
        channels,
        texels: Arc::new((0..channels * WINDOW * WINDOW).map(value).collect()),
        wrap: [[Wrap::Repeat, Wrap::Mirror, Wrap::Clamp][random.random_range(0..3)]; 2],
        sampling: [Sampling::Center, Sampling::Node][random.random_range(0..2)],
        source_bits: 8,
    })
}

fn source(mesh: &Mesh, images: &[image::RgbImage], random: &mut StdRng) -> LayerSource {
    let image = &images[random.random_range(0..images.len())];
    let kind = random.random_range(0..4);
    match kind {
        _ if !has_uv(mesh) => {
            let times = 4.0 / diagonal(mesh);
            expression(&format!("0.5*sin({times}*x+{times}*z)*cos({times}*y)"))
        }
        0 => LayerSource::VectorObject(window(image, random, 3)),
        1 if !mesh.av_tangent.is_empty() && mesh.primitives.len() == 1 => {
            LayerSource::VectorTangent(window(image, random, 3))
        }
        _ => LayerSource::Height(window(image, random, 1)),
    }
}

fn has_uv(mesh: &Mesh) -> bool {
    let is_everywhere = |attribute: &Attribute| attribute.primitives.iter().all(|has| *has);
    mesh.attributes.iter().any(|attribute| attribute.semantic == "TEXCOORD_0" && is_everywhere(attribute))
}

fn diagonal(mesh: &Mesh) -> f64 {
    let far = |k: usize, best: fn(f32, f32) -> f32, start| mesh.gv_position.iter().map(|p| p[k]).fold(start, best);
    let along = |k| f64::from(far(k, f32::max, f32::NEG_INFINITY) - far(k, f32::min, f32::INFINITY));
    (0..3).map(|k| along(k).powi(2)).sum::<f64>().sqrt()
}

fn seeded(seed: u64, meshes: &[Mesh], images: &[image::RgbImage]) -> Case {
    let mut random = StdRng::seed_from_u64(seed);
    let mesh = &meshes[random.random_range(0..meshes.len())];
    let diagonal = diagonal(mesh);
    let scale = (diagonal * [0.005, 0.02][random.random_range(0..2)]) as f32;
    let tolerance = [0.02, 0.01, 0.005][random.random_range(0..3)];
    let world = random.random_bool(0.5);
    let base = [Base::Flat, Base::Flat, Base::Flat, Base::Pn, Base::Phong, Base::Loop][random.random_range(0..6)];
    let case = Case {
        name: format!("case {seed}: {}, {base:?}, scale {scale}", mesh.name),
        mesh: mesh.clone(),
        detail: detail(source(mesh, images, &mut random), scale),
        geometry: Geometry {
            seams: [SeamRule::Mean, SeamRule::Dominant][random.random_range(0..2)],
            feather_texels: [1.0, 3.0][random.random_range(0..2)],
            ..uniform(0)
        },
        allowed: if world { Allowed::World(tolerance * diagonal) } else { Allowed::Diagonal(tolerance) },
    };
    case.over(base)
}

#[test]
#[ignore = "takes a quarter of an hour: cargo test -p displace-tests --test it over_the_corpus -- --ignored"]
fn no_place_of_two_hundred_results_over_the_corpus_is_farther_than_the_tolerance() {
    let Some(corpus) = corpus("tolerances over the corpus") else { return };
    let (meshes, images) = (meshes(&corpus), maps(&corpus));
    let mut shares = Vec::new();
    for seed in 0..COMBINATIONS {
        let case = seeded(seed, &meshes, &images);
        let tolerance =
            Tolerance { allowed: case.allowed.clone(), error_at: ErrorAt::Surface, quality: Quality::Normal };
        let geometry = Geometry { refinement: Refinement::Tolerance(tolerance), ..case.geometry.clone() };
        eprint!("{case}: ");
        let (share, budget_reached) = share_of_tolerance(&case, &geometry);
        eprintln!("{share:.3}{}", if budget_reached { ", budget reached" } else { "" });
        assert!(share <= 1.0, "{case}: {share} of the tolerance");
        shares.push(share);
    }
    shares.sort_by(f64::total_cmp);
    let (median, largest) = (shares[shares.len() / 2], shares[shares.len() - 1]);
    eprintln!("{} meshes, {COMBINATIONS} results: median {median:.3}, largest {largest:.3}", meshes.len());
}
