//! A histogram from which percentiles are read.

/// How many values lie in each 128th of an octave from 2^-16 to 2^16.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Counts(Vec<u64>);

impl Default for Counts {
    fn default() -> Self {
        Self(vec![0; Self::SIZE])
    }
}

impl Counts {
    const SIZE: usize = 64 << 6;
    /// f32 bits of 2^-32, the square of the lowest, without the last 17.
    const LOWEST: usize = 95 << 6;

    #[inline]
    pub(super) fn count(&mut self, square: f64) {
        let bin = ((square as f32).to_bits() >> 17) as usize;
        self.0[bin.saturating_sub(Self::LOWEST).min(Self::SIZE - 1)] += 1;
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.0.iter_mut().zip(&other.0).for_each(|(own, others)| *own += others);
    }

    /// The upper end of the bin in which the share `part` of all values is reached; infinite in the last.
    pub(super) fn percentile(&self, part: f64) -> f64 {
        let wanted = (part * self.0.iter().sum::<u64>() as f64).ceil() as u64;
        let mut sum = 0;
        let reached = self.0.iter().position(|count| {
            sum += count;
            sum >= wanted
        });
        let next = reached.map_or(Self::SIZE, |bin| bin + 1);
        let bits = ((next + Self::LOWEST) as u32) << 17;
        if next < Self::SIZE { f64::from(f32::from_bits(bits)).sqrt() } else { f64::INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_the_upper_ends_of_their_bins() {
        let mut counts = Counts::default();
        (1..=1000).for_each(|k| counts.count((f64::from(k) / 100.0).powi(2)));
        for part in [0.01, 0.5, 0.99] {
            let (found, exact) = (counts.percentile(part), 10.0 * part);
            assert!(found >= exact && found <= exact * 1.008, "{part}: {found}");
        }
        counts.count(1e30);
        assert_eq!(counts.percentile(1.0), f64::INFINITY);
    }
}
