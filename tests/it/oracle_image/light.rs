//! The renderer's light against the oracle's: the metallic-roughness model, and surroundings.

use std::sync::Arc;

use displace_server::{
    domain::{
        cancel::{Cancel, NoProgress},
        environment::Environment,
        image::{ImageSet, Lighting, RenderLight, RenderMaterial, RenderMesh, RenderScene, Shading},
    },
    oracle::image::{Exposure, OracleScene, render},
};
use displace_tests::{device, meshes};

use super::IDENTITY;
use crate::raster::{
    self,
    scenes::{Builder, material, pixel_camera, render_mesh, view_camera},
};

/// Tiles each way, and pixels of one.
const TILES: [u32; 2] = [10, 7];
const TILE_PX: u32 = 8;

fn traced(scene: &RenderScene, [width, height]: [u32; 2], samples: u32) -> ImageSet {
    let exposure = Exposure { width, height, samples, shadows: false };
    render(&OracleScene::from(scene), &exposure, &Cancel::default(), &NoProgress).expect("renders")
}

fn with_roughness(color: [f32; 3], metallic: f32, roughness: f32) -> RenderMaterial {
    RenderMaterial {
        metallic_factor: metallic,
        roughness_factor: roughness,
        emissive_factor: [0.0, 0.01, 0.0],
        ..material(color, None)
    }
}

/// Tiles that parallel rays see, each of one material and one normal: rougher to the right, tilted more downwards,
/// dielectrics, metals and mixtures in turn.
fn tiles(lighting: Lighting) -> RenderScene {
    let [columns, rows] = TILES;
    let mut builder = Builder::lit(pixel_camera(columns * TILE_PX, rows * TILE_PX));
    for k in 0..columns * rows {
        let (i, j) = (k % columns, k / columns);
        let corner = |dx: u32, dy: u32| [((i + dx) * TILE_PX) as f32, ((j + dy) * TILE_PX) as f32, 0.5];
        let (tilt, turn) = (1.4 * j as f32 / (rows - 1) as f32, 2.4 * k as f32);
        let normal = [tilt.sin() * turn.cos(), tilt.sin() * turn.sin(), tilt.cos()];
        let mesh = RenderMesh {
            positions: Arc::new(vec![corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)]),
            normals: Arc::new(vec![normal; 4]),
            uvs: Arc::new(vec![[0.0; 2]; 4]),
            triangles: Arc::new(vec![[0, 2, 1], [0, 3, 2]]),
            ..RenderMesh::default()
        };
        let roughness = i as f32 / (columns - 1) as f32;
        builder.add(mesh, with_roughness([0.9, 0.5, 0.2], ((i + j) % 3) as f32 / 2.0, roughness), IDENTITY);
    }
    RenderScene { lighting, shading: Shading::Pbr, ..builder.finish() }
}

/// Of each tile's middle, largest over colours, over what is expected and a tenth.
fn differences(image: &ImageSet, expected: &ImageSet) -> Vec<f64> {
    let width = TILES[0] * TILE_PX;
    let middle = |k: u32| {
        let at = |tile: u32| tile * TILE_PX + TILE_PX / 2;
        (at(k / TILES[0]) * width + at(k % TILES[0])) as usize
    };
    let off = |i: usize| {
        assert!(expected.normal.as_ref().expect("asked for")[i][2] > 0.0, "the front is seen");
        (0..3).map(move |k| f64::from((image.color[i][k] - expected.color[i][k]).abs() / (expected.color[i][k] + 0.1)))
    };
    (0..TILES[0] * TILES[1]).map(|k| off(middle(k)).fold(0.0, f64::max)).collect()
}

fn size() -> [u32; 2] {
    TILES.map(|tiles| tiles * TILE_PX)
}

fn lamps() -> Lighting {
    let mut lamp = RenderLight::point([40.0, 30.0, 50.0]);
    lamp.color = [4000.0, 3000.0, 2000.0];
    Lighting { lights: vec![RenderLight::sun([0.36, -0.48, 0.8]), lamp], ..Lighting::default() }
}

fn assert_lamps_agree(image: &ImageSet) {
    let off = differences(image, &traced(&tiles(lamps()), size(), 16));
    let worst = off.iter().fold(0.0, |most, off| f64::max(most, *off));
    // Both have the same formula; the renderer reads its table of albedo along lines, the oracle one of its own.
    assert!(worst < 4e-3, "{worst} of {off:?}");
}

#[test]
fn the_reference_has_the_oracles_metallic_roughness_model() {
    assert_lamps_agree(&raster::reference(&tiles(lamps()), size()[0], size()[1]));
}

#[test]
fn the_renderer_has_the_oracles_metallic_roughness_model() {
    if device::without_gpu("the metallic-roughness model of the renderer against the oracle") {
        return;
    }
    assert_lamps_agree(&raster::render(&tiles(lamps()), size()[0], size()[1]));
}

/// Blue above, brown below, brighter to one side, and a sun of four texels.
fn surroundings() -> Lighting {
    let (width, height) = (128, 64);
    let texel = |k: u32| {
        let (turn, tilt) =
            (std::f32::consts::TAU * (k % width) as f32 / width as f32, (k / width) as f32 / height as f32);
        if (20..22).contains(&(k / width)) && (90..92).contains(&(k % width)) {
            return [100.0, 90.0, 70.0];
        }
        let side = 1.0 + 0.5 * turn.cos() * (std::f32::consts::PI * tilt).sin();
        [0.4 + 0.3 * tilt, 0.5, 0.9 - 0.7 * tilt].map(|c| c * side)
    };
    let map = Environment { width, height, texels: (0..width * height).map(texel).collect() };
    Lighting { lights: Vec::new(), environment: Some(Arc::new(map)), ambient: 0.0, ..Lighting::default() }
}

#[test]
fn tiles_under_surroundings_are_nearly_the_integral_over_the_sky() {
    let scene = tiles(surroundings());
    let off = differences(&raster::reference(&scene, size()[0], size()[1]), &traced(&scene, size(), 64));
    let (worst, mean) =
        (off.iter().fold(0.0, |most: f64, off| most.max(*off)), off.iter().sum::<f64>() / off.len() as f64);
    // Lobes are seen through 32 samples, and a sun of four texels lies in some of them; the oracle's rays have noise too.
    assert!(worst < 0.15 && mean < 0.02, "{off:?}");
}

/// A torus of metal and a plane.
fn still(shading: Shading) -> RenderScene {
    let mut builder = Builder::lit(view_camera([1.5, 1.2, 2.0], [0.0; 3], 45.0, 160, 120));
    builder.add(render_mesh(&meshes::torus(192, 96)), with_roughness([0.9, 0.6, 0.3], 1.0, 0.3), IDENTITY);
    builder.add(render_mesh(&meshes::plane(4)), with_roughness([0.2, 0.6, 0.9], 0.0, 0.5), IDENTITY);
    RenderScene { lighting: surroundings(), shading, ..builder.finish() }
}

fn mean_difference(a: &ImageSet, b: &ImageSet) -> f64 {
    let off = |(a, b): (&[f32; 4], &[f32; 4])| (0..3).map(|k| f64::from((a[k] - b[k]).abs())).fold(0.0, f64::max);
    a.color.iter().zip(&b.color).map(off).sum::<f64>() / a.color.len() as f64
}

fn assert_surroundings_agree(render: impl Fn(&RenderScene) -> ImageSet) {
    let bounds = [(Shading::Pbr, 0.03), (Shading::Phong, 0.015), (Shading::Gouraud, 0.015), (Shading::Flat, 0.015)];
    for (shading, bound) in bounds {
        let scene = still(shading);
        let expected = traced(&scene, [160, 120], 64);
        let light = expected.color.iter().map(|c| f64::from(c[0] + c[1] + c[2])).sum::<f64>() / 3.0 / 19_200.0;
        let mean = mean_difference(&render(&scene), &expected);
        // Edges are four samples, and mirrors and lobes see levels of the sky's map; the oracle's rays have noise.
        assert!(mean < bound * light, "{shading:?}: {mean} of {light}");
    }
}

#[test]
fn surroundings_of_the_reference_are_nearly_those_of_the_oracle() {
    assert_surroundings_agree(|scene| raster::reference(scene, 160, 120));
}

#[test]
fn surroundings_of_the_renderer_are_nearly_those_of_the_oracle() {
    if device::without_gpu("surroundings of the renderer against the oracle") {
        return;
    }
    assert_surroundings_agree(|scene| raster::render(scene, 160, 120));
}
