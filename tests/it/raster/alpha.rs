//! Alpha of materials: cut off, by chance, and in layers; the device against its twin and against closed forms.

use std::sync::Arc;

use displace_glsl::reference::composite::MAX_LAYERS;
use displace_server::{
    domain::{
        cancel::{Cancel, NoProgress},
        image::{ImagePlan, ImageSet, RenderAlpha, RenderLight, RenderMaterial, RenderMesh, RenderScene},
        request::{Rays, Shadows},
    },
    render::{JobContext, reference_image},
};
use displace_tests::meshes;
use rand::{SeedableRng, rngs::StdRng, seq::SliceRandom};

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
/// `triangle_order` numbers the sheet's triangles in another.
pub(super) fn waves(triangle_order: Option<u64>, alpha: RenderAlpha) -> RenderScene {
    let mut builder = Builder::lit(view_camera([0.3, 1.3, 1.9], [0.0, -0.1, 0.0], 50.0, 96, 96));
    let mut sheet = material([1.0, 0.9, 0.8], Some(checker(16, 16)));
    sheet.base_color_factor[3] = 0.8;
    sheet.alpha = alpha;
    let mut mesh = render_mesh(&meshes::plane(40));
    if let Some(seed) = triangle_order {
        Arc::make_mut(&mut mesh.triangles).shuffle(&mut StdRng::seed_from_u64(seed));
    }
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
    assert_agrees(&waves(None, RenderAlpha::Stochastic), "by chance");
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

/// Every pixel has the colour, up to a few roundings of values up to `LEAK`.
fn assert_all(image: &ImageSet, [r, g, b]: [f64; 3], what: &str) {
    for found in &image.color {
        let off = [r, g, b].iter().zip(found).fold(0f64, |most, (c, found)| most.max((c - f64::from(*found)).abs()));
        assert!(off < 32.0 * f64::from(f32::EPSILON * LEAK), "{what}: {found:?} for {r}, {g}, {b}");
    }
}

#[test]
fn blending_is_the_closed_form_in_whatever_order_triangles_come() {
    for layers in [&THREE[..1], &THREE[..2], &THREE] {
        for order in [vec![0, 1, 2], vec![2, 1, 0], vec![1, 0, 2]] {
            let order = order.into_iter().filter(|k| *k < layers.len());
            let scene = quads(layers, order, RenderAlpha::Blend);
            assert_all(&render(&scene, 32, 32), blended(layers), "device");
            assert_all(&reference(&scene, 32, 32), blended(layers), "twin");
        }
    }
}

#[test]
fn rays_blend_by_the_same_form_whether_asked_for_layers_or_for_chances() {
    for alpha in [RenderAlpha::Blend, RenderAlpha::Stochastic] {
        let scene = quads(&THREE, [2, 0, 1].into_iter(), alpha);
        let rays = Some(Rays { samples: 2, shadows: Shadows::None });
        let job = JobContext { cancel: &Cancel::default(), progress: &NoProgress };
        let plan = ImagePlan { rays, ..plan(&scene, 32, 32) };
        let image = reference_image::render(&job, &plan, &scene).expect("renders").0;
        assert_all(&image, blended(&THREE), "rays");
    }
}

#[test]
fn layers_agree_with_their_twin() {
    let scene = waves(None, RenderAlpha::Blend);
    assert_agrees(&scene, "layers");
    let ids = |image: ImageSet| image.triangle.expect("asked for");
    let (found, expected) = (ids(render(&scene, 96, 96)), ids(reference(&scene, 96, 96)));
    let apart = found.iter().zip(&expected).filter(|(a, b)| a != b).count();
    assert!(apart <= 96 * 96 / 50, "{apart} pixels show another triangle");
}

#[test]
fn layers_change_with_neither_the_order_of_triangles_nor_slabs() {
    let scene = waves(None, RenderAlpha::Blend);
    let image = render(&scene, 96, 96);
    assert_eq!(render(&waves(Some(5), RenderAlpha::Blend), 96, 96).color, image.color);
    assert_eq!(render_plan(&scene, &ImagePlan { slab_px: 16, ..plan(&scene, 96, 96) }), image);
}

#[test]
fn layers_beyond_the_last_are_left_out_and_told() {
    for count in [MAX_LAYERS, MAX_LAYERS + 1, 32] {
        let layers: Vec<Layer> = (0..count).map(|k| ([k as f32 / count as f32, 0.5, 1.0], 0.2)).collect();
        let scene = quads(&layers, (0..count).rev(), RenderAlpha::Blend);
        for image in [render(&scene, 32, 32), reference(&scene, 32, 32)] {
            assert_all(&image, blended(&layers[..MAX_LAYERS]), "the first layers");
            assert_eq!(image.layers_left_out, count > MAX_LAYERS, "{count} layers");
        }
    }
}

#[test]
fn what_is_solid_hides_the_layers_behind_it() {
    let mut builder = Builder::unlit(pixel_camera(32, 32));
    let solid = ([0.25, 0.5, 0.75], 1.0);
    builder.add(quad(0.2), look(THREE[1], RenderAlpha::Blend), IDENTITY);
    builder.add(quad(0.5), look(solid, RenderAlpha::Opaque), IDENTITY);
    builder.add(quad(0.8), look(THREE[0], RenderAlpha::Blend), IDENTITY);
    let image = render(&builder.finish(), 32, 32);
    assert_all(&image, blended(&[THREE[0], solid]), "one before, one behind");
}

#[test]
fn of_equal_depths_the_smaller_number_is_in_front() {
    let mut builder = Builder::unlit(pixel_camera(32, 32));
    THREE.iter().for_each(|layer| builder.add(quad(0.5), look(*layer, RenderAlpha::Blend), IDENTITY));
    assert_all(&render(&builder.finish(), 32, 32), blended(&THREE), "in one plane");
}

#[test]
fn further_outputs_show_the_nearest_surface_that_hides_half() {
    for (shares, shown) in [([0.4, 0.6], 2), ([0.6, 0.6], 0), ([0.4, 0.4], 4)] {
        let mut builder = Builder::unlit(pixel_camera(32, 32));
        for (k, share) in shares.into_iter().enumerate() {
            builder.add(quad(0.8 - 0.2 * k as f32), look(([1.0; 3], share), RenderAlpha::Blend), IDENTITY);
        }
        builder.add(quad(0.1), look(([1.0; 3], 1.0), RenderAlpha::Opaque), IDENTITY);
        let scene = builder.finish();
        for image in [render(&scene, 32, 32), reference(&scene, 32, 32)] {
            let ids = image.triangle.expect("asked for");
            assert!(ids.iter().all(|id| id / 2 * 2 == shown), "{shares:?}: {ids:?}");
        }
    }
}

#[test]
fn the_back_of_a_single_sided_layer_is_not_seen() {
    let mut builder = Builder::unlit(pixel_camera(32, 32));
    let mut turned = quad(0.5);
    Arc::make_mut(&mut turned.triangles).iter_mut().for_each(|t| t.swap(1, 2));
    for mesh in [quad(0.5), turned] {
        let single = RenderMaterial { double_sided: false, ..look(THREE[0], RenderAlpha::Blend) };
        builder.add(mesh, single, IDENTITY);
    }
    assert_all(&render(&builder.finish(), 32, 32), blended(&THREE[..1]), "one of two sides");
}

#[test]
fn layers_stop_light_from_an_alpha_of_one_half_on() {
    for (share, is_dark) in [(0.6, true), (0.4, false)] {
        let mut builder = Builder::lit(view_camera([0.0, 3.0, 0.01], [0.0; 3], 40.0, 64, 64));
        let mut raised = IDENTITY;
        (raised[0], raised[10], raised[12], raised[13]) = (0.5, 0.5, 3.0, 1.0);
        builder.add(render_mesh(&meshes::plane(1)), look(([1.0; 3], share), RenderAlpha::Blend), raised);
        builder.mesh(&meshes::plane(1), [0.5; 3]);
        let mut scene = RenderScene { shadows: Shadows::Ray, ..builder.finish() };
        // Meets the middle of the plane through that of the raised one.
        scene.lighting.lights = vec![RenderLight::sun([3.0 / 10f32.sqrt(), 1.0 / 10f32.sqrt(), 0.0])];
        let image = render(&scene, 64, 64);
        assert_eq!(differing(&image, &reference(&scene, 64, 64), 2e-3), 0, "alpha {share}");
        assert_eq!(image.color[32 * 64 + 32][0] < 0.11, is_dark, "alpha {share}: {:?}", image.color[32 * 64 + 32]);
    }
}
