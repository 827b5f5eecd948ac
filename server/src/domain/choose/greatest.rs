//! The greatest value over any box of a grid, by a pyramid.

use glam::IVec2;
use rayon::prelude::*;

/// A box that is longer is taken in blocks, so many across at least, and reaches as far as they do.
const ACROSS_LOG2: usize = 5;

/// Values of blocks of a grid, and the greatest of ever 2 x 2 of those below.
#[derive(Clone, Debug)]
pub(super) struct Greatest {
    /// Finest first; width, then values row by row.
    levels: Vec<(usize, Vec<f32>)>,
}

impl Greatest {
    /// Of `size` values, row by row.
    pub(super) fn new(size: [usize; 2], values: Vec<f32>) -> Self {
        let mut levels = vec![(size[0], values)];
        let mut size = size;
        while size != [1, 1] {
            let below = &levels[levels.len() - 1].1;
            let above = fours(below, size);
            size = size.map(|n| n.div_ceil(2));
            levels.push((size[0], above));
        }
        Self { levels }
    }

    /// Of what is told for each column and row, rounded up.
    pub(super) fn of(size: [usize; 2], value: impl Fn(IVec2) -> f64 + Sync) -> Self {
        let row = |y: usize| (0..size[0]).map(|x| value(IVec2::new(x as i32, y as i32))).collect();
        Self::of_rows(size, row)
    }

    /// Of the values of each row, rounded up.
    pub(super) fn of_rows(size: [usize; 2], row: impl Fn(usize) -> Vec<f64> + Sync) -> Self {
        let mut values = vec![0.0; size[0] * size[1]];
        values.par_chunks_mut(size[0]).enumerate().for_each(|(y, told)| {
            told.iter_mut().zip(row(y)).for_each(|(told, value)| *told = above(value));
        });
        Self::new(size, values)
    }

    /// Over columns and rows from the first to the last, both included and inside; of a box longer than 32 also over what is
    /// nearer than a sixteenth of it.
    pub(super) fn over(&self, x: [usize; 2], y: [usize; 2]) -> f64 {
        let longest = (x[1] - x[0]).max(y[1] - y[0]);
        // The box meets at most 2 x 2 of blocks that are no shorter.
        let level = ((usize::BITS - longest.leading_zeros()) as usize).min(self.levels.len() - 1);
        let least = level.saturating_sub(ACROSS_LOG2);
        let outwards = |[first, last]: [usize; 2]| [(first >> least) << least, (((last >> least) + 1) << least) - 1];
        let (x, y) = (outwards(x), outwards(y));
        let mut best = f32::NEG_INFINITY;
        for row in y[0] >> level..=y[1] >> level {
            for column in x[0] >> level..=x[1] >> level {
                self.visit(level, [column, row], (x, y), &mut best);
            }
        }
        f64::from(best)
    }

    fn visit(&self, level: usize, at: [usize; 2], (x, y): ([usize; 2], [usize; 2]), best: &mut f32) {
        let (width, values) = &self.levels[level];
        let value = values[at[1] * width + at[0]];
        let ends = |k: usize| [at[k] << level, ((at[k] + 1) << level) - 1];
        let apart = |own: [usize; 2], asked: [usize; 2]| own[1] < asked[0] || own[0] > asked[1];
        if value <= *best || apart(ends(0), x) || apart(ends(1), y) {
            return;
        }
        let within = |own: [usize; 2], asked: [usize; 2]| own[0] >= asked[0] && own[1] <= asked[1];
        if level == 0 || within(ends(0), x) && within(ends(1), y) {
            *best = value;
            return;
        }
        let below = &self.levels[level - 1];
        let size = [below.0, below.1.len() / below.0];
        for child in [[0, 0], [1, 0], [0, 1], [1, 1]].map(|c| [2 * at[0] + c[0], 2 * at[1] + c[1]]) {
            if child[0] < size[0] && child[1] < size[1] {
                self.visit(level - 1, child, (x, y), best);
            }
        }
    }
}

fn fours(below: &[f32], [width, height]: [usize; 2]) -> Vec<f32> {
    let at = |x: usize, y: usize| below[y.min(height - 1) * width + x.min(width - 1)];
    let greatest = |x: usize, y: usize| at(x, y).max(at(x + 1, y)).max(at(x, y + 1).max(at(x + 1, y + 1)));
    let [columns, rows] = [width, height].map(|n| n.div_ceil(2));
    (0..rows).flat_map(|y| (0..columns).map(move |x| [x, y])).map(|[x, y]| greatest(2 * x, 2 * y)).collect()
}

/// The nearest f32 that is not below.
fn above(value: f64) -> f32 {
    let near = value as f32;
    if f64::from(near) < value { near.next_up() } else { near }
}

/// Of an endless row of `count` values that repeat or end as their borders do, what of the first to the last there is,
/// in at most two runs.
pub(super) fn runs(first: i64, last: i64, count: usize, repeats: bool) -> impl Iterator<Item = [usize; 2]> + Clone {
    let n = count as i64;
    let [a, b] = [first, last].map(|i| i.rem_euclid(n) as usize);
    let (run, other) = match repeats {
        false => ([first, last].map(|i| i.clamp(0, n - 1) as usize), None),
        true if last - first + 1 >= n => ([0, count - 1], None),
        true if a <= b => ([a, b], None),
        true => ([a, count - 1], Some([0, b])),
    };
    std::iter::once(run).chain(other)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_greatest_of_any_box_is_that_of_its_values() {
        let (width, height) = (13, 7);
        let values: Vec<f32> = (0..width * height).map(|k| ((k * 7919) % 101) as f32).collect();
        let grid = Greatest::new([width, height], values.clone());
        for (x0, y0) in (0..width).flat_map(|x| (0..height).map(move |y| (x, y))) {
            for (x1, y1) in (x0..width).flat_map(|x| (y0..height).map(move |y| (x, y))) {
                let all = (y0..=y1).flat_map(|y| (x0..=x1).map(move |x| (x, y)));
                let expected = all.map(|(x, y)| values[y * width + x]).fold(f32::MIN, f32::max);
                assert_eq!(grid.over([x0, x1], [y0, y1]), f64::from(expected));
            }
        }
    }

    #[test]
    fn rows_repeat_or_go_on_as_they_end() {
        let runs = |first, last, count, repeats| runs(first, last, count, repeats).collect::<Vec<_>>();
        assert_eq!(runs(-2, 1, 5, true), [[3, 4], [0, 1]]);
        assert_eq!(runs(6, 8, 5, true), [[1, 3]]);
        assert_eq!(runs(-9, 9, 5, true), [[0, 4]]);
        assert_eq!(runs(-2, 1, 5, false), [[0, 1]]);
        assert_eq!(runs(7, 8, 5, false), [[4, 4]]);
    }
}
