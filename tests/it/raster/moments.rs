//! Normals that keep their scatter when they are filtered: the device against the twins, light that is neither made nor
//! lost, and highlights from afar against a mean of many samples.

use std::{f32::consts::TAU, sync::Arc};

use displace_glsl::layout::raster::{MAP_NORMAL, MAP_NORMAL_MOMENTS};
use displace_server::domain::{
    detail::Wrap,
    environment::Environment,
    image::{ColorMap, Filter, ImagePlan, RenderLight, RenderMap, RenderMaterial, RenderScene, Shading},
    maps::SlopeMaps,
    request::Shadows,
};
use displace_tests::meshes;

use super::{
    differing,
    looks::{assert_agrees, sky, still_life},
    plan, render, render_plan,
    scenes::{Builder, IDENTITY, render_mesh, view_camera},
};

/// Slopes and moments in the place of all normal maps.
fn with_moments(mut scene: RenderScene) -> RenderScene {
    for material in &mut scene.materials {
        let Some(normals) = material.maps[MAP_NORMAL].take() else { continue };
        let SlopeMaps { slopes, moments } = SlopeMaps::of_normals(&normals.map, normals.wrap);
        material.maps[MAP_NORMAL] = Some(RenderMap { map: Arc::new(slopes), ..normals.clone() });
        material.maps[MAP_NORMAL_MOMENTS] = Some(RenderMap { map: Arc::new(moments), ..normals });
    }
    RenderScene { shading: Shading::Pbr, ..scene }
}

#[test]
fn light_of_many_normals_is_that_of_the_twins() {
    let mut scene = with_moments(still_life());
    for filter in [Filter::Trilinear, Filter::Ewa] {
        scene.filter = filter;
        assert_agrees(&scene, 3e-3, "lights");
    }
    scene.shadows = Shadows::Ray;
    assert_agrees(&scene, 3e-3, "lights that cast shadows");
    scene.lighting.environment = Some(Arc::new(sky()));
    assert_agrees(&scene, 5e-3, "lights and sky");
}

#[test]
fn a_flat_normal_map_scatters_nothing() {
    let mut scene = RenderScene { shading: Shading::Pbr, ..still_life() };
    let flat = ColorMap { width: 4, height: 4, texels: vec![[0.0, 0.0, 1.0, 1.0]; 16] };
    for normals in scene.materials.iter_mut().filter_map(|material| material.maps[MAP_NORMAL].as_mut()) {
        normals.map = Arc::new(flat.clone());
    }
    scene.lighting.environment = Some(Arc::new(sky()));
    let (one, many) = (render(&scene, 96, 96), render(&with_moments(scene.clone()), 96, 96));
    assert_eq!(differing(&one, &many, 1e-4), 0);
}

/// Waves of random direction and phase, whole ones over the map: slopes are nearly Gaussian, 0.15 along either axis.
fn waves(side: u32) -> ColorMap {
    let wave = |k: u32| {
        let turn = 2.4 * k as f32;
        let length = 6.0 + 18.0 * (0.618 * k as f32).fract();
        ((length * turn.cos()).round(), (length * turn.sin()).round(), TAU * (0.755 * k as f32).fract())
    };
    let waves: Vec<_> = (0..40).map(wave).collect();
    let scale = 0.15 * (4.0 / waves.len() as f32).sqrt();
    let texel = |i: u32| {
        let (x, y) = ((i % side) as f32 / side as f32, (i / side) as f32 / side as f32);
        let sum = waves.iter().fold([0.0; 2], |[a, b], (u, v, phase)| {
            let slope = scale * (TAU * (u * x + v * y) + phase).sin() / u.hypot(*v);
            [a + u * slope, b + v * slope]
        });
        [sum[0], sum[1], 1.0, 1.0]
    };
    ColorMap { width: side, height: side, texels: (0..side * side).map(texel).collect() }
}

fn waved(metallic: f32, roughness: f32, tiles: f32) -> RenderMaterial {
    let mut material = RenderMaterial {
        base_color_factor: [1.0; 4],
        metallic_factor: metallic,
        roughness_factor: roughness,
        normal_scale: 1.0,
        occlusion_strength: 1.0,
        double_sided: true,
        ..RenderMaterial::default()
    };
    material.maps[MAP_NORMAL] = Some(RenderMap {
        map: Arc::new(waves(128)),
        uv_channel: 0,
        map_from_uv: [[tiles, 0.0, 0.3], [0.0, tiles, 0.1]],
        wrap: [Wrap::Repeat; 2],
    });
    material
}

/// A plane that fills the image, with tangents along u.
fn plane_from(eye: [f32; 3], material: RenderMaterial) -> RenderScene {
    let mut builder = Builder::lit(view_camera(eye, [0.0; 3], 20.0, 64, 64));
    let mut plane = render_mesh(&meshes::plane(1));
    plane.tangents = Arc::new(vec![[1.0, 0.0, 0.0, 1.0]; 6]);
    let mut large = IDENTITY;
    (large[0], large[10]) = (8.0, 8.0);
    builder.add(plane, material, large);
    let mut scene = builder.finish();
    (scene.shading, scene.lighting.ambient) = (Shading::Pbr, 0.0);
    scene.lighting.lights = Vec::new();
    scene
}

/// White surfaces vanish in white light from everywhere, however many normals a pixel covers.
#[test]
fn no_light_is_made_or_lost_where_normals_scatter() {
    let white = Environment { width: 8, height: 4, texels: vec![[1.0; 3]; 32] };
    for (metallic, roughness) in [(1.0, 0.1), (1.0, 0.6), (0.0, 0.3)] {
        let mut scene = with_moments(plane_from([0.0, 5.0, 4.0], waved(metallic, roughness, 40.0)));
        for environment in [None, Some(Arc::new(white.clone()))] {
            scene.lighting.ambient = if environment.is_none() { 1.0 } else { 0.0 };
            scene.lighting.environment = environment;
            let image = render(&scene, 64, 64);
            let off = image.color.iter().flat_map(|c| &c[..3]).map(|c| (c - 1.0).abs()).fold(0.0, f32::max);
            assert!(off < 0.01, "metallic {metallic}, roughness {roughness}: {off}");
        }
    }
}

/// Mean of what red shows.
fn mean(scene: &RenderScene, supersample: u32) -> f64 {
    let image = render_plan(scene, &ImagePlan { supersample, ..plan(scene, 64, 64) });
    image.color.iter().map(|c| f64::from(c[0])).sum::<f64>() / image.color.len() as f64
}

/// The highlight of a sun and of a point, from where pixels cover a quarter of a map and more.
#[test]
fn highlights_from_afar_are_as_bright_as_a_mean_of_256_samples_is() {
    for (eye, sun) in [([0.0, 8.0, 0.1], [0.1, 1.0, 0.05]), ([0.0, 6.0, 6.0], [0.05, 1.0, -1.0])] {
        let mut scene = plane_from(eye, waved(1.0, 0.3, 80.0));
        let length = sun.iter().map(|x: &f32| x * x).sum::<f32>().sqrt();
        scene.lighting.lights = vec![RenderLight::sun(sun.map(|x| x / length))];
        let without = mean(&scene, 1);
        let truth = mean(&RenderScene { filter: Filter::Bilinear, ..scene.clone() }, 8);
        let moments = mean(&with_moments(scene), 1);
        println!("{truth:.4}: moments {moments:.4}, without {without:.4}");
        assert!((moments / truth - 1.0).abs() < 0.03, "{moments} for {truth}");
        assert!((without / truth - 1.0).abs() > 0.2, "{without} for {truth}");
    }
}
