//! What surfaces look like under every kind of light: the device against the f64 twins, and what must hold whatever
//! the scene.

use std::sync::Arc;

use displace_glsl::layout::raster::{MAP_BASE_COLOR, MAP_EMISSIVE, MAP_METALLIC_ROUGHNESS, MAP_NORMAL, MAP_OCCLUSION};
use displace_server::domain::{
    detail::Wrap,
    environment::Environment,
    image::{
        ColorMap, Filter, ImagePlan, LightShape, Lighting, RenderAlpha, RenderLight, RenderMap, RenderMaterial,
        RenderScene, Shading,
    },
    request::Shadows,
};
use displace_tests::meshes;
use rand::{RngExt as _, SeedableRng, rngs::StdRng};

use super::{
    differing, plan, reference, render, render_plan,
    scenes::{Builder, IDENTITY, checker, render_mesh, view_camera},
};

/// Random texels from `low` to `high`, blurred enough to be smooth over a texel.
fn noise(seed: u64, side: u32, low: [f32; 4], high: [f32; 4]) -> Arc<ColorMap> {
    let mut random = StdRng::seed_from_u64(seed);
    let texel = |_| std::array::from_fn(|k| random.random_range(low[k]..=high[k]));
    Arc::new(ColorMap { width: side, height: side, texels: (0..side * side).map(texel).collect() })
}

fn used(map: Arc<ColorMap>) -> Option<RenderMap> {
    let map_from_uv = [[2.0, 0.3, 0.1], [-0.2, 2.5, -0.3]];
    Some(RenderMap { map, uv_channel: 0, map_from_uv, wrap: [Wrap::Repeat, Wrap::Mirror] })
}

/// Every kind of map.
pub(crate) fn rich() -> RenderMaterial {
    let mut material = RenderMaterial {
        base_color_factor: [0.9, 0.8, 0.7, 1.0],
        metallic_factor: 0.8,
        roughness_factor: 0.9,
        emissive_factor: [0.2, 0.1, 0.05],
        normal_scale: 0.7,
        occlusion_strength: 0.6,
        double_sided: true,
        ..RenderMaterial::default()
    };
    material.maps[MAP_BASE_COLOR] = used(checker(16, 16));
    material.maps[MAP_NORMAL] = used(noise(1, 8, [-0.5, -0.5, 0.7, 1.0], [0.5, 0.5, 1.0, 1.0]));
    material.maps[MAP_METALLIC_ROUGHNESS] = used(noise(2, 8, [0.0, 0.2, 0.0, 1.0], [1.0; 4]));
    material.maps[MAP_OCCLUSION] = used(noise(3, 8, [0.2; 4], [1.0; 4]));
    material.maps[MAP_EMISSIVE] = used(noise(4, 8, [0.0; 4], [1.0; 4]));
    material
}

/// A ball with every kind of map over a plane, with tangents made by hand, under a sun, a lamp and a spot.
pub(super) fn still_life() -> RenderScene {
    let mut builder = Builder::lit(view_camera([1.5, 1.6, 3.0], [0.0, 0.0, 0.0], 45.0, 96, 96));
    let mut ball = render_mesh(&meshes::uv_sphere(24, 12));
    let corners = ball.triangles.iter().flatten().map(|&v| {
        let [x, _, z] = ball.normals[v as usize];
        let length = x.hypot(z).max(1e-3);
        [z / length, 0.0, -x / length, 1.0]
    });
    ball.tangents = Arc::new(corners.collect());
    builder.add(ball, rich(), IDENTITY);
    let mut ground = IDENTITY;
    (ground[0], ground[10], ground[13]) = (4.0, 4.0, -1.0);
    let plain = RenderMaterial {
        base_color_factor: [0.5, 0.6, 0.7, 1.0],
        roughness_factor: 0.4,
        metallic_factor: 0.0,
        ..RenderMaterial::default()
    };
    builder.add(render_mesh(&meshes::plane(4)), plain, ground);
    let mut scene = builder.finish();
    scene.lighting.lights = vec![
        RenderLight::sun([0.48, 0.6, 0.64]),
        RenderLight::point([-1.5, 1.0, 1.5]),
        RenderLight {
            shape: LightShape::Spot {
                position_world: [1.0, 3.0, 1.0],
                range_world: Some(9.0),
                direction_world: [-0.301_511_35, -0.904_534_04, -0.301_511_35],
                cone_cosines: [0.95, 0.8],
            },
            color: [9.0, 6.0, 3.0],
            radius: 0.0,
        },
    ];
    scene
}

/// A gradient with a small bright sun in it.
pub(super) fn sky() -> Environment {
    let (width, height) = (64u32, 32u32);
    let texel = |i: u32| {
        let (x, y) = (i % width, i / width);
        let up = 1.0 - y as f32 / height as f32;
        if (x, y) == (20, 8) { [60.0, 50.0, 40.0] } else { [0.3 * up, 0.2 + 0.3 * up, 0.3 + 0.01 * (x % 7) as f32] }
    };
    Environment { width, height, texels: (0..width * height).map(texel).collect() }
}

/// Pixels where rounding decides what is seen, or whether a light is, may differ: a hundredth of them.
pub(super) fn assert_agrees(scene: &RenderScene, tolerance: f32, what: &str) {
    let (image, expected) = (render(scene, 96, 96), reference(scene, 96, 96));
    let apart = differing(&image, &expected, tolerance);
    assert!(apart <= 92, "{what}: {apart} pixels");
    let lit = image.color.iter().filter(|c| c[0] > 0.06).count();
    assert!(lit > 2000, "{what}: {lit} pixels are lit");
}

#[test]
fn every_shading_agrees_with_its_twin() {
    for shading in [Shading::Flat, Shading::Gouraud, Shading::Phong, Shading::Pbr] {
        assert_agrees(&RenderScene { shading, ..still_life() }, 2e-3, &format!("{shading:?}"));
    }
}

#[test]
fn every_shading_agrees_with_its_twin_under_an_environment() {
    for shading in [Shading::Flat, Shading::Gouraud, Shading::Phong, Shading::Pbr] {
        let mut scene = RenderScene { shading, ..still_life() };
        scene.lighting = Lighting { environment: Some(Arc::new(sky())), ambient: 0.0, ..scene.lighting };
        assert_agrees(&scene, 1e-2, &format!("{shading:?}"));
    }
}

#[test]
fn every_filter_agrees_with_its_twin() {
    for filter in [Filter::Nearest, Filter::Bilinear, Filter::Trilinear, Filter::Anisotropic, Filter::Ewa] {
        assert_agrees(&RenderScene { filter, ..still_life() }, 2e-2, &format!("{filter:?}"));
    }
}

#[test]
fn shadows_by_rays_agree_with_their_twin_and_fall_on_the_ground() {
    let scene = RenderScene { shadows: Shadows::Ray, ..still_life() };
    assert_agrees(&scene, 2e-3, "shadows");
    let mut side = scene;
    side.lighting.lights = vec![RenderLight::sun([-0.8, 0.6, 0.0])];
    let shadowed = render(&side, 96, 96);
    let open = render(&RenderScene { shadows: Shadows::None, ..side }, 96, 96);
    let darker = |(a, b): (&[f32; 4], &[f32; 4])| a[0] < 0.7 * b[0];
    let count = shadowed.color.iter().zip(&open.color).filter(|pair| darker(*pair)).count();
    assert!(count > 100, "{count} pixels are in shadow");
}

#[test]
fn a_ball_does_not_shadow_where_light_meets_it() {
    // Facets of a smooth ball darken only near the rim of the light, where they turn away before its normals do.
    let mut builder = Builder::lit(view_camera([0.0, 0.0, 4.0], [0.0; 3], 40.0, 96, 96));
    builder.mesh(&meshes::icosphere(4), [0.8; 3]);
    let mut scene = builder.finish();
    scene.lighting.lights = vec![RenderLight::sun([0.0, 0.6, 0.8])];
    let open = render(&scene, 96, 96);
    let shadowed = render(&RenderScene { shadows: Shadows::Ray, ..scene }, 96, 96);
    let normals = open.normal.as_ref().expect("asked for");
    for (i, n) in normals.iter().enumerate() {
        let cosine = 0.6 * n[1] + 0.8 * n[2];
        if cosine > 0.1 {
            assert_eq!(open.color[i], shadowed.color[i], "pixel {i}, cosine {cosine}");
        }
    }
}

#[test]
fn holes_of_a_fence_let_light_through() {
    let mut builder = Builder::lit(view_camera([0.0, 3.0, 0.01], [0.0; 3], 40.0, 96, 96));
    let mut fence = RenderMaterial { base_color_factor: [1.0; 4], double_sided: true, ..RenderMaterial::default() };
    fence.maps[MAP_BASE_COLOR] = used(checker(16, 16));
    fence.alpha = RenderAlpha::Mask { cutoff: 0.5 };
    let mut raised = IDENTITY;
    (raised[0], raised[10], raised[13]) = (0.5, 0.5, 0.5);
    builder.add(render_mesh(&meshes::plane(1)), fence, raised);
    let ground = RenderMaterial { base_color_factor: [0.5, 0.5, 0.5, 1.0], ..RenderMaterial::default() };
    builder.add(render_mesh(&meshes::plane(1)), ground, IDENTITY);
    let mut scene = RenderScene { shadows: Shadows::Ray, ..builder.finish() };
    scene.lighting.lights = vec![RenderLight::sun([0.6, 0.8, 0.0])];
    let (image, expected) = (render(&scene, 96, 96), reference(&scene, 96, 96));
    let apart = differing(&image, &expected, 2e-3);
    assert!(apart <= 92, "{apart} pixels");
}

#[test]
fn more_samples_average_a_finer_image() {
    let scene = still_life();
    let fine = render(&scene, 192, 192);
    let plan = ImagePlan { supersample: 2, ..plan(&scene, 96, 96) };
    let image = render_plan(&scene, &plan);
    for (i, color) in image.color.iter().enumerate() {
        let (x, y) = (i % 96 * 2, i / 96 * 2);
        let square = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(a, b)| fine.color[(y + b) * 192 + x + a]);
        for (k, color) in color.iter().enumerate().take(3) {
            let sum: f32 = square.iter().map(|c| c[k]).sum();
            assert!((color - 0.25 * sum).abs() <= 1e-6 * sum.max(1.0), "pixel {i}");
        }
        let triangle = |image: &Option<Vec<u32>>, i: usize| image.as_ref().expect("asked for")[i];
        assert_eq!(triangle(&image.triangle, i), triangle(&fine.triangle, (y + 1) * 192 + x + 1));
    }
}

#[test]
fn an_environment_is_seen_behind_everything() {
    let mut scene = Builder::lit(view_camera([0.0; 3], [1.0, 0.0, 0.0], 60.0, 64, 64)).finish();
    scene.lighting.environment = Some(Arc::new(sky()));
    let (image, expected) = (render(&scene, 64, 64), reference(&scene, 64, 64));
    assert_eq!(differing(&image, &expected, 1e-4), 0);
    // +x is in the middle of the map.
    let middle = &sky().texels[16 * 64 + 31..16 * 64 + 33];
    let found = image.color[32 * 64 + 32];
    assert!((found[1] - middle[0][1]).abs() < 0.02, "{found:?} for {middle:?}");
}
