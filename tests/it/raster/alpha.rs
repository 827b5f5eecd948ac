//! Alpha of materials: cut off, by chance, and in layers; the device against its twin and against closed forms.

use std::sync::Arc;

use displace_server::domain::image::{ImagePlan, RenderAlpha, RenderMaterial, RenderMesh, RenderScene};
use displace_tests::meshes;

use super::{
    differing, plan, reference, render, render_plan,
    scenes::{Builder, IDENTITY, LEAK, checker, material, pixel_camera, render_mesh, view_camera},
};

/// Colour and alpha of a surface.
type Layer = ([f32; 3], f32);

/// Two triangles over the whole of an image of up to 64 pixels, at a reversed depth.
fn quad(depth: f32) -> RenderMesh {
    let corners = [[-1.0, -2.0], [66.0, -1.5], [65.5, 67.0], [-3.0, 66.0]];
    RenderMesh {
        positions: Arc::new(corners.map(|[x, y]| [x, y, depth]).to_vec()),
        normals: Arc::new(vec![[0.0, 0.0, 1.0]; 4]),
        uvs: Arc::new(vec![[0.0; 2]; 4]),
        triangles: Arc::new(vec![[0, 1, 2], [0, 2, 3]]),
        ..RenderMesh::default()
    }
}

fn look((color, share): Layer, alpha: RenderAlpha) -> RenderMaterial {
    let mut material = material(color, None);
    material.base_color_factor[3] = share;
    material.alpha = alpha;
    material
}

/// Quads one behind the other, the nearest first, added in some order.
fn quads(layers: &[Layer], order: impl Iterator<Item = usize>, alpha: RenderAlpha) -> RenderScene {
    let mut builder = Builder::unlit(pixel_camera(32, 32));
    for k in order {
        let depth = 0.95 - 0.9 * k as f32 / layers.len() as f32;
        builder.add(quad(depth), look(layers[k], alpha), IDENTITY);
    }
    builder.finish()
}

/// What is seen and how likely: each layer, and what is behind all of them.
fn chances(layers: &[Layer]) -> Vec<(f64, [f64; 3])> {
    let mut passes = 1.0;
    let mut seen: Vec<_> = Vec::new();
    for (color, share) in layers {
        seen.push((passes * f64::from(*share), color.map(f64::from)));
        passes *= 1.0 - f64::from(*share);
    }
    seen.push((passes, [f64::from(LEAK); 3]));
    seen
}

/// Of each channel: c = sum of a_k c_k (1 - a_1) ... (1 - a_(k-1)).
fn blended(layers: &[Layer]) -> [f64; 3] {
    std::array::from_fn(|channel| chances(layers).iter().map(|(p, color)| p * color[channel]).sum())
}

const THREE: [Layer; 3] = [([1.0, 0.25, 0.0], 0.5), ([0.0, 0.5, 1.0], 0.3), ([0.5, 1.0, 0.75], 0.8)];

/// A sheet of waves whose map says its alpha, above a ground, before a sky of one colour.
fn waves(alpha: RenderAlpha) -> RenderScene {
    let mut builder = Builder::lit(view_camera([0.3, 1.3, 1.9], [0.0, -0.1, 0.0], 50.0, 96, 96));
    let mut sheet = material([1.0, 0.9, 0.8], Some(checker(16, 16)));
    sheet.base_color_factor[3] = 0.8;
    sheet.alpha = alpha;
    let mut mesh = render_mesh(&meshes::plane(40));
    let lifted = mesh.positions.iter().map(|&[x, _, z]| [x, 0.25 * (9.0 * x).sin() * (7.0 * z).cos(), z]);
    mesh.positions = Arc::new(lifted.collect());
    builder.add(mesh, sheet, IDENTITY);
    builder.mesh(&meshes::torus(32, 16), [0.3, 0.6, 0.2]);
    let mut ground = IDENTITY;
    (ground[0], ground[10], ground[13]) = (3.0, 3.0, -0.6);
    builder.add(render_mesh(&meshes::plane(2)), material([0.2, 0.3, 0.9], None), ground);
    builder.finish()
}

/// Pixels where rounding decides what is seen may differ: one in fifty.
fn assert_agrees(scene: &RenderScene, what: &str) {
    let (image, expected) = (render(scene, 96, 96), reference(scene, 96, 96));
    let apart = differing(&image, &expected, 2e-3);
    assert!(apart <= 96 * 96 / 50, "{what}: {apart} pixels");
}

#[test]
fn chance_agrees_with_its_twin() {
    assert_agrees(&waves(RenderAlpha::Stochastic), "by chance");
    let scene = quads(&THREE, 0..3, RenderAlpha::Stochastic);
    assert_eq!(differing(&render(&scene, 32, 32), &reference(&scene, 32, 32), 1e-6), 0);
}

#[test]
fn the_mean_of_chances_is_what_blending_gives() {
    for layers in [&THREE[..1], &THREE[..2], &THREE] {
        let scene = quads(layers, 0..layers.len(), RenderAlpha::Stochastic);
        let image = render_plan(&scene, &ImagePlan { supersample: 4, ..plan(&scene, 32, 32) });
        let samples = f64::from(32 * 32 * 4 * 4 * 4);
        let expected = blended(layers);
        for channel in 0..3 {
            let sum: f64 = image.color.iter().map(|color| f64::from(color[channel])).sum();
            let moment: f64 = chances(layers).iter().map(|(p, color)| p * color[channel].powi(2)).sum();
            // Four standard deviations of a mean of independent samples.
            let bound = 4.0 * ((moment - expected[channel].powi(2)) / samples).sqrt();
            let off = sum / (32.0 * 32.0) - expected[channel];
            assert!(off.abs() < bound, "{} layers, channel {channel}: off by {off}, {bound} allowed", layers.len());
        }
        assert!(image.color.iter().any(|color| *color != image.color[0]), "every sample saw the same");
    }
}

#[test]
fn nothing_is_left_to_chance_where_alpha_is_0_or_1() {
    let scene = quads(&[([1.0; 3], 0.0), ([0.5; 3], 1.0)], 0..2, RenderAlpha::Stochastic);
    assert!(render(&scene, 32, 32).color.iter().all(|color| *color == [0.5, 0.5, 0.5, 1.0]));
}
