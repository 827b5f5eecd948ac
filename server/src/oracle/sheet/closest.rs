//! The nearest place of one triangle.

use glam::DVec3;

/// The place of a triangle nearest to a point, and its barycentrics (Ericson 2005, 5.1.5).
#[inline]
pub(crate) fn closest_on_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> (DVec3, DVec3) {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (a, DVec3::X);
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return (b, DVec3::Y);
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 && d1 > d3 {
        let t = d1 / (d1 - d3);
        return (a + ab * t, DVec3::new(1.0 - t, t, 0.0));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return (c, DVec3::Z);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 && d2 > d6 {
        let t = d2 / (d2 - d6);
        return (a + ac * t, DVec3::new(1.0 - t, 0.0, t));
    }
    let va = d3 * d6 - d5 * d4;
    let (e, f) = (d4 - d3, d5 - d6);
    if va <= 0.0 && e >= 0.0 && f >= 0.0 && e + f > 0.0 {
        let t = e / (e + f);
        return (b + (c - b) * t, DVec3::new(0.0, 1.0 - t, t));
    }
    let sum = va + vb + vc;
    if sum <= 0.0 {
        return closest_on_sides(p, [a, b, c]);
    }
    let (v, w) = refined(p, a, ab, ac, vb / sum, vc / sum);
    let inside = a + ab * v + ac * w;
    // What is refined out of the triangle is nearest to a side; so are slivers, where digits are lost.
    let sides = closest_on_sides(p, [a, b, c]);
    if sides.0.distance_squared(p) < inside.distance_squared(p) {
        sides
    } else {
        (inside, DVec3::new(1.0 - v - w, v, w))
    }
}

/// One step towards the foot of p on the plane, across directions at right angles.
#[inline]
fn refined(p: DVec3, a: DVec3, ab: DVec3, ac: DVec3, v: f64, w: f64) -> (f64, f64) {
    let along = ab.normalize_or_zero();
    let across = ac - along * along.dot(ac);
    let rest = p - (a + ab * v + ac * w);
    let dw = rest.dot(across) / across.length_squared();
    let dv = (rest.dot(along) - dw * ac.dot(along)) / ab.length();
    let (better_v, better_w) = (v + dv, w + dw);
    let inside = better_v >= 0.0 && better_w >= 0.0 && better_v + better_w <= 1.0;
    if inside { (better_v, better_w) } else { (v, w) }
}

fn closest_on_sides(p: DVec3, corners: [DVec3; 3]) -> (DVec3, DVec3) {
    let side = |k: usize| {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        let length = (b - a).length_squared();
        let t = if length > 0.0 { ((p - a).dot(b - a) / length).clamp(0.0, 1.0) } else { 0.0 };
        let mut at = DVec3::ZERO;
        at[k] = 1.0 - t;
        at[(k + 1) % 3] += t;
        (a + (b - a) * t, at)
    };
    let sides = [side(0), side(1), side(2)];
    let nearer = |x: &(DVec3, DVec3), y: &(DVec3, DVec3)| x.0.distance_squared(p).total_cmp(&y.0.distance_squared(p));
    sides.into_iter().min_by(nearer).unwrap_or(side(0))
}

#[inline]
pub(crate) fn distance_to_triangle(p: DVec3, triangle: [DVec3; 3]) -> f64 {
    closest_on_triangle(p, triangle).0.distance(p)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(k: u32) -> f64 {
        f64::from(k.wrapping_mul(0x9E37_79B1) ^ k.wrapping_mul(0x85EB_CA6B) >> 9) / f64::from(u32::MAX)
    }

    fn point(k: u32) -> DVec3 {
        DVec3::new(noise(3 * k), noise(3 * k + 1), noise(3 * k + 2))
    }

    #[test]
    fn no_place_of_a_triangle_is_nearer_than_the_nearest() {
        for k in 0..2000 {
            let mut triangle = [point(5 * k), point(5 * k + 1), point(5 * k + 2)];
            if k % 3 == 0 {
                triangle[2] = triangle[0].lerp(triangle[1], noise(k)) + 1e-9 * point(k);
            }
            let p = 3.0 * point(5 * k + 3) - 1.0;
            let (place, at) = closest_on_triangle(p, triangle);
            assert!((at.element_sum() - 1.0).abs() < 1e-9 && at.min_element() >= -1e-12, "{at}");
            assert!(super::super::blend(triangle, at).distance(place) < 1e-7);
            for i in 0..=30 {
                for j in 0..=30 - i {
                    let b = DVec3::new(f64::from(30 - i - j), f64::from(i), f64::from(j)) / 30.0;
                    let other = super::super::blend(triangle, b);
                    assert!(place.distance(p) <= other.distance(p) + 1e-12, "{triangle:?} {p}");
                }
            }
        }
    }
}
