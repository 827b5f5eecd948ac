//! Relief that is seen to the horizon: which levels of its heights are marched, what that costs, and what it keeps.

use displace_glsl::methods::Method;
use displace_server::domain::{
    image::{HeightMap, ImageSet, RenderLight, RenderScene, SelfShadow, Silhouettes},
    request::Aov,
};
use displace_tests::meshes;
use glam::DVec3;

use super::{
    looks::assert_agrees,
    relief::in_relief,
    render,
    scenes::{Builder, IDENTITY, LEAK, render_mesh, view_camera},
};

const SIDE: u32 = 96;

/// Bumps of every size from a texel to the map, which tiles: of each octave half as high as of the one before.
fn rough(side: u32, height: f32) -> HeightMap {
    let noise = |x: u32, y: u32, octave: u32| {
        let mixed = x.wrapping_mul(0x9E37_79B9) ^ y.wrapping_mul(0x85EB_CA6B) ^ octave.wrapping_mul(0xC2B2_AE35);
        let mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x2C1B_3C6D);
        ((mixed ^ (mixed >> 12)) >> 16 & 0xff) as f32 / 127.5 - 1.0
    };
    let octave = |i: u32, k: u32| {
        let (cells, size) = (4 << k, side / (4 << k));
        let (x, y) = (i % side, i / side);
        let [fx, fy] = [x, y].map(|a| (a % size) as f32 / size as f32);
        let at = |dx: u32, dy: u32| noise((x / size + dx) % cells, (y / size + dy) % cells, k);
        let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
        mix(mix(at(0, 0), at(1, 0), fx), mix(at(0, 1), at(1, 1), fx), fy) / (1 << k) as f32
    };
    let octaves = (side / 4).ilog2() + 1;
    let heights = (0..side * side).map(|i| height * (0..octaves).map(|k| octave(i, k)).sum::<f32>()).collect();
    HeightMap { width: side, height: side, heights, repeats: [true; 2], thinnest_texels: 2.0 }
}

/// A floor of 40 x 40 with 24 x 24 maps of 128 x 128 texels on it, seen from `eye`. A pixel in the middle of an image 96
/// pixels high is as wide as 0.58 texels for each unit of distance.
fn floor(method: Method, eye: [f32; 3], size: u32) -> RenderScene {
    let mut builder = Builder::lit(view_camera(eye, [0.0, -0.6, -20.0], 40.0, size, size));
    let mut material = in_relief(rough(128, 0.02));
    let tiles = [[24.0, 0.0, 0.0], [0.0, 24.0, 0.0]];
    if let Some(relief) = &mut material.relief {
        relief.map_from_uv = tiles;
    }
    material.maps.iter_mut().flatten().for_each(|map| map.map_from_uv = tiles);
    let mut placed = IDENTITY;
    (placed[0], placed[5], placed[10]) = (40.0, 1.0, 40.0);
    builder.add(render_mesh(&meshes::plane(2)), material, placed);
    let mut scene = builder.finish();
    scene.relief.method = method;
    scene.aovs.push(Aov::Cost);
    scene.lighting.lights = vec![RenderLight::sun(DVec3::new(0.6, 0.5, 0.2).normalize().as_vec3().to_array())];
    scene
}

const EYE: [f32; 3] = [0.0, 1.0, 19.0];

#[test]
fn a_floor_to_the_horizon_shows_the_levels_that_its_twin_does() {
    for method in [Method::Exact, Method::Relief, Method::Cone, Method::ParallaxIterative] {
        assert_agrees(&floor(method, EYE, SIDE), 1e-2, method.name());
    }
    let mut scene = floor(Method::Exact, EYE, SIDE);
    scene.relief.self_shadow = SelfShadow::Hard;
    assert_agrees(&scene, 1e-2, "self-shadow");
}

/// Of fetches, in rows from the horizon down.
fn mean_cost(image: &ImageSet, rows: std::ops::Range<usize>) -> f64 {
    let costs = &image.cost.as_ref().expect("asked for")[rows.start * SIDE as usize..rows.end * SIDE as usize];
    costs.iter().map(|cost| f64::from(cost[0])).sum::<f64>() / costs.len() as f64
}

/// The way over the map grows as far as what is seen is away, here tenfold, and texels of the level do with it: but for up to
/// twice because levels are whole, and twice because steps are no shorter than a texel where the thinnest feature had two.
#[test]
fn what_is_ten_times_as_far_takes_no_more_than_four_times_the_reads() {
    for method in [Method::Exact, Method::Steep, Method::Cone] {
        let image = render(&floor(method, EYE, SIDE), SIDE, SIDE);
        let horizon = image.cost.as_ref().expect("asked for").iter().position(|cost| cost[0] > 0.0).expect("a floor");
        let first = horizon / SIDE as usize + 2;
        let (far, near) = (mean_cost(&image, first..first + 8), mean_cost(&image, SIDE as usize - 24..SIDE as usize));
        println!("{}: {far:.0} far away, {near:.0} near", method.name());
        assert!(far < 4.0 * near, "{}: {far} {near}", method.name());
    }
}

fn luminance(color: [f32; 4]) -> f64 {
    color[..3].iter().map(|c| f64::from(*c)).sum::<f64>() / 3.0
}

fn seen(scene: &RenderScene) -> Vec<f64> {
    render(scene, SIDE, SIDE).color.into_iter().map(luminance).collect()
}

/// Bright pixels below the horizon: what lies behind the floor.
fn holes(levels_meet: bool) -> usize {
    let mut scene = floor(Method::Exact, EYE, SIDE);
    scene.meshes[0] = render_mesh(&meshes::plane(if levels_meet { 32 } else { 2 }));
    scene.lighting.background = [LEAK; 3];
    scene.relief.silhouettes = Silhouettes::Shell;
    let seen = seen(&scene);
    seen[46 * SIDE as usize..].iter().filter(|color| **color > 0.25 * f64::from(LEAK)).count()
}

#[test]
fn prisms_whose_levels_differ_leave_few_holes() {
    let found = [true, false].map(holes);
    assert!(found[0] <= 4 && found[1] == 0, "{found:?}");
}
