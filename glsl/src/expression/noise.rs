//! Value noise on the integer lattice: hashed corner values in [−1, 1] blended by quintic fades, so that
//! it is C2 and the same bits decide it everywhere. The twin of `noise` in `expression.glsl`.

/// Hash of a lattice point (the mixer of Jarzynski & Olano 2020's pcg3d, first lane).
#[must_use]
pub fn hash(x: i32, y: i32, z: i32) -> u32 {
    let mut v = [x, y, z].map(|c| (c as u32).wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    for _ in 0..2 {
        v[0] = v[0].wrapping_add(v[1].wrapping_mul(v[2]));
        v[1] = v[1].wrapping_add(v[2].wrapping_mul(v[0]));
        v[2] = v[2].wrapping_add(v[0].wrapping_mul(v[1]));
        v = v.map(|c| c ^ (c >> 16));
    }
    v[0]
}

/// Value in [−1, 1] of a lattice point: 24 bits, exact in f32.
#[must_use]
pub fn corner(x: i32, y: i32, z: i32) -> f64 {
    f64::from(hash(x, y, z) >> 8) * (2.0 / 16_777_216.0) - 1.0
}

fn fade(t: f64) -> [f64; 2] {
    [t * t * t * (t * (t * 6.0 - 15.0) + 10.0), 30.0 * t * t * (t * (t - 2.0) + 1.0)]
}

/// The noise and its gradient.
#[must_use]
pub fn value_and_gradient(p: [f64; 3]) -> [f64; 4] {
    let cell = p.map(|x| x.clamp(-2_147_483_000.0, 2_147_483_000.0).floor());
    let f: [[f64; 2]; 3] = std::array::from_fn(|k| fade(p[k] - cell[k]));
    let c = cell.map(|x| x as i32);
    let mut result = [0.0; 4];
    for k in 0..8i32 {
        let o = [k & 1, (k >> 1) & 1, k >> 2];
        let w: [[f64; 2]; 3] = std::array::from_fn(|a| if o[a] == 1 { f[a] } else { [1.0 - f[a][0], -f[a][1]] });
        let value = corner(c[0].wrapping_add(o[0]), c[1].wrapping_add(o[1]), c[2].wrapping_add(o[2]));
        result[0] += value * w[0][0] * w[1][0] * w[2][0];
        result[1] += value * w[0][1] * w[1][0] * w[2][0];
        result[2] += value * w[0][0] * w[1][1] * w[2][0];
        result[3] += value * w[0][0] * w[1][0] * w[2][1];
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_noise_takes_its_corner_values_and_stays_in_range() {
        assert_eq!(value_and_gradient([3.0, -2.0, 7.0])[0], corner(3, -2, 7));
        for k in 0..1000 {
            let p = [f64::from(k) * 0.37, f64::from(k) * -0.11, f64::from(k) * 0.053];
            assert!(value_and_gradient(p)[0].abs() <= 1.0);
        }
    }

    #[test]
    fn the_gradient_is_the_derivative() {
        let p = [0.3, -1.7, 2.45];
        let gradient = value_and_gradient(p);
        for axis in 0..3 {
            let (mut a, mut b) = (p, p);
            a[axis] -= 1e-6;
            b[axis] += 1e-6;
            let slope = (value_and_gradient(b)[0] - value_and_gradient(a)[0]) / 2e-6;
            assert!((slope - gradient[axis + 1]).abs() < 1e-7);
        }
    }
}
