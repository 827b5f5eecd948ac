//! Light from endlessly far away: what it is by direction, and directions drawn by how bright they are.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use rayon::prelude::*;

use crate::domain::environment::Environment;

/// A map, read between texels of its finest level. Its cells have the middles of texels at their corners, those at
/// the poles half a texel high: within one the radiance is bilinear.
pub(super) struct Sky<'e> {
    map: &'e Environment,
    /// Luminance of all cells of a row up to and with each, times the row's width and height on the sphere.
    cells: Vec<f64>,
    /// Of all rows up to and with each.
    rows: Vec<f64>,
}

impl<'e> Sky<'e> {
    pub(super) fn new(map: &'e Environment) -> Self {
        let mut sky = Self { map, cells: Vec::new(), rows: Vec::new() };
        sky.cells = (0..=map.height as usize).into_par_iter().flat_map_iter(|row| sky.row_of_cells(row)).collect();
        sky.rows = sums(sky.cells.chunks(map.width as usize).map(|row| row[row.len() - 1]));
        sky
    }

    fn row_of_cells(&self, row: usize) -> Vec<f64> {
        let [top, bottom] = self.edges(row);
        let size = (bottom - top) * self.width(row);
        let mean = |x: usize| 0.25 * self.corners(x, row).as_flattened().iter().sum::<f64>();
        sums((0..self.map.width as usize).map(|x| mean(x) * size))
    }

    /// Where a row of cells begins and ends, texels from the top.
    fn edges(&self, row: usize) -> [f64; 2] {
        [0, 1].map(|end| ((row + end) as f64 - 0.5).clamp(0.0, self.map.height.into()))
    }

    /// Of the middle of a row of cells, as a share of the equator's.
    fn width(&self, row: usize) -> f64 {
        let [top, bottom] = self.edges(row);
        (0.5 * (top + bottom) * PI / f64::from(self.map.height)).sin()
    }

    /// Luminance at the corners of a cell: above and below, from left to right.
    fn corners(&self, x: usize, row: usize) -> [[f64; 2]; 2] {
        self.edges(row).map(|y| [0.5, 1.5].map(|step| luminance(self.between([x as f64 + step, y]))))
    }

    /// From a unit direction.
    pub(super) fn radiance(&self, d: DVec3) -> DVec3 {
        self.between(self.place(d))
    }

    /// Texels from the top left corner of the map.
    fn place(&self, d: DVec3) -> [f64; 2] {
        let (turn, tilt) = (0.5 + d.z.atan2(d.x) / TAU, d.x.hypot(d.z).atan2(d.y) / PI);
        [turn * f64::from(self.map.width), tilt * f64::from(self.map.height)]
    }

    fn between(&self, [x, y]: [f64; 2]) -> DVec3 {
        let above = (y - 0.5).floor();
        self.along(x, above as i64).lerp(self.along(x, above as i64 + 1), y - 0.5 - above)
    }

    /// Between the texels of a row. Beyond a pole lies the same row, half a turn away.
    fn along(&self, x: f64, y: i64) -> DVec3 {
        let (width, height) = (i64::from(self.map.width), i64::from(self.map.height));
        let (x, y) = match y {
            0.. if y < height => (x, y),
            0.. => (x + 0.5 * width as f64, 2 * height - 1 - y),
            _ => (x + 0.5 * width as f64, -1 - y),
        };
        let before = (x - 0.5).floor();
        let texel = |x: i64| {
            let at = y * width + x.rem_euclid(width);
            DVec3::from_array(self.map.texels[at as usize].map(f64::from))
        };
        texel(before as i64).lerp(texel(before as i64 + 1), x - 0.5 - before)
    }

    /// Whether any light comes from anywhere.
    pub(super) fn shines(&self) -> bool {
        self.total() > 0.0
    }

    fn total(&self) -> f64 {
        self.rows[self.rows.len() - 1]
    }

    /// A direction drawn by `density`, unit. There is light.
    pub(super) fn sample(&self, [u, v]: [f64; 2]) -> DVec3 {
        let (row, v) = chosen(&self.rows, v);
        let (x, u) = chosen(self.row(row), u);
        let [[a, b], [c, d]] = self.corners(x, row);
        let t = linear(a + b, c + d, v);
        let s = linear(a + (c - a) * t, b + (d - b) * t, u);
        let [top, bottom] = self.edges(row);
        let turn = TAU * ((x as f64 + 0.5 + s) / f64::from(self.map.width) - 0.5);
        let (out, up) = (PI * (top + (bottom - top) * t) / f64::from(self.map.height)).sin_cos();
        DVec3::new(out * turn.cos(), up, out * turn.sin())
    }

    /// Of `sample`, per steradian: as luminance, but for what a row is wider in its middle than there. There is light.
    pub(super) fn density(&self, d: DVec3) -> f64 {
        let [x, y] = self.place(d);
        let texel = TAU * PI / (f64::from(self.map.width) * f64::from(self.map.height));
        let wider = self.width((y + 0.5) as usize) / d.x.hypot(d.z).max(1e-12);
        luminance(self.between([x, y])) * wider / (self.total() * texel)
    }

    fn row(&self, row: usize) -> &[f64] {
        let width = self.map.width as usize;
        &self.cells[row * width..(row + 1) * width]
    }
}

fn luminance(color: DVec3) -> f64 {
    color.dot(DVec3::new(0.2126, 0.7152, 0.0722))
}

fn sums(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let add = |sum: &mut f64, value: f64| {
        *sum += value;
        Some(*sum)
    };
    values.scan(0.0, add).collect()
}

/// The part of `sums` that a number of [0, 1) falls into, and where in it.
fn chosen(sums: &[f64], at: f64) -> (usize, f64) {
    let at = at * sums[sums.len() - 1];
    let k = sums.partition_point(|sum| *sum <= at).min(sums.len() - 1);
    let before = if k == 0 { 0.0 } else { sums[k - 1] };
    (k, ((at - before) / (sums[k] - before)).clamp(0.0, 1.0))
}

/// A place of [0, 1] by a density that goes from `a` to `b`, both 0 or more and not both 0.
fn linear(a: f64, b: f64, at: f64) -> f64 {
    at * (a + b) / (a + (a * a * (1.0 - at) + b * b * at).sqrt()).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(width: u32, height: u32) -> Environment {
        let texel = |i: u32| [(i * 7 % 11) as f32, (i * 5 % 3) as f32, (i % 13) as f32 * 0.5];
        Environment { width, height, texels: (0..width * height).map(texel).collect() }
    }

    #[test]
    fn texels_lie_where_the_convention_has_them() {
        let mut map = Environment { width: 4, height: 2, texels: vec![[0.0; 3]; 8] };
        map.texels[4 + 2] = [1.0, 2.0, 3.0];
        // An eighth of a turn from +x to +z, and half way down to -y.
        let s = 0.5f64.sqrt();
        let sky = Sky::new(&map);
        assert!((sky.radiance(DVec3::new(0.5, -s, 0.5)) - DVec3::new(1.0, 2.0, 3.0)).length() < 1e-14);
        assert!((sky.radiance(DVec3::new(s, -s, 0.0)) - 0.5 * DVec3::new(1.0, 2.0, 3.0)).length() < 1e-14);
        assert_eq!(sky.radiance(DVec3::new(-0.5, -s, 0.5)), DVec3::ZERO);
    }

    #[test]
    fn seam_and_poles_are_crossed_without_a_step() {
        for map in [map(8, 4), map(7, 3)] {
            let sky = Sky::new(&map);
            let step = |a: DVec3, b: DVec3| (sky.radiance(a.normalize()) - sky.radiance(b.normalize())).length();
            for tilt in [-1.3, -0.2, 0.4, 2.0] {
                assert!(step(DVec3::new(-1.0, tilt, 1e-12), DVec3::new(-1.0, tilt, -1e-12)) < 1e-9);
            }
            for (turn, up) in (0..12).flat_map(|k| [(f64::from(k), 1.0), (f64::from(k), -1.0)]) {
                let side = 1e-12 * DVec3::new(turn.cos(), 0.0, turn.sin());
                assert!(step(up * DVec3::Y + side, up * DVec3::Y - side) < 1e-9);
            }
        }
    }

    #[test]
    fn directions_are_drawn_as_densely_as_the_density_says() {
        for map in [map(8, 4), map(7, 3), Environment { width: 1, height: 1, texels: vec![[2.0; 3]] }] {
            let sky = Sky::new(&map);
            let side = 512;
            let middle = |k: u32| (f64::from(k) + 0.5) / f64::from(side);
            // The mean over drawn directions of what a function is over the density is its integral.
            let mut sum = DVec3::ZERO;
            for (i, j) in (0..side * side).map(|k| (k % side, k / side)) {
                let d = sky.sample([middle(i), middle(j)]);
                assert!((d.length() - 1.0).abs() < 1e-14);
                sum += DVec3::new(1.0, d.x * d.x, d.y) * luminance(sky.radiance(d)) / sky.density(d);
            }
            let mut expected = DVec3::ZERO;
            for (i, j) in (0..side * side).map(|k| (k % side, k / side)) {
                let ((sine, cosine), (out, up)) = ((TAU * middle(i)).sin_cos(), (PI * middle(j)).sin_cos());
                let d = DVec3::new(out * cosine, up, out * sine);
                expected += DVec3::new(1.0, d.x * d.x, d.y) * luminance(sky.radiance(d)) * TAU * PI * out;
            }
            let off = (sum - expected).abs().max_element() / expected.x;
            // The density has steps where rows meet, which 512 places find to one of them.
            assert!(off < 2e-3, "{} x {}: {off}", map.width, map.height);
        }
    }

    #[test]
    fn a_black_map_does_not_shine() {
        assert!(!Sky::new(&Environment { width: 2, height: 1, texels: vec![[0.0; 3]; 2] }).shines());
    }
}
