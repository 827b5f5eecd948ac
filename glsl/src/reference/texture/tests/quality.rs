//! Each filter against the mean over the pixel, on a plane seen at 60 and 85 degrees.

use rayon::prelude::*;

use super::{
    Filter, Level, REPEAT, Random, filtered, grey,
    plane::{SIDE_PX, View},
};

/// Parts of a pixel by which the camera is moved.
const SHIFTS: [[f64; 2]; 4] = [[0.0, 0.0], [0.3, 0.1], [0.6, 0.45], [0.15, 0.7]];
/// Texels along the shorter side of the pixel in the middle.
const TEXELS: [f64; 3] = [0.7, 1.5, 3.3];
const MAPS: [&str; 4] = ["zone plate", "checker", "bricks", "noise"];

fn map(name: &str) -> Vec<Level> {
    let mut random = Random(5);
    let tones: Vec<f64> = (0..128 * 128).map(|_| random.next()).collect();
    match name {
        // Up to the map's own limit at the middle of its sides.
        "zone plate" => grey(256, 256, |x, y| {
            let (x, y) = (x as f64 - 127.5, y as f64 - 127.5);
            0.5 + 0.5 * ((x * x + y * y) * std::f64::consts::PI / 256.0).cos()
        }),
        "checker" => grey(64, 64, |x, y| ((x / 8 + y / 8) % 2) as f64),
        "bricks" => grey(128, 96, |x, y| {
            let (row, along) = (y / 12, (x + y / 12 % 2 * 16) % 128);
            let mortar = y % 12 < 2 || along % 32 < 2;
            if mortar { 0.9 } else { 0.2 + 0.3 * tones[row * 4 + along / 32] }
        }),
        _ => grey(128, 128, |x, y| tones[y * 128 + x]),
    }
}

/// What a filter is off by in each pixel for each shift.
fn errors(filter: Filter, levels: &[Level], view: &View, means: &[Vec<f64>]) -> Vec<[f64; 4]> {
    let error = |i: usize, s: usize| {
        let (x, y) = ((i % SIDE_PX) as f64 + SHIFTS[s][0], (i / SIDE_PX) as f64 + SHIFTS[s][1]);
        let p = view.pixel(x + 0.5, y + 0.5);
        filtered(filter, levels, p.uv, p.dx, p.dy, REPEAT)[0] - means[s][i]
    };
    (0..SIDE_PX * SIDE_PX).map(|i| [0, 1, 2, 3].map(|s| error(i, s))).collect()
}

fn means(finest: &Level, view: &View) -> Vec<Vec<f64>> {
    let row = |(s, y): (usize, usize)| {
        let mut random = Random((s * SIDE_PX + y) as u64);
        (0..SIDE_PX)
            .map(|x| view.mean(finest, x as f64 + SHIFTS[s][0], y as f64 + SHIFTS[s][1], &mut random))
            .collect::<Vec<f64>>()
    };
    let rows: Vec<(usize, usize)> = (0..SHIFTS.len()).flat_map(|s| (0..SIDE_PX).map(move |y| (s, y))).collect();
    let all: Vec<f64> = rows.into_par_iter().map(row).flatten().collect();
    all.chunks(SIDE_PX * SIDE_PX).map(<[f64]>::to_vec).collect()
}

/// Root mean square of all errors, and of a pixel's deviation from its own mean error: shimmer.
fn measures(errors: &[[f64; 4]]) -> [f64; 2] {
    let mean_square = |e: &[f64; 4]| e.iter().map(|e| e * e).sum::<f64>() / 4.0;
    let variance = |e: &[f64; 4]| mean_square(e) - (e.iter().sum::<f64>() / 4.0).powi(2);
    let root_mean = |sum: f64| (sum / errors.len() as f64).sqrt();
    [root_mean(errors.iter().map(mean_square).sum()), root_mean(errors.iter().map(variance).sum())]
}

/// Error and shimmer by filter, the mean over the sizes of texels.
fn table(name: &str, degrees: f64, half_width: f64) -> [[f64; 2]; 5] {
    let levels = map(name);
    let mut table = [[0.0; 2]; 5];
    for texels in TEXELS {
        let view = View::new(degrees, half_width, texels, &levels[0]);
        let means = means(&levels[0], &view);
        for (row, filter) in table.iter_mut().zip(Filter::ALL) {
            let [error, shimmer] = measures(&errors(filter, &levels, &view, &means));
            row[0] += error / TEXELS.len() as f64;
            row[1] += shimmer / TEXELS.len() as f64;
        }
    }
    table
}

fn printed(degrees: f64, half_width: f64) -> Vec<[[f64; 2]; 5]> {
    println!("{degrees} degrees: root mean square error / shimmer by {:?}", Filter::ALL);
    let tables = MAPS.iter().map(|name| {
        let table = table(name, degrees, half_width);
        let cells: Vec<String> = table.iter().map(|[error, shimmer]| format!("{error:.4} / {shimmer:.4}")).collect();
        println!("{name:>12}  {}", cells.join("  "));
        table
    });
    tables.collect()
}

#[test]
fn at_60_degrees_each_filter_is_better_than_the_one_before_and_ewa_by_half() {
    for (name, [nearest, bilinear, trilinear, anisotropic, ewa]) in MAPS.iter().zip(printed(60.0, 0.27)) {
        for k in 0..2 {
            assert!(bilinear[k] < nearest[k], "{name}: bilinear");
            assert!(trilinear[k] < 0.9 * bilinear[k], "{name}: trilinear");
            assert!(anisotropic[k] < 1.1 * trilinear[k], "{name}: anisotropic");
            assert!(ewa[k] < 0.55 * trilinear[k], "{name}: elliptical beside trilinear");
            assert!(ewa[k] < 1.05 * anisotropic[k], "{name}: elliptical beside anisotropic");
        }
    }
}

#[test]
fn at_85_degrees_anisotropic_and_ewa_err_less_than_a_third_of_what_trilinear_does() {
    for (name, [nearest, bilinear, trilinear, anisotropic, ewa]) in MAPS.iter().zip(printed(85.0, 0.044)) {
        for k in 0..2 {
            assert!(bilinear[k] < nearest[k], "{name}: bilinear");
            assert!(trilinear[k] < bilinear[k], "{name}: trilinear");
            let share = [0.3, 0.4][k];
            assert!(anisotropic[k] < share * trilinear[k], "{name}: anisotropic");
            assert!(ewa[k] < share * trilinear[k], "{name}: elliptical");
        }
    }
}
