//! Where pixels lie on maps, and how much of them edges cover: the renderer against what perspective and areas say.

use displace_server::{
    domain::{
        image::{ImagePlan, ImageSet, RenderScene},
        request::Aov,
    },
    render::reference_image::preimage,
};
use displace_tests::{
    meshes,
    projective::{Projective, bilinear},
};
use glam::{DMat4, DVec2, DVec4};

use super::{
    ALL_AOVS, plan,
    projection::two_bodies,
    reference, render, render_plan,
    scenes::{Builder, IDENTITY, LEAK, checker, masked_grid, material, pixel_camera, render_mesh, view_camera},
};

const SIZE: [u32; 2] = [128, 96];

fn counted(scene: RenderScene) -> RenderScene {
    RenderScene { aovs: [&ALL_AOVS[..], &[Aov::Overdraw, Aov::Samples]].concat(), ..scene }
}

/// A floor of two triangles that runs away from the viewer.
fn floor() -> RenderScene {
    let [width, height] = SIZE;
    let mut builder = Builder::unlit(view_camera([0.15, 0.3, 0.75], [0.0, -0.05, 0.0], 50.0, width, height));
    builder.textured_mesh(&meshes::plane(1), &checker(16, 16));
    counted(builder.finish())
}

/// The floor's corners on the screen, at (u, v) of (0, 0), (1, 0), (1, 1), (0, 1).
fn corners(scene: &RenderScene) -> [DVec2; 4] {
    let [clip, view] =
        [scene.camera.clip_from_view, scene.camera.view_from_world].map(|m| DMat4::from_cols_array(&m.map(f64::from)));
    let half = DVec2::new(SIZE[0].into(), SIZE[1].into()) * 0.5;
    [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(|[x, z]| {
        let p = clip * view * DVec4::new(x, 0.0, z, 1.0);
        half + half * DVec2::new(p.x, -p.y) / p.w
    })
}

/// Pixels that one triangle covers alone.
fn whole(image: &ImageSet) -> Vec<usize> {
    let (overdraw, samples) = (image.overdraw.as_ref().expect("asked for"), image.samples.as_ref().expect("asked for"));
    (0..overdraw.len()).filter(|&i| overdraw[i] == 4 && samples[i] == 1).collect()
}

fn centre(i: usize) -> DVec2 {
    DVec2::new((i % SIZE[0] as usize) as f64 + 0.5, (i / SIZE[0] as usize) as f64 + 0.5)
}

/// The matrices are rounded to f32: a place of the screen by 2^-24 of some hundred pixels, times what a pixel is on the map, at
/// most a twentieth; coordinates of vertices and weights by as much of 1.
const ROUNDING: f64 = 2e-6;

#[test]
fn a_quadrilateral_is_read_by_the_projective_map_of_its_corners_and_not_by_the_bilinear_one() {
    let scene = floor();
    let map = Projective::from_corners(corners(&scene)).expect("a quadrilateral");
    for (image, bound) in
        [(render(&scene, SIZE[0], SIZE[1]), ROUNDING), (reference(&scene, SIZE[0], SIZE[1]), ROUNDING)]
    {
        let pixels = whole(&image);
        assert!(pixels.len() > 2500, "{} pixels", pixels.len());
        let uv = |i: &usize| DVec2::from_array(image.uv.as_ref().expect("asked for")[*i].map(f64::from));
        let off = |i: &usize| (map.adjugate().at(centre(*i)) - uv(i)).abs().max_element();
        let worst = pixels.iter().map(off).fold(0.0, f64::max);
        assert!(worst <= bound, "{worst}");
        // In pixels: where the bilinear map would put what is seen there.
        let apart = |i: &usize| (bilinear(corners(&scene), uv(i)) - centre(*i)).length();
        let farthest = pixels.iter().map(apart).fold(0.0, f64::max);
        assert!(farthest > 10.0, "{farthest}");
    }
}

#[test]
fn the_pre_image_of_a_pixel_is_where_the_projective_map_takes_its_corners() {
    let mut scene = floor();
    let at = [60u32, 50];
    for material in &mut scene.materials {
        material.maps[0].as_mut().expect("a map").map_from_uv = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    }
    let inverse = Projective::from_corners(corners(&scene)).expect("a quadrilateral").adjugate();
    let image = render(&scene, SIZE[0], SIZE[1]);
    let triangle = image.triangle.as_ref().expect("asked for")[(at[1] * SIZE[0] + at[0]) as usize];
    let found = preimage(&plan(&scene, SIZE[0], SIZE[1]), &scene, at, triangle).expect("on the floor");
    let corner = DVec2::new(at[0].into(), at[1].into());
    for (k, step) in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].into_iter().enumerate() {
        let expected = inverse.at(corner + DVec2::from_array(step));
        assert!((found.corners[k] - expected).abs().max_element() < ROUNDING, "{k}: {} {expected}", found.corners[k]);
    }
    // Sides are those of the quadrilateral to first order.
    let [dx, dy] = found.sides;
    let [a, b, c, d] = found.corners;
    assert!((0.5 * (b + c - a - d) - dx).length() < 0.02 * dx.length());
    assert!((0.5 * (c + d - a - b) - dy).length() < 0.02 * dy.length());
}

#[test]
fn a_pre_image_stays_on_its_side_of_the_seam_of_a_sphere() {
    let scene = two_bodies(displace_server::domain::projection::Projection::Sphere);
    let image = render(&scene, 96, 96);
    let triangle = image.triangle.as_ref().expect("asked for");
    let mut count = 0;
    for i in (0..96 * 96).filter(|i| triangle[*i] != u32::MAX).step_by(7) {
        let at = [i as u32 % 96, i as u32 / 96];
        let Ok(found) = preimage(&plan(&scene, 96, 96), &scene, at, triangle[i]) else { continue };
        // The map is 2.5 and 2 times smaller than a turn; half of that is the farthest that a corner may be.
        assert!(found.corners.iter().all(|c| (*c - found.centre).abs().max_element() < 1.3), "{at:?}: {found:?}");
        count += 1;
    }
    assert!(count > 200, "{count} pixels");
}

#[test]
fn what_is_covered_is_counted_alike_on_the_device_and_by_its_twin() {
    let mut stack = Builder::unlit(pixel_camera(64, 64));
    for k in 0..5 {
        let (low, depth) = (4.0 * k as f32, 0.1 + 0.15 * k as f32);
        stack.flat_triangle([[low, low, depth], [60.0, low, depth], [low, 60.0, depth]], [1.0; 3]);
    }
    let mut blended = two_bodies(displace_server::domain::projection::Projection::Uv);
    blended.materials[0].alpha = displace_server::domain::image::RenderAlpha::Blend;
    for (scene, exact) in [(stack.finish(), true), (blended, false), (masked_grid(64), false)] {
        let scene = counted(scene);
        let (image, expected) = (render(&scene, 64, 64), reference(&scene, 64, 64));
        for (found, expected) in [(&image.overdraw, &expected.overdraw), (&image.samples, &expected.samples)] {
            let pairs = found.iter().flatten().zip(expected.iter().flatten());
            let apart = pairs.filter(|(a, b)| a != b).count();
            // Where corners are no multiples of 1/256 pixel, their rounding is that of f32 on one side.
            assert!(apart <= if exact { 0 } else { 24 }, "{apart} pixels");
        }
    }
}

/// A closed ball is covered once by its front and once by its back, where both are shown.
#[test]
fn a_ball_seen_from_both_sides_is_covered_twice() {
    let ball = |double_sided| {
        let mut builder = Builder::unlit(view_camera([0.0, 0.0, 4.0], [0.0; 3], 40.0, 64, 64));
        let skin = displace_server::domain::image::RenderMaterial { double_sided, ..material([1.0; 3], None) };
        builder.add(render_mesh(&meshes::icosphere(3)), skin, IDENTITY);
        render(&counted(builder.finish()), 64, 64)
    };
    let (single, both) = (ball(false), ball(true));
    let counts = |image: &ImageSet| image.overdraw.clone().expect("asked for");
    for (i, (one, two)) in counts(&single).into_iter().zip(counts(&both)).enumerate() {
        assert_eq!(2 * one, two, "pixel {i}");
    }
    assert!(counts(&single).contains(&4) && counts(&single).contains(&0));
}

/// Of the unit square, what lies on the side of a line where n . p <= d.
fn area(n: DVec2, d: f64) -> f64 {
    let square = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
    let mut kept = Vec::new();
    for k in 0..4 {
        let (a, b) = (square[k], square[(k + 1) % 4]);
        let (da, db) = (n.dot(a) - d, n.dot(b) - d);
        if da <= 0.0 {
            kept.push(a);
        }
        if (da < 0.0) != (db < 0.0) && da != db {
            kept.push(a.lerp(b, da / (da - db)));
        }
    }
    let count = kept.len();
    0.5 * (0..count).map(|k| kept[k].perp_dot(kept[(k + 1) % count])).sum::<f64>()
}

const SAMPLES: [DVec2; 4] =
    [DVec2::new(0.375, 0.125), DVec2::new(0.875, 0.375), DVec2::new(0.125, 0.625), DVec2::new(0.625, 0.875)];
const ANGLES: usize = 4096;

/// By how much the share of a pixel's four samples on one side of a line differs from the area there, at most: it jumps at
/// lines through samples alone, and between angles the area changes by at most half the squared diagonal per radian.
fn discrepancy() -> f64 {
    let mut worst = 0f64;
    for k in 0..ANGLES {
        let n = DVec2::from_angle(std::f64::consts::TAU * k as f64 / ANGLES as f64);
        for sample in SAMPLES {
            let d = n.dot(sample);
            let inside = |slack: f64| SAMPLES.iter().filter(|s| n.dot(**s) <= d + slack).count() as f64 / 4.0;
            worst = worst.max((inside(1e-9) - area(n, d)).abs()).max((inside(-1e-9) - area(n, d)).abs());
        }
    }
    worst + std::f64::consts::PI / ANGLES as f64
}

/// A line crosses at most 2 n - 1 of the n x n finer pixels of a pixel, and in each the samples are off by the discrepancy of
/// four at most. Corners are rounded to 1/256 of a finer pixel, which moves the line by less than that within a pixel.
#[test]
fn a_slanted_edge_covers_its_area_as_nearly_as_its_samples_allow() {
    let pattern = discrepancy();
    assert!((0.2..0.4).contains(&pattern), "{pattern}");
    for side in [1u32, 2, 4, 8, 16] {
        let n = f64::from(side);
        let bound = (2.0 * n - 1.0) / (n * n) * pattern + 1.5 / (256.0 * n);
        let (mut worst, mut squares, mut count) = (0f64, 0.0, 0);
        for k in 0..12 {
            let normal = DVec2::from_angle(0.13 + 0.51 * f64::from(k));
            let through = DVec2::new(4.1 + 0.07 * f64::from(k), 3.9);
            let (along, away) = (normal.perp() * 40.0, normal * 60.0);
            let triangle = [through - along, through + along, through - away].map(|p| [p.x as f32, p.y as f32, 0.5]);
            let mut builder = Builder::unlit(pixel_camera(8, 8));
            builder.flat_triangle(triangle, [1.0; 3]);
            let scene = builder.finish();
            let image = render_plan(&scene, &ImagePlan { supersample: side, ..plan(&scene, 8, 8) });
            for (i, color) in image.color.iter().enumerate() {
                let corner = DVec2::new((i % 8) as f64, (i / 8) as f64);
                let covered = (f64::from(LEAK) - f64::from(color[0])) / (f64::from(LEAK) - 1.0);
                let error = (covered - area(normal, normal.dot(through - corner))).abs();
                assert!(error <= bound, "{side}: {error} for {bound} at pixel {i} of edge {k}");
                worst = worst.max(error);
                (squares, count) = (squares + error * error, count + u32::from(error > 1e-6));
            }
        }
        println!(
            "{} samples: worst {worst:.4}, rms {:.4}, bound {bound:.4}",
            4 * side * side,
            (squares / f64::from(count.max(1))).sqrt()
        );
    }
}
