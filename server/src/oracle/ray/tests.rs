//! Rays against all triangles one by one, the exact signs, and the rule for ties.

use super::*;

/// A deterministic number in [0, 1).
fn noise(k: u32) -> f64 {
    let mut x = k.wrapping_mul(0x9E37_79B1) ^ 0x85EB_CA6B;
    x = (x ^ x >> 15).wrapping_mul(0x2C1B_3C6D);
    x = (x ^ x >> 13).wrapping_mul(0x297A_2D39);
    f64::from(x ^ x >> 16) / 2f64.powi(32)
}

fn point(k: u32) -> DVec3 {
    DVec3::new(noise(3 * k), noise(3 * k + 1), noise(3 * k + 2))
}

/// Triangles of all sizes, some of them twice, some along an axis.
fn soup(count: u32) -> Tracer {
    let positions: Vec<DVec3> = (0..count)
        .flat_map(|k| {
            let k = if k % 7 == 0 { k / 2 } else { k };
            let size = [0.02, 0.3, 1.0][k as usize % 3];
            let axis = if k % 5 == 0 { DVec3::new(1.0, 0.0, 1.0) } else { DVec3::ONE };
            [0, 1, 2].map(|corner| point(k) + size * axis * point(3 * k + corner + 90_000))
        })
        .collect();
    Tracer::new(positions, (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect())
}

fn segment(k: u32) -> Segment {
    let direction = if k.is_multiple_of(6) { DVec3::Y } else { point(k + 1_000_000) - 0.5 };
    Segment { origin: 3.0 * point(k + 2_000_000) - 1.0, direction, from: 0.0, to: [0.7, f64::INFINITY][k as usize % 2] }
}

#[test]
fn the_nearest_hit_is_the_nearest_of_all_triangles() {
    let tracer = soup(1000);
    let mut met = 0;
    for k in 0..4000 {
        let segment = segment(k);
        let ray = Sheared::new(&segment);
        let all = (0..1000).filter_map(|triangle| tracer.hit(&ray, triangle));
        let nearest = all.clone().min_by(|a, b| (a.t, a.triangle).partial_cmp(&(b.t, b.triangle)).unwrap());
        assert_eq!(tracer.first_hit(&segment), nearest, "segment {k}");
        assert_eq!(tracer.any_hit(&segment), nearest.is_some(), "segment {k}");
        assert_eq!(tracer.hits(&segment).len(), all.count(), "segment {k}");
        met += u32::from(nearest.is_some());
    }
    assert!(met > 500, "{met} segments met a triangle");
}

#[test]
fn hits_lie_on_the_segment_and_on_the_triangle() {
    let tracer = soup(1000);
    for k in 0..4000 {
        let segment = segment(k);
        for hit in tracer.hits(&segment) {
            let [a, b, c] = tracer.corners(hit.triangle);
            let w = hit.barycentrics;
            assert!(w.min_element() >= 0.0 && (w.element_sum() - 1.0).abs() < 1e-15);
            let on_triangle = w.x * a + w.y * b + w.z * c;
            let normal = (b - a).cross(c - a);
            let grazing = (segment.direction.dot(normal) / segment.direction.length() / normal.length()).abs();
            let apart = (segment.origin + hit.t * segment.direction - on_triangle).length();
            assert!(apart * grazing < 1e-14, "segment {k}: {apart} apart at a cosine of {grazing}");
            assert_eq!(hit.front, segment.direction.dot(normal) < 0.0, "segment {k}");
        }
    }
}

#[test]
fn of_equal_triangles_the_first_is_hit() {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let tracer = Tracer::new(corners.to_vec(), vec![[1, 2, 0]; 5]);
    let segment = Segment { origin: DVec3::new(0.2, 0.2, 1.0), direction: -DVec3::Z, from: 0.0, to: 2.0 };
    assert_eq!(tracer.first_hit(&segment).unwrap().triangle, 0);
    assert_eq!(tracer.first_hit_where(&segment, |hit| hit.triangle > 2).unwrap().triangle, 3);
    assert!(!tracer.any_hit_where(&segment, |hit| !hit.front));
    assert!(!tracer.any_hit(&Segment { to: 0.999, ..segment }));
}

#[test]
fn a_fan_around_the_ray_is_hit_once_wherever_the_ray_goes() {
    for turn in 0..6 {
        // Exact quarter turns, mirrored or not: every direction of edge decides once.
        let turned = |(x, y): (i32, i32)| match turn % 3 {
            0 => DVec3::new(x.into(), y.into(), 0.0),
            1 => DVec3::new((-y).into(), x.into(), 0.0),
            _ => DVec3::new((-x).into(), (-y).into(), 0.0),
        };
        let rim = [(2, 0), (2, 2), (0, 2), (-2, 2), (-2, 0), (-2, -2), (0, -2), (2, -2)];
        let positions = [DVec3::ZERO].into_iter().chain(rim.map(turned)).collect();
        let triangle = |k: u32| if turn < 3 { [0, k + 1, (k + 1) % 8 + 1] } else { [0, (k + 1) % 8 + 1, k + 1] };
        let tracer = Tracer::new(positions, (0..8).map(triangle).collect());
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, -1.0), (-1.0, 1.0)] {
            for direction in [DVec3::Z, -DVec3::Z, DVec3::new(0.0, 0.25, -1.0)] {
                let origin = DVec3::new(x, y, 0.0) - direction;
                let hits = tracer.hits(&Segment { origin, direction, from: 0.0, to: 9.0 });
                assert_eq!(hits.len(), 1, "turn {turn}, ({x}, {y}) along {direction}");
                assert_eq!(hits[0].front, (direction.z < 0.0) == (turn < 3));
            }
        }
    }
}

#[test]
fn signs_are_exact_where_rounded_products_cancel() {
    let tiny = 2f64.powi(-52);
    let a = DVec2::new(1.0 + tiny, 1.0);
    assert_eq!(exact_cross(a, a), 0.0);
    // (1 + e)(1 − e) − 1 = −e², far below the rounding of the products.
    assert_eq!(exact_cross(a, DVec2::new(1.0, 1.0 - tiny)), -tiny * tiny);
    assert_eq!(exact_cross(DVec2::new(1.0, 1.0 - tiny), a), tiny * tiny);
    for k in 0..100_000u32 {
        let integer = |n: u32| (noise(4 * k + n) * 2f64.powi(53)).floor();
        let (a, b) = (DVec2::new(integer(0), integer(1)), DVec2::new(integer(2), integer(3)));
        // Nearly parallel, so that the products agree in almost all bits.
        let b = if k % 2 == 0 { b } else { DVec2::new(a.x - f64::from(k % 5), a.y - f64::from(k % 3)) };
        let exact = a.x as i128 * b.y as i128 - a.y as i128 * b.x as i128;
        assert_eq!(exact_cross(a, b).partial_cmp(&0.0).unwrap(), exact.cmp(&0), "{a} {b}");
    }
}

#[test]
fn a_triangle_without_area_is_never_hit() {
    let tracer = Tracer::new(vec![DVec3::ZERO, DVec3::X, 2.0 * DVec3::X], vec![[0, 1, 2], [0, 0, 1], [1, 1, 1]]);
    let segment = Segment { origin: DVec3::new(1.0, 0.0, 1.0), direction: -DVec3::Z, from: 0.0, to: 9.0 };
    assert_eq!(tracer.hits(&segment), []);
}
