//! Images: coverage, order, slabs, clipping, filtering and shading, each against the f64 oracle or against
//! what must hold whatever the scene.

mod alpha;
mod borders;
mod bump;
mod filters;
mod levels;
mod light;
mod looks;
mod mapping;
mod moments;
mod passes;
pub(crate) mod projection;
mod reflections;
mod relief;
mod relief_light;
pub(crate) mod scenes;
mod shadows;

use std::{collections::HashSet, sync::OnceLock};

use displace_server::{
    domain::{
        cancel::{Cancel, NoProgress},
        encode::encode,
        image::{ImagePlan, ImageSet, RenderAlpha, RenderScene},
        request::{Aov, ImageFormat},
    },
    render::{
        JobContext,
        image::{self, KeptCones},
        reference_image,
    },
    vulkan::{Device, DeviceOptions, Testing},
};
use displace_tests::meshes;
use rand::{RngExt as _, SeedableRng, rngs::StdRng, seq::SliceRandom};
use scenes::{Builder, LEAK, pixel_camera, view_camera};

pub(crate) const ALL_AOVS: [Aov; 5] = [Aov::Depth, Aov::Normal, Aov::Position, Aov::Uv, Aov::Triangle];

pub(crate) fn device() -> &'static std::sync::Arc<Device> {
    static DEVICE: OnceLock<std::sync::Arc<Device>> = OnceLock::new();
    DEVICE.get_or_init(|| {
        let options = DeviceOptions { validation: true, ..Default::default() };
        Device::open(&options).expect("a Vulkan device that passes its self-test; run deploy/setup to install one")
    })
}

fn plan(scene: &RenderScene, width: u32, height: u32) -> ImagePlan {
    ImagePlan::new(width, height, &scene.contents()).expect("the size is in range")
}

fn render_plan(scene: &RenderScene, plan: &ImagePlan) -> ImageSet {
    render_after(scene, plan, &KeptCones::default()).0
}

/// After renders that made these cones, with the names of its passes.
fn render_after(scene: &RenderScene, plan: &ImagePlan, cones: &KeptCones) -> (ImageSet, Vec<String>) {
    let job = JobContext { cancel: &Cancel::default(), progress: &NoProgress };
    let (images, times) = image::render(device(), &job, plan, scene, cones).expect("renders");
    (images, times.into_iter().map(|time| time.name).collect())
}

pub(crate) fn render(scene: &RenderScene, width: u32, height: u32) -> ImageSet {
    render_plan(scene, &plan(scene, width, height))
}

pub(crate) fn reference(scene: &RenderScene, width: u32, height: u32) -> ImageSet {
    let job = JobContext { cancel: &Cancel::default(), progress: &NoProgress };
    reference_image::render(&job, &plan(scene, width, height), scene).expect("renders").0
}

/// Pixels whose colours are farther apart than `tolerance`.
fn differing(a: &ImageSet, b: &ImageSet, tolerance: f32) -> usize {
    let apart = |(a, b): (&[f32; 4], &[f32; 4])| a.iter().zip(b).any(|(a, b)| (a - b).abs() > tolerance);
    a.color.iter().zip(&b.color).filter(|pair| apart(*pair)).count()
}

/// A closed fan around a random centre whose corners lie on the 1/256 pixel grid, each triangle of its own
/// colour; `reversed` numbers the triangles the other way round.
fn fan(seed: u64, size: f32, reversed: bool) -> RenderScene {
    let mut random = StdRng::seed_from_u64(seed);
    let snap = |x: f32| (x * 256.0).round() / 256.0;
    let spokes = random.random_range(3..40);
    let centre = [snap(random.random_range(20.0..44.0)), snap(random.random_range(20.0..44.0))];
    let mut angles: Vec<f32> = (0..spokes).map(|_| random.random_range(0.0..std::f32::consts::TAU)).collect();
    angles.extend([0.0, 2.0, 4.0]);
    angles.sort_by(f32::total_cmp);
    let rim = |angle: &f32| {
        let radius = size * random.random_range(0.3f32..1.0);
        [snap(centre[0] + radius * angle.cos()), snap(centre[1] + radius * angle.sin())]
    };
    let rim: Vec<[f32; 2]> = angles.iter().map(rim).collect();
    let mut triangles: Vec<_> = (0..rim.len()).map(|k| [centre, rim[k], rim[(k + 1) % rim.len()]]).collect();
    let mut colors: Vec<_> = triangles.iter().map(|_| random.random::<[f32; 3]>()).collect();
    if reversed {
        triangles.reverse();
        colors.reverse();
    }
    let mut builder = Builder::unlit(pixel_camera(64, 64));
    for (triangle, color) in triangles.iter().zip(colors) {
        builder.flat_triangle(triangle.map(|[x, y]| [x, y, 0.5]), color);
    }
    builder.finish()
}

#[test]
fn every_sample_of_a_closed_fan_is_covered_exactly_once() {
    for seed in 0..60 {
        let size = [1.5, 6.0, 30.0, 400.0, 20_000.0][seed as usize % 5];
        let image = render(&fan(seed, size, false), 64, 64);
        // A sample covered twice would go to another triangle when the ids run the other way.
        assert_eq!(differing(&image, &render(&fan(seed, size, true), 64, 64), 0.0), 0, "seed {seed}, twice");
        // The reference decides coverage in 128-bit integers.
        assert_eq!(differing(&image, &reference(&fan(seed, size, false), 64, 64), 1e-5), 0, "seed {seed}");
    }
}

#[test]
fn a_fan_larger_than_the_image_leaves_no_hole() {
    for seed in 100..120 {
        let mut builder = Builder::unlit(pixel_camera(64, 64));
        let mut random = StdRng::seed_from_u64(seed);
        let centre = [random.random_range(0.0..64.0), random.random_range(0.0..64.0), 0.5];
        let reach = [100.0, 3000.0, 1e6, 1e9][seed as usize % 4];
        let corner = |k: usize| {
            let angle = k as f32 / 7.0 * std::f32::consts::TAU;
            [centre[0] + reach * angle.cos(), centre[1] + reach * angle.sin(), 0.5]
        };
        (0..7).for_each(|k| builder.flat_triangle([centre, corner(k), corner((k + 1) % 7)], [1.0; 3]));
        let image = render(&builder.finish(), 64, 64);
        assert!(image.color.iter().all(|c| *c == [1.0; 4]), "seed {seed}");
    }
}

#[test]
fn slivers_and_vertices_on_samples_are_covered_as_the_integers_say() {
    let mut random = StdRng::seed_from_u64(7);
    let mut builder = Builder::unlit(pixel_camera(64, 64));
    for k in 0..400 {
        // Corners on the sample grid, or a 1/256 pixel beside it.
        let mut corner = || {
            let mut on_grid = || random.random_range(0..256) as f32 / 4.0 + 0.125;
            [on_grid(), on_grid(), 0.5]
        };
        let (a, b) = (corner(), corner());
        let c = if k % 2 == 0 { [b[0] + 1.0 / 256.0, b[1], 0.5] } else { corner() };
        builder.flat_triangle([a, b, c], [k as f32, (k * k % 97) as f32, 1.0]);
    }
    let scene = builder.finish();
    assert_eq!(differing(&render(&scene, 64, 64), &reference(&scene, 64, 64), 1e-4), 0);
}

/// Random triangles around and behind the camera, some enormous.
fn wild(seed: u64) -> RenderScene {
    let mut random = StdRng::seed_from_u64(seed);
    let mut builder = Builder::unlit(view_camera([0.0; 3], [0.0, 0.0, -1.0], 70.0, 96, 96));
    for _ in 0..60 {
        let spread = [0.2f32, 2.0, 50.0, 1e6][random.random_range(0..4)];
        let mut corner = || [0; 3].map(|_| random.random_range(-spread..spread));
        let corners = [corner(), corner(), corner()];
        builder.flat_triangle(corners, random.random());
    }
    builder.finish()
}

#[test]
fn triangles_through_the_camera_are_clipped_as_the_reference_clips_them() {
    for seed in 0..12 {
        let (image, expected) = (render(&wild(seed), 96, 96), reference(&wild(seed), 96, 96));
        // Corners are rounded to 1/256 pixel from f32 or f64 values: only pixels on edges may differ.
        let differing = differing(&image, &expected, 1e-3);
        assert!(differing <= 96 * 96 / 100, "seed {seed}: {differing} pixels differ");
    }
}

#[test]
fn a_closed_mesh_around_the_camera_covers_every_sample() {
    for (level, fov) in [(1, 60.0), (3, 100.0), (5, 150.0)] {
        let mut builder = Builder::unlit(view_camera([0.1, 0.2, 0.05], [0.3, -0.4, -1.0], fov, 200, 150));
        builder.mesh(&meshes::icosphere(level), [1.0; 3]);
        let image = render(&builder.finish(), 200, 150);
        assert!(image.color.iter().all(|c| *c == [1.0; 4]), "level {level}: the background shows");
        assert!(image.triangle.unwrap().iter().all(|id| *id != u32::MAX));
    }
}

/// A lit torus with a map, seen from outside, on a ground plane that cuts it.
pub(crate) fn still_life(triangle_order: Option<u64>) -> RenderScene {
    let mut builder = Builder::lit(view_camera([1.5, 1.2, 2.0], [0.0, 0.0, 0.0], 45.0, 160, 120));
    for mesh in [meshes::torus(48, 24), meshes::plane(4)] {
        let mut mesh = mesh;
        if let Some(seed) = triangle_order {
            mesh.triangles.shuffle(&mut StdRng::seed_from_u64(seed));
        }
        builder.textured_mesh(&mesh, &scenes::checker(37, 29));
    }
    builder.finish()
}

#[test]
fn the_order_of_triangles_changes_nothing_but_their_numbers() {
    let (image, shuffled) = (render(&still_life(None), 160, 120), render(&still_life(Some(3)), 160, 120));
    assert_eq!(image.color, shuffled.color);
    assert_eq!(image.depth, shuffled.depth);
    assert_eq!(image.normal, shuffled.normal);
    assert_ne!(image.triangle, shuffled.triangle);
}

#[test]
fn the_size_of_the_slabs_changes_nothing() {
    let scene = still_life(None);
    let whole = plan(&scene, 160, 120);
    let image = render_plan(&scene, &whole);
    for slab_px in [16, 64, 128] {
        assert_eq!(render_plan(&scene, &ImagePlan { slab_px, ..whole.clone() }), image, "slabs of {slab_px}");
    }
}

#[test]
fn pages_staging_and_batches_change_no_byte() {
    let scenes = [still_life(None), scenes::masked_grid(8), alpha::waves(None, RenderAlpha::Blend)];
    let ways = [
        Testing { page_shift: Some(14), ..Testing::default() },
        Testing { force_staging: true, ..Testing::default() },
        Testing { batch: Some(1), ..Testing::default() },
        Testing { no_int64_atomics: true, ..Testing::default() },
    ];
    let job = JobContext { cancel: &Cancel::default(), progress: &NoProgress };
    for testing in ways {
        let options = DeviceOptions { validation: true, testing: testing.clone(), ..Default::default() };
        let device = Device::open(&options).expect("opens");
        assert_eq!(device.has_int64_atomics(), !testing.no_int64_atomics);
        for scene in &scenes {
            let plan = plan(scene, 160, 120);
            let found = image::render(&device, &job, &plan, scene, &KeptCones::default()).expect("renders").0;
            assert!(found == render_plan(scene, &plan), "{testing:?}");
        }
    }
}

#[test]
fn repeated_renders_are_equal_to_the_byte() {
    let bytes = |format| encode(&render(&still_life(None), 160, 120), format).expect("encodes");
    assert_eq!(bytes(ImageFormat::Png), bytes(ImageFormat::Png));
    assert_eq!(bytes(ImageFormat::Exr), bytes(ImageFormat::Exr));
}

#[test]
fn images_agree_with_the_reference() {
    let scene = still_life(None);
    let (image, expected) = (render(&scene, 160, 120), reference(&scene, 160, 120));
    // Half-float maps and f32 arithmetic stay within 2e-3; pixels on silhouettes may see another triangle.
    let far = differing(&image, &expected, 2e-3);
    assert!(far <= 160 * 120 / 200, "{far} pixels differ");
    let (ids, expected_ids) = (image.triangle.unwrap(), expected.triangle.unwrap());
    let same: Vec<usize> = (0..ids.len()).filter(|&i| ids[i] == expected_ids[i] && ids[i] != u32::MAX).collect();
    assert!(ids.len() - same.len() < ids.len(), "nothing is seen");
    let moved = ids.iter().zip(&expected_ids).filter(|(a, b)| a != b).count();
    assert!(moved <= ids.len() / 200, "{moved} pixels show another triangle");
    let (depth, expected_depth) = (image.depth.unwrap(), expected.depth.unwrap());
    let (normal, expected_normal) = (image.normal.unwrap(), expected.normal.unwrap());
    let mut worst = [0f32; 2];
    for i in same {
        worst[0] = worst[0].max((depth[i] - expected_depth[i]).abs());
        let apart = normal[i].iter().zip(expected_normal[i]).map(|(a, b)| (a - b).abs());
        worst[1] = apart.fold(worst[1], f32::max);
    }
    assert!(worst[0] < 2e-3 && worst[1] < 2e-2, "depth and normal are off by {worst:?}");
}

#[test]
fn alpha_cutoffs_open_holes_before_depth_is_decided() {
    for size in [96, 97] {
        let scene = scenes::masked_grid(size);
        let (image, expected) = (render(&scene, size, size), reference(&scene, size, size));
        let colors: HashSet<[u32; 4]> = image.color.iter().map(|c| c.map(f32::to_bits)).collect();
        assert!(colors.len() > 2, "the plane behind shows through the holes");
        let far = differing(&image, &expected, 2e-3);
        assert!(far <= (size * size / 100) as usize, "{far} pixels differ at size {size}");
        let slabs = ImagePlan { slab_px: 16, ..plan(&scene, size, size) };
        assert_eq!(render_plan(&scene, &slabs), image, "in slabs");
    }
}

#[test]
fn single_sided_triangles_show_one_side_also_in_mirrored_instances() {
    for mirrored in [false, true] {
        let seen = |flipped: bool| {
            let image = render(&scenes::one_sided(mirrored, flipped), 32, 32);
            image.triangle.unwrap().iter().any(|id| *id != u32::MAX)
        };
        assert!(seen(false), "the front, mirrored: {mirrored}");
        assert!(!seen(true), "the back, mirrored: {mirrored}");
    }
}

#[test]
fn the_back_of_a_double_sided_surface_is_lit_by_the_flipped_normal() {
    let normal = |from: f32| {
        let mut builder = Builder::lit(view_camera([0.0, from, 0.01], [0.0; 3], 30.0, 16, 16));
        builder.textured_mesh(&meshes::plane(2), &scenes::checker(4, 4));
        render(&builder.finish(), 16, 16).normal.unwrap()[8 * 16 + 8]
    };
    assert_eq!(normal(2.0), [0.0, 1.0, 0.0]);
    assert_eq!(normal(-2.0), [0.0, -1.0, 0.0]);
}

#[test]
fn an_empty_scene_is_all_background() {
    let image = render(&Builder::unlit(pixel_camera(40, 24)).finish(), 40, 24);
    assert!(image.color.iter().all(|c| *c == [LEAK, LEAK, LEAK, 1.0]));
    assert!(image.depth.unwrap().iter().all(|d| *d == f32::INFINITY));
}

#[test]
fn sizes_out_of_range_are_refused_by_name() {
    for (width, height, field) in [(0, 1, "size.width"), (1, 16385, "size.height")] {
        let error = ImagePlan::new(width, height, &Default::default()).unwrap_err();
        assert_eq!(error.field.as_deref(), Some(field));
    }
}
