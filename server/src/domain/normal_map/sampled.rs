//! How far a map is from the surface, as a reader of the result sees it: bilinear, in the frame it interpolates.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::Sheet;

/// A place on the triangles of a sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    pub triangle: u32,
    /// Sum 1, none 0.
    pub b: DVec3,
}

/// `count` places spread evenly over the area of the triangles; always the same ones.
#[must_use]
pub fn samples(sheet: &Sheet, count: usize) -> Vec<Sample> {
    let mut sum = 0.0;
    let up_to: Vec<f64> = (0..sheet.triangles.len())
        .map(|triangle| {
            let [a, b, c] = sheet.corners(triangle);
            sum += (b - a).cross(c - a).length();
            sum
        })
        .collect();
    if sum.is_nan() || sum <= 0.0 {
        return Vec::new();
    }
    let of = |k: usize| {
        let [along, s, t] = [0, 1, 2].map(|axis| fraction(3 * k as u64 + axis));
        let area = (k as f64 + along) / count as f64 * sum;
        let triangle = up_to.partition_point(|up_to| *up_to <= area).min(up_to.len() - 1);
        let root = s.sqrt();
        Sample { triangle: triangle as u32, b: DVec3::new(1.0 - root, root * (1.0 - t), root * t) }
    };
    (0..count).map(of).collect()
}

/// Between 0 and 1, without the ends, well mixed (splitmix64).
fn fraction(seed: u64) -> f64 {
    let mut z = seed.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 12) as f64 / (1u64 << 52) as f64 + f64::EPSILON
}

/// Angles between the normals that a reader of the map sees at samples and `normals`, those of the surface; rising.
#[must_use]
pub fn angles_degrees(sheet: &Sheet, rgb: &[u8], size: [u32; 2], samples: &[Sample], normals: &[DVec3]) -> Vec<f64> {
    let angle = |(sample, normal): (&Sample, &DVec3)| {
        let triangle = sample.triangle as usize;
        let direction = bilinear(rgb, size, sheet.uv(triangle, sample.b));
        let seen = sheet.frame(triangle, sample.b).decode(direction);
        seen.cross(*normal).length().atan2(seen.dot(*normal)).to_degrees()
    };
    let mut angles: Vec<f64> = samples.par_iter().zip(normals).map(angle).collect();
    angles.par_sort_unstable_by(f64::total_cmp);
    angles
}

fn bilinear(rgb: &[u8], size: [u32; 2], uv: DVec2) -> DVec3 {
    let at = uv * DVec2::from_array(size.map(f64::from)) - 0.5;
    let (first, part) = (at.floor(), at - at.floor());
    let texel = |x: f64, y: f64| {
        let [x, y] = [x.rem_euclid(f64::from(size[0])), y.rem_euclid(f64::from(size[1]))];
        let texel = 3 * (y as usize * size[0] as usize + x as usize);
        DVec3::from_array([0, 1, 2].map(|k| f64::from(rgb[texel + k]) / 127.5 - 1.0))
    };
    let row = |y: f64| texel(first.x, y).lerp(texel(first.x + 1.0, y), part.x);
    row(first.y).lerp(row(first.y + 1.0), part.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Sheet {
        let corners = [[0.0f32, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        Sheet {
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            positions: corners.map(|[x, y]| [4.0 * x, 4.0 * y, 0.0]).to_vec(),
            normals: vec![[0.0, 0.0, 1.0]; 4],
            tangents: vec![[1.0, 0.0, 0.0, 1.0]; 4],
            uvs: corners.to_vec(),
            ..Sheet::default()
        }
    }

    #[test]
    fn samples_are_spread_evenly() {
        let sheet = square();
        let samples = samples(&sheet, 4000);
        let mut counts = [0; 16];
        for sample in &samples {
            let uv = 4.0 * sheet.uv(sample.triangle as usize, sample.b);
            counts[4 * uv.y as usize + uv.x as usize] += 1;
        }
        assert!(counts.iter().all(|count| (190..310).contains(count)), "{counts:?}");
    }

    #[test]
    fn a_flat_map_is_as_far_off_as_the_surface_is_tilted_and_8_bits_take() {
        let (sheet, rgb) = (square(), [128, 128, 255].repeat(16));
        let samples = samples(&sheet, 100);
        let tilted = DVec3::new(0.0, 0.6, 0.8);
        let angles = angles_degrees(&sheet, &rgb, [4, 4], &samples, &vec![tilted; 100]);
        assert!((angles[0] - 0.6f64.asin().to_degrees()).abs() < 0.5 && angles[99] - angles[0] < 1e-9, "{}", angles[0]);
    }

    #[test]
    fn reading_between_texels_is_bilinear_and_repeats() {
        let mut rgb = vec![0; 12];
        rgb[..3].copy_from_slice(&[255; 3]);
        let at = |u, v| bilinear(&rgb, [2, 2], DVec2::new(u, v)).x;
        assert!((at(0.25, 0.25) - 1.0).abs() < 1e-12 && (at(0.5, 0.25)).abs() < 1e-12);
        assert!((at(0.0, 0.0) + 0.5).abs() < 1e-12 && (at(-0.75, 1.25) - 1.0).abs() < 1e-12);
    }
}
