//! Upper bounds of what methods are off by hold on random patches, and say something; estimates of cost are near what is
//! counted; patches of whole meshes are what a view sees of them. The same at length: `benches/predicted.rs`.

use std::sync::Arc;

use displace_glsl::methods::Method;
use displace_server::domain::{
    chart::Setting,
    choose::{
        facts::HeightFacts,
        patch::{Patch, PatchView},
        patches::{patches_of, quantile, view_of},
        predict::predict,
    },
    image::{HeightMap, RenderCamera},
    relief::Relief,
    scene::{Instance, Scene, SceneMesh},
};
use displace_tests::{
    data::sample,
    maps::{hash, png16},
    meshes::{self, TestMesh},
    predicted::{counts::Count, maps, measured},
};
use glam::{DMat2, DMat4, DVec3};

#[test]
fn no_method_is_farther_off_than_predicted_and_half_are_no_less_than_a_third_of_it() {
    let rows = measured(&maps::all(), 20_000..20_300, 150);
    let worse = rows.violations();
    assert!(worse.is_empty(), "{worse:#?}");
    for summary in rows.by_method() {
        let name = summary.trial.method.name();
        assert!(summary.above_floor >= 25, "{name}: {}", summary.above_floor);
        assert!(summary.median_ratio <= 3.0, "{name}: {}", summary.median_ratio);
        assert!(summary.unknown <= 5, "{name}: {}", summary.unknown);
    }
    for summary in rows.summaries().iter().filter(|summary| summary.fetches_ratio[1] > 0.0) {
        let ratio = summary.fetches_ratio[1];
        assert!((1.0 / 1.5..=1.5).contains(&ratio), "{:?}: {ratio} of the reads", summary.trial);
    }
}

#[test]
fn triangles_of_a_tolerance_are_estimated_within_a_factor_of_two() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let turn = |x: u32, of: f64| (f64::from(x) * std::f64::consts::TAU / of).sin();
    let hills = png16(128, 128, |x, y| (32768.0 + 16000.0 * turn(x, 64.0) * turn(y + 3, 42.0)) as u16);
    let rough =
        png16(128, 128, |x, y| (20000.0 + 9000.0 * turn(x, 32.0) + f64::from(hash(x / 4, y / 4, 3) >> 18)) as u16);
    let file = |name: &str, bytes: Vec<u8>| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).expect("written");
        path
    };
    let maps = [file("hills.png", hills), file("rough.png", rough), sample("maps/rock_height.png")];
    for map in &maps {
        for tolerance in [0.004, 0.002, 0.001] {
            let count = Count::of(map, 0.05, tolerance);
            assert!((0.5..=2.0).contains(&count.ratio()), "{count:?}");
        }
    }
}

#[test]
fn no_more_than_a_share_of_the_area_is_farther_off() {
    let errors = vec![(3.0, 1.0), (0.5, 90.0), (7.0, 0.5), (1.0, 8.5)];
    for (share, error) in [(0.9, 0.5), (0.985, 1.0), (0.99, 3.0), (1.0, 7.0)] {
        assert_eq!(quantile(errors.clone(), share), error);
    }
    assert_eq!(quantile(Vec::new(), 0.99), 0.0);
}

fn relief(highest: f32) -> Relief {
    let heights = (0..64 * 64).map(|k| highest * (0.1 * (k % 64 + k / 64) as f32).sin()).collect();
    let map = HeightMap { width: 64, height: 64, heights, repeats: [true; 2], thinnest_texels: 8.0 };
    Relief { map: Arc::new(map), uv_set: 0, map_from_uv: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] }
}

/// What a camera at (0, 0, 4) sees of a mesh turned by so much about X, 200 x 200 pixels, 60 degrees.
fn seen(mesh: &TestMesh, relief: &Relief, turned: f64) -> Vec<PatchView> {
    let mesh = SceneMesh { gltf_mesh: 0, mesh: mesh.to_mesh_without_tangents() };
    let scene = Scene { meshes: vec![mesh], ..Scene::default() };
    let world = DMat4::from_rotation_x(turned).as_mat4().to_cols_array();
    let instance = Instance { mesh: 0, world_from_mesh: world };
    let back = DMat4::from_translation(DVec3::new(0.0, 0.0, -4.0)).as_mat4().to_cols_array();
    let cotangent = 1.0 / 30f32.to_radians().tan();
    let mut clip = [0.0; 16];
    (clip[0], clip[5], clip[11], clip[14]) = (cotangent, cotangent, -1.0, 0.01);
    let camera = RenderCamera { view_from_world: back, clip_from_view: clip, eye_world: [0.0, 0.0, 4.0] };
    let patches = patches_of(&scene, 0, &|_| true, relief, &view_of(&camera, &instance, [200, 200]));
    assert_eq!(patches.unknown, 0);
    patches.seen
}

/// The square is 1 wide and 4 away: 200 / (8 tan 30) pixels.
#[test]
fn patches_of_a_square_cover_what_it_does_on_the_screen() {
    let patches = seen(&meshes::plane(2), &relief(0.01), std::f64::consts::FRAC_PI_2);
    let area: f64 = patches.iter().map(|patch| patch.area_px).sum();
    let side = 200.0 / (8.0 * 30f64.to_radians().tan());
    assert!((area / (side * side) - 1.0).abs() < 1e-4, "{area}");
    assert!(patches.len() >= 8 && patches.iter().all(|patch| patch.is_front && patch.tangent < 0.2));
}

#[test]
fn gentle_heights_change_the_outline_at_the_border_alone_and_steep_ones_no_farther_inside_than_they_reach() {
    let outlines = |highest: f32| {
        let relief = relief(highest);
        let facts = HeightFacts::new(&relief.map);
        let patches = seen(&meshes::plane(4), &relief, 0.6);
        let of = |patch: &PatchView| predict(Method::Flat, Setting::None, patch, &facts);
        patches.iter().map(|patch| (patch.patch.is_rim, patch.outline_distance_px, of(patch))).collect::<Vec<_>>()
    };
    for (is_rim, distance, predicted) in outlines(0.001) {
        assert_eq!(predicted.outline_px > 0.0, is_rim && predicted.error_px > 1e-6, "{distance} {predicted:?}");
        assert!(!predicted.may_show_hidden);
    }
    let steep = outlines(0.2);
    for (is_rim, distance, predicted) in &steep {
        assert!(
            *is_rim || predicted.outline_px == 0.0 || predicted.outline_px >= *distance,
            "{distance} {predicted:?}"
        );
    }
    assert!(steep.iter().any(|(is_rim, _, predicted)| !is_rim && predicted.outline_px > 0.0));
}

/// Where a ray goes on beyond its triangle the base is elsewhere than the triangle's plane, by no more than is told of it.
#[test]
fn what_is_around_a_triangle_leaves_its_plane_no_faster_than_is_told() {
    let relief = relief(0.1);
    let patches = seen(&meshes::uv_sphere(32, 16), &relief, 0.3);
    let (mut looked_at, mut tight) = (0, 0.0f64);
    for own in patches.iter().map(|view| &view.patch).step_by(7) {
        for other in patches.iter().map(|view| &view.patch) {
            for k in 0..3 {
                let there = on_plane(own, other.texels[k]);
                let way = distance(own, there);
                if way > 1e-6 && way < 0.2 && own.seam_distance > 0.4 {
                    let leaves = there.distance(other.corners[k]);
                    assert!(leaves <= own.base.bend_rate * way + 1e-6, "{leaves} over {way}: {}", own.base.bend_rate);
                    tight = tight.max(leaves / (own.base.bend_rate * way));
                    looked_at += 1;
                }
            }
        }
    }
    assert!(looked_at > 1000 && tight > 0.3, "{looked_at}, of which {tight} is the most");
}

/// Where a triangle would have a place of the map, did its plane go on.
fn on_plane(patch: &Patch, texel: glam::DVec2) -> DVec3 {
    let ([a, b, c], [p, q, r]) = (patch.corners, patch.texels);
    let share = DMat2::from_cols(q - p, r - p).inverse() * (texel - p);
    a + (b - a) * share.x + (c - a) * share.y
}

fn distance(patch: &Patch, point: DVec3) -> f64 {
    let [a, b, c] = patch.corners;
    let normal = (b - a).cross(c - a);
    let sides = [[a, b], [b, c], [c, a]];
    if sides.iter().all(|[p, q]| (*q - *p).cross(point - *p).dot(normal) >= 0.0) {
        return 0.0;
    }
    let to = |[p, q]: [DVec3; 2]| {
        let t = ((point - p).dot(q - p) / (q - p).length_squared()).clamp(0.0, 1.0);
        point.distance(p.lerp(q, t))
    };
    sides.map(to).into_iter().fold(f64::INFINITY, f64::min)
}
