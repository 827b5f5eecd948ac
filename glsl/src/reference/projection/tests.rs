//! Projections against their closed forms, and what they say of change against differences.

use super::*;

const KINDS: [Kind; 7] =
    [Kind::Sphere, Kind::SphereAsPrinted, Kind::PlanarX, Kind::PlanarY, Kind::PlanarZ, Kind::Box, Kind::Triplanar];

/// A place of the unit sphere at (u, v) of its map: Everson's formula with y_w = R sin(theta) sin(phi), turned so that
/// +Y is up.
fn on_sphere(u: f64, v: f64) -> DVec3 {
    let ((sin_phi, cos_phi), (sin_theta, cos_theta)) = ((TAU * u).sin_cos(), (PI * v).sin_cos());
    DVec3::new(sin_theta * cos_phi, cos_theta, -sin_theta * sin_phi)
}

fn still(at: DVec3) -> Place {
    Place { at, normal: at.normalize_or_zero(), ..Place::default() }
}

fn grid(n: usize) -> impl Iterator<Item = (f64, f64)> {
    (0..n * n).map(move |i| ((i % n) as f64 / n as f64, ((i / n) as f64 + 0.5) / n as f64))
}

fn turns_apart(a: f64, b: f64) -> f64 {
    let d = (a - b).rem_euclid(1.0);
    d.min(1.0 - d)
}

#[test]
fn a_sphere_is_read_where_its_formula_puts_it() {
    for (u, v) in grid(64) {
        let found = projected(Kind::Sphere, &still(on_sphere(u, v) * 0.5), 0);
        assert!(turns_apart(found.uv.x, u) < 1e-14 && (found.uv.y - v).abs() < 1e-14, "({u}, {v}): {found:?}");
        assert!((0.0..1.0).contains(&found.uv.x));
    }
}

/// Half of all places are read at -u instead of u, as far apart as 2u: from 0 to half a turn, and a quarter on average.
#[test]
fn as_printed_half_of_the_sphere_is_mirrored() {
    let n = 256;
    let off = |(u, v)| turns_apart(projected(Kind::SphereAsPrinted, &still(on_sphere(u, v)), 0).uv.x, u);
    let errors: Vec<f64> = grid(n).map(off).collect();
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    let worst = errors.iter().copied().fold(0.0, f64::max);
    assert!((mean - 0.125).abs() < 1.0 / n as f64, "{mean}");
    assert!((worst - 0.5).abs() < 1.0 / n as f64, "{worst}");
    assert!(errors.iter().filter(|e| **e < 1e-12).count() >= errors.len() / 2);
}

#[test]
fn derivatives_are_those_of_the_place_across_the_seam_too() {
    let (at, dx, dy) = (DVec3::new(0.3, 0.2, 0.0), DVec3::new(0.01, 0.02, 0.07), DVec3::new(-0.03, 0.05, 0.01));
    let turned = [at, DVec3::new(0.2, -0.3, 0.4), DVec3::new(-0.4, 0.1, -0.2)];
    for (kind, at) in KINDS.into_iter().flat_map(|kind| turned.map(|at| (kind, at))) {
        // At z = 0 the printed form has a kink.
        if kind == Kind::SphereAsPrinted && at.z == 0.0 {
            continue;
        }
        let place = Place { at, dx, dy, normal: DVec3::new(0.8, 0.36, -0.48) };
        for k in 0..kind.count() {
            let found = projected(kind, &place, k);
            for (side, d) in [(found.dx, dx), (found.dy, dy)] {
                let h = 1e-6;
                let uv = |s: f64| projected(kind, &Place { at: at + s * d, ..place }, k).uv;
                let mut difference = uv(h) - uv(-h);
                difference.x -= difference.x.round();
                assert!((difference / (2.0 * h) - side).abs().max_element() < 1e-8, "{kind:?} at {at}");
            }
        }
    }
}

#[test]
fn a_pixel_at_a_pole_covers_a_turn_and_no_more() {
    for at in [DVec3::Y, DVec3::NEG_Y, DVec3::new(1e-9, 1.0, 0.0), DVec3::ZERO] {
        let found = projected(Kind::Sphere, &Place { at, dx: DVec3::X * 0.01, dy: DVec3::Z * 0.01, normal: at }, 0);
        let sides = [found.dx, found.dy];
        assert!(sides.iter().all(|side| side.is_finite() && side.x.abs() <= 1.0), "{at}: {sides:?}");
    }
}

#[test]
fn frames_point_where_their_maps_grow() {
    for kind in KINDS {
        for (u, v) in grid(7) {
            let at = on_sphere(u + 0.01, v) * 0.4;
            let place = Place { at, normal: at.normalize(), ..Place::default() };
            for k in 0..kind.count() {
                let found = projected(kind, &place, k);
                let moved = |d: DVec3| projected(kind, &Place { dx: d, ..place }, k).dx;
                let (along, up) = (moved(found.tangent * 1e-3), moved(found.bitangent * 1e-3));
                assert!(along.x > 0.0 && along.y.abs() < 1e-12, "{kind:?}: {along}");
                assert!(up.y < 0.0 && up.x.abs() < 1e-12, "{kind:?}: {up}");
                assert!((found.tangent.length() - 1.0).abs() < 1e-14 && (found.bitangent.length() - 1.0).abs() < 1e-14);
            }
        }
    }
}

/// Seen from outside, right of a map is right of it, on all six sides of a box.
#[test]
fn a_box_shows_no_mirrored_map() {
    for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
        for normal in [axis, -axis] {
            let found = projected(Kind::Box, &still(normal * 0.5), 0);
            assert!(found.tangent.cross(found.bitangent).dot(normal) > 0.99, "{normal}");
            assert_eq!(found.uv, DVec2::splat(0.5));
        }
    }
}

#[test]
fn weights_are_shares_of_one_and_a_side_that_is_turned_away_has_none() {
    for (u, v) in grid(24) {
        let weights = weights_of(on_sphere(u, v));
        assert!((weights.element_sum() - 1.0).abs() < 1e-15 && weights.min_element() >= 0.0);
    }
    assert_eq!(weights_of(DVec3::new(0.2, 0.98, 0.0)), DVec3::Y);
    assert!((weights_of(DVec3::ONE.normalize()) - DVec3::splat(1.0 / 3.0)).length() < 1e-15);
}

/// As Everson's notes print it: y_w = R sin(theta) cos(phi) puts every place into the plane x = y, at radii from 0 to sqrt 2.
#[test]
fn the_sphere_as_printed_is_flat() {
    let (mut sum, mut count) = (0.0, 0.0);
    let mut radii = (f64::INFINITY, 0.0f64);
    for (u, v) in grid(200) {
        let right = on_sphere(u, v);
        let printed = DVec3::new(right.x, right.y, -right.x);
        radii = (radii.0.min(printed.length()), radii.1.max(printed.length()));
        let area = (PI * v).sin();
        sum += area * (printed - right).length();
        count += area;
        assert_eq!(printed.x + printed.z, 0.0);
    }
    // Mean of sin(theta) |cos(phi) - sin(phi)| over the sphere: pi / 4 times 2 sqrt 2 / pi.
    assert!((sum / count - 0.5f64.sqrt()).abs() < 1e-3, "{}", sum / count);
    assert!(radii.0 < 0.02 && (radii.1 - 2f64.sqrt()).abs() < 1e-3, "{radii:?}");
}
