//! What every filter must do whatever the map, and how far each is from the mean over the pixel.

mod plane;
mod quality;
mod rules;
mod sine;

use super::{super::mip::Level, *};

const REPEAT: [u32; 2] = [WRAP_REPEAT; 2];

/// A grey map and its levels.
fn grey(width: usize, height: usize, value: impl Fn(usize, usize) -> f64) -> Vec<Level> {
    let texel = |i: usize| [value(i % width, i / width); 4];
    Level { width, height, texels: (0..width * height).map(texel).collect(), alpha_scale: 1.0 }.chain()
}

/// Evenly spread in 0 to 1, the same every time (PCG's multiplier, upper bits).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn within(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.next()
    }

    /// The sides of a pixel in texels, from much smaller than one to much larger, of any shape.
    fn sides(&mut self) -> [[f64; 2]; 2] {
        let size = self.within(-3.0, 6.0).exp2();
        let shape = self.within(0.0, 6.0).exp2();
        let (angle, turn) = (self.within(0.0, 6.3), self.within(0.0, 6.3));
        let axes = |a: f64| {
            let (x, y) = (a.cos() * size * shape, a.sin() * size);
            [x * turn.cos() - y * turn.sin(), x * turn.sin() + y * turn.cos()]
        };
        [axes(angle), axes(angle + std::f64::consts::FRAC_PI_2)]
    }
}
