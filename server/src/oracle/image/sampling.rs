//! Where the samples of a pixel lie: the Sobol' (0, 2)-sequence, scrambled by Owen's nested permutations, which
//! are hashed (Burley 2020) from the pixel. Deterministic; each power of two of samples is stratified. Further
//! dimensions are further such sequences, in another order each.

/// Places in [0, 1)² of the samples of pixel (x, y), from its top left corner.
#[derive(Clone, Copy, Debug)]
pub(super) struct Places {
    seeds: [u32; 2],
}

impl Places {
    pub(super) fn of_pixel(x: u32, y: u32) -> Self {
        let pixel = hashed(x ^ hashed(y));
        Self { seeds: [hashed(pixel), hashed(!pixel)] }
    }

    pub(super) fn at(self, sample: u32) -> [f64; 2] {
        let bits = [sample.reverse_bits(), second_dimension(sample)];
        [0, 1].map(|k| f64::from(scrambled(bits[k], self.seeds[k])) / 2f64.powi(32))
    }

    /// Two dimensions more, numbered from 0.
    pub(super) fn further(self, number: u32) -> Further {
        let seed = hashed(self.seeds[0] ^ hashed(self.seeds[1] ^ hashed(number)));
        Further { places: Self { seeds: [hashed(seed), hashed(!seed)] }, order: seed }
    }
}

/// Places in [0, 1)² that nothing ties to the first ones: two dimensions more, of samples or of what follows them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Further {
    places: Places,
    order: u32,
}

impl Further {
    pub(super) fn at(self, sample: u32) -> [f64; 2] {
        self.places.at(scrambled(sample, self.order))
    }
}

/// Dimension 1 of Sobol' 1967; dimension 0 is the reversed index.
fn second_dimension(mut index: u32) -> u32 {
    let (mut column, mut bits) = (1u32 << 31, 0);
    while index != 0 {
        bits ^= column * (index & 1);
        index >>= 1;
        column ^= column >> 1;
    }
    bits
}

/// A nested uniform scramble: each bit is flipped by a hash of the bits above it. The constants are those of
/// Vegdahl 2021.
fn scrambled(bits: u32, seed: u32) -> u32 {
    let mut x = bits.reverse_bits();
    x ^= x.wrapping_mul(0x3D20_ADEA);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul(seed >> 16 | 1);
    x ^= x.wrapping_mul(0x0552_6C56);
    x ^= x.wrapping_mul(0x53A2_2864);
    x.reverse_bits()
}

/// Wellons 2018 ("lowbias32").
fn hashed(mut x: u32) -> u32 {
    x = x.wrapping_add(0x9E37_79B9);
    x = (x ^ x >> 16).wrapping_mul(0x7FEB_352D);
    x = (x ^ x >> 15).wrapping_mul(0x846C_A68B);
    x ^ x >> 16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_elementary_interval_of_a_power_of_two_holds_one_sample() {
        for (x, y) in [(0, 0), (7, 3), (640, 359), (16383, 16383)] {
            let places = Places::of_pixel(x, y);
            assert_stratified(|sample| places.at(sample));
            assert_stratified(|sample| places.further(1).at(sample));
        }
    }

    fn assert_stratified(place: impl Fn(u32) -> [f64; 2]) {
        for log in 0..=10u32 {
            for wide in 0..=log {
                let (columns, rows) = (1u32 << wide, 1u32 << (log - wide));
                let mut seen = vec![0; 1 << log];
                for sample in 0..1 << log {
                    let [u, v] = place(sample);
                    let (i, j) = ((u * f64::from(columns)) as u32, (v * f64::from(rows)) as u32);
                    seen[(j * columns + i) as usize] += 1;
                }
                assert!(seen.iter().all(|count| *count == 1), "{columns} x {rows}");
            }
        }
    }

    #[test]
    fn further_dimensions_are_not_tied_to_the_first() {
        let places = Places::of_pixel(3, 5);
        let pairs = [[places.further(0), places.further(1)], [places.further(7), places.further(8)]];
        for [a, b] in pairs {
            let mut seen = [0; 16];
            for sample in 0..4096 {
                let ([u, _], [s, _]) = (a.at(sample), b.at(sample));
                seen[(u * 4.0) as usize + 4 * (s * 4.0) as usize] += 1;
            }
            // Five standard deviations of how many of 4096 fall into a sixteenth.
            assert!(seen.iter().all(|count| (i32::abs(count - 256)) < 78), "{seen:?}");
        }
    }

    #[test]
    fn pixels_have_samples_of_their_own() {
        let first = |x: u32, y: u32| Places::of_pixel(x, y).at(0);
        let places: Vec<[f64; 2]> = (0..64).flat_map(|y| (0..64).map(move |x| first(x, y))).collect();
        let mean = |k: usize| places.iter().map(|p| p[k]).sum::<f64>() / 4096.0;
        // Five standard deviations of the mean of 4096 uniform numbers.
        assert!((mean(0) - 0.5).abs() < 0.0226 && (mean(1) - 0.5).abs() < 0.0226, "{} {}", mean(0), mean(1));
        let mut sorted: Vec<u64> = places.iter().map(|p| p[0].to_bits()).collect();
        sorted.sort_unstable();
        sorted.dedup();
        assert!(sorted.len() > 4090, "{} of 4096 differ", sorted.len());
    }
}
