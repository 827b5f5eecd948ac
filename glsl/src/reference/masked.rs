//! Twin of `masked` where alpha is a chance (Enderton et al. 2010): each sample of each triangle has a threshold of its
//! own, and keeps what has more alpha.

use super::keys::mixed;

/// Within (0, 1): of sample `s` of a pixel and a triangle, uniform over any of them.
#[must_use]
pub fn threshold(pixel: [u32; 2], s: u32, id: u32) -> f64 {
    let key = mixed(mixed(mixed(pixel[0]) ^ pixel[1]) ^ id);
    let key = mixed(key.wrapping_add(s.wrapping_mul(0x9E37_79B9)));
    (f64::from(key >> 9) + 0.5) / 8_388_608.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of 2^16 samples, those that keep each of two triangles, and both.
    fn kept(alphas: [f64; 2], ids: [u32; 2]) -> [f64; 3] {
        let mut counts = [0.0; 3];
        for i in 0..1u32 << 16 {
            let keeps = |k: usize| alphas[k] > threshold([i / 4 % 128, i / 512], i % 4, ids[k]);
            let keeps = [keeps(0), keeps(1)];
            counts[0] += f64::from(u8::from(keeps[0]));
            counts[1] += f64::from(u8::from(keeps[1]));
            counts[2] += f64::from(u8::from(keeps[0] && keeps[1]));
        }
        counts.map(|count| count / f64::from(1 << 16))
    }

    #[test]
    fn samples_keep_what_alpha_says_and_triangles_know_nothing_of_each_other() {
        for ids in [[0, 1], [7, 8], [1, 1 << 20]] {
            for alphas in [[0.5, 0.5], [0.1, 0.9], [0.75, 0.02]] {
                let expected = [alphas[0], alphas[1], alphas[0] * alphas[1]];
                for (found, p) in kept(alphas, ids).into_iter().zip(expected) {
                    // Four standard deviations of a binomial share.
                    let bound = 4.0 * (p * (1.0 - p) / f64::from(1 << 16)).sqrt();
                    assert!((found - p).abs() < bound, "{ids:?}: {found} for {p}");
                }
            }
        }
    }

    #[test]
    fn no_alpha_is_never_kept_and_full_alpha_always() {
        assert_eq!(kept([0.0, 1.0], [3, 4]), [0.0, 1.0, 0.0]);
    }
}
