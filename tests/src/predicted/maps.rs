//! Height maps of all kinds: of the corpus where there is one, of the samples, and generated ones; their heights from 0 to 1,
//! from -1/2, from -1 and above 0, wherever the midlevel may be.

use std::{path::Path, sync::Arc};

use displace_glsl::reference::{
    cone_map::cones,
    relief::{HeightLevel, ReliefMap, exact::bounds},
};
use displace_server::domain::{choose::facts::HeightFacts, image::HeightMap};
use rayon::prelude::*;

use crate::{data::sample, maps::hash};

/// Texels of a side, at most.
const MOST: u32 = 128;
const CORPUS: [(&str, &str); 6] = [
    ("bricks", "maps/godot_bricks/texture_bricks_depth.jpg"),
    ("rock", "maps/ambientcg_Rock020/Rock020_1K_Displacement.jpg"),
    ("tiles", "maps/ambientcg_Tiles036/Tiles036_1K_Displacement.jpg"),
    ("cube", "maps/bevy_parallax_cube/cube_depth.png"),
    ("terrain", "maps/dem_jacksboro/jacksboro_fault_dem_u16_metres.png"),
    ("sample rock", ""),
];
/// Lowest heights, of the range.
const LOWEST: [f32; 4] = [0.0, -0.5, -1.0, 0.2];

/// A map, and what methods and predictions know of it.
pub struct TestMap {
    pub name: String,
    pub map: Arc<HeightMap>,
    pub facts: HeightFacts,
    /// The finest first; with bounds and cones.
    pub levels: Vec<ReliefMap>,
}

/// Each by every lowest height.
#[must_use]
pub fn all() -> Vec<TestMap> {
    let mut drawn = generated();
    let root = std::env::var_os("DISPLACE_CORPUS");
    for (name, file) in CORPUS {
        match &root {
            _ if file.is_empty() => drawn.push(read(name, &sample("maps/rock_height.png"))),
            Some(root) => drawn.push(read(name, &Path::new(root).join(file))),
            None => {}
        }
    }
    drawn.into_par_iter().enumerate().flat_map_iter(|(k, (name, level))| of_levels(k, &name, &level)).collect()
}

type Named = (String, HeightLevel);

fn generated() -> Vec<Named> {
    let noise = |x: u32, y: u32| f64::from(hash(x, y, 7)) / f64::from(u32::MAX);
    let posts = |x: u32, y: u32| f64::from(u8::from(x % 16 == 5 && y % 12 == 9));
    let walls = |x: u32, y: u32| f64::from(u8::from((x + 5 * y) % 32 < 11));
    let hill = |x: u32, of: f64| (f64::from(x) * std::f64::consts::TAU / of).sin();
    let hills = |x: u32, y: u32| hill(x, 64.0) + hill(y, 32.0) + 0.3 * hill(x + y, 16.0);
    let ramp = |x: u32, y: u32| f64::from(x) + 0.3 * f64::from(y);
    let rough = |x: u32, y: u32| hills(x, y) + 0.2 * noise(x, y);
    let of = |name: &str, size, height: &dyn Fn(u32, u32) -> f64| (name.to_owned(), level(size, height));
    vec![
        of("noise", [64; 2], &noise),
        of("odd noise", [45, 37], &noise),
        of("posts", [128, 96], &posts),
        of("walls", [64; 2], &walls),
        of("hills", [128; 2], &hills),
        of("ramp", [64, 32], &ramp),
        of("rough hills", [128, 64], &rough),
    ]
}

fn read(name: &str, path: &Path) -> Named {
    let image = image::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display())).to_luma32f();
    let size = [image.width().min(MOST), image.height().min(MOST)];
    (name.to_owned(), level(size, &|x, y| f64::from(image.get_pixel(x, y).0[0])))
}

/// Stretched to heights from 0 to 1.
fn level(size: [u32; 2], height: &dyn Fn(u32, u32) -> f64) -> HeightLevel {
    let all: Vec<f64> = (0..size[0] * size[1]).map(|k| height(k % size[0], k / size[0])).collect();
    let [low, high] = all.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], h| [a.min(*h), b.max(*h)]);
    let heights = all.iter().map(|h| ((h - low) / (high - low)) as f32).collect();
    HeightLevel { size, heights, repeats: [true; 2] }
}

fn of_levels(k: usize, name: &str, level: &HeightLevel) -> Vec<TestMap> {
    let thinnest = [1.0, 2.0, 4.0, 16.0][k % 4];
    let repeats = [[true, true], [true, true], [false, true], [false, false]][k % 4];
    let level = HeightLevel { repeats, ..level.clone() };
    let chain = level.clone().chain();
    let cones: Vec<Vec<f32>> = chain.iter().map(cones).collect();
    LOWEST.iter().map(|lowest| raised(name, &level, *lowest, &cones, thinnest)).collect()
}

fn raised(name: &str, level: &HeightLevel, lowest: f32, cones: &[Vec<f32>], thinnest: f64) -> TestMap {
    let heights: Vec<f32> = level.heights.iter().map(|h| h + lowest).collect();
    let level = HeightLevel { heights: heights.clone(), ..level.clone() };
    let [width, height] = level.size;
    let map = HeightMap { width, height, heights, repeats: level.repeats, thinnest_texels: thinnest as f32 };
    let relief = |(k, level): (usize, HeightLevel)| ReliefMap {
        bounds: bounds(&level),
        cones: cones[k].clone(),
        thinnest_texels: thinnest / 2f64.powi(k as i32),
        steps: 0,
        level,
    };
    let levels = level.chain().into_iter().enumerate().map(relief).collect();
    let name = format!("{name} from {lowest}");
    TestMap { name, facts: HeightFacts::new(&map), map: Arc::new(map), levels }
}
