//! The greatest value over any box of a grid, by a pyramid.

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

    /// Over columns and rows from the first to the last, both included and inside.
    pub(super) fn over(&self, x: [usize; 2], y: [usize; 2]) -> f64 {
        let mut best = f32::NEG_INFINITY;
        self.visit(self.levels.len() - 1, [0, 0], (x, y), &mut best);
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
    (0..columns * rows).map(|k| greatest(2 * (k % columns), 2 * (k / columns))).collect()
}

/// Of an endless row of `count` values that repeat or end as their borders do, what of the first to the last there is,
/// in at most two runs.
pub(super) fn runs(first: i64, last: i64, count: usize, repeats: bool) -> Vec<[usize; 2]> {
    let n = count as i64;
    if !repeats {
        return vec![[first, last].map(|i| i.clamp(0, n - 1) as usize)];
    }
    if last - first + 1 >= n {
        return vec![[0, count - 1]];
    }
    let [a, b] = [first, last].map(|i| i.rem_euclid(n) as usize);
    if a <= b { vec![[a, b]] } else { vec![[a, count - 1], [0, b]] }
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
        assert_eq!(runs(-2, 1, 5, true), [[3, 4], [0, 1]]);
        assert_eq!(runs(6, 8, 5, true), [[1, 3]]);
        assert_eq!(runs(-9, 9, 5, true), [[0, 4]]);
        assert_eq!(runs(-2, 1, 5, false), [[0, 1]]);
        assert_eq!(runs(7, 8, 5, false), [[4, 4]]);
    }
}
