//! Reflection mapping: against its twin, against traced mirrors, and how far off it is with and without the box of the room.

use std::sync::Arc;

use displace_server::{
    domain::{
        cancel::{Cancel, NoProgress},
        image::{ImageSet, Lighting, Reflector, RenderMaterial, RenderMesh, RenderScene, Shading},
    },
    oracle::image::{Exposure, OracleScene, render as trace},
};
use displace_tests::meshes;

use super::{
    differing, reference, render,
    scenes::{Builder, IDENTITY, render_mesh, view_camera},
};

const MIRROR: u32 = 6;

/// Inside of a box from -2 to 2, 1.5 high from -1, each wall with a colour of its own that shines by itself, and a mirror
/// ball of radius 0.5 away from its middle.
fn room() -> RenderScene {
    let mut builder = Builder::lit(view_camera([1.5, 0.8, 1.7], [-0.3, -0.2, -0.3], 60.0, 96, 96));
    let cube = meshes::cube();
    for face in 0..6usize {
        let triangles = cube.triangles[2 * face..2 * face + 2].to_vec();
        let share = |k: usize| 0.2 + 0.13 * ((face * (k + 2) + k) % 6) as f32;
        let mesh = RenderMesh { triangles: Arc::new(triangles), ..render_mesh(&cube) };
        let emissive_factor = [share(0), share(1), share(2)];
        let material = RenderMaterial { emissive_factor, double_sided: true, ..RenderMaterial::default() };
        let mut walls = IDENTITY;
        (walls[0], walls[5], walls[10], walls[13]) = (4.0, 2.5, 4.0, 0.25);
        builder.add(mesh, material, walls);
    }
    let mut ball = IDENTITY;
    (ball[0], ball[5], ball[10], ball[12], ball[13], ball[14]) = (0.5, 0.5, 0.5, -0.4, -0.3, 0.2);
    let mirror = RenderMaterial { base_color_factor: [1.0; 4], metallic_factor: 1.0, ..RenderMaterial::default() };
    builder.add(render_mesh(&meshes::icosphere(5)), mirror, ball);
    let mut scene = builder.finish();
    scene.lighting = Lighting { lights: Vec::new(), environment: None, ambient: 0.0, background: [0.0; 3] };
    scene.shading = Shading::Pbr;
    scene
}

fn mapped(in_room: bool, size_px: u32) -> RenderScene {
    RenderScene { reflectors: vec![Reflector { material: MIRROR, size_px, in_room }], ..room() }
}

fn traced(bounces: u32) -> ImageSet {
    let scene = OracleScene { bounces, ..OracleScene::from(&room()) };
    let exposure = Exposure { width: 96, height: 96, samples: 16, shadows: false };
    trace(&scene, &exposure, &Cancel::default(), &NoProgress).expect("traces")
}

/// Root mean square over the pixels of the ball, without its rim.
fn off(image: &ImageSet, expected: &ImageSet) -> f64 {
    let ids = image.triangle.as_ref().expect("asked for");
    let is_ball = |i: usize| ids.get(i).is_some_and(|id| (12..u32::MAX).contains(id));
    let around = |i: usize| [0, 1, 2, 96, 97, 98, 192, 193, 194].map(|k| i + k - 97);
    let ball: Vec<usize> = (97..ids.len()).filter(|i| around(*i).into_iter().all(is_ball)).collect();
    assert!(ball.len() > 300, "{}", ball.len());
    let square = |i: &usize| (0..3).map(|k| f64::from(image.color[*i][k] - expected.color[*i][k]).powi(2)).sum::<f64>();
    (ball.iter().map(square).sum::<f64>() / (3 * ball.len()) as f64).sqrt()
}

#[test]
fn what_a_reflector_shows_agrees_with_its_twin() {
    for (in_room, shading) in
        [(false, Shading::Pbr), (true, Shading::Pbr), (true, Shading::Phong), (false, Shading::Flat)]
    {
        let scene = RenderScene { shading, ..mapped(in_room, 32) };
        let apart = differing(&render(&scene, 96, 96), &reference(&scene, 96, 96), 1e-2);
        assert!(apart <= 92, "{apart} pixels: {shading:?}, {in_room}");
    }
}

#[test]
fn in_a_room_of_walls_alone_the_box_makes_mapped_mirrors_those_that_rays_follow() {
    let traced = traced(1);
    let [boxed, endless] = [true, false].map(|in_room| off(&render(&mapped(in_room, 256), 96, 96), &traced));
    // Walls differ by up to 0.65 where they meet, which a texel and a pixel blur.
    assert!(boxed < 0.04, "{boxed} with the box");
    assert!(endless > 2.0 * boxed, "{endless} without, {boxed} with the box");
}

#[test]
fn without_a_bounce_or_a_map_a_mirror_is_black() {
    let (none, black) = (traced(0), render(&room(), 96, 96));
    let ids = black.triangle.as_ref().expect("asked for");
    let sum = |image: &ImageSet, i: usize| image.color[i][..3].iter().sum::<f32>();
    let middle = (0..ids.len()).find(|i| {
        let inside = |j: usize| (12..u32::MAX).contains(&ids[j]);
        [*i, i + 1, i + 2, i + 96, i + 192, i + 98].into_iter().all(|j| ids.get(j).is_some() && inside(j))
    });
    let middle = middle.expect("the ball is seen") + 97;
    assert_eq!((sum(&none, middle), sum(&black, middle)), (0.0, 0.0));
}

#[test]
fn two_mirrors_show_each_other_by_rays_and_not_by_maps() {
    // A second ball beside the first: its reflection in the first is black where one bounce ends.
    let mut scene = mapped(true, 64);
    let mut beside = scene.instances[MIRROR as usize];
    (beside.world_from_mesh[12], beside.world_from_mesh[14]) = (0.75, 0.2);
    beside.mesh = scene.meshes.len();
    let mut mesh = scene.meshes[MIRROR as usize].clone();
    mesh.material_of_triangles = vec![(0, 7)];
    scene.meshes.push(mesh);
    scene.materials.push(scene.materials[MIRROR as usize].clone());
    scene.instances.push(beside);
    scene.reflectors.push(Reflector { material: 7, size_px: 64, in_room: true });
    let exposure = Exposure { width: 96, height: 96, samples: 4, shadows: false };
    let dark = |image: &ImageSet| image.color.iter().filter(|c| c[..3].iter().sum::<f32>() < 0.05).count();
    let by_rays = [1, 2, 4].map(|bounces| {
        let scene = OracleScene { bounces, ..OracleScene::from(&scene) };
        dark(&trace(&scene, &exposure, &Cancel::default(), &NoProgress).expect("traces"))
    });
    let by_maps = dark(&render(&scene, 96, 96));
    assert!(by_rays[0] > 20 && by_rays[1] < by_rays[0] / 2 && by_rays[2] == 0, "{by_rays:?}");
    assert!(by_maps > 20, "{by_maps}");
}
