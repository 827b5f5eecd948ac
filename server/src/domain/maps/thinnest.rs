//! How thin the thinnest feature of a height map is: what the steps of a march must not be longer than.

use rayon::prelude::*;

/// A feature is as high at least as this share of the range of heights.
const SHARE_OF_RANGE: f32 = 1.0 / 8.0;
/// Features cover more than this share of the texels.
const SHARE_OF_TEXELS: f64 = 1e-3;
/// So many texels are looked at along either axis; of more, rows spread evenly.
const LOOKED_AT: usize = 1 << 20;
/// Texels; what is wider asks for no more steps than a march takes at least.
const WIDEST: usize = 64;
/// The fractional part of the golden ratio: multiples of it spread evenly over rows, at no period of theirs.
const GOLDEN: f64 = 0.618_033_988_749_895;

/// Texels across a map of so many columns that repeats along both axes or goes on as its border does: no feature is
/// thinner. A feature of width w along a row or column is what the opening or the closing by a run of w + 1 texels
/// (Matheron 1975) takes away: more than an eighth of the range of the heights, at more than a thousandth of the texels.
/// The widths tried grow by about a quarter each time, and the least that a feature found may have is told; where none is
/// found, 64, or the longer side of a smaller map.
pub(super) fn thinnest(heights: &[f32], columns: usize, repeats: [bool; 2]) -> f32 {
    let rows = heights.len() / columns;
    let (low, high) = heights.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
    let least = SHARE_OF_RANGE * (high - low);
    let turned = turned(heights, columns);
    let across = Lines { heights, count: rows, length: columns, repeats: repeats[0] };
    let down = Lines { heights: &turned, count: columns, length: rows, repeats: repeats[1] };
    let widest = columns.max(rows).min(WIDEST);
    let mut wider = 1;
    while least > 0.0 && wider < widest {
        let width = tried(wider);
        if [&across, &down].iter().any(|lines| lines.have_features(width, least)) {
            return wider as f32;
        }
        wider = width + 1;
    }
    widest as f32
}

/// The width that stands for those from this one on.
fn tried(from: usize) -> usize {
    from + (from - 1) / 4
}

/// Columns for rows.
fn turned(heights: &[f32], columns: usize) -> Vec<f32> {
    let column = |x: usize| heights.iter().skip(x).step_by(columns).copied();
    (0..columns).into_par_iter().flat_map_iter(column).collect()
}

/// The rows of a map, or its columns.
struct Lines<'h> {
    /// Line by line.
    heights: &'h [f32],
    count: usize,
    length: usize,
    repeats: bool,
}

impl Lines<'_> {
    /// Whether features up to so wide are as high as `least`, and many enough.
    fn have_features(&self, width: usize, least: f32) -> bool {
        if width >= self.length {
            return false;
        }
        let looked_at = self.count.min((LOOKED_AT / self.length).max(1));
        let of_line = |k: usize| self.features(self.chosen(k, looked_at), width + 1, least);
        let found: usize = (0..looked_at).into_par_iter().map(of_line).sum();
        found as f64 > SHARE_OF_TEXELS * (looked_at * self.length) as f64
    }

    fn chosen(&self, k: usize, looked_at: usize) -> usize {
        if looked_at == self.count { k } else { (self.count as f64 * (k as f64 * GOLDEN).fract()) as usize }
    }

    /// Texels of a line that its opening or its closing by a run changes by more than `least`.
    fn features(&self, line: usize, run: usize, least: f32) -> usize {
        let own = self.padded(line, run - 1);
        let opened = of_runs(of_runs(own.clone(), run, f32::min), run, f32::max);
        let closed = of_runs(of_runs(own.clone(), run, f32::max), run, f32::min);
        let changed = own[run - 1..].iter().zip(opened.iter().zip(&closed));
        changed.filter(|(own, (opened, closed))| *own - *opened > least || *closed - *own > least).count()
    }

    /// A line with so many texels more before it and behind it.
    fn padded(&self, line: usize, more: usize) -> Vec<f32> {
        let (n, more) = (self.length as isize, more as isize);
        let own = &self.heights[line * self.length..][..self.length];
        let texel = |i: isize| own[if self.repeats { i.rem_euclid(n) } else { i.clamp(0, n - 1) } as usize];
        let before: Vec<f32> = (-more..0).map(texel).collect();
        let behind: Vec<f32> = (n..n + more).map(texel).collect();
        [&before, own, &behind].concat()
    }
}

/// The least or the greatest of each run of values.
fn of_runs(mut values: Vec<f32>, run: usize, pick: impl Fn(f32, f32) -> f32 + Copy) -> Vec<f32> {
    let mut covered = 1;
    while covered < run {
        let step = covered.min(run - covered);
        values = values.iter().zip(&values[step..]).map(|(a, b)| pick(*a, *b)).collect();
        covered += step;
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    const REPEATS: [bool; 2] = [true; 2];

    fn of(side: usize, repeats: [bool; 2], height: impl Fn(usize, usize) -> f32) -> f32 {
        let heights: Vec<f32> = (0..side * side).map(|i| height(i % side, i / side)).collect();
        thinnest(&heights, side, repeats)
    }

    #[test]
    fn posts_and_slots_are_as_thin_as_they_are_drawn() {
        for width in 1..=6 {
            for up in [1.0, -1.0] {
                let post = |x: usize, y: usize| if x % 20 < width && y % 20 < width { up } else { 0.0 };
                let found = of(60, REPEATS, post);
                // Widths above 4 are tried in pairs, and the lesser of a pair is told.
                let told = if width == 6 { 5 } else { width };
                assert_eq!(found, told as f32, "width {width}, {up}");
            }
        }
    }

    #[test]
    fn bricks_are_as_thin_as_the_mortar_between_them() {
        let brick = |x: usize, y: usize| {
            let shift = 16 * ((y / 16) % 2);
            if y % 16 < 4 || (x + shift) % 32 < 4 { 0.0 } else { 1.0 }
        };
        assert_eq!(of(64, REPEATS, brick), 4.0);
    }

    /// The opening by L texels of a sine of period P lowers its crest to where it is L wide, cos(pi L / P) of its amplitude: more than
    /// an eighth of the range, twice the amplitude, from L = 0.23 P on.
    #[test]
    fn smooth_waves_are_about_a_quarter_of_a_period_thin() {
        for period in [16.0f32, 32.0, 64.0, 128.0] {
            let found = of(128, REPEATS, |x, _| (std::f32::consts::TAU * x as f32 / period).sin());
            assert!((0.15..=0.25).contains(&(found / period)), "{found} of {period}");
        }
    }

    #[test]
    fn a_flat_map_and_one_with_a_faint_or_rare_feature_have_none() {
        assert_eq!(of(32, REPEATS, |_, _| 3.0), 32.0);
        // A ramp that ends has no crest, and one texel of 4096 is none of a thousand.
        assert_eq!(of(64, [false; 2], |x, _| x as f32), 64.0);
        assert_eq!(of(64, [false; 2], |x, y| if (x, y) == (20, 20) { 1.0 } else { 0.0 }), 64.0);
        let faint = |x: usize, y: usize| x as f32 + if x.is_multiple_of(8) && y.is_multiple_of(8) { 7.0 } else { 0.0 };
        assert_eq!(of(64, [false; 2], faint), 64.0);
    }

    #[test]
    fn what_repeats_is_as_wide_across_the_border() {
        let slot = |x: usize, _: usize| if !(3..61).contains(&x) { 0.0 } else { 1.0 };
        assert_eq!(of(64, REPEATS, slot), 5.0, "3 + 3 texels; 5 and 6 are tried as one");
        assert_eq!(
            of(64, [false; 2], slot),
            48.0,
            "the border goes on, and what is left is 58 wide; 48 to 59 are tried as one"
        );
    }
}
