//! Heights as they are laid out, against the maps that displacement reads.

use super::{super::resolve_bumps, *};
use crate::{
    domain::{
        Digest,
        detail::Sampling,
        encode::encode_linear_rgb8,
        request::{Channel, LayerRequest, MapRequest, Preset, Space, Swizzle},
        scene::{Material, MaterialDisplacement, SceneImage, TextureUse},
    },
    oracle::field::Field,
};

/// No two texels alike, and no symmetry; but what repeats on nodes ends as it begins.
fn map(wrap: Wrap, sampling: Sampling) -> Map {
    let (width, height) = (6u32, 5u32);
    let closed = |i: u32, n: u32| if (wrap, sampling) == (Wrap::Repeat, Sampling::Node) { i % (n - 1) } else { i };
    let number = |i: u32| closed(i / width, height) * width + closed(i % width, width);
    let texels: Vec<f32> = (0..width * height).map(|i| (number(i) * (7 * number(i) + 3) % 31) as f32 / 31.0).collect();
    Map { width, height, channels: 1, texels: texels.into(), wrap: [wrap; 2], sampling, source_bits: 32 }
}

fn detail(map: &Map, scale: f32, midlevel: f32, map_from_uv: [[f32; 3]; 2]) -> Detail {
    let source = LayerSource::Height(Arc::new(map.clone()));
    Detail { layers: vec![Layer { source, scale, midlevel, map_from_uv }], uv_set: 1 }
}

/// As a march reads it at (u, v) of the mesh.
fn read(relief: &Relief, [u, v]: [f64; 2]) -> f64 {
    let map = &relief.map;
    let [column, row] = [0, 1].map(|axis| {
        let [a, b, c] = relief.map_from_uv[axis].map(f64::from);
        let n = f64::from([map.width, map.height][axis]);
        (a * u + b * v + c) * n - 0.5
    });
    let index = |i: f64, n: u32, repeats: bool| {
        let (i, n) = (i as i64, i64::from(n));
        (if repeats { i.rem_euclid(n) } else { i.clamp(0, n - 1) }) as usize
    };
    let texel = |i: f64, j: f64| {
        let (i, j) = (index(i, map.width, map.repeats[0]), index(j, map.height, map.repeats[1]));
        f64::from(map.heights[j * map.width as usize + i])
    };
    let [(i, s), (j, t)] = [column, row].map(|at| (at.floor(), at - at.floor()));
    let along = |j: f64| texel(i, j) * (1.0 - s) + texel(i + 1.0, j) * s;
    along(j) * (1.0 - t) + along(j + 1.0) * t
}

const AFFINE: [[f32; 3]; 2] = [[0.75, -0.5, 0.125], [0.25, 1.5, -0.375]];

#[test]
fn heights_are_those_that_displacement_reads_however_the_map_wraps_and_is_sampled() {
    for sampling in [Sampling::Center, Sampling::Node] {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            let map = map(wrap, sampling);
            let relief = relief(&detail(&map, -2.5, 0.25, AFFINE)).expect("heights");
            assert_eq!((relief.uv_set, relief.map.repeats), (1, [wrap != Wrap::Clamp; 2]));
            let field = Field::new(&Arc::new(map));
            let texel_from_uv = field.texel_from_uv();
            for k in 0..400 {
                let uv = [k, 17 * k].map(|k| f64::from(k % 401) / 401.0 * 4.0 - 1.5);
                let [x, y] = [0, 1].map(|axis| {
                    let [a, b, c] = AFFINE[axis].map(f64::from);
                    let [scale, offset] = texel_from_uv[axis];
                    scale * (a * uv[0] + b * uv[1] + c) + offset
                });
                let expected = -2.5 * (field.value(0, x, y) - 0.25);
                let found = read(&relief, uv);
                // Rows of the map are f32: 4 of them, within 3 texels of the origin, over slopes of 2.5 a texel.
                assert!((found - expected).abs() < 2e-5, "{sampling:?} {wrap:?} at {uv:?}: {found} {expected}");
            }
        }
    }
}

/// Red 0, 51, 102, 153, green the reverse; and the file's own, as large.
fn png() -> Vec<u8> {
    encode_linear_rgb8(4, 1, &[0, 153, 9, 51, 102, 9, 102, 51, 9, 153, 0, 9]).expect("a PNG")
}

fn asset() -> Digest {
    Digest::of(&png())
}

fn map_request() -> MapRequest {
    MapRequest { asset: asset(), wrap: Some(Wrap::Clamp), sampling: Sampling::Center }
}

fn layer(source: SourceRequest) -> LayerRequest {
    LayerRequest { source, scale: 1.0, midlevel: None, invert_height: false, flip_v: false, preset: Preset::Right }
}

fn height(channel: Channel) -> LayerRequest {
    layer(SourceRequest::Height { map: map_request(), channel })
}

fn normal() -> LayerRequest {
    let (space, swizzle) = (Space::Tangent, Swizzle::default());
    layer(SourceRequest::Normal { map: map_request(), space, swizzle, flip_green: false, exact_zero: false })
}

/// A material without displacement, and one with the file's: factor 2, offset -1.
fn scene() -> Scene {
    let texture = TextureUse { image: 0, uv_set: 3, wrap: [Wrap::Repeat, Wrap::Clamp], map_from_uv: AFFINE };
    let displacement = Some(MaterialDisplacement { texture, factor: 2.0, offset: -1.0 });
    let named = |name: &str, displacement| Material { name: Some(name.into()), displacement, ..Material::default() };
    let image = SceneImage { media_type: "image/png".into(), bytes: Some(png().into()) };
    Scene { materials: vec![named("bare", None), named("rich", displacement)], images: vec![image], ..Scene::default() }
}

fn resolved(scene: &Scene, material: Option<&str>, layers: Vec<LayerRequest>) -> Result<Reliefs> {
    let requests = if layers.is_empty() {
        vec![]
    } else {
        vec![MaterialDetail { material: material.map(Into::into), layers, uv_set: 0 }]
    };
    resolve_reliefs(scene, &requests, Method::Steep, &|_| Ok(png().into()))
}

fn near(reliefs: &Reliefs, material: usize, expected: [f32; 4]) {
    let found = &reliefs.of(Some(material)).expect("heights").map.heights;
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?} {expected:?}");
}

#[test]
fn heights_are_scale_times_value_less_midlevel_of_the_channel_asked_for() {
    let scene = scene();
    let of = |layer: LayerRequest| resolved(&scene, Some("bare"), vec![layer]).expect("heights");
    near(&of(height(Channel::R)), 0, [0.0, 0.2, 0.4, 0.6]);
    near(&of(height(Channel::G)), 0, [0.6, 0.4, 0.2, 0.0]);
    let scaled = || LayerRequest { scale: 0.5, midlevel: Some(0.4), ..height(Channel::R) };
    near(&of(scaled()), 0, [-0.2, -0.1, 0.0, 0.1]);
    near(&of(LayerRequest { invert_height: true, ..scaled() }), 0, [0.3, 0.2, 0.1, 0.0]);
    near(&of(LayerRequest { preset: Preset::AsPrinted, ..scaled() }), 0, [0.2, 0.1, 0.0, -0.1]);
    let flipped = of(LayerRequest { flip_v: true, ..height(Channel::R) });
    assert_eq!(flipped.of(Some(0)).expect("heights").map_from_uv[1], [0.0, -1.0, 1.0]);
}

#[test]
fn the_files_own_displacement_counts_where_the_request_has_no_heights() {
    let scene = scene();
    let own = resolved(&scene, None, vec![]).expect("heights");
    assert!(own.of(Some(0)).is_none() && own.of(None).is_none());
    near(&own, 1, [-1.0, -0.6, -0.2, 0.2]);
    let relief = own.of(Some(1)).expect("heights");
    assert_eq!((relief.uv_set, relief.map.repeats, relief.map_from_uv), (3, [true, false], AFFINE));
    near(&resolved(&scene, Some("rich"), vec![normal()]).expect("heights"), 1, [-1.0, -0.6, -0.2, 0.2]);
    near(
        &resolved(&scene, Some("rich"), vec![height(Channel::R), normal()]).expect("heights"),
        1,
        [0.0, 0.2, 0.4, 0.6],
    );
}

/// Its normals are those of the fine surface already.
#[test]
fn slopes_of_heights_bend_normals_beside_those_of_the_files_own_normal_map() {
    let mut scene = scene();
    for material in &mut scene.materials {
        let displacement = material.displacement.clone();
        material.normal = displacement.map(|d| d.texture);
    }
    let of = |method: Method, layers: Vec<LayerRequest>| {
        let requests = [MaterialDetail { material: None, layers, uv_set: 0 }];
        let requests = if requests[0].layers.is_empty() { &[][..] } else { &requests };
        let bumps = resolve_bumps(&scene, requests, method, &|_| Ok(png().into())).expect("bumps");
        [0, 1].map(|material| bumps.of(Some(material)).bump.is_some())
    };
    for method in [Method::Steep, Method::Exact, Method::Parallax] {
        assert_eq!(of(method, vec![height(Channel::R)]), [true, true]);
        assert_eq!(of(method, vec![]), [false, true]);
    }
    assert_eq!(of(Method::Bump, vec![height(Channel::R)]), [true, true]);
}

#[test]
fn materials_of_one_entry_share_their_heights() {
    let reliefs = resolved(&scene(), None, vec![height(Channel::R)]).expect("heights");
    assert!(reliefs.all().count() == 3 && reliefs.texels() == 4);
}

#[test]
fn what_is_not_one_height_map_is_refused_by_name() {
    let scene = scene();
    let vector = || SourceRequest::Vector { map: map_request(), space: Space::Tangent, swizzle: Swizzle::default() };
    let pair = || SourceRequest::DirectionMagnitude {
        direction: map_request(),
        magnitude: map_request(),
        space: Space::Tangent,
        swizzle: Swizzle::default(),
    };
    let formula = || SourceRequest::Expression { source: "u".into() };
    let huge = LayerRequest { scale: f32::MAX, midlevel: Some(-2.0), ..height(Channel::R) };
    for (layers, field, part) in [
        (vec![height(Channel::R), height(Channel::G)], "details[0].layers[1].height", "merge them into one map"),
        (vec![height(Channel::R), layer(formula())], "details[0].layers[1].expression", "draw it into one"),
        (vec![layer(vector())], "details[0].layers[0].vector", "choose method vector"),
        (vec![normal(), layer(pair())], "details[0].layers[1].direction", "choose method vector"),
        (vec![normal()], "details[0].layers", "give a height map beside it"),
        (vec![huge], "details", "heights must be finite"),
    ] {
        let error = resolved(&scene, Some("bare"), layers).expect_err(part);
        assert_eq!(error.field.as_deref(), Some(field), "{error}");
        assert!(error.to_string().contains(part), "{error}");
    }
    let plain = Scene { materials: vec![Material::default()], ..Scene::default() };
    let error = resolved(&plain, None, vec![]).expect_err("no heights").to_string();
    assert!(error.contains("give a height map"), "{error}");
}
