//! The levels of a height map: each the mean of 2 x 2 texels of the one before, and of 3 polyphase where a size is odd,
//! so that nothing shifts. The device marches what is made here.

use rayon::prelude::*;

use super::HeightLevel;
use crate::reference::mip::weights;

impl HeightLevel {
    /// Half the size, rounded down, at least 1. Means are rounded once.
    #[must_use]
    pub fn coarser(&self) -> Self {
        let [width, height] = self.size.map(|n| n as usize);
        let size = self.size.map(|n| (n / 2).max(1));
        let [columns, rows] = size.map(|n| n as usize);
        let across: Vec<[f64; 3]> = (0..columns).map(|x| weights(x, width, columns)).collect();
        let mut heights = vec![0.0; columns * rows];
        heights.par_chunks_mut(columns).enumerate().for_each(|(y, row)| {
            let down = weights(y, height, rows);
            let lines = (0..3).filter(|k| down[*k] > 0.0);
            let lines: Vec<_> = lines.map(|k| (down[k], &self.heights[(2 * y + k) * width..][..width])).collect();
            for (x, mean) in row.iter_mut().enumerate() {
                let of_line = |line: &[f32]| {
                    let texels = line[2 * x..].iter().zip(across[x]);
                    texels.map(|(height, weight)| weight * f64::from(*height)).sum::<f64>()
                };
                *mean = lines.iter().map(|(weight, line)| weight * of_line(line)).sum::<f64>() as f32;
            }
        });
        Self { size, heights, repeats: self.repeats }
    }

    /// This level and all coarser ones, down to one texel.
    #[must_use]
    pub fn chain(self) -> Vec<Self> {
        let mut levels = vec![self];
        while let Some(last) = levels.last()
            && last.size != [1; 2]
        {
            let next = last.coarser();
            levels.push(next);
        }
        levels
    }
}

#[cfg(test)]
mod tests {
    use super::{super::exact::bounds, *};

    fn level(size: [u32; 2], height: impl Fn(u32, u32) -> f32) -> HeightLevel {
        let heights = (0..size[0] * size[1]).map(|i| height(i % size[0], i / size[0])).collect();
        HeightLevel { size, heights, repeats: [true; 2] }
    }

    fn mean(level: &HeightLevel) -> f64 {
        level.heights.iter().map(|h| f64::from(*h)).sum::<f64>() / level.heights.len() as f64
    }

    fn noise(x: u32, y: u32) -> f32 {
        (x.wrapping_mul(2_654_435_761).wrapping_add(y.wrapping_mul(0x9E37_79B9)) >> 24) as f32
    }

    /// Eight bits of noise and two more for each of eight levels are less than the 24 of an f32.
    #[test]
    fn means_of_powers_of_two_are_exact_on_every_level() {
        let finest = level([256, 64], noise);
        let expected = mean(&finest);
        for level in finest.chain() {
            assert_eq!(mean(&level), expected, "{:?}", level.size);
        }
    }

    #[test]
    fn means_of_other_sizes_are_kept_but_for_rounding() {
        for size in [[7, 5], [13, 1], [1, 6], [31, 17], [100, 75], [3, 1024]] {
            let levels = level(size, noise).chain();
            let (first, last) = (&levels[0], levels.last().expect("one at least"));
            assert_eq!(last.size, [1; 2]);
            assert!((f64::from(last.heights[0]) - mean(first)).abs() < 1e-4, "{size:?}");
        }
    }

    /// Texel i of n lies at (i + 1/2) / n. Of an odd size n the mean is off by (m - 2i - 1) / (2m n) texels, m = (n - 1) / 2.
    #[test]
    fn a_ramp_stays_where_it_lies_and_of_odd_sizes_within_a_twentieth_of_a_texel() {
        for (n, bound) in [(64, 0.0), (6, 0.0), (3, 0.0), (5, 0.05), (7, 0.0477), (31, 0.0151), (101, 0.00486)] {
            let coarser = level([n, 1], |x, _| x as f32).coarser();
            let size = f64::from(coarser.size[0]);
            let off = |(i, h): (usize, &f32)| f64::from(*h) + 0.5 - (i as f64 + 0.5) / size * f64::from(n);
            let worst = coarser.heights.iter().enumerate().map(off).fold(0.0, |most: f64, off| most.max(off.abs()));
            assert!(worst <= bound + 1e-5 && worst >= bound * 0.98, "{n}: {worst}");
        }
    }

    #[test]
    fn bounds_hold_on_every_level_and_no_level_leaves_the_range_of_the_finest() {
        let finest = level([45, 22], noise);
        let range = |heights: &[f32]| heights.iter().fold([f32::MAX, f32::MIN], |[a, b], h| [a.min(*h), b.max(*h)]);
        let [low, high] = range(&finest.heights);
        for level in finest.chain() {
            let (bounds, [least, greatest]) = (bounds(&level), range(&level.heights));
            assert!(low <= least && greatest <= high);
            assert_eq!(bounds[bounds.len() - 2..], [greatest, least], "{:?}", level.size);
        }
    }
}
