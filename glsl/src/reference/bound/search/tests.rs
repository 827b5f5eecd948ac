//! Searches against looking everywhere.

use super::*;
use crate::{
    layout::geometry::{Layer, MapAxis},
    tables::Tables,
};

/// A small generator of numbers (Steele et al. 2014, splitmix64).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ z >> 31
    }

    fn share(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn below(&mut self, n: i32) -> i32 {
        (self.next() % n as u64) as i32
    }
}

const FAR: i32 = 1 << 23;
const NO_FOLD: i32 = 1 << 30;
const WAYS: i32 = 5;

/// The ways a map of n texels may go on: repeated by texels or by nodes, mirrored by texels or by nodes, clamped.
fn axis(n: i32, way: i32) -> MapAxis {
    let (low, high, period, top, fold) = match way {
        0 => (-FAR, FAR, n, n - 1, NO_FOLD),
        1 => (-FAR, FAR, (n - 1).max(1), n - 1, NO_FOLD),
        2 => (-FAR, FAR, 2 * n, 2 * n - 1, 2 * n - 1),
        3 => (-FAR, FAR, (2 * n - 2).max(1), (2 * n - 3).max(0), if n > 1 { 2 * n - 2 } else { NO_FOLD }),
        _ => (0, n - 1, n, n - 1, NO_FOLD),
    };
    MapAxis { low, high, period, top, fold, inverse_period: 1.0 / period as f32 }
}

fn map(numbers: &mut Numbers) -> Tables {
    let [width, height] = [0; 2].map(|_| 1 + numbers.below(60));
    let layer = Layer {
        row: width as u32,
        across: axis(width, numbers.below(WAYS)),
        down: axis(height, numbers.below(WAYS)),
        ..Layer::default()
    };
    let rough = numbers.share() as f32;
    let tilt = [0; 2].map(|_| numbers.below(3) as f32);
    let mut texel =
        |k: i32| (k % width) as f32 * tilt[0] + (k / width) as f32 * tilt[1] + rough * numbers.share() as f32;
    let texels: Vec<f32> = (0..width * height).map(&mut texel).collect();
    Tables { layers: vec![layer], texels: texels.into(), ..Tables::default() }
}

fn corners(numbers: &mut Numbers, lattice: &Lattice<'_>) -> [MapPlace; 3] {
    let size = [3.0, 30.0, 300.0][numbers.below(3) as usize];
    let middle = [0; 2].map(|_| 80.0 * (numbers.share() - 0.5));
    let place = |numbers: &mut Numbers| {
        middle.map(|at| (at + size * (numbers.share() - 0.5)) * 16.0).map(f64::round).map(|x| x / 16.0)
    };
    let [a, b, mut c] = [0; 3].map(|_| place(numbers));
    match numbers.below(4) {
        0 => c = b,
        1 => c = [0, 1].map(|k| a[k] + (b[k] - a[k]) * 0.375),
        2 => c = [0, 1].map(|k| a[k] + (b[k] - a[k]) * 0.4 + 1e-7 * numbers.share()),
        _ => {}
    }
    [a, b, c].map(|[x, y]| MapPlace { x, y, value: lattice.cell(x.floor() as i64, y.floor() as i64)[0][0] })
}

/// Everywhere, without blocks.
fn exhaustive(lattice: &Lattice<'_>, corners: &[MapPlace; 3], at_texels: bool) -> f64 {
    let window = Window::around(corners).clipped(&lattice.domain());
    directly(lattice, corners, &window, at_texels, f64::INFINITY).max(if at_texels {
        beyond(lattice, corners, 0.0, f64::INFINITY)
    } else {
        0.0
    })
}

#[test]
fn blocks_lose_nothing_whatever_the_map_its_wrapping_and_the_triangle() {
    let mut numbers = Numbers(1);
    for case in 0..4000 {
        let tables = map(&mut numbers);
        let lattice = Lattice::new(&tables, &tables.layers[0], 0);
        let pyramid = Pyramid::new(&lattice);
        for at_texels in [false, true] {
            let corners = corners(&mut numbers, &lattice);
            let right = exhaustive(&lattice, &corners, at_texels);
            let found = Search::new(&lattice, &pyramid, corners, at_texels, f64::INFINITY).run();
            let quick = greatest(&lattice, &pyramid, corners, at_texels, f64::INFINITY);
            let slack = 1e-7 * (1.0 + right);
            assert!((found - right).abs() <= slack, "case {case}: {found} {right} {corners:?} {lattice:?}");
            assert!((quick - right).abs() <= slack, "case {case}: {quick} {right} {corners:?} {lattice:?}");
        }
    }
}

#[test]
fn a_cap_ends_searches_early_and_never_below_the_truth() {
    let mut numbers = Numbers(3);
    let [mut below, mut above] = [0; 2];
    for case in 0..2000 {
        let tables = map(&mut numbers);
        let lattice = Lattice::new(&tables, &tables.layers[0], 0);
        let pyramid = Pyramid::new(&lattice);
        let (corners, at_texels) = (corners(&mut numbers, &lattice), case % 2 == 1);
        let right = exhaustive(&lattice, &corners, at_texels);
        let cap = right * [0.2, 0.9, 1.1, 3.0][numbers.below(4) as usize];
        let slack = 1e-7 * (1.0 + right);
        for found in [
            Search::new(&lattice, &pyramid, corners, at_texels, cap).run(),
            greatest(&lattice, &pyramid, corners, at_texels, cap),
        ] {
            let allowed =
                if right > cap { cap..=right + slack } else { right - slack..=right + RESOLUTION * cap + slack };
            assert!(allowed.contains(&found), "case {case}: {found} of {right}, cap {cap}, {corners:?} {lattice:?}");
            *(if right > cap { &mut above } else { &mut below }) += 1;
        }
    }
    assert!(below > 500 && above > 500, "{below} {above}");
}

/// The map at a place of texel space, from its definition.
fn bilinear_at(lattice: &Lattice<'_>, [x, y]: [f64; 2]) -> f64 {
    let [[a, b], [c, d]] = lattice.cell(x.floor() as i64, y.floor() as i64);
    let (s, t) = (x - x.floor(), y - y.floor());
    (a * (1.0 - s) + b * s) * (1.0 - t) + (c * (1.0 - s) + d * s) * t
}

#[test]
fn no_place_looked_at_closely_is_farther_off_than_what_is_found() {
    const ALONG_SIDE: i32 = 60;
    let mut numbers = Numbers(4);
    for case in 0..500 {
        let tables = map(&mut numbers);
        let lattice = Lattice::new(&tables, &tables.layers[0], 0);
        let pyramid = Pyramid::new(&lattice);
        let corners = corners(&mut numbers, &lattice);
        let found = greatest(&lattice, &pyramid, corners, false, f64::INFINITY);
        let mut seen: f64 = 0.0;
        for (i, j) in (0..=ALONG_SIDE).flat_map(|i| (0..=ALONG_SIDE - i).map(move |j| (i, j))) {
            let shares = [i, j, ALONG_SIDE - i - j].map(|share| f64::from(share) / f64::from(ALONG_SIDE));
            let sum = |of: fn(&MapPlace) -> f64| (0..3).map(|k| shares[k] * of(&corners[k])).sum::<f64>();
            let flat = sum(|corner| corner.value);
            seen = seen.max((bilinear_at(&lattice, [sum(|corner| corner.x), sum(|corner| corner.y)]) - flat).abs());
        }
        assert!(seen <= found + 1e-7 * (1.0 + found), "case {case}: {seen} beyond {found}, {corners:?} {lattice:?}");
        assert!(found <= 3.0 * seen + 1e-7, "case {case}: {found} is far from {seen}, {corners:?} {lattice:?}");
    }
}

#[test]
fn every_texel_is_within_the_rest_of_its_blocks() {
    let mut numbers = Numbers(2);
    for _ in 0..200 {
        let tables = map(&mut numbers);
        let lattice = Lattice::new(&tables, &tables.layers[0], 0);
        let pyramid = Pyramid::new(&lattice);
        let [width, height] = pyramid.cells;
        for (x, y) in (0..=height).flat_map(|y| (0..=width).map(move |x| (x, y))) {
            let value = lattice.at(x, y);
            for level in 0..=pyramid.top() {
                let at = [0, 1].map(|k| ([x, y][k] / (BLOCK << level)).min(pyramid.size(level)[k] - 1));
                let block = pyramid.block(level, at);
                let [u, v] = [0, 1].map(|k| ([x, y][k] - at[k] * (BLOCK << level)) as f64);
                let rest = value - block.plane(u, v);
                assert!((f64::from(block.range[0])..=f64::from(block.range[1])).contains(&value));
                assert!((f64::from(block.rest[0])..=f64::from(block.rest[1])).contains(&rest));
            }
        }
    }
}
