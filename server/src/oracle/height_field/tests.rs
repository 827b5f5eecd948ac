//! Both walkers against each other, against small steps, and where the answer is known by hand.

use std::{f64::consts::TAU, sync::Arc, time::Instant};

use glam::DVec3;

use super::{Hit, Pyramid, walk_cells};
use crate::domain::detail::{Map, Sampling, Wrap};
use crate::oracle::{
    bvh::Segment,
    field::Field,
    test_maps::{KINDS, Kind, Random, any_field, map},
};

fn field(width: u32, height: u32, texels: &[f32], wrap: Wrap) -> Field {
    let (texels, wrap, sampling) = (texels.to_vec(), [wrap; 2], Sampling::Center);
    Field::new(&Arc::new(Map { width, height, channels: 1, texels: texels.into(), wrap, sampling, source_bits: 32 }))
}

fn segment(origin: [f64; 3], direction: [f64; 3], to: f64) -> Segment {
    Segment { origin: DVec3::from_array(origin), direction: DVec3::from_array(direction), from: 0.0, to }
}

/// What both walkers find.
fn first_hit(field: &Field, ray: &Segment) -> Option<Hit> {
    let (cells, tree) = (walk_cells(field, 0, ray), Pyramid::new(field, 0).walk(ray));
    assert_eq!(bits(cells.hit), bits(tree.hit), "{ray:?}");
    cells.hit
}

fn bits(hit: Option<Hit>) -> Option<(u64, [i64; 2], bool)> {
    hit.map(|hit| (hit.t.to_bits(), hit.cell, hit.from_above))
}

/// 0 to 89.9 degrees from the vertical, down or up, any way round, through the heights of the map or short of them;
/// many along lines of the lattice or diagonals, through texels, or with components of 0.
fn any_ray(random: &mut Random) -> Segment {
    let slope = random.between(0.0, 89.9).to_radians().tan() * random.pick(&[1.0, 1.0, 1.0, 0.0]);
    let turns = if random.unit() < 0.3 { random.pick(&[0.0, 0.125, 0.25, 0.5, 0.75]) } else { random.unit() };
    let [x, y] = match (turns * TAU).sin_cos() {
        _ if turns == 0.5 => [-1.0, 0.0],
        _ if turns == 0.25 => [0.0, 1.0],
        (sin, cos) => [cos, sin],
    };
    let [some, other, more] = [0; 3].map(|_| random.unit());
    let z = random.pick(&[1.0, 1.25, some, -0.25]);
    let down = random.pick(&[-1.0, -1.0, -1.0, -1.0, 1.0]) * if z < 0.0 { -1.0 } else { 1.0 };
    let speed = random.between(0.1, 10.0);
    let direction = speed * DVec3::new(slope * x, slope * y, down * random.pick(&[1.0, 1.0, 1.0, 1.0, 1.0, 0.0]));
    let place =
        random.pick(&[1.0, 1.0, 10.0]) * DVec3::new(random.between(-80.0, 150.0), random.between(-80.0, 150.0), 0.0);
    let place = if random.unit() < 0.3 { place.round() } else { place };
    let from = random.pick(&[0.0, 0.0, 2.0 * other - 1.0]);
    let length = random.pick(&[1.5, 1.5, 1.5, 1.5, more, 0.0]) / speed;
    Segment { origin: place.with_z(z) - direction * from, direction, from, to: from + length }
}

/// The same ray through a lattice point of the surface, as near as it can be said.
fn aimed(random: &mut Random, field: &Field, ray: &Segment) -> Segment {
    let [x, y] = [0; 2].map(|_| random.between(-20.0, 80.0).floor());
    let texel = DVec3::new(x, y, field.texel(0, x as i64, y as i64));
    Segment { origin: texel - ray.direction * random.between(ray.from, ray.to), ..*ray }
}

fn agree_on(maps: u32, rays: u32) {
    let mut random = Random(11);
    let (mut hits, mut misses) = (0, 0);
    for _ in 0..maps {
        let field = any_field(&mut random);
        let pyramid = Pyramid::new(&field, 0);
        for _ in 0..rays {
            let ray = any_ray(&mut random);
            let ray = if random.unit() < 0.2 { aimed(&mut random, &field, &ray) } else { ray };
            let (cells, tree) = (walk_cells(&field, 0, &ray), pyramid.walk(&ray));
            assert_eq!(bits(cells.hit), bits(tree.hit), "{ray:?} on {field:?}");
            let z = [ray.from, ray.to].map(|t| ray.origin.z + ray.direction.z * t);
            assert!(cells.hit.is_some() || z[0] <= 1.0 || z[1] >= 0.0, "{ray:?} slips through {field:?}");
            *(if cells.hit.is_some() { &mut hits } else { &mut misses }) += 1;
        }
    }
    assert!(3 * hits > maps * rays && 10 * misses > maps * rays, "{hits} hits, {misses} misses");
}

#[test]
fn both_walkers_find_the_same_bits() {
    agree_on(500, 100);
}

#[test]
fn both_walkers_find_the_same_bits_for_a_million_rays() {
    agree_on(2000, 500);
}

#[test]
fn small_steps_find_nothing_earlier() {
    let mut random = Random(12);
    for _ in 0..1500 {
        let (field, ray) = (any_field(&mut random), any_ray(&mut random));
        let ray = if random.unit() < 0.2 { aimed(&mut random, &field, &ray) } else { ray };
        let hit = first_hit(&field, &ray);
        let gap = |t: f64| {
            let p = ray.origin + ray.direction * t;
            p.z - field.value(0, p.x, p.y)
        };
        let (end, side) = (hit.map_or(ray.to, |hit| hit.t), if gap(ray.from) < 0.0 { -1.0 } else { 1.0 });
        assert!(hit.is_none_or(|hit| gap(hit.t).abs() < 1e-10), "{hit:?} of {ray:?} is {} off", gap(end));
        for k in 0..=10_000 {
            let t = ray.from + (end - ray.from) * f64::from(k) / 10_000.0;
            assert!(side * gap(t) > -1e-10, "{hit:?} of {ray:?}, but {} through at {t}", gap(t));
        }
    }
}

#[test]
fn a_saddle_is_met_at_the_first_of_two_roots() {
    let saddle = field(2, 2, &[0.0, 0.0, 0.0, 1.0], Wrap::Clamp);
    // Along the diagonal h = t², so z = 3/16 + t/2 is met where t² − t/2 − 3/16 = (t − 3/4)(t + 1/4).
    let hit = first_hit(&saddle, &segment([0.0, 0.0, 0.1875], [1.0, 1.0, 0.5], 1.0));
    assert_eq!(hit, Some(Hit { t: 0.75, cell: [0, 0], from_above: true }));
    // Across it h = t − t², which z = 3/16 leaves at 1/4 and enters again at 3/4, backwards too.
    for [x, dx] in [[0.0, 1.0], [1.0, -1.0]] {
        let across = segment([x, 1.0 - x, 0.1875], [dx, -dx, 0.0], 1.0);
        assert_eq!(first_hit(&saddle, &across).map(|hit| hit.t), Some(0.25));
        let hit = first_hit(&saddle, &Segment { from: 0.5, ..across });
        assert_eq!(hit.map(|hit| (hit.t, hit.from_above)), Some((0.75, false)));
        assert_eq!(first_hit(&saddle, &Segment { from: 0.8, ..across }), None);
    }
}

#[test]
fn vertical_rays_meet_texels_edges_and_what_is_beyond_the_map() {
    let map = field(2, 2, &[0.0, 1.0, 2.0, 7.0], Wrap::Clamp);
    let places =
        [(0.0, 0.0, 0.0), (1.0, 1.0, 7.0), (0.5, 0.5, 2.5), (1.0, 0.5, 4.0), (-99.5, 1.0, 2.0), (50.0, -3.0, 1.0)];
    for (x, y, z) in places {
        let down = first_hit(&map, &segment([x, y, 10.0], [0.0, 0.0, -1.0], 20.0)).expect("it goes through");
        assert_eq!((10.0 - down.t, down.from_above), (z, true));
        let up = first_hit(&map, &segment([x, y, -10.0], [-0.0, 0.0, 2.0], 20.0)).expect("it goes through");
        assert_eq!((2.0 * up.t - 10.0, up.from_above), (z, false));
    }
}

#[test]
fn rays_along_lattice_lines_meet_the_flank_of_a_texel() {
    let map = field(3, 3, &[0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0], Wrap::Repeat);
    let hit = |origin, direction| first_hit(&map, &segment(origin, direction, 100.0)).map(|hit| hit.t);
    assert_eq!(hit([-1.0, 1.0, 0.25], [1.0, 0.0, 0.0]), Some(1.25));
    assert_eq!(hit([3.0, 1.0, 0.25], [-1.0, 0.0, 0.0]), Some(1.25));
    assert_eq!(hit([1.0, -1.0, 0.75], [0.0, 2.0, 0.0]), Some(0.875));
    assert_eq!(hit([-1.0, 0.0, 0.25], [1.0, 0.0, 0.0]), None);
    assert_eq!(hit([-0.5, -0.5, 1.0 / 9.0], [1.0, 1.0, 0.0]).map(|t| (t - 5.0 / 6.0).abs() < 1e-12), Some(true));
}

#[test]
fn on_the_surface_a_ray_is_met_at_its_start_and_no_range_meets_nothing() {
    let flat = field(1, 1, &[0.5], Wrap::Mirror);
    let hit = |direction, to| first_hit(&flat, &segment([0.3, 0.0, 0.5], direction, to)).map(|hit| hit.t);
    for direction in [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3], [-3.0, 2.0, -1.0]] {
        assert_eq!(hit(direction, 1.0), Some(0.0));
        assert_eq!(hit(direction, 0.0), None);
        assert_eq!(hit(direction, -1.0), None);
    }
    assert_eq!(first_hit(&flat, &segment([0.3, 0.0, 0.6], [0.0; 3], 1.0)), None);
}

#[test]
fn far_above_the_surface_the_hierarchy_reads_little() {
    let mut texels = vec![0.0; 256 * 256];
    texels[128 * 256 + 128] = 1.0;
    let map = field(256, 256, &texels, Wrap::Repeat);
    let ray = segment([0.3, 90.7, 0.9], [1.0, 0.003, -0.001], 2000.0);
    let (cells, tree) = (walk_cells(&map, 0, &ray), Pyramid::new(&map, 0).walk(&ray));
    assert_eq!(bits(cells.hit), bits(tree.hit));
    assert!(cells.fetches > 800 && tree.fetches < cells.fetches / 10, "{cells:?} {tree:?}");
}

#[test]
#[ignore = "a measurement, run by hand: cargo test -p displace-server --lib height_field -- --ignored --nocapture"]
fn time_and_fetches_per_ray() {
    let mut random = Random(5);
    for kind in KINDS {
        let mut map = map(&mut random, kind, [512, 512]);
        map.wrap = [Wrap::Repeat; 2];
        let field = Field::new(&Arc::new(map));
        let pyramid = Pyramid::new(&field, 0);
        for degrees in [0.0_f64, 30.0, 60.0, 85.0, 89.0] {
            // A height of 8 texels, given in texels by the slope.
            let slope = 8.0 * degrees.to_radians().tan();
            let rays: Vec<Segment> = (0..20_000)
                .map(|_| {
                    let ((sin, cos), at) =
                        ((TAU * random.unit()).sin_cos(), [0; 2].map(|_| random.between(0.0, 512.0)));
                    segment([at[0], at[1], 1.0], [slope * cos, slope * sin, -1.0], 1.0)
                })
                .collect();
            let [cells, tree] = [false, true].map(|tree| {
                let walk = |ray| if tree { pyramid.walk(ray) } else { walk_cells(&field, 0, ray) };
                let fetches: u64 = rays.iter().map(|ray| walk(ray).fetches).sum();
                // The least of many short rounds: other processes only add to it.
                let rounds = rays.chunks(100).map(|rays| {
                    let start = Instant::now();
                    std::hint::black_box(rays.iter().map(|ray| walk(ray).fetches).sum::<u64>());
                    start.elapsed().as_nanos() as u64 / rays.len() as u64
                });
                let ns = rounds.min().unwrap_or(0);
                format!("{:6.1} fetches {ns:6} ns", fetches as f64 / rays.len() as f64)
            });
            println!("{kind:?} {degrees:2}°: cells {cells}, pyramid {tree}");
        }
    }
    assert!(matches!(KINDS[0], Kind::Noise));
}
