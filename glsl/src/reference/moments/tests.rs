//! Claims about slope moments, and how near they keep highlights to what all normals of a pixel show.

mod highlights;

use super::*;

#[test]
fn slopes_are_bounded_whatever_a_normal_map_holds() {
    for n in [[0.6, 0.8, 0.0], [0.1, 0.0, -1.0], [0.7, 0.7, 1e-30], [-1.0, 1.0, -1.0]] {
        let [x, y] = slopes(n);
        assert!((x.hypot(y) - MAX_SLOPE).abs() < 1e-4, "{n:?}: {x} {y}");
    }
    assert_eq!([slopes([0.3, -0.4, 0.5]), slopes([0.0; 3])], [[0.6, -0.8], [0.0; 2]]);
}

#[test]
fn a_covariance_is_never_negative_and_is_that_of_the_slopes() {
    let slopes = [[0.5, -0.25], [0.1, 0.7], [-0.3, 0.2], [0.4, 0.1]].map(DVec2::from_array);
    let mean = slopes.iter().sum::<DVec2>() / 4.0;
    let squares = |d: DVec2| [d.x * d.x, d.y * d.y, d.x * d.y];
    let moments = [0, 1, 2].map(|k| slopes.iter().map(|s| squares(*s)[k]).sum::<f64>() / 4.0);
    let [xx, xy, yy] = covariance(mean, moments);
    let expected = [0, 1, 2].map(|k| slopes.iter().map(|s| squares(*s - mean)[k]).sum::<f64>() / 4.0);
    assert!([xx, yy, xy].iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15));
    // What rounding may make of the moments of one slope.
    for wrong in [-1e-5, 0.0, 1e-5] {
        let [xx, xy, yy] = covariance(DVec2::new(3.0, -2.0), [9.0 + wrong, 4.0, -6.0 + 1e-5]);
        assert!(xx >= 0.0 && yy >= 0.0 && xx * yy - xy * xy >= -1e-18);
    }
}

#[test]
fn products_of_a_texel_are_means_over_it_of_what_lies_between_texels() {
    let around = [
        [[0.1, 0.9], [0.3, -0.2], [0.5, 0.4]],
        [[-0.6, 0.2], [0.2, 0.1], [0.7, -0.3]],
        [[0.0, 0.5], [-0.4, 0.8], [1.0, 0.6]],
    ];
    let texels = around.as_flattened().iter().map(|[x, y]| [f64::from(*x), f64::from(*y), 0.0, 0.0]).collect();
    let level = crate::reference::mip::Level { width: 3, height: 3, texels, alpha_scale: 1.0 };
    let count = 400;
    let place = |i: usize| (1.0 + (i as f64 + 0.5) / count as f64) / 3.0;
    let mut sums = [0.0; 3];
    for (x, y) in (0..count * count).map(|i| (place(i % count), place(i / count))) {
        let [a, b, ..] = crate::reference::texture::bilinear(&level, [x, y], [2; 2]);
        [a * a, b * b, a * b].iter().zip(&mut sums).for_each(|(p, sum)| *sum += p / (count * count) as f64);
    }
    assert!(products(&around).iter().zip(sums).all(|(a, b)| (f64::from(*a) - b).abs() < 1e-5));
}

fn under(normal: DVec3, flip: f64) -> Under {
    Under { color: glam::DVec4::ONE, normal: normal * flip, flip, tangent: DVec3::X.extend(-1.0), tilt: None }
}

/// Covariance of slopes, over the plane across `n`, of normals drawn evenly about `mean` in the tangent frame.
fn of_normals(under: &Under, mean: DVec2, axes: [DVec2; 2], n: DVec3) -> [f64; 3] {
    let front = under.normal * under.flip;
    let b = -front.cross(DVec3::X);
    let (e, f) = (n.any_orthonormal_vector(), n.cross(n.any_orthonormal_vector()));
    let mut sums = [0.0; 3];
    for (side, axis) in [(1.0, 0), (-1.0, 0), (1.0, 1), (-1.0, 1)] {
        let slope = mean + side * 2f64.sqrt() * axes[axis];
        let normal = slope.x * DVec3::X + slope.y * b + front;
        let over = DVec2::new(normal.dot(e), normal.dot(f)) / normal.dot(n);
        [over.x * over.x, over.x * over.y, over.y * over.y].iter().zip(&mut sums).for_each(|(p, s)| *s += p / 4.0);
    }
    sums
}

#[test]
fn spreads_lie_across_the_mean_normal_and_hold_the_covariance_there() {
    let axes = [DVec2::new(2e-3, 1e-3), DVec2::new(-0.5e-3, 1.5e-3)];
    let sigma = [0, 1, 2].map(|k| axes.iter().map(|d| [d.x * d.x, d.x * d.y, d.y * d.y][k]).sum::<f64>());
    for (normal, flip) in [(DVec3::Z, 1.0), (DVec3::new(0.3, 0.2, 1.0).normalize(), -1.0)] {
        let (under, mean) = (under(normal, flip), DVec2::new(0.8, -0.5));
        let spread = in_world(&under, mean, sigma);
        let n = (mean.x * DVec3::X - mean.y * normal.cross(DVec3::X) + normal).normalize();
        assert!(spread.major.dot(n).abs() < 1e-12 && spread.minor.dot(n).abs() < 1e-12);
        assert!(spread.major.dot(spread.minor).abs() < 1e-12 && spread.major.length() >= spread.minor.length());
        let (e, f) = (n.any_orthonormal_vector(), n.cross(n.any_orthonormal_vector()));
        let over = [spread.major, spread.minor].map(|axis| DVec2::new(axis.dot(e), axis.dot(f)));
        let found = [0, 1, 2].map(|k| over.iter().map(|d| [d.x * d.x, d.x * d.y, d.y * d.y][k]).sum::<f64>());
        for (found, expected) in found.iter().zip(of_normals(&under, mean, axes, n)) {
            assert!((found - expected).abs() < 1e-5 * sigma[0], "{found} {expected}");
        }
    }
}

#[test]
fn pixels_within_a_texel_see_no_spread_and_those_of_two_see_all() {
    let seen = |side: f64| covered(DVec2::new(side, 0.0), DVec2::new(0.0, 1e-6 * side));
    assert_eq!(
        [0.0, 1.0, 2.5f64.sqrt(), 2.0, 9.0, f64::INFINITY].map(seen).map(|x| (x * 1e9).round() / 1e9),
        [0.0, 0.0, 0.5, 1.0, 1.0, 1.0]
    );
}
