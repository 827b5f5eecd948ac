//! The renderer's four samples against the oracle's many, on the renderer's own test scenes.

use displace_server::{
    domain::{
        cancel::{Cancel, NoProgress},
        image::{ImageSet, RenderScene},
        projection::Projection,
    },
    oracle::image::{Exposure, OracleScene, render},
};
use displace_tests::{device, meshes};

use crate::raster::{
    self,
    projection::PROJECTIONS,
    scenes::{self, Builder, pixel_camera, view_camera},
    still_life,
};

const SIZE: [u32; 2] = [160, 120];

fn traced(scene: &RenderScene, [width, height]: [u32; 2], samples: u32) -> ImageSet {
    let exposure = Exposure { width, height, samples, shadows: false };
    render(&OracleScene::from(scene), &exposure, &Cancel::default(), &NoProgress).expect("renders")
}

/// Mean over pixels of the largest difference of their colours.
fn mean_difference(a: &ImageSet, b: &ImageSet) -> f64 {
    (0..a.color.len()).map(|i| apart(a, b, i)).sum::<f64>() / a.color.len() as f64
}

fn apart(a: &ImageSet, b: &ImageSet, i: usize) -> f64 {
    (0..3).fold(0.0, |most, k| f64::max(most, f64::from((a.color[i][k] - b.color[i][k]).abs())))
}

/// A torus and the plane that cuts it, without maps: all edges are of geometry.
fn plain() -> RenderScene {
    let mut builder = Builder::lit(view_camera([1.5, 1.2, 2.0], [0.0; 3], 45.0, SIZE[0], SIZE[1]));
    builder.mesh(&meshes::torus(192, 96), [0.9, 0.4, 0.2]);
    builder.mesh(&meshes::plane(4), [0.2, 0.6, 0.9]);
    builder.finish()
}

/// Whether something else is seen in a pixel or beside it: nothing, the other mesh, or a place far behind.
fn is_edge(image: &ImageSet, i: usize) -> bool {
    let (depth, triangle) = (image.depth.as_ref().expect("asked for"), image.triangle.as_ref().expect("asked for"));
    let kind = |i: usize| if triangle[i] == u32::MAX { 2 } else { u32::from(triangle[i] >= 2 * 192 * 96) };
    let (x, y) = (i as i64 % 160, i as i64 / 160);
    let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (x + dx, y + dy)));
    around.filter(|(x, y)| (0..160).contains(x) && (0..120).contains(y)).any(|(x, y)| {
        let j = (y * 160 + x) as usize;
        kind(j) != kind(i) || (depth[j] - depth[i]).abs() > 0.1
    })
}

fn assert_differs_on_edges_alone(image: &ImageSet, scene: &RenderScene) {
    let expected = traced(scene, SIZE, 256);
    let inner: Vec<usize> = (0..image.color.len()).filter(|&i| !is_edge(&expected, i)).collect();
    assert!(inner.len() > 15_000, "{} pixels are not on edges", inner.len());
    let worst = inner.iter().map(|&i| apart(image, &expected, i)).fold(0.0, f64::max);
    // Beside a silhouette the light changes fast, and a triangle is shaded once a pixel.
    assert!(worst < 0.04, "{worst} apart inside");
    let mean = inner.iter().map(|&i| apart(image, &expected, i)).sum::<f64>() / inner.len() as f64;
    assert!(mean < 2e-4, "{mean} apart inside, in the mean");
    // Four samples of an edge are off by an eighth of its contrast in the mean.
    let mean = mean_difference(image, &expected);
    assert!(mean < 4e-3, "{mean} apart in the mean");
}

#[test]
fn the_reference_differs_from_the_oracle_on_edges_alone() {
    assert_differs_on_edges_alone(&raster::reference(&plain(), SIZE[0], SIZE[1]), &plain());
}

#[test]
fn the_renderer_differs_from_the_oracle_on_edges_alone() {
    if device::without_gpu("the renderer against the oracle") {
        return;
    }
    assert_differs_on_edges_alone(&raster::render(&plain(), SIZE[0], SIZE[1]), &plain());
}

#[test]
fn points_that_all_samples_of_a_pixel_see_are_the_oracles() {
    let scene = still_life(None);
    let (raster, traced) = (raster::reference(&scene, SIZE[0], SIZE[1]), traced(&scene, SIZE, 1));
    let (ids, expected) = (raster.triangle.unwrap(), traced.triangle.unwrap());
    let same = |i: &usize| ids[*i] == expected[*i] && ids[*i] != u32::MAX;
    let (mut worst, mut exact) = (0f32, 0);
    for i in (0..ids.len()).filter(same) {
        let [p, q] = [&raster.position, &traced.position].map(|places| places.as_ref().expect("asked for")[i]);
        let off = (0..3).map(|k| (p[k] - q[k]).abs()).fold(0.0, f32::max);
        exact += u32::from(off < 2e-6);
        worst = worst.max(off);
    }
    let seen = (0..ids.len()).filter(same).count();
    // Where a triangle has fewer than four samples its point is their middle, not the pixel's.
    assert!(f64::from(exact) > 0.5 * seen as f64, "{exact} of {seen} points are the same");
    assert!(worst < 0.1, "points are up to {worst} apart");
}

#[test]
fn maps_colours_masks_and_sides_are_the_renderers() {
    // Trilinear maps are softer than many samples of the finest level, and holes have edges everywhere.
    let scenes = [(still_life(None), SIZE, 0.03), (scenes::masked_grid(96), [96, 96], 0.06)];
    for (k, (scene, [width, height], most)) in scenes.into_iter().enumerate() {
        let mean = mean_difference(&raster::reference(&scene, width, height), &traced(&scene, [width, height], 64));
        assert!(mean < most, "scene {k}: {mean} apart in the mean");
    }
    for (mirrored, flipped) in [(false, false), (false, true), (true, false), (true, true)] {
        let scene = scenes::one_sided(mirrored, flipped);
        let (expected, found) = (raster::reference(&scene, 32, 32), traced(&scene, [32, 32], 16));
        let seen = |image: &ImageSet| image.triangle.as_ref().expect("asked for").iter().any(|id| *id != u32::MAX);
        assert_eq!(seen(&found), seen(&expected), "mirrored: {mirrored}, flipped: {flipped}");
        let mean = mean_difference(&expected, &found);
        assert!(mean < 5e-3, "{mean} apart, mirrored: {mirrored}, flipped: {flipped}");
    }
}

#[test]
fn parallel_rays_and_mirrored_views_are_the_renderers() {
    let mut builder = Builder::unlit(pixel_camera(32, 24));
    builder.flat_triangle([[2.0, 3.0, 0.5], [29.0, 5.0, 0.7], [6.0, 22.0, 0.2]], [0.8, 0.4, 0.1]);
    builder.flat_triangle([[1.0, 20.0, 0.6], [30.0, 2.0, 0.1], [30.0, 23.0, 0.9]], [0.1, 0.4, 0.8]);
    let scene = builder.finish();
    let (expected, found) = (raster::reference(&scene, 32, 24), traced(&scene, [32, 24], 256));
    let mean = mean_difference(&expected, &found);
    assert!(mean < 0.06, "{mean} apart against a background of {}", scenes::LEAK);
    let (depth, expected) = (found.depth.unwrap()[12 * 32 + 16], expected.depth.unwrap()[12 * 32 + 16]);
    assert!((depth - expected).abs() < 1e-6, "{depth} for {expected}");
}

/// Bilinear maps of some texels a pixel, so that the pixels' own sizes hardly matter: what is left is noise of 64 rays and of
/// four samples along edges of geometry.
#[test]
fn projections_of_the_renderer_are_those_of_the_oracle() {
    for projection in PROJECTIONS {
        let mut scene = raster::projection::two_bodies(projection);
        scene.filter = displace_server::domain::image::Filter::Bilinear;
        let expected = traced(&scene, [96, 96], 64);
        let mean = mean_difference(&raster::reference(&scene, 96, 96), &expected);
        assert!(mean < 1.2e-2, "{projection:?}: {mean} apart in the mean");
        let other = if projection == Projection::Triplanar { Projection::Box } else { Projection::Triplanar };
        let wrong = mean_difference(&raster::reference(&RenderScene { projection: other, ..scene }, 96, 96), &expected);
        assert!(wrong > 2.0 * mean, "{projection:?}: {wrong} apart for another one, {mean} for its own");
    }
}
