//! On which side a point lies, exactly: signs of determinants of f32 coordinates.
//!
//! Products of coordinates are kept without loss as sums of f64, and sums as expansions whose terms do not overlap,
//! the largest of which has the sign (Shewchuk 1997). A rounded determinant that is farther from 0 than its error
//! decides alone.

/// A bound on the error of a rounded determinant, relative to the sum of its terms' magnitudes (Shewchuk 1997).
const ERROR_2D: f64 = (3.0 + 16.0 * f64::EPSILON) * (f64::EPSILON / 2.0);
const ERROR_3D: f64 = (7.0 + 56.0 * f64::EPSILON) * (f64::EPSILON / 2.0);

/// The sign of the signed area of a, b, c: 1 where they run counter-clockwise, 0 on a line.
#[must_use]
pub fn orient_2d(a: [f32; 2], b: [f32; 2], c: [f32; 2]) -> i8 {
    let [ax, ay, bx, by, cx, cy] = [a[0], a[1], b[0], b[1], c[0], c[1]].map(f64::from);
    let (left, right) = ((ax - cx) * (by - cy), (ay - cy) * (bx - cx));
    if let Some(sign) = certain(left - right, ERROR_2D * (left.abs() + right.abs())) {
        return sign;
    }
    // Products of two f32 fit in f64.
    sign_of_sum([ax * by, -(ay * bx), -(cx * by), cy * bx, -(ax * cy), ay * cx])
}

/// The sign of the signed volume of a, b, c, d: 1 where a, b, c run counter-clockwise seen from d, 0 on a plane.
#[must_use]
pub fn orient_3d(a: [f32; 3], b: [f32; 3], c: [f32; 3], d: [f32; 3]) -> i8 {
    let [a, b, c, d] = [a, b, c, d].map(|p| p.map(f64::from));
    let from_d = |p: [f64; 3]| [p[0] - d[0], p[1] - d[1], p[2] - d[2]];
    let terms = triple_terms(from_d(a), from_d(b), from_d(c)).map(|[x, y, z]| x * y * z);
    let magnitude: f64 = terms.iter().map(|term| term.abs()).sum();
    let value: f64 = (terms[0] + terms[1]) + (terms[2] + terms[3]) + (terms[4] + terms[5]);
    // Seen from d, counter-clockwise means a negative determinant.
    match certain(value, 2.0 * ERROR_3D * magnitude) {
        Some(sign) => -sign,
        None => -exact_3d(a, b, c, d),
    }
}

/// det(a − d, b − d, c − d) = det(a, b, c) − det(d, b, c) − det(a, d, c) − det(a, b, d), each of six products.
fn exact_3d(a: [f64; 3], b: [f64; 3], c: [f64; 3], d: [f64; 3]) -> i8 {
    let positive = triple_terms(a, b, c);
    let negative = [triple_terms(d, b, c), triple_terms(a, d, c), triple_terms(a, b, d)];
    let negative = negative.as_flattened().iter().map(|&[x, y, z]| [-x, y, z]);
    let parts = positive.into_iter().chain(negative).flat_map(|[x, y, z]| {
        let (xy, product) = (x * y, x * y * z);
        [product, xy.mul_add(z, -product)]
    });
    sign_of_sum(parts)
}

/// The factors of the six terms of a determinant.
fn triple_terms(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> [[f64; 3]; 6] {
    [
        [a[0], b[1], c[2]],
        [-a[0], b[2], c[1]],
        [a[1], b[2], c[0]],
        [-a[1], b[0], c[2]],
        [a[2], b[0], c[1]],
        [-a[2], b[1], c[0]],
    ]
}

/// The sign of a rounded value, where the error cannot change it.
fn certain(value: f64, error: f64) -> Option<i8> {
    (value.abs() > error || error == 0.0).then(|| sign(value))
}

fn sign(value: f64) -> i8 {
    i8::from(value > 0.0) - i8::from(value < 0.0)
}

/// The sign of a sum without loss.
fn sign_of_sum(terms: impl IntoIterator<Item = f64>) -> i8 {
    let mut expansion: Vec<f64> = Vec::with_capacity(64);
    for term in terms {
        let mut sum = term;
        let mut kept = 0;
        for k in 0..expansion.len() {
            let (high, low) = two_sum(sum, expansion[k]);
            sum = high;
            if low != 0.0 {
                expansion[kept] = low;
                kept += 1;
            }
        }
        expansion.truncate(kept);
        expansion.extend((sum != 0.0).then_some(sum));
    }
    expansion.last().map_or(0, |&largest| sign(largest))
}

/// The rounded sum and what rounding took (Knuth 1969).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Multiples of 2^-20 below 2 in magnitude: determinants fit in i128.
    fn coordinate() -> impl Strategy<Value = i64> {
        prop_oneof![-3i64..4, -(1i64 << 21)..1 << 21]
    }

    fn exactly(p: [i64; 3]) -> [f32; 3] {
        p.map(|x| x as f32 / (1 << 20) as f32)
    }

    proptest! {
        #[test]
        fn signs_are_those_of_whole_numbers(p in prop::array::uniform4(prop::array::uniform3(coordinate()))) {
            let d = |i: usize, k: usize| i128::from(p[i][k] - p[3][k]);
            let minor = |k: usize, l: usize| d(1, k) * d(2, l) - d(1, l) * d(2, k);
            let volume = d(0, 0) * minor(1, 2) + d(0, 1) * minor(2, 0) + d(0, 2) * minor(0, 1);
            let [a, b, c, e] = p.map(exactly);
            prop_assert_eq!(i128::from(orient_3d(a, b, c, e)), -volume.signum());
            let area = (d(0, 0) - d(2, 0)) * (d(1, 1) - d(2, 1)) - (d(0, 1) - d(2, 1)) * (d(1, 0) - d(2, 0));
            let flat = |p: [f32; 3]| [p[0], p[1]];
            prop_assert_eq!(i128::from(orient_2d(flat(a), flat(b), flat(c))), area.signum());
        }

        #[test]
        fn a_point_on_a_plane_is_on_it_and_the_next_number_is_not(i in 0i64..64, j in 0i64..64, k in 1i64..1 << 20) {
            // x + y + z = 3k over points of very different size.
            let plane = [[3 * k, 0, 0], [0, 3 * k, 0], [0, 0, 3 * k]].map(exactly);
            let on = exactly([k + i, k + j, k - i - j]);
            prop_assert_eq!(orient_3d(plane[0], plane[1], plane[2], on), 0);
            let above = [on[0], on[1], on[2].next_up()];
            prop_assert_eq!(orient_3d(plane[0], plane[1], plane[2], above), 1);
        }
    }

    #[test]
    fn coordinates_far_apart_are_not_rounded_away() {
        let (tiny, huge) = (f32::from_bits(1), 1e30);
        assert_eq!(orient_2d([0.0, 0.0], [huge, 0.0], [huge, tiny]), 1);
        let plane = [[0.0, 0.0, 0.0], [huge, 0.0, 0.0], [0.0, huge, 0.0]];
        assert_eq!(orient_3d(plane[0], plane[1], plane[2], [huge, huge, tiny]), 1);
        assert_eq!(orient_3d(plane[0], plane[1], plane[2], [huge, -huge, -tiny]), -1);
    }
}
