//! The greatest heights of cells and of 2 x 2 of those below, which rays are held against (Tevs, Ihrke and Seidel 2008).

use rayon::prelude::*;

use super::super::HeightLevel;

/// Of every cell, row by row, then of ever 2 x 2 of those, sizes rounded up, until one is left; then the least height of
/// the map. Exact: greatest of f32.
#[must_use]
pub fn bounds(level: &HeightLevel) -> Vec<f32> {
    let mut all = cells(level);
    let (mut first, mut size) = (0, level.size);
    while size != [1; 2] {
        let above = fours(&all[first..], size);
        first = all.len();
        size = size.map(|n| n.div_ceil(2));
        all.extend(above);
    }
    all.push(level.heights.iter().copied().fold(f32::INFINITY, f32::min));
    all
}

fn cells(level: &HeightLevel) -> Vec<f32> {
    let [width, height] = level.size.map(|n| n as usize);
    let next = |i: usize, n: usize, repeats: bool| if i + 1 < n { i + 1 } else { i * usize::from(!repeats) };
    let line = |y: usize| &level.heights[y * width..][..width];
    let row = |y: usize| {
        let below = line(next(y, height, level.repeats[1]));
        let greater: Vec<f32> = line(y).iter().zip(below).map(|(a, b)| a.max(*b)).collect();
        (0..width).map(move |x| greater[x].max(greater[next(x, width, level.repeats[0])]))
    };
    (0..height).into_par_iter().flat_map_iter(row).collect()
}

fn fours(below: &[f32], [width, height]: [u32; 2]) -> Vec<f32> {
    let at = |x: u32, y: u32| below[(y.min(height - 1) * width + x.min(width - 1)) as usize];
    let greatest = |x: u32, y: u32| {
        let (x, y) = (2 * x, 2 * y);
        at(x, y).max(at(x + 1, y)).max(at(x, y + 1).max(at(x + 1, y + 1)))
    };
    let [columns, rows] = [width, height].map(|n| n.div_ceil(2));
    (0..rows).into_par_iter().flat_map_iter(|y| (0..columns).map(move |x| greatest(x, y))).collect()
}
