//! Bumps that are smaller than a pixel.

use std::{f32::consts::TAU, sync::Arc};

use displace_glsl::layout::raster::{MAP_NORMAL, MAP_NORMAL_MOMENTS};

use super::{
    images,
    lab::Lab,
    meshes, outlines,
    row::{Asset, Row, curve},
};
use crate::domain::{
    Result,
    detail::Wrap,
    image::{ColorMap, Lighting, RenderLight, RenderMap, RenderMaterial, RenderScene, Shading},
    maps::SlopeMaps,
    stability::{Curve, Worse},
};

pub(super) const ROW: Row = Row {
    name: "highlights",
    family: "mip: far camera, noise normals",
    title: "Highlights of bumps smaller than a pixel",
    story: "From afar a pixel covers many bumps, and the mean of their normals is that of a smooth surface: its highlight is narrow, and beside the mirror's \
            way there is none where there should be glitter. Second moments of slopes keep how normals scatter. Energy of the whole image, seen \
            off the mirror's way, against 256 times as many pixels.",
    asset: Asset::Made("a metal plane under noise of slopes of 0.15, seen from above at 48 x 48 pixels"),
    parameter: ["texels to a pixel", "texels"],
    metric: ["energy of the highlight off by", "%"],
    line: 20.0,
    worse: Worse::Upwards,
    literature: &[
        ("normal map", "loses roughness from one texel to a pixel on (Toksvig 2005; Olano and Baker 2010)"),
        ("normal map, moments", "keeps it where slopes are nearly Gaussian (Olano and Baker 2010)"),
    ],
    run,
};

const TEXELS_PER_PIXEL: [f64; 5] = [0.5, 1.0, 2.0, 4.0, 8.0];
const SIDE: u32 = 48;
/// Of the truth, along either side.
const FINER: u32 = 16;
const TEXELS: u32 = 128;
/// Sides of plane and pixel, world units.
const PLANE: f32 = 8.0;
const ABOVE: f32 = 8.0;
const FOV_DEGREES: f32 = 20.0;

fn run(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    let (mut plain, mut moments) = (Vec::new(), Vec::new());
    for texels in TEXELS_PER_PIXEL {
        let scene = plane(texels)?;
        let truth = energy(lab, &scene, FINER)?;
        let off = |energy: f64| 100.0 * (energy / truth - 1.0).abs();
        plain.push([texels, off(energy(lab, &scene, 1)?)]);
        moments.push([texels, off(energy(lab, &with_moments(scene), 1)?)]);
    }
    Ok(vec![curve("normal map", plain), curve("normal map, moments", moments)])
}

/// Mean of what red shows.
fn energy(lab: &Lab<'_>, scene: &RenderScene, supersample: u32) -> Result<f64> {
    let image = lab.supersampled(scene, [SIDE; 2], supersample)?;
    Ok(image.color.iter().map(|color| f64::from(color[0])).sum::<f64>() / image.color.len() as f64)
}

fn plane(texels_per_pixel: f64) -> Result<RenderScene> {
    let camera = images::camera([0.0, ABOVE, 0.1], [0.0; 3], FOV_DEGREES, [SIDE; 2])?;
    let mut mesh = outlines::base(&meshes::plane(1));
    mesh.tangents = Arc::new(vec![[1.0, 0.0, 0.0, 1.0]; 6]);
    let mut scene = images::scene(vec![mesh], camera);
    (scene.instances[0].world_from_mesh[0], scene.instances[0].world_from_mesh[10]) = (PLANE, PLANE);
    let pixel = 2.0 * ABOVE * (0.5 * FOV_DEGREES).to_radians().tan() / SIDE as f32;
    let tiles = texels_per_pixel as f32 * PLANE / (pixel * TEXELS as f32);
    scene.materials = vec![metal(tiles)];
    let toward = glam::Vec3::new(0.45, 1.0, 0.05).normalize().to_array();
    scene.lighting =
        Lighting { lights: vec![RenderLight::sun(toward)], environment: None, ambient: 0.0, background: [0.0; 3] };
    scene.shading = Shading::Pbr;
    Ok(scene)
}

fn metal(tiles: f32) -> RenderMaterial {
    let mut material = RenderMaterial {
        base_color_factor: [1.0; 4],
        metallic_factor: 1.0,
        roughness_factor: 0.25,
        unlit: false,
        ..images::grey()
    };
    material.maps[MAP_NORMAL] = Some(RenderMap {
        map: Arc::new(waves()),
        uv_channel: 0,
        map_from_uv: [[tiles, 0.0, 0.3], [0.0, tiles, 0.1]],
        wrap: [Wrap::Repeat; 2],
    });
    material
}

/// Waves of random direction and phase, whole ones over the map: slopes are nearly Gaussian, 0.15 along either axis.
fn waves() -> ColorMap {
    let wave = |k: u32| {
        let (turn, length) = (2.4 * k as f32, 6.0 + 18.0 * (0.618 * k as f32).fract());
        ((length * turn.cos()).round(), (length * turn.sin()).round(), TAU * (0.755 * k as f32).fract())
    };
    let waves: Vec<_> = (0..40).map(wave).collect();
    let scale = 0.15 * (4.0 / waves.len() as f32).sqrt();
    let texel = |i: u32| {
        let (x, y) = ((i % TEXELS) as f32 / TEXELS as f32, (i / TEXELS) as f32 / TEXELS as f32);
        let sum = waves.iter().fold([0.0; 2], |[a, b], (u, v, phase)| {
            let slope = scale * (TAU * (u * x + v * y) + phase).sin() / u.hypot(*v);
            [a + u * slope, b + v * slope]
        });
        [sum[0], sum[1], 1.0, 1.0]
    };
    ColorMap { width: TEXELS, height: TEXELS, texels: (0..TEXELS * TEXELS).map(texel).collect() }
}

fn with_moments(mut scene: RenderScene) -> RenderScene {
    for material in &mut scene.materials {
        let Some(normals) = material.maps[MAP_NORMAL].take() else { continue };
        let SlopeMaps { slopes, moments } = SlopeMaps::of_normals(&normals.map, normals.wrap);
        material.maps[MAP_NORMAL] = Some(RenderMap { map: Arc::new(slopes), ..normals.clone() });
        material.maps[MAP_NORMAL_MOMENTS] = Some(RenderMap { map: Arc::new(moments), ..normals });
    }
    scene
}
