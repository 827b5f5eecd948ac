//! What surface gradients promise, against the displaced surface in closed form.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::*;
use crate::layout::bump::{BUMP_CYSLICE, BUMP_HEIGHT};

fn place(sides: [DVec3; 2], normal: DVec3) -> Place {
    Place {
        sides,
        normal,
        front: normal,
        tangent: DVec4::new(1.0, 0.0, 0.0, 1.0),
        world_from_mesh: DMat3::IDENTITY,
        world_from_normal: DMat3::IDENTITY,
    }
}

/// In the plane z = 0.
const PLANE: [DVec3; 2] = [DVec3::new(0.7, 0.1, 0.0), DVec3::new(-0.3, 0.8, 0.0)];

fn shown(kind: u32, value: DVec3) -> Shown {
    Shown { kind, scale: 1.0, value, map_changes: DMat2::IDENTITY, uv_changes: DMat2::IDENTITY }
}

/// Unit vectors and slopes in no order.
fn numbers() -> impl Iterator<Item = [f64; 6]> {
    (1..200).map(|k| std::array::from_fn(|j| (f64::from(k) * (1.3 + j as f64)).sin() * 2.0))
}

fn degrees_between(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}

#[test]
fn the_surface_gradient_bends_as_blinn_does() {
    for [a, b, c, d, hu, hv] in numbers() {
        let (pu, pv) = (DVec3::new(a, b, 0.3 * c), DVec3::new(d, 0.2 * a, b - c));
        let across = pu.cross(pv);
        if across.length() < 0.1 {
            continue;
        }
        let n = across.normalize();
        let blinn = across + hu * n.cross(pv) - hv * n.cross(pu);
        let bent = bent(&place([pu, pv], n), n, DVec2::new(hu, hv), &[]);
        assert!((bent - blinn.normalize()).length() < 1e-12, "{pu} {pv} {hu} {hv}");
    }
}

#[test]
fn a_sine_over_a_plane_is_bent_as_if_it_were_displaced() {
    for k in 0..100 {
        let x = f64::from(k) / 37.0;
        let slope = 0.1 * TAU * 3.0 * (TAU * 3.0 * x).cos();
        let rises = DVec2::new(PLANE[0].x, PLANE[1].x) * slope;
        let displaced = DVec3::new(-slope, 0.0, 1.0).normalize();
        assert!((bent(&place(PLANE, DVec3::Z), DVec3::Z, rises, &[]) - displaced).length() < 1e-14);
    }
}

/// Blinn leaves out H N_u: at height H over curvature 1/R the sides should be longer by 1 + H/R, so slope s is taken for
/// s / (1 + H/R): the angles between are at most that between slopes s and s (1 + H/R).
#[test]
fn over_a_sphere_bump_errs_by_no_more_than_height_times_curvature() {
    for height in [0.01, 0.05, 0.1, 0.2, 0.4] {
        let mut most = 0f64;
        for k in 0..=400 {
            let slope = f64::from(k) / 100.0;
            let displaced = DVec3::new(-slope, 0.0, 1.0 + height).normalize();
            let bumped = bent(&place([DVec3::X, DVec3::Y], DVec3::Z), DVec3::Z, DVec2::new(slope, 0.0), &[]);
            let bound = (height / (2.0 + height)).asin().to_degrees();
            let apart = degrees_between(bumped, displaced);
            assert!(apart <= bound + 1e-12, "height {height}, slope {slope}: {apart} degrees above {bound}");
            most = most.max(apart);
        }
        assert!(most > 0.25 * height.to_degrees(), "height {height}: the bound is near, {most}");
    }
}

#[test]
fn gradients_of_several_heights_add() {
    for [a, b, c, d, ..] in numbers() {
        let [first, second, both] = [DVec2::new(a, b), DVec2::new(c, d), DVec2::new(a + c, b + d)]
            .map(|slopes| shown(BUMP_HEIGHT, slopes.extend(0.0)));
        let bent = |maps: &[Shown]| bent(&place(PLANE, DVec3::Z), DVec3::Z, DVec2::ZERO, maps);
        assert!((bent(&[first, second]) - bent(&[both])).length() < 1e-14);
    }
}

#[test]
fn two_normal_maps_lean_as_much_as_their_slopes_together() {
    let [a, b] = [DVec3::new(0.3, -0.2, 0.8), DVec3::new(-0.1, 0.5, 0.9)];
    let sum = DVec3::new(a.x / a.z + b.x / b.z, a.y / a.z + b.y / b.z, 1.0).normalize();
    let bent = |maps: &[Shown]| bent(&place(PLANE, DVec3::Z), DVec3::Z, DVec2::ZERO, maps);
    assert!((bent(&[a, b].map(|m| shown(BUMP_TANGENT, m))) - sum).length() < 1e-14);
    assert!((bent(&[shown(BUMP_TANGENT, a), shown(BUMP_OBJECT, b)]) - sum).length() < 1e-14);
}

#[test]
fn a_normal_of_object_space_is_taken_as_it_is() {
    for [a, b, c, ..] in numbers() {
        let m = DVec3::new(a, b, c);
        let bent = bent(&place(PLANE, DVec3::Z), DVec3::Z, DVec2::ZERO, &[shown(BUMP_OBJECT, m)]);
        assert!((bent - m.normalize()).length() < 1e-12, "{m}");
    }
}

/// Whatever the UVs, the gradient is that of the height over the plane: mirrored, turned, sheared.
#[test]
fn mirrored_uvs_bend_the_same_way() {
    let gradient = DVec2::new(0.4, -0.7);
    let expected = DVec3::new(-gradient.x, -gradient.y, 1.0).normalize();
    let place_changes = DMat2::from_cols(PLANE[0].truncate(), PLANE[1].truncate());
    for uv_from_place in [[1.0, 0.0, 0.0, 1.0], [-1.0, 0.0, 0.0, 1.0], [0.2, 1.3, -0.9, 0.4], [2.0, 1.0, 0.5, -1.0]] {
        let uv_from_place = DMat2::from_cols_array(&uv_from_place);
        let by_uv = uv_from_place.inverse().transpose() * gradient;
        let map_changes = uv_from_place * place_changes;
        let map = Shown { map_changes, ..shown(BUMP_HEIGHT, by_uv.extend(0.0)) };
        let bent = bent(&place(PLANE, DVec3::Z), DVec3::Z, DVec2::ZERO, &[map]);
        assert!((bent - expected).length() < 1e-12, "{uv_from_place}");
    }
}

#[test]
fn a_triangle_without_area_bends_nothing() {
    assert_eq!(surface_gradient([DVec3::X, DVec3::X], DVec3::Z, DVec2::ONE), DVec3::ZERO);
    assert_eq!(surface_gradient([DVec3::ZERO, DVec3::Y], DVec3::Z, DVec2::ONE), DVec3::ZERO);
}

/// Heights are mesh-local: the surface is displaced, then scaled.
#[test]
fn uneven_scale_bends_as_the_scaled_displaced_surface() {
    let scale = DVec3::new(2.0, 0.5, 3.0);
    let world_from_normal = DMat3::from_diagonal(1.0 / scale);
    let slopes = DVec2::new(0.6, -0.3);
    let local = Place { world_from_mesh: DMat3::from_diagonal(scale), world_from_normal, ..place(PLANE, DVec3::Z) };
    let rises = DVec2::new(PLANE[0].truncate().dot(slopes), PLANE[1].truncate().dot(slopes));
    let displaced = (DVec3::new(-slopes.x, -slopes.y, 1.0) / scale).normalize();
    assert!((bent(&local, DVec3::Z, rises, &[]) - displaced).length() < 1e-14);
}

/// CySlice prints red along T and green along S; t points up, as the bitangent of glTF does.
#[test]
fn cyslice_is_a_swizzle_where_uvs_are_not_mirrored_and_inverts_green_where_they_are() {
    let m = DVec3::new(0.3, 0.5, 0.8);
    let bent = |map: Shown, w: f64| {
        let place = Place { tangent: DVec4::new(1.0, 0.0, 0.0, w), ..place([DVec3::X, DVec3::Y], DVec3::Z) };
        bent(&place, DVec3::Z, DVec2::ZERO, &[map])
    };
    // v runs down: s = x and t = y, not mirrored.
    let uv_changes = DMat2::from_cols(DVec2::X, -DVec2::Y);
    let printed = bent(Shown { uv_changes, ..shown(BUMP_CYSLICE, m) }, 1.0);
    assert!((printed - bent(shown(BUMP_TANGENT, DVec3::new(m.y, m.x, m.z)), 1.0)).length() < 1e-14);
    // s = -x: the tangent points to -x, and the bitangent stays, by its handedness.
    let mirrored = DMat2::from_cols(-DVec2::X, -DVec2::Y);
    let printed = bent(Shown { uv_changes: mirrored, ..shown(BUMP_CYSLICE, m) }, 1.0);
    let right = DVec3::new(-m.y, m.x, m.z).normalize();
    assert!((printed - DVec3::new(m.y, m.x, m.z).normalize()).length() < 1e-14);
    assert!(
        (degrees_between(printed, right) - 2.0 * FRAC_PI_2.min((m.y / m.length()).asin()).to_degrees()).abs() < 1e-9
    );
}

#[test]
fn a_back_facing_normal_of_a_tangent_frame_leans_no_more_than_the_steepest() {
    assert_eq!(leaning(DVec3::new(1.0, 0.0, 0.0)), DVec2::new(STEEPEST, 0.0));
    assert_eq!(leaning(DVec3::new(0.0, 0.0, -1.0)), DVec2::ZERO);
}
