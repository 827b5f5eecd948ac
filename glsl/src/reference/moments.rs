//! Twin of `moments`: how the normals under a fragment scatter, from the filtered means and second moments of a map's slopes
//! (LEAN, Olano and Baker 2010).

use glam::{DMat2, DVec2, DVec3};

use super::{appearance::Under, surface::unit_or_zero};

/// Longest slope that a normal stands for; steeper ones, and normals that point into the surface, are cut off there. Its
/// square times the rounding of f32 is what is lost of a covariance: 3e-5.
pub const MAX_SLOPE: f32 = 16.0;

/// Slopes (x / z, y / z) of a normal of the tangent frame, of any length.
#[must_use]
pub fn slopes([x, y, z]: [f32; 3]) -> [f32; 2] {
    let least = x.hypot(y) / MAX_SLOPE;
    let z = z.max(least);
    if z > 0.0 { [x / z, y / z] } else { [0.0; 2] }
}

/// Places of a texel, by its middle and along either axis, whose mean is exactly that of products of what is bilinear between
/// texels (two points of Gauss for either half).
const PLACES: [f64; 4] =
    [-0.394_337_567_297_406_4, -0.105_662_432_702_593_56, 0.105_662_432_702_593_56, 0.394_337_567_297_406_4];

/// Means over a texel of the products xx, yy and xy of slopes, which are bilinear between texels: what has to be filtered
/// besides the slopes themselves. `around`: slopes of the texel, in the middle, and of its neighbours, rows of v.
#[must_use]
pub fn products(around: &[[[f32; 2]; 3]; 3]) -> [f32; 3] {
    let slope = |x: usize, y: usize| DVec2::from_array(around[y][x].map(f64::from));
    let along = |row: usize, u: f64| slope(1, row).lerp(slope(if u < 0.0 { 0 } else { 2 }, row), u.abs());
    let mut sums = [0.0; 3];
    for v in PLACES {
        for u in PLACES {
            let at = along(1, u).lerp(along(if v < 0.0 { 0 } else { 2 }, u), v.abs());
            [at.x * at.x, at.y * at.y, at.x * at.y].iter().zip(&mut sums).for_each(|(p, sum)| *sum += p / 16.0);
        }
    }
    sums.map(|sum| sum as f32)
}

/// As in `spread.glsl`: one standard deviation of slopes over the plane across the normal, along the principal axes; world.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    pub major: DVec3,
    pub minor: DVec3,
}

/// xx, xy and yy of slopes. `moments`: means of [`products`]. Never negative, though rounding may leave a difference of near
/// equals so.
#[must_use]
pub fn covariance(mean: DVec2, moments: [f64; 3]) -> [f64; 3] {
    let xx = (moments[0] - mean.x * mean.x).max(0.0);
    let yy = (moments[1] - mean.y * mean.y).max(0.0);
    let most = (xx * yy).sqrt();
    [xx, (moments[2] - mean.x * mean.y).clamp(-most, most), yy]
}

/// Share of the spread that a pixel sees. Within a texel there is none: what is bilinear between texels has the slopes that
/// it shows there, and the products are those of whole texels. A pixel of two texels sees all. `dx`, `dy`: sides of the
/// pixel, texels.
#[must_use]
pub fn covered(dx: DVec2, dy: DVec2) -> f64 {
    let (xx, xy, yy) = (dx.x * dx.x + dy.x * dy.x, dx.x * dx.y + dy.x * dy.y, dx.y * dx.y + dy.y * dy.y);
    let major_squared = 0.5 * (xx + yy) + (0.5 * (xx - yy)).hypot(xy);
    if major_squared.is_finite() { ((major_squared - 1.0) / 3.0).clamp(0.0, 1.0) } else { 1.0 }
}

/// `mean` and `sigma` (xx, xy, yy) of slopes in the tangent frame, brought over the plane across the mean normal to first
/// order.
#[must_use]
pub fn in_world(under: &Under, mean: DVec2, sigma: [f64; 3]) -> Spread {
    let tangent = unit_or_zero(under.tangent.truncate());
    if tangent == DVec3::ZERO || under.tangent.w == 0.0 {
        return Spread::default();
    }
    let front = under.normal * under.flip;
    let bitangent = under.tangent.w.signum() * front.cross(tangent);
    let direction = mean.x * tangent + mean.y * bitangent + front;
    let size = direction.length();
    let n = direction / size.max(1e-20);
    let across = tangent - tangent.dot(n) * n;
    if size < 1e-10 || across.length_squared() < 1e-12 {
        return Spread::default();
    }
    let e = across.normalize();
    let f = n.cross(e);
    let map =
        DMat2::from_cols_array(&[tangent.dot(e), tangent.dot(f), bitangent.dot(e), bitangent.dot(f)].map(|w| w / size));
    principal(e, f, map * DMat2::from_cols_array(&[sigma[0], sigma[1], sigma[1], sigma[2]]) * map.transpose())
}

fn principal(e: DVec3, f: DVec3, sigma: DMat2) -> Spread {
    let (xx, xy, yy) = (sigma.x_axis.x, sigma.y_axis.x, sigma.y_axis.y);
    let halved = 0.5 * (xx - yy);
    let root = halved.hypot(xy);
    let mean = 0.5 * (xx + yy);
    let along = if halved >= 0.0 { DVec2::new(halved + root, xy) } else { DVec2::new(xy, root - halved) };
    let along = along.try_normalize().unwrap_or(DVec2::X);
    let [major, minor] = [mean + root, mean - root].map(|variance| variance.max(0.0).sqrt());
    Spread { major: major * (along.x * e + along.y * f), minor: minor * (along.x * f - along.y * e) }
}

#[cfg(test)]
mod tests;
