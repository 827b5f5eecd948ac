//! Heights to march over, from 0 to 8 texels.

use std::path::Path;

use displace_glsl::reference::relief::{HeightLevel, ReliefMap, exact::bounds};
use displace_tests::{maps::hash, march::map};

/// Of heights, texels.
pub(crate) const AMPLITUDE: f64 = 8.0;
/// Of a map that is marched over, at most.
const MOST: u32 = 512;

/// Maps of the corpus, and whether white is low.
const CORPUS: [(&str, &str, bool); 5] = [
    ("godot_bricks", "maps/godot_bricks/texture_bricks_depth.jpg", true),
    ("ambientcg_Rock020", "maps/ambientcg_Rock020/Rock020_1K_Displacement.jpg", false),
    ("ambientcg_Tiles036", "maps/ambientcg_Tiles036/Tiles036_1K_Displacement.jpg", false),
    ("bevy_parallax_cube", "maps/bevy_parallax_cube/cube_depth.png", true),
    ("dem_jacksboro", "maps/dem_jacksboro/jacksboro_fault_dem_u16_metres.png", false),
];

/// Generated ones, those of the corpus where there is one, and files that are named.
pub(crate) fn all(files: &[String]) -> Vec<(String, ReliefMap)> {
    let mut levels = vec![("fractal".to_string(), fractal()), ("posts".to_string(), posts())];
    if let Some(root) = std::env::var_os("DISPLACE_CORPUS") {
        let read =
            |(name, file, depth): (&str, &str, bool)| (name.to_string(), read(&Path::new(&root).join(file), depth));
        levels.extend(CORPUS.map(read));
    }
    levels.extend(files.iter().map(|file| (file.clone(), read(Path::new(file), false))));
    levels.into_iter().map(|(name, level)| (name, ReliefMap { bounds: bounds(&level), ..map(level) })).collect()
}

fn read(path: &Path, depth: bool) -> HeightLevel {
    let image = image::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display())).to_luma32f();
    let size = [image.width().min(MOST), image.height().min(MOST)];
    let sign = if depth { -1.0 } else { 1.0 };
    level(size, |x, y| sign * f64::from(image.get_pixel(x, y).0[0]))
}

/// Stretched to all heights.
fn level(size: [u32; 2], height: impl Fn(u32, u32) -> f64) -> HeightLevel {
    let all: Vec<f64> = (0..size[0] * size[1]).map(|k| height(k % size[0], k / size[0])).collect();
    let [low, high] = all.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], h| [a.min(*h), b.max(*h)]);
    let heights = all.iter().map(|h| ((h - low) / (high - low).max(1e-9) * AMPLITUDE) as f32).collect();
    HeightLevel { size, heights, repeats: [true; 2] }
}

/// Noise between ever closer places, each octave half as high.
fn fractal() -> HeightLevel {
    let noise = |x: u32, y: u32, step: u32| {
        let at = |i: u32, j: u32| f64::from(hash(i % (MOST / step), j % (MOST / step), step)) / f64::from(u32::MAX);
        let smooth = |t: f64| t * t * (3.0 - 2.0 * t);
        let (i, j) = (x / step, y / step);
        let [u, v] = [x % step, y % step].map(|r| smooth(f64::from(r) / f64::from(step)));
        let row = |j: u32| at(i, j) * (1.0 - u) + at(i + 1, j) * u;
        (row(j) * (1.0 - v) + row(j + 1) * v) * f64::from(step)
    };
    level([MOST; 2], |x, y| (1..7).map(|octave| noise(x, y, 1 << octave)).sum())
}

/// A texel wide, 16 apart.
fn posts() -> HeightLevel {
    level([MOST; 2], |x, y| f64::from(u8::from(x % 16 == 5 && y % 16 == 9)))
}
