//! Arithmetic of tolerances, on meshes whose answers are known.

use glam::{DMat4, DVec2, DVec3};

use super::*;
use crate::domain::{
    request::ToleranceView,
    scene::SceneMesh,
    weld::{PrimitiveInput, weld},
};

/// A triangle from -`half` to `half` in the plane z = 0.
fn mesh(half: f32) -> SceneMesh {
    let positions = vec![[-half, -half, 0.0], [half, -half, 0.0], [0.0, half, 0.0]];
    let input = PrimitiveInput {
        normals: Some(vec![[0.0, 0.0, 1.0]; 3]),
        positions,
        triangles: vec![[0, 1, 2]],
        ..PrimitiveInput::default()
    };
    SceneMesh { gltf_mesh: 0, mesh: weld("triangle", &[input]).unwrap() }
}

fn placed(world: DMat4) -> Instance {
    Instance { mesh: 0, world_from_mesh: world.as_mat4().to_cols_array() }
}

fn scaled(x: f64, y: f64, z: f64) -> Instance {
    placed(DMat4::from_scale(DVec3::new(x, y, z)))
}

/// The scene's diagonal is 10 world units.
fn scene(instances: Vec<Instance>) -> Scene {
    Scene { meshes: vec![mesh(1.0)], instances, diagonal: 10.0, ..Scene::default() }
}

fn tolerance(allowed: Allowed) -> Tolerance {
    Tolerance { allowed, error_at: ErrorAt::Surface, quality: Quality::Normal }
}

fn planned(scene: &Scene, allowed: Allowed) -> (TolerancePlan, Option<Warning>) {
    TolerancePlan::new(scene, 0, &tolerance(allowed), 1000).unwrap()
}

/// From 3 ahead of the middle, 90 degrees high and wide, 100 pixels: a pixel is 0.02 at depth 1.
fn view() -> ToleranceView {
    ToleranceView { eye: [0.0, 0.0, 3.0], target: [0.0; 3], yfov_degrees: 90.0, width: 100, height: 100 }
}

fn pixels(tolerance_px: f64) -> Allowed {
    Allowed::Pixels { tolerance_px, views: vec![view()] }
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-6 * b.abs()
}

#[test]
fn a_world_length_is_divided_by_what_the_most_enlarged_instance_does() {
    for (instances, enlarged) in [
        (vec![], 1.0),
        (vec![scaled(0.5, 0.5, 0.5)], 0.5),
        (vec![scaled(1.0, 2.0, 3.0), scaled(0.1, 5.0, 0.1)], 5.0),
        // What shows nothing asks for nothing.
        (vec![scaled(0.0, 0.0, 0.0)], 1.0),
        (vec![placed(DMat4::from_rotation_x(1.0) * DMat4::from_scale(DVec3::new(-4.0, 1.0, 1.0)))], 4.0),
    ] {
        let (plan, warning) = planned(&scene(instances), Allowed::World(0.01));
        assert!(near(plan.tolerance_local, 0.01 / enlarged), "{enlarged}: {plan:?}");
        assert!(near(plan.unit_per_local, enlarged) && warning.is_none(), "{enlarged}: {plan:?}");
    }
}

#[test]
fn instances_of_other_meshes_say_nothing() {
    let other = Instance { mesh: 1, ..scaled(100.0, 100.0, 100.0) };
    let (plan, _) = planned(&scene(vec![other, scaled(2.0, 2.0, 2.0)]), Allowed::World(0.01));
    assert!(near(plan.tolerance_local, 0.005), "{plan:?}");
}

#[test]
fn a_share_is_of_the_diagonal_of_the_scene() {
    let (plan, _) = planned(&scene(vec![scaled(2.0, 1.0, 1.0)]), Allowed::Diagonal(1e-3));
    assert!(near(plan.tolerance_local, 1e-3 * 10.0 / 2.0), "{plan:?}");
    assert!(near(plan.tolerance_local * plan.unit_per_local, 1e-3), "{plan:?}");
    let flat = Scene { diagonal: 0.0, ..scene(vec![]) };
    let error = TolerancePlan::new(&flat, 0, &tolerance(Allowed::Diagonal(1e-3)), 1000).unwrap_err();
    assert!(error.message.contains("no extent") && error.message.contains("world units"), "{error}");
}

#[test]
fn what_positions_cannot_hold_is_raised_to_what_they_can() {
    let (plan, warning) = planned(&scene(vec![]), Allowed::World(1e-9));
    // The box is 2 wide.
    let least = 2.0 * 4.0 / f64::from(1 << 24);
    assert!(near(plan.tolerance_local, least), "{plan:?}");
    let warning = warning.unwrap();
    assert_eq!(warning.code, "tolerance_clamped");
    for part in ["'triangle'", "1.000e-9", "4.768e-7", "world units", "origin"] {
        assert!(warning.message.contains(part), "{part}: {}", warning.message);
    }
    // A length of the result in the unit of the request stays what it is.
    assert!(near(plan.unit_per_local, 1.0), "{plan:?}");
    assert_eq!(planned(&scene(vec![]), Allowed::World(1.01 * least)).1, None);
}

#[test]
fn a_stream_bounds_the_triangles_of_a_mesh() {
    let unbounded = TolerancePlan::new(&scene(vec![]), 0, &tolerance(Allowed::World(1.0)), u64::MAX).unwrap().0;
    assert_eq!(unbounded.max_triangles, MOST_TRIANGLES);
    assert_eq!(planned(&scene(vec![]), Allowed::World(1.0)).0.max_triangles, 1000);
}

#[test]
fn without_views_the_tolerance_is_the_same_everywhere() {
    let (plan, _) = planned(&scene(vec![]), Allowed::World(0.25));
    assert_eq!(plan.tolerance_at(DVec3::splat(1e6), 3.0), 0.25);
}

#[test]
fn pixels_allow_more_the_deeper_they_lie() {
    let (plan, warning) = planned(&scene(vec![scaled(2.0, 2.0, 2.0)]), pixels(0.5));
    // A pixel of depth 1 over the scale.
    let at_unit_depth = 0.5 * 0.02 / 2.0;
    // Local places; the eye is 3 world units ahead of the middle.
    assert!(near(plan.tolerance_at(DVec3::ZERO, 0.0), 3.0 * at_unit_depth));
    let cosine = (3.0 - 0.5) / (3.0 + 0.5);
    assert!(near(plan.tolerance_at(DVec3::ZERO, 0.25), (3.0 - 0.5) * cosine * at_unit_depth));
    let aside = DVec3::new(1.5, 1.0, -8.0);
    let cosine = 19.0 / DVec3::new(3.0, 2.0, 19.0).length();
    assert!(near(plan.tolerance_at(aside, 0.0), 19.0 * cosine * at_unit_depth));
    let of_corner = at_unit_depth / 3f64.sqrt();
    assert!(near(plan.tolerance_local, 0.01 * of_corner), "1/1000 of the diagonal is the nearest: {plan:?}");
    assert!(near(plan.tolerance_local * plan.unit_per_local, 0.5) && warning.is_none());
}

#[test]
fn what_the_eye_is_inside_of_is_held_to_the_nearest_depth() {
    let (plan, _) = planned(&scene(vec![scaled(1.0, 1.0, 1.0)]), pixels(0.5));
    assert_eq!(plan.tolerance_at(DVec3::new(0.0, 0.0, 3.0), 0.5), plan.tolerance_local);
    assert_eq!(plan.tolerance_at(DVec3::new(0.0, 0.0, 2.0), 100.0), plan.tolerance_local);
    let on_axis = 3f64.sqrt() * plan.tolerance_local;
    assert!(near(plan.tolerance_at(DVec3::new(0.0, 0.0, 2.995), 0.0), on_axis));
}

#[test]
fn what_a_view_sees_nearer_than_the_nearest_depth_is_found_and_nothing_else() {
    let (plan, _) = planned(&scene(vec![scaled(2.0, 2.0, 2.0)]), pixels(0.5));
    let seen = |corners: [[f64; 3]; 3]| plan.views[0].seen_too_near(corners.map(|p| DVec3::from_array(p) * 0.5));
    // The nearest depth is 0.01.
    let least = seen([[-9.0, -9.0, 2.995], [9.0, -9.0, 2.995], [0.0, 9.0, 2.995]]).unwrap();
    assert!(near(least, 0.005), "{least}");
    assert_eq!(seen([[-1.0, -1.0, 2.98], [1.0, -1.0, 2.98], [0.0, 1.0, 2.98]]), None, "farther");
    assert_eq!(seen([[-1.0, -1.0, 3.005], [1.0, -1.0, 3.005], [0.0, 1.0, 3.005]]), None, "behind");
    assert_eq!(seen([[0.1, -1.0, 9.0], [0.1, 1.0, 9.0], [0.1, 0.0, -9.0]]), None, "passes by");
    let least = seen([[0.0, -1.0, 9.0], [0.0, 1.0, 9.0], [0.0, 0.0, -9.0]]).unwrap();
    assert!(least < 1e-12, "through the eye: {least}");
}

#[test]
fn what_is_not_seen_is_allowed_eight_times_what_a_look_there_would_allow() {
    let (plan, _) = planned(&scene(vec![scaled(1.0, 1.0, 1.0)]), pixels(0.5));
    // On the axis.
    let at_unit_depth = plan.views[0].tolerance_at_unit_depth * 3f64.sqrt();
    let eye = DVec3::new(0.0, 0.0, 3.0);
    for away in [DVec3::Z, DVec3::X, -DVec3::Y, DVec3::new(2.0, 0.0, -1.0)] {
        let expected = 8.0 * (away.length() * 5.0 - 0.5) * at_unit_depth;
        let found = plan.tolerance_at(eye + away * 5.0, 0.5);
        assert!(near(found, expected), "{away}: {found} instead of {expected}");
    }
    // A part inside counts as inside.
    let across = plan.tolerance_at(eye + DVec3::new(1.1, 0.0, -1.0), 0.2);
    let cosine = (0.8 / (1.1f64.hypot(1.0) + 0.2)).max(1.0 / 3f64.sqrt());
    assert!(near(across, 0.8 * cosine * at_unit_depth), "{across}");
}

#[test]
fn a_larger_sphere_is_never_allowed_more() {
    let wide = ToleranceView { yfov_degrees: 179.0, width: 100, height: 1, ..view() };
    for view in [view(), wide] {
        let allowed = Allowed::Pixels { tolerance_px: 1.0, views: vec![view] };
        let (plan, _) = planned(&scene(vec![scaled(1.0, 2.0, 0.5)]), allowed);
        for k in 0..500 {
            let turn = |n: i32| f64::from(k % n) / f64::from(n) * 2.0 - 1.0;
            let centre = DVec3::new(turn(17) * 9.0, turn(13) * 9.0, turn(7) * 9.0);
            let mut last = f64::MAX;
            for radius in [0.0, 0.01, 0.3, 1.0, 3.0, 10.0] {
                let found = plan.tolerance_at(centre, radius);
                assert!(found <= last, "{centre}, {radius}: {found} after {last}");
                last = found;
            }
        }
    }
}

#[test]
fn what_is_flat_but_for_rounding_is_allowed_what_the_corner_is() {
    let turn = |axis: DVec3, degrees: f64| DMat4::from_axis_angle(axis, degrees.to_radians());
    for k in 0..300 {
        let [a, b] = [f64::from(k % 12) * 15.0, f64::from(k % 25) * 15.0];
        let world = turn(DVec3::Y, a)
            * DMat4::from_scale(DVec3::new(1.0, 0.0, 1.0))
            * turn(DVec3::X, b)
            * turn(DVec3::Z, a + 30.0);
        let (plan, _) = planned(&scene(vec![placed(world)]), pixels(1.0));
        let found = plan.tolerance_at(DVec3::ZERO, 0.0);
        assert!(near(found, 3.0 * plan.views[0].tolerance_at_unit_depth), "{k}: {found}");
    }
}

#[test]
fn nothing_allowed_moves_a_place_of_the_image_by_more_than_the_pixels() {
    let shear = DMat4::from_cols_array_2d(&[
        [1.0, 0.0, 0.0, 0.0],
        [0.7, 1.5, 0.0, 0.0],
        [0.0, 0.3, 0.8, 0.0],
        [0.1, 0.2, -6.0, 1.0],
    ]);
    let turned = DMat4::from_axis_angle(DVec3::new(1.0, 2.0, 2.0) / 3.0, 0.7);
    assert!((0.8..=2.0).contains(&most_pixels(shear)), "{} pixels", most_pixels(shear));
    assert!((1.85..=2.0).contains(&most_pixels(turned)), "{} pixels", most_pixels(turned));
}

/// The most that what two pixels allow moves anything seen of an instance.
fn most_pixels(world: DMat4) -> f64 {
    let view = ToleranceView { yfov_degrees: 100.0, width: 300, height: 100, ..view() };
    let allowed = Allowed::Pixels { tolerance_px: 2.0, views: vec![view.clone()] };
    let (plan, _) = planned(&scene(vec![placed(world)]), allowed);
    let tangent = (0.5 * f64::from(view.yfov_degrees).to_radians()).tan();
    let on_screen = |p: DVec3| {
        let p = world.transform_point3(p) - DVec3::new(0.0, 0.0, 3.0);
        let behind = DVec2::MAX;
        if p.z < -0.1 { p.truncate() / -p.z * (0.5 * f64::from(view.height) / tangent) } else { behind }
    };
    let mut most: f64 = 0.0;
    for k in 0..4000 {
        let turn = |k: i32, n: i32| f64::from(k % n) / f64::from(n) * 2.0 - 1.0;
        let p = DVec3::new(turn(k, 17) * 20.0, turn(k, 13) * 8.0, turn(k, 5) * 4.0);
        let shift = DVec3::new(turn(k, 7), turn(k, 11), turn(k, 3)).normalize_or(DVec3::Z);
        let (x, y) = (on_screen(p).x.abs(), on_screen(p).y.abs());
        if x > 150.0 || y > 50.0 {
            continue;
        }
        let allowed = plan.tolerance_at(p, 0.0);
        // The sphere holds both ends.
        let allowed = plan.tolerance_at(p, allowed);
        most = most.max(on_screen(p).distance(on_screen(p + shift * allowed)));
    }
    most
}

#[test]
fn what_is_kept_back_is_there_in_every_view_and_sphere() {
    let scene = scene(vec![scaled(1.0, 1.0, 1.0)]);
    let (asked, _) = planned(&scene, pixels(0.5));
    let mut plan = asked.clone();
    plan.keep_back(&scene.meshes[0].mesh, 0.0);
    let error = plan.reserve.unwrap().error_local;
    for (centre, radius) in [(DVec3::ZERO, 0.1), (DVec3::new(0.9, -0.9, 0.3), 0.3), (DVec3::ZERO, 1.4)] {
        let (whole, rest) = (asked.tolerance_at(centre, radius), plan.tolerance_at(centre, radius));
        assert!(rest + error <= whole && rest > 0.7 * whole, "{rest} and {error} of {whole}");
    }
}

#[test]
fn the_strictest_view_and_instance_decide() {
    let far = ToleranceView { eye: [0.0, 0.0, 300.0], ..view() };
    let both = |views: Vec<ToleranceView>| Allowed::Pixels { tolerance_px: 1.0, views };
    let scene = scene(vec![scaled(1.0, 1.0, 1.0), scaled(3.0, 3.0, 3.0)]);
    let (one, _) = planned(&scene, both(vec![view()]));
    let (two, _) = planned(&scene, both(vec![far, view()]));
    assert_eq!((one.views.len(), two.views.len()), (2, 4));
    assert_eq!(one.tolerance_at(DVec3::ZERO, 0.0), two.tolerance_at(DVec3::ZERO, 0.0));
    let views: Vec<ToleranceView> = vec![view(); 64];
    let crowd = Scene { instances: vec![scaled(1.0, 1.0, 1.0); 65], ..scene };
    let error = TolerancePlan::new(&crowd, 0, &tolerance(both(views)), 1000).unwrap_err();
    assert!(error.message.contains("64 views of 65 instances"), "{error}");
}

#[test]
fn a_flattened_instance_is_never_called_unseen_by_mistake() {
    // Seen on edge: the plane through the eye's axis has no normal left.
    let (plan, _) = planned(&scene(vec![scaled(0.0, 1.0, 1.0)]), pixels(1.0));
    let found = plan.tolerance_at(DVec3::new(1e9, 0.0, 0.0), 0.0);
    assert!(near(found, 3.0 * plan.views[0].tolerance_at_unit_depth), "{found}");
    for plane in &plan.views[0].planes_local {
        assert!(plane.iter().all(|x| x.is_finite()), "{plane:?}");
    }
}

#[test]
fn pixels_too_small_for_positions_are_told_where_the_mesh_lies() {
    let close = ToleranceView { eye: [0.0, 0.0, 1.5], width: 16384, height: 16384, ..view() };
    let (plan, warning) = planned(&scene(vec![]), Allowed::Pixels { tolerance_px: 0.01, views: vec![close] });
    assert_eq!(warning.map(|w| w.code).as_deref(), Some("tolerance_clamped"));
    let least = 2.0 * 4.0 / f64::from(1 << 24);
    assert!(near(plan.tolerance_local, least), "{plan:?}");
    assert!(plan.tolerance_local * plan.unit_per_local > 0.01, "more pixels than asked for are told");
    // Where only what is nowhere would be too near, nothing is.
    let (plan, warning) = planned(&scene(vec![]), pixels(0.01));
    assert!(warning.is_none() && plan.tolerance_local >= least, "{plan:?}");
}

#[test]
fn a_plan_survives_being_written_and_read() {
    for allowed in [Allowed::World(0.25), pixels(1.0)] {
        let (plan, _) = planned(&scene(vec![scaled(1.0, 2.0, 3.0)]), allowed);
        let text = serde_json::to_string(&plan).unwrap();
        let read: TolerancePlan = serde_json::from_str(&text).unwrap();
        assert_eq!(read.views.len(), plan.views.len());
        assert!(near(read.tolerance_at(DVec3::ONE, 0.5), plan.tolerance_at(DVec3::ONE, 0.5)), "{text}");
    }
}
