//! The two ways to walk against each other, marches that end early, and what begins or ends on the surface.

use std::f64::consts::TAU;

use glam::DVec4;

use super::{super::HeightLevel, *};

/// Splitmix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[(self.unit() * from.len() as f64) as usize]
    }
}

const SIZES: [[u32; 2]; 8] = [[1, 1], [1, 7], [7, 1], [2, 2], [7, 13], [16, 5], [33, 47], [64, 64]];

/// Noise, spikes, plateaus with joints, posts of two texels, or one height; from −1 or 0 to 8.
fn map(random: &mut Random) -> ReliefMap {
    let (size, kind, low) = (random.pick(&SIZES), random.pick(&[0, 1, 2, 3, 4]), random.pick(&[0.0, -1.0]));
    let texel = |k: u32, random: &mut Random| match (kind, k % size[0], k / size[0]) {
        (0, ..) => random.unit(),
        (1, ..) => f64::from(u8::from(random.unit() < 0.05)),
        (2, x, y) => {
            if y % 8 == 0 || (x + y / 8 * 4) % 8 == 0 {
                0.1
            } else {
                0.9
            }
        }
        (3, x, y) => f64::from(u8::from(x % 8 < 2 && y % 8 < 2)),
        _ => 0.5,
    };
    let heights = (0..size[0] * size[1]).map(|k| (low + (8.0 - low) * texel(k, random)) as f32).collect();
    let repeats = [random.unit() < 0.6, random.unit() < 0.6];
    let level = HeightLevel { size, heights, repeats };
    ReliefMap { bounds: bounds(&level), level, cones: Vec::new(), thinnest_texels: 1.0, steps: 0 }
}

/// One to three pieces, 0 to 89.9 degrees from the vertical, most from above the map to below it; many along lattice
/// lines or diagonals, from texels, or level.
fn course(random: &mut Random) -> Course {
    let tangent = random.between(0.0, 89.9).to_radians().tan();
    let turns = if random.unit() < 0.3 { random.pick(&[0.0, 0.125, 0.25, 0.5, 0.75]) } else { random.unit() };
    let (sin, cos) = (turns * TAU).sin_cos();
    let round = |v: f64| if v.abs() < 1e-9 { 0.0 } else { v };
    let across = DVec4::new(round(cos), round(sin), 0.0, 0.0);
    let place = DVec4::new(random.between(-90.0, 150.0), random.between(-90.0, 150.0), 0.0, 0.0);
    let place = if random.unit() < 0.3 { place.round() } else { place };
    let heights = match random.pick(&[0, 0, 0, 0, 1, 2, 3]) {
        0 => [8.0, -1.0],
        1 => [-1.5, 8.5],
        2 => [random.between(-1.0, 8.0); 2],
        _ => [random.between(-1.0, 8.0), random.between(-1.0, 8.0)],
    };
    let run = tangent * f64::max((heights[1] - heights[0]).abs(), 0.5);
    let pieces = random.pick(&[1, 1, 2, 3]);
    let node = |k: usize| {
        let share = k as f64 / f64::from(pieces);
        let z = heights[0] + (heights[1] - heights[0]) * share;
        (place + across * run * share + DVec4::Z * z + DVec4::W * share).as_vec4().as_dvec4()
    };
    Course { nodes: (0..=pieces as usize).map(node).collect(), cosine: 1.0 / tangent.hypot(1.0), is_open: [false; 2] }
}

#[test]
fn the_pyramid_and_the_cells_find_the_same_bits() {
    let mut random = Random(21);
    let mut hits = 0;
    for _ in 0..600 {
        let map = map(&mut random);
        for _ in 0..200 {
            let course = course(&mut random);
            let [tree, cells, some] = [0.0, f64::INFINITY, 12.0].map(|setting| marched(&map, &course, setting));
            let found = |march: &March| (march.s.to_bits(), march.place.to_array().map(f64::to_bits), march.capped);
            assert_eq!(found(&tree), found(&cells), "{course:?} over {map:?}");
            assert_eq!(found(&some), found(&cells), "{course:?} over {map:?}");
            hits += u32::from(tree.is_hit());
        }
    }
    assert!((60_000..110_000).contains(&hits), "{hits} of 120 000 hit");
}

/// Level, along a diagonal of 2^16 cells each way.
#[test]
fn a_march_of_too_many_cells_says_so_and_where_it_came_to() {
    let level = HeightLevel { size: [2, 2], heights: vec![0.0; 4], repeats: [true; 2] };
    let map = ReliefMap { bounds: bounds(&level), level, cones: Vec::new(), thinnest_texels: 1.0, steps: 0 };
    let nodes = vec![DVec4::new(0.25, 0.5, 1.0, 0.0), DVec4::new(65536.25, 65536.5, 1.0, 1.0)];
    let course = Course { nodes, cosine: 0.0, is_open: [false; 2] };
    let cells = marched(&map, &course, f64::INFINITY);
    assert!(cells.capped && cells.fetches == MOST_READS, "{cells:?}");
    assert!((0.49..0.51).contains(&cells.s), "{cells:?}");
}

#[test]
fn what_falls_onto_or_from_a_flat_meets_it_and_what_rises_from_it_does_not() {
    let level = HeightLevel { size: [3, 5], heights: vec![0.3; 15], repeats: [true, false] };
    let map = ReliefMap { bounds: bounds(&level), level, cones: Vec::new(), thinnest_texels: 1.0, steps: 0 };
    let [low, flat, high] = [0.0, f64::from(0.3_f32), 1.0];
    for (from, to, s) in [(high, flat, 1.0), (flat, low, 0.0), (flat, high, -1.0), (low, flat, -1.0), (low, high, -1.0)]
    {
        let nodes = vec![DVec4::new(0.7, 9.1, from, 0.0), DVec4::new(40.3, -7.7, to, 1.0)];
        for setting in [0.0, f64::INFINITY] {
            let found = marched(&map, &Course { nodes: nodes.clone(), cosine: 0.5, is_open: [false; 2] }, setting).s;
            assert!((found - s).abs() < 1e-12, "{found} from {from} to {to}");
        }
    }
}
