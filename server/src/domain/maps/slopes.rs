//! From heights to a map of their slopes (Mikkelsen 2020), and maps whose texels lie on nodes or mirror, laid out anew.

use rayon::prelude::*;

use crate::domain::{
    detail::{Sampling, Wrap},
    image::ColorMap,
};

/// One axis of a map as the renderer reads it: texel i of n at (i + 1/2) / n.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Axis {
    /// The texel of the source at each place.
    pub(super) texels: Vec<usize>,
    pub(super) wrap: Wrap,
    /// u of it is `factor` u + `offset`.
    pub(super) factor: f32,
    pub(super) offset: f32,
}

impl Axis {
    /// Of `n` texels, at least 2 of them on nodes. What mirrors is unfolded, so that slopes mirror too; of what repeats on
    /// nodes the last texel is the first of the next period.
    pub(super) fn new(n: usize, wrap: Wrap, sampling: Sampling) -> Self {
        let unfolded = |back: std::ops::Range<usize>| (0..n).chain(back.rev()).collect::<Vec<_>>();
        let nodes = (n - 1).max(1) as f32;
        let (texels, wrap, factor, offset) = match (sampling, wrap) {
            (Sampling::Center, Wrap::Mirror) => (unfolded(0..n), Wrap::Repeat, 0.5, 0.0),
            (Sampling::Center, wrap) => ((0..n).collect(), wrap, 1.0, 0.0),
            (Sampling::Node, Wrap::Repeat) => ((0..n - 1).collect(), Wrap::Repeat, 1.0, 0.5 / nodes),
            (Sampling::Node, Wrap::Mirror) => (unfolded(1..n - 1), Wrap::Repeat, 0.5, 0.25 / nodes),
            (Sampling::Node, Wrap::Clamp) => ((0..n).collect(), Wrap::Clamp, nodes / n as f32, 0.5 / n as f32),
        };
        Self { texels, wrap, factor, offset }
    }

    /// The texels of the source before and behind place i.
    fn neighbours(&self, i: usize) -> [usize; 2] {
        let n = self.texels.len();
        let [before, after] = match self.wrap {
            Wrap::Clamp => [i.saturating_sub(1), (i + 1).min(n - 1)],
            Wrap::Repeat | Wrap::Mirror => [(i + n - 1) % n, (i + 1) % n],
        };
        [self.texels[before], self.texels[after]]
    }

    /// By what the difference of both becomes a slope by u.
    fn half(&self) -> f32 {
        0.5 * self.texels.len() as f32
    }

    /// A row of a map to (u, v, 1) with this axis behind it.
    pub(super) fn row(&self, [a, b, c]: [f32; 3]) -> [f32; 3] {
        [self.factor * a, self.factor * b, self.factor * c + self.offset]
    }
}

/// dH/du and dH/dv of each texel in red and green, by central differences: heights per unit of u and v of the axes.
pub(super) fn slopes(heights: &[f32], width: usize, [across, down]: [&Axis; 2]) -> ColorMap {
    let columns = across.texels.len();
    let mut texels = vec![[0.0, 0.0, 0.0, 1.0]; columns * down.texels.len()];
    texels.par_chunks_mut(columns).enumerate().for_each(|(y, row)| {
        let here = down.texels[y] * width;
        let [above, below] = down.neighbours(y).map(|y| y * width);
        for (x, texel) in row.iter_mut().enumerate() {
            let column = across.texels[x];
            let [left, right] = across.neighbours(x);
            texel[0] = (heights[here + right] - heights[here + left]) * across.half();
            texel[1] = (heights[below + column] - heights[above + column]) * down.half();
        }
    });
    ColorMap { width: columns as u32, height: down.texels.len() as u32, texels }
}

/// Vectors, three values a texel, laid out by the axes.
pub(super) fn laid_out(vectors: &[f32], width: usize, [across, down]: [&Axis; 2]) -> ColorMap {
    let texel = |x: usize, y: usize| {
        let at = 3 * (y * width + x);
        [vectors[at], vectors[at + 1], vectors[at + 2], 1.0]
    };
    let row = |y: &usize| across.texels.iter().map(|x| texel(*x, *y)).collect::<Vec<_>>();
    let texels = down.texels.par_iter().flat_map_iter(row).collect();
    ColorMap { width: across.texels.len() as u32, height: down.texels.len() as u32, texels }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The value of row 0 at u, between texels, as the renderer reads it.
    fn read(map: &ColorMap, axis: &Axis, u: f32) -> f32 {
        let n = map.width as i64;
        let place = (axis.factor * u + axis.offset) * n as f32 - 0.5;
        let (i, t) = (place.floor() as i64, place - place.floor());
        let texel = |i: i64| match axis.wrap {
            Wrap::Clamp => map.texels[i.clamp(0, n - 1) as usize][0],
            _ => map.texels[i.rem_euclid(n) as usize][0],
        };
        texel(i) * (1.0 - t) + texel(i + 1) * t
    }

    #[test]
    fn the_slope_of_a_ramp_is_the_same_everywhere_inside() {
        for (sampling, rise) in [(Sampling::Center, 2.0), (Sampling::Node, 2.0)] {
            let place = |i: usize| if sampling == Sampling::Center { (i as f32 + 0.5) / 8.0 } else { i as f32 / 7.0 };
            let heights: Vec<f32> = (0..8).map(|i| rise * place(i)).collect();
            let axis = Axis::new(8, Wrap::Clamp, sampling);
            let map = slopes(&heights, 8, [&axis, &Axis::new(1, Wrap::Clamp, Sampling::Center)]);
            for u in [0.25f32, 0.4, 0.6, 0.75] {
                let slope = read(&map, &axis, u) * axis.factor;
                assert!((slope - rise).abs() < 1e-5, "{sampling:?} at {u}: {slope}");
            }
        }
    }

    #[test]
    fn slopes_of_a_sine_that_repeats_are_its_cosine_up_to_the_texel() {
        let (n, nodes) = (64, 65);
        let single = Axis::new(1, Wrap::Clamp, Sampling::Center);
        for (sampling, count) in [(Sampling::Center, n), (Sampling::Node, nodes)] {
            let place = |i: usize| if sampling == Sampling::Center { (i as f32 + 0.5) / 64.0 } else { i as f32 / 64.0 };
            let heights: Vec<f32> = (0..count).map(|i| (std::f32::consts::TAU * place(i)).sin()).collect();
            let axis = Axis::new(count, Wrap::Repeat, sampling);
            let map = slopes(&heights, count, [&axis, &single]);
            // The central difference of a sine is its cosine times sin(h) / h, h = tau / 64.
            let step = std::f32::consts::TAU / 64.0;
            for k in 0..count - 1 {
                let u = place(k);
                let expected = std::f32::consts::TAU * (std::f32::consts::TAU * u).cos() * step.sin() / step;
                assert!((read(&map, &axis, u) - expected).abs() < 1e-4, "{sampling:?} at {u}");
            }
        }
    }

    #[test]
    fn what_mirrors_slopes_the_other_way_in_its_mirror() {
        for sampling in [Sampling::Center, Sampling::Node] {
            let heights = [0.0, 1.0, 3.0, 6.0, 10.0];
            let axis = Axis::new(5, Wrap::Mirror, sampling);
            let map = slopes(&heights, 5, [&axis, &Axis::new(1, Wrap::Clamp, Sampling::Center)]);
            for u in [0.1f32, 0.3, 0.55, 0.9] {
                let [here, there] = [u, 2.0 - u].map(|u| read(&map, &axis, u));
                assert!((here + there).abs() < 1e-4, "{sampling:?} at {u}: {here} {there}");
            }
        }
    }
}
