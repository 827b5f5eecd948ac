//! The maps of the pictures, in the scratch folder: heights of 16 bits that repeat on every side, and colours beside them.

use std::{fs, path::Path};

use displace_tests::{
    data::sample,
    maps::{hash, png16},
};
use image::{GrayImage, Luma, Rgb, Rgb32FImage, RgbImage, RgbaImage, codecs::hdr::HdrEncoder, imageops};

use crate::Result;

const SIDE: u32 = 256;
const RANDOM_SIDE: u32 = 128;
/// The middle of a map.
const MIDDLE: f64 = 127.5;

/// Writes all maps.
pub(crate) fn write(folder: &Path) -> Result<()> {
    for (name, height) in [
        ("bricks", brick as fn(f64, f64) -> f64),
        ("tiles", tile),
        ("crate", plank),
        ("posts", post),
        ("holes", hole),
        ("domes", dome),
    ] {
        let value = |x, y| (65535.0 * height(f64::from(x), f64::from(y))).round() as u16;
        fs::write(folder.join(format!("{name}.png")), png16(SIDE, SIDE, value))?;
    }
    for (name, color) in [
        ("bricks_color", brick_color as fn(f64, f64) -> [f64; 3]),
        ("tiles_color", tile_color),
        ("crate_color", plank_color),
        ("posts_color", post_color),
        ("holes_color", hole_color),
        ("stripes", stripe),
        ("bricks_normal", |x, y| normal(brick, 5.0, x, y)),
        ("cyslice", |x, y| {
            let [r, g, b] = normal(dome, 12.0, x, y);
            [g, r, b]
        }),
        ("ripples", ripple),
    ] {
        let texel = |x, y| Rgb(color(f64::from(x), f64::from(y)).map(byte));
        RgbImage::from_fn(SIDE, SIDE, texel).save(folder.join(format!("{name}.png")))?;
    }
    globe(folder)?;
    rock(folder)?;
    random(folder)?;
    sky(folder)
}

fn byte(value: f64) -> u8 {
    (255.0 * value.clamp(0.0, 1.0)).round() as u8
}

/// A number from 0 to 1 for each cell.
fn chance(x: f64, y: f64, seed: u32) -> f64 {
    f64::from(hash(x as u32, y as u32, seed) >> 8) / f64::from(1 << 24)
}

fn ramp(from: f64, to: f64, x: f64) -> f64 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Bricks of 32 x 16 texels, every other row half a brick aside: their column and row, and the way to the nearest edge.
fn wall(x: f64, y: f64) -> (f64, f64, f64) {
    let row = (y / 16.0).floor();
    let along = (x + 16.0 * (row % 2.0)).rem_euclid(256.0);
    let (a, b) = (along % 32.0, y % 16.0);
    ((along / 32.0).floor(), row, a.min(31.0 - a).min(b).min(15.0 - b))
}

fn brick(x: f64, y: f64) -> f64 {
    let (column, row, edge) = wall(x, y);
    let top = 0.86 + 0.14 * chance(column, row, 1);
    0.012 * chance(x, y, 2) + 0.958 * top * ramp(0.4, 3.2, edge)
}

fn brick_color(x: f64, y: f64) -> [f64; 3] {
    let (column, row, edge) = wall(x, y);
    let (tone, grain) = (chance(column, row, 3), 0.02 * (chance(x, y, 4) - 0.5));
    let clay = [0.62 + 0.2 * tone, 0.30 + 0.13 * tone, 0.22 + 0.09 * tone];
    let is_mortar = 1.0 - ramp(0.8, 2.4, edge);
    [0, 1, 2].map(|k| clay[k] + grain + is_mortar * (0.72 - clay[k]))
}

/// Flat tiles of 32 texels with joints two texels wide.
fn tile(x: f64, y: f64) -> f64 {
    let (a, b) = (x % 32.0, y % 32.0);
    ramp(0.6, 2.4, a.min(31.0 - a).min(b).min(31.0 - b))
}

fn tile_color(x: f64, y: f64) -> [f64; 3] {
    let (column, row) = ((x / 32.0).floor(), (y / 32.0).floor());
    let tone = 0.06 * (chance(column, row, 5) - 0.5);
    let base = if (column + row) % 2.0 < 1.0 { [0.82, 0.80, 0.74] } else { [0.22, 0.42, 0.48] };
    let joint = 1.0
        - ramp(0.6, 2.0, {
            let (a, b) = (x % 32.0, y % 32.0);
            a.min(31.0 - a).min(b).min(31.0 - b)
        });
    base.map(|c| (c + tone) * (1.0 - 0.6 * joint))
}

/// Planks between a frame, and a boss in their middle: the side of a crate.
fn plank(x: f64, y: f64) -> f64 {
    let border = x.min(255.0 - x).min(y).min(255.0 - y);
    let gap = {
        let a = (x - 36.0).rem_euclid(46.0);
        a.min(45.0 - a)
    };
    let boards = 0.28 + 0.22 * ramp(0.5, 4.0, gap);
    let far = (x - MIDDLE).hypot(y - MIDDLE);
    let boss = if far < 58.0 { 0.98 * (1.0 - (far / 58.0).powi(2)).sqrt() } else { 0.0 };
    let frame = 1.0 - ramp(34.0, 38.0, border);
    boards.max(boss).max(frame)
}

fn plank_color(x: f64, y: f64) -> [f64; 3] {
    let border = x.min(255.0 - x).min(y).min(255.0 - y);
    let far = (x - MIDDLE).hypot(y - MIDDLE);
    let grain = 0.05 * ((y / 5.0 + 3.0 * chance((x / 46.0).floor(), 0.0, 6)).sin() * (x / 9.0).cos());
    let base = if border < 36.0 {
        [0.50, 0.33, 0.18]
    } else if far < 58.0 {
        [0.75, 0.22, 0.16]
    } else {
        [0.74, 0.57, 0.36]
    };
    base.map(|c| c + grain)
}

/// Posts of two texels, sixteen apart.
fn post(x: f64, y: f64) -> f64 {
    let (a, b) = ((x % 16.0 - 7.5).abs(), (y % 16.0 - 7.5).abs());
    if a < 1.0 && b < 1.0 { 1.0 } else { 0.0 }
}

fn post_color(x: f64, y: f64) -> [f64; 3] {
    let ground =
        if ((x / 16.0).floor() + (y / 16.0).floor()) % 2.0 < 1.0 { [0.66, 0.68, 0.62] } else { [0.48, 0.52, 0.5] };
    let near = (x % 16.0 - 7.5).abs().max((y % 16.0 - 7.5).abs());
    if near < 2.6 { [0.9, 0.45, 0.1] } else { ground }
}

/// The way to the nearest of nine bullet holes, in texels, and a share of its size.
fn shot(x: f64, y: f64) -> f64 {
    let mut nearest = f64::INFINITY;
    for cell in 0..9u32 {
        let (i, j) = (f64::from(cell % 3), f64::from(cell / 3));
        let (a, b) = (85.3 * (i + 0.3 + 0.4 * chance(i, j, 7)), 85.3 * (j + 0.3 + 0.4 * chance(i, j, 8)));
        let size = 11.0 + 8.0 * chance(i, j, 9);
        let turn = (y - b).atan2(x - a);
        let ragged = 1.0 + 0.1 * (5.0 * turn + 9.0 * chance(i, j, 10)).sin() + 0.05 * (11.0 * turn).sin();
        nearest = nearest.min((x - a).hypot(y - b) / (size * ragged));
    }
    nearest
}

fn hole(x: f64, y: f64) -> f64 {
    let near = shot(x, y);
    let crater = 0.92 - 0.5 * (1.0 - ramp(0.5, 1.0, near)) - 0.4 * (1.0 - ramp(0.25, 0.45, near));
    crater + 0.06 * (1.0 - ramp(1.0, 1.35, near)) + 0.015 * chance(x, y, 11)
}

fn hole_color(x: f64, y: f64) -> [f64; 3] {
    let near = shot(x, y);
    let soot = 0.45 * (1.0 - ramp(0.9, 1.9, near));
    let base = if near < 0.4 {
        [0.13, 0.12, 0.12]
    } else if near < 0.95 {
        [0.62, 0.58, 0.52]
    } else {
        [0.58, 0.66, 0.62]
    };
    base.map(|c| c * (1.0 - soot) + 0.03 * (chance(x, y, 12) - 0.5))
}

/// Round domes, four a side.
fn dome(x: f64, y: f64) -> f64 {
    let (a, b) = ((x % 64.0 - 31.5) / 28.0, (y % 64.0 - 31.5) / 28.0);
    (1.0 - a * a - b * b).max(0.0).sqrt() * 0.9
}

/// The normal of heights of `texels` texels, by central differences, as colour: green is up.
fn normal(height: fn(f64, f64) -> f64, texels: f64, x: f64, y: f64) -> [f64; 3] {
    let at = |dx: f64, dy: f64| texels * height((x + dx).rem_euclid(256.0), (y + dy).rem_euclid(256.0));
    let (a, b) = (0.5 * (at(1.0, 0.0) - at(-1.0, 0.0)), 0.5 * (at(0.0, 1.0) - at(0.0, -1.0)));
    let length = (1.0 + a * a + b * b).sqrt();
    [-a, b, 1.0].map(|c| 0.5 + 0.5 * c / length)
}

/// Red along s, green along t, and rows that the patch does not reach, dark for the darts.
fn stripe(x: f64, y: f64) -> [f64; 3] {
    let (is_green, is_red) = (x % 32.0 < 6.0, y % 32.0 < 6.0);
    match () {
        () if (168.0..204.0).contains(&y) => [0.08, 0.08, 0.1],
        () if is_red => [0.8, 0.22, 0.18],
        () if is_green => [0.28, 0.63, 0.28],
        () => [0.9, 0.88, 0.82],
    }
}

/// A simple colour map for the ball: bands along u that follow ten waves.
fn ripple(x: f64, _: f64) -> [f64; 3] {
    let wave = 0.5 + 0.5 * (std::f64::consts::TAU * 10.0 * (x + 0.5) / 256.0).sin();
    [0.25 + 0.6 * wave, 0.45 + 0.2 * wave, 0.75 - 0.45 * wave]
}

/// The sample's colours, twice as bright: they are those of wet rock.
fn rock(folder: &Path) -> Result<()> {
    let mut picture = image::open(sample("maps/rock_color.jpg"))?.to_rgb8();
    picture.pixels_mut().for_each(|pixel| pixel.0 = pixel.0.map(|c| c.saturating_mul(2)));
    imageops::blur(&picture, 2.0).save(folder.join("rock_light.png"))?;
    Ok(())
}

/// A globe with a net of 30 degrees, and holes in it as a map of opacity.
fn globe(folder: &Path) -> Result<()> {
    let paint = |x: u32, y: u32| {
        let (a, b) = (f64::from(x), f64::from(y));
        let is_net = (x + 1) % 43 < 3 || (y + 1) % 43 < 3;
        let land = (a / 37.0).sin() + (b / 21.0 + a / 53.0).sin() + 0.6 * (a / 10.0 + b / 14.0).sin() > 0.5;
        Rgb(if is_net {
            [235, 235, 225]
        } else if land {
            [90, 150, 70]
        } else {
            [50, 90, 170]
        })
    };
    RgbImage::from_fn(512, 256, paint).save(folder.join("globe.png"))?;
    let letters = |x: u32, y: u32| {
        let (a, b) = (x % 64, y % 64);
        let is_letter = (16..26).contains(&a) && (10..54).contains(&b)
            || (26..48).contains(&a) && ((10..20).contains(&b) || (27..36).contains(&b));
        let (hue, light) = (f64::from(x / 64) * std::f64::consts::FRAC_PI_4, 0.75 - 0.12 * f64::from(y / 64));
        let ink = if is_letter { 0.25 } else { 1.0 };
        Rgb([0.0, 1.0, 2.0].map(|k| byte(ink * light * (0.72 + 0.28 * (hue - 2.1 * k).cos()))))
    };
    RgbImage::from_fn(512, 256, letters).save(folder.join("letters.png"))?;
    let hole = |x: u32, y: u32| {
        let near = (f64::from(x % 64) - 31.5).hypot(f64::from(y % 64) - 31.5);
        image::Rgba([255, 255, 255, byte(0.5 + 0.05 * (near - 20.0))])
    };
    RgbaImage::from_fn(512, 256, hole).save(folder.join("holed.png"))?;
    Ok(())
}

/// West's test maps: random colours and random greys, blurred, stretched to the full range.
fn random(folder: &Path) -> Result<()> {
    let channel = |seed: u32, radius: i64| {
        let mut values: Vec<f64> = (0..RANDOM_SIDE * RANDOM_SIDE)
            .map(|k| chance(f64::from(k % RANDOM_SIDE), f64::from(k / RANDOM_SIDE), seed))
            .collect();
        for _ in 0..3 {
            values = blurred(&blurred(&values, radius, 1), radius, i64::from(RANDOM_SIDE));
        }
        let (low, high) = values.iter().fold((1.0f64, 0.0f64), |(low, high), &x| (low.min(x), high.max(x)));
        values.iter().map(|x| byte((x - low) / (high - low))).collect::<Vec<u8>>()
    };
    let [r, g, b] = [20, 21, 22].map(|seed| channel(seed, 6));
    let at = |x: u32, y: u32| (y * RANDOM_SIDE + x) as usize;
    RgbImage::from_fn(RANDOM_SIDE, RANDOM_SIDE, |x, y| Rgb([r[at(x, y)], g[at(x, y)], b[at(x, y)]]))
        .save(folder.join("random_rgb.png"))?;
    let grey = channel(23, 6);
    GrayImage::from_fn(RANDOM_SIDE, RANDOM_SIDE, |x, y| Luma([grey[at(x, y)]])).save(folder.join("random_grey.png"))?;
    Ok(())
}

/// The mean over 2 radius + 1 texels along rows (stride 1) or columns (stride RANDOM_SIDE), wrapping round.
fn blurred(values: &[f64], radius: i64, stride: i64) -> Vec<f64> {
    let side = i64::from(RANDOM_SIDE);
    let mean = |k: i64| {
        let (along, line) = if stride == 1 { (k % side, k - k % side) } else { (k / side, k % side) };
        let sum: f64 =
            (-radius..=radius).map(|d| values[(line + stride * (along + d).rem_euclid(side)) as usize]).sum();
        sum / (2 * radius + 1) as f64
    };
    (0..side * side).map(mean).collect()
}

/// Radiance all around: a gradient above, a checker below, a sun.
fn sky(folder: &Path) -> Result<()> {
    let light = |x: u32, y: u32| {
        let up = (std::f32::consts::PI * (y as f32 + 0.5) / 128.0).cos();
        let sun = 80.0 * (-((x as f32 - 180.0).powi(2) + (y as f32 - 36.0).powi(2)) / 24.0).exp();
        let ground = 0.18 + 0.1 * ((x / 16 + y / 16) % 2) as f32;
        Rgb(if up > 0.0 { [0.35 + sun, 0.55 + sun, 1.0 + 0.8 * sun] } else { [ground, 0.8 * ground, 0.6 * ground] })
    };
    let sky = Rgb32FImage::from_fn(256, 128, light);
    let pixels: Vec<Rgb<f32>> = sky.pixels().copied().collect();
    HdrEncoder::new(fs::File::create(folder.join("sky.hdr"))?).encode(&pixels, 256, 128)?;
    Ok(())
}
