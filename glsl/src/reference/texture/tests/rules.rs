//! What every filter must do whatever the map.

use super::{Filter, Level, REPEAT, Random, WRAP_CLAMP, WRAP_MIRROR, WRAP_REPEAT, bilinear, filtered, grey, nearest};

const WRAPS: [u32; 3] = [WRAP_REPEAT, WRAP_MIRROR, WRAP_CLAMP];
/// Sizes of all kinds: one texel, a row, odd, not square.
const SIZES: [[usize; 2]; 7] = [[1, 1], [1, 9], [64, 1], [3, 3], [37, 29], [256, 4], [64, 64]];

fn by_size([x, y]: [f64; 2], level: &Level) -> [f64; 2] {
    [x / level.width as f64, y / level.height as f64]
}

/// Calls with every filter, size and wrap, at random places with random sides.
fn everywhere(count: usize, mut call: impl FnMut(Filter, &[Level], [f64; 2], [[f64; 2]; 2], [u32; 2])) {
    let mut random = Random(11);
    for size in SIZES {
        let levels = grey(size[0], size[1], |x, y| ((x * 37 + y * 101) % 64) as f64 / 64.0);
        for _ in 0..count {
            let uv = [random.within(-2.0, 3.0), random.within(-2.0, 3.0)];
            let sides = random.sides().map(|side| by_size(side, &levels[0]));
            let wrap = [0, 0].map(|_: i32| WRAPS[(random.next() * 3.0) as usize]);
            Filter::ALL.into_iter().for_each(|filter| call(filter, &levels, uv, sides, wrap));
        }
    }
}

#[test]
fn a_map_of_one_value_has_it_everywhere() {
    everywhere(60, |filter, levels, uv, [dx, dy], wrap| {
        let even: Vec<Level> = levels
            .iter()
            .map(|level| Level { texels: vec![[0.3, 0.5, 0.7, 1.0]; level.texels.len()], ..level.clone() })
            .collect();
        let found = filtered(filter, &even, uv, dx, dy, wrap);
        let off = found.iter().zip([0.3, 0.5, 0.7, 1.0]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // Rounding of at most 2 000 additions.
        assert!(off < 1e-13, "{filter:?}: {found:?}");
    });
}

#[test]
fn values_stay_within_those_of_the_map() {
    everywhere(200, |filter, levels, uv, [dx, dy], wrap| {
        let found = filtered(filter, levels, uv, dx, dy, wrap)[0];
        assert!((-1e-12..=63.0 / 64.0 + 1e-12).contains(&found), "{filter:?}: {found}");
    });
}

#[test]
fn pixels_of_half_a_texel_see_the_bilinear_map() {
    everywhere(100, |filter, levels, uv, sides, wrap| {
        let finest = &levels[0];
        let in_texels = |d: [f64; 2]| (d[0] * finest.width as f64).hypot(d[1] * finest.height as f64);
        let shrink = 0.35 / in_texels(sides[0]).max(in_texels(sides[1]));
        let [dx, dy] = sides.map(|side| side.map(|d| d * shrink));
        let found = filtered(filter, levels, uv, dx, dy, wrap)[0];
        let expected =
            if filter == Filter::Nearest { nearest(finest, uv, wrap) } else { bilinear(finest, uv, wrap) }[0];
        assert!((found - expected).abs() < 1e-12, "{filter:?}: {found} for {expected}");
    });
}

/// Values are the place itself. Taps lie in pairs around the middle, so rows of them are exact; the elliptical weights of
/// whole texels are not quite even about the middle. In texels of the finest level, by the level's width.
#[test]
fn ramps_are_kept_away_from_the_border() {
    let levels = grey(256, 256, |x, y| x as f64 + 0.5 * y as f64);
    let mut random = Random(3);
    let mut worst = 0.0f64;
    for _ in 0..4000 {
        let at = [random.within(120.0, 136.0), random.within(120.0, 136.0)];
        let [dx, dy] = random.sides();
        let longest = dx[0].hypot(dx[1]).hypot(dy[0].hypot(dy[1]));
        if longest > 32.0 {
            continue;
        }
        let uv = by_size(at, &levels[0]);
        let (dx, dy) = (by_size(dx, &levels[0]), by_size(dy, &levels[0]));
        let expected = at[0] - 0.5 + 0.5 * (at[1] - 0.5);
        let off = |filter| (filtered(filter, &levels, uv, dx, dy, [WRAP_CLAMP; 2])[0] - expected).abs();
        for filter in [Filter::Bilinear, Filter::Trilinear, Filter::Anisotropic] {
            assert!(off(filter) < 1e-10, "{filter:?}: off by {}", off(filter));
        }
        let determinant = (dx[0] * dy[1] - dx[1] * dy[0]).abs() * 65536.0;
        let texel = (determinant / longest).max(longest / 16.0).max(1.0);
        worst = worst.max(off(Filter::Ewa) / texel);
    }
    println!("elliptical: a slope of 1 is off by at most {worst:.4} texels");
    assert!(worst < 0.1, "elliptical: {worst}");
}

/// Derivatives that differ by one part in 10^6 change the value by at most 10^-4 of the map's range: nothing jumps where
/// a level, a tap or a row of texels comes in.
#[test]
fn small_changes_of_the_derivatives_change_the_value_little() {
    let levels = grey(64, 48, |x, y| ((x * 37 + y * 101) % 64) as f64 / 63.0);
    let mut random = Random(29);
    let mut worst = [0.0f64; 5];
    for _ in 0..3000 {
        let uv = [random.next(), random.next()];
        let mut sides = random.sides();
        // Where things would jump: circles, whole numbers of taps, whole levels.
        let scale = [1.0, 2.0, 4.0][(random.next() * 3.0) as usize];
        let longer = [1.0, 2.0, 3.0, 16.0][(random.next() * 4.0) as usize];
        if random.next() < 0.5 {
            sides = [[scale * longer, 0.0], [0.0, scale]];
        }
        let changed = sides.map(|side| side.map(|d| d + random.within(-1e-6, 1e-6) * scale));
        for (worst, filter) in worst.iter_mut().zip(Filter::ALL) {
            let value = |sides: [[f64; 2]; 2]| {
                let [dx, dy] = sides.map(|side| by_size(side, &levels[0]));
                filtered(filter, &levels, uv, dx, dy, REPEAT)[0]
            };
            *worst = worst.max((value(sides) - value(changed)).abs());
        }
    }
    println!("10^-6 of the derivatives changes values by at most {worst:?}");
    assert!(worst.iter().all(|worst| *worst < 1e-4), "{worst:?}");
}

#[test]
fn derivatives_that_are_not_numbers_or_endless_show_the_coarsest_level() {
    for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e200] {
        for place in 0..4 {
            let mut sides = [0.01; 4];
            sides[place] = odd;
            let (dx, dy) = ([sides[0], sides[1]], [sides[2], sides[3]]);
            let levels = grey(37, 29, |x, y| ((x * 37 + y * 101) % 64) as f64);
            for filter in [Filter::Trilinear, Filter::Anisotropic, Filter::Ewa] {
                let found = filtered(filter, &levels, [0.3, 0.8], dx, dy, REPEAT);
                assert_eq!(found[0], levels[levels.len() - 1].texels[0][0], "{filter:?} for {odd}");
            }
        }
    }
}

#[test]
fn alpha_is_scaled_by_level() {
    let mut levels = grey(64, 64, |_, _| 0.4);
    levels.iter_mut().zip([1.0, 1.5, 2.0, 9.0]).for_each(|(level, scale)| level.alpha_scale = scale);
    let alpha = |filter, texels: f64| {
        let side = texels / 64.0;
        filtered(filter, &levels, [0.3, 0.4], [side, 0.0], [0.0, side], REPEAT)[3]
    };
    for filter in [Filter::Trilinear, Filter::Anisotropic] {
        for (texels, expected) in [(1.0, 0.4), (2.0, 0.6), (4.0, 0.8), (8.0, 1.0)] {
            assert!((alpha(filter, texels) - expected).abs() < 1e-12, "{filter:?} {texels}");
        }
    }
    for (texels, expected) in [(2.0, 0.4), (4.0, 0.6), (8.0, 0.8), (16.0, 1.0)] {
        assert!((alpha(Filter::Ewa, texels) - expected).abs() < 1e-12, "elliptical, {texels}");
    }
}
