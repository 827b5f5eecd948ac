//! Twin of `mip`: the next level of a map, box filtered in linear light; three texels wide where a size is
//! odd (polyphase), so that nothing shifts.

mod coverage;

pub use coverage::{coverage, keep_coverage};

/// A mip level: linear RGBA, row-major.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    pub width: usize,
    pub height: usize,
    pub texels: Vec<[f64; 4]>,
    /// Alpha is multiplied by this when the level is read, so that levels cover alike; 1 where nothing is cut off.
    pub alpha_scale: f64,
}

/// Weights of source texels 2i, 2i + 1 and 2i + 2 in target texel i.
pub(super) fn weights(i: usize, source: usize, target: usize) -> [f64; 3] {
    if source == 1 {
        [1.0, 0.0, 0.0]
    } else if source.is_multiple_of(2) {
        [0.5, 0.5, 0.0]
    } else {
        [(target - i) as f64, target as f64, (i + 1) as f64].map(|w| w / source as f64)
    }
}

impl Level {
    fn texel(&self, x: usize, y: usize) -> [f64; 4] {
        self.texels[y * self.width + x]
    }

    fn filtered(&self, wx: [f64; 3], wy: [f64; 3], x: usize, y: usize) -> [f64; 4] {
        let mut sum = [0.0; 4];
        for (dy, wy) in wy.iter().enumerate() {
            for (dx, wx) in wx.iter().enumerate() {
                if wx * wy > 0.0 {
                    let texel = self.texel(2 * x + dx, 2 * y + dy);
                    sum.iter_mut().zip(texel).for_each(|(s, t)| *s += wx * wy * t);
                }
            }
        }
        sum
    }

    /// The next coarser level: half the size, rounded down, at least 1.
    #[must_use]
    pub fn coarser(&self) -> Self {
        let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
        let mut texels = Vec::with_capacity(width * height);
        for y in 0..height {
            let wy = weights(y, self.height, height);
            texels.extend((0..width).map(|x| self.filtered(weights(x, self.width, width), wy, x, y)));
        }
        Self { width, height, texels, alpha_scale: 1.0 }
    }

    /// This level and all coarser ones, down to one texel.
    #[must_use]
    pub fn chain(self) -> Vec<Self> {
        let mut levels = vec![self];
        while let Some(last) = levels.last()
            && last.texels.len() > 1
        {
            let next = last.coarser();
            levels.push(next);
        }
        levels
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_level_keeps_the_mean_whatever_the_size() {
        for (width, height) in [(8, 8), (7, 5), (13, 1), (1, 6), (31, 17)] {
            let texels: Vec<[f64; 4]> = (0..width * height).map(|i| [(i * 37 % 101) as f64; 4]).collect();
            let mean = texels.iter().map(|t| t[0]).sum::<f64>() / texels.len() as f64;
            let last = Level { width, height, texels, alpha_scale: 1.0 }.chain().pop().unwrap();
            assert!((last.texels[0][0] - mean).abs() < 1e-9, "{width} x {height}");
        }
    }
}
