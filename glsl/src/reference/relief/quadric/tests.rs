//! Heights over quadrics beside those over the sphere and the plane they stand for.

use super::{super::shell::tests::Numbers, *};

/// A small triangle at the pole of a sphere of radius R whose curvature is 1/R everywhere.
fn pole(radius: f64, scale: f64, heights: Range<f64>) -> Bent {
    let corners = [0.0, 2.0, 4.0].map(|third: f64| {
        let turn = third / 3.0 * std::f64::consts::PI;
        DVec3::new(turn.cos(), turn.sin(), 0.0) * scale + DVec3::Z * (radius - scale * scale / (2.0 * radius))
    });
    let half = -0.5 / radius;
    let bends = [[half, 0.0, 0.0, half, 0.0, half]; 3];
    Bent::new(corners, corners, bends, heights.clone(), heights.end * 1.02).unwrap()
}

/// h = √((R + z)² + r²) - R is z + r²/(2 (R + z)) but for r⁴/(8 (R + z)³), where z is how high the ray would be over the
/// plane; what the quadric has for the second term is r²/(2 (R + z₀)), z₀ where it struck.
#[test]
fn heights_over_a_sphere_are_off_by_no_more_than_the_quadric_leaves_out() {
    let (radius, scale) = (1.0, 0.01);
    let mut numbers = Numbers::new();
    for _ in 0..1000 {
        let bent = pole(radius, scale, 0.0..0.05);
        let side = bent.prism().side;
        let lean = numbers.unit().reject_from_normalized(DVec3::Z).normalize() * (0.2 + 3.0 * numbers.next());
        let direction = lean - DVec3::Z;
        let origin = DVec3::Z * (radius + 0.05) - direction * 0.15;
        let flight = bent.strike(bent.prism().local(origin), direction / side).unwrap();
        let time = bent.time(&flight).unwrap();
        for n in 1..=8 {
            let t = time * f64::from(n) / 8.0;
            let place = origin + direction * (flight.t + t);
            let exact = place.length() - radius;
            let (across, z) = (lean.length() * t, place.z - radius);
            let left_out = across.powi(4) / 8.0 / (radius + z).powi(3)
                + across.powi(2) / 2.0 * (1.0 / (radius + z) - 1.0 / (radius + 0.051)).abs();
            // A triangle is flat, and its normals between corners are not those of the place.
            let flat = 2.0 * scale * scale;
            let (_, height) = flight.under(t);
            assert!((height * side - exact).abs() <= left_out * 1.001 + flat, "{n} {height} {exact} {left_out}");
        }
    }
}

#[test]
fn a_ray_that_a_sphere_bends_away_from_leaves_above() {
    let bent = pole(1.0, 0.01, 0.0..0.05);
    let side = bent.prism().side;
    // It comes as near as z = 1.03: between the greatest height and the least.
    let direction = DVec3::new(1.0, 0.0, -0.2).normalize();
    let origin = DVec3::Z * (1.051 + 1e-6) - direction * 0.1;
    let flight = bent.strike(bent.prism().local(origin), direction / side).unwrap();
    let (_, height) = flight.under(bent.time(&flight).unwrap());
    assert!((height - bent.prism().heights.end).abs() < 1e-9, "{height}");
    let lowest = 1.051 * (1.0 - 0.2f64.powi(2) / 1.04).sqrt() - 1.0;
    let times = (0..1000).map(|n| f64::from(n) * 1e-3 * bent.time(&flight).unwrap());
    let least = times.fold(f64::INFINITY, |least, time| least.min(flight.under(time).1 * side));
    assert!((least - lowest).abs() < 2e-3, "{least} {lowest}");
}

#[test]
fn over_a_plane_a_flight_is_straight() {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let bent = Bent::new(corners, [DVec3::Z; 3], [[0.0; 6]; 3], -0.1..0.2, 0.21).unwrap();
    let side = bent.prism().side;
    let direction = DVec3::new(1.0, 0.5, -0.5);
    let flight = bent.strike(bent.prism().local(DVec3::new(0.2, 0.2, 0.2)), direction / side).unwrap();
    let time = bent.time(&flight).unwrap();
    let (weights, height) = flight.under(time);
    assert!((height - bent.prism().heights.start).abs() < 1e-12);
    // 0.6 from where it is at the greatest height to where it is at the least, and on by the margin.
    let further = (height * side + 0.1) / -0.5;
    let end = DVec3::new(0.2, 0.2, 0.2) + direction * (0.6 + further);
    assert!((flight.t + time - 0.6 - further).abs() < 1e-12);
    assert!((weights - DVec3::new(1.0 - end.x - end.y, end.x, end.y)).abs().max_element() < 1e-12, "{weights}");
    assert!(bent.strike(bent.prism().local(DVec3::new(0.2, 0.2, -1.0)), DVec3::Z).is_none());
}
