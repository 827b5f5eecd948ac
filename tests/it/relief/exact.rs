//! The exact method: its two ways to walk, its twin, and the oracle, which does the same by other code.

use std::sync::Arc;

use displace_glsl::{
    SHADERS,
    layout::relief::March,
    reference::relief::{Course, ReliefMap, exact::marched},
};
use displace_server::{
    domain::detail::{Map, Sampling, Wrap},
    oracle::{bvh::Segment, field::Field, height_field::walk_cells},
};
use displace_tests::march::{Marches, place};
use glam::{DVec2, DVec4};
use rand::{RngExt as _, SeedableRng, rngs::StdRng};
use rayon::prelude::*;

use super::{
    device,
    rays::{KINDS, any_map, course},
};

const ALWAYS_CELLS: f32 = 1e30;
/// Below all heights.
const END: f64 = -1.0;

/// Many courses over many maps, 0 to 89.9 degrees.
fn cases(seed: u64, maps: usize, rays: usize, end: f64) -> Vec<(ReliefMap, Vec<Course>)> {
    let mut random = StdRng::seed_from_u64(seed);
    let mut case = |k: usize| {
        let map = any_map(&mut random, KINDS[k % KINDS.len()]);
        let courses = (0..rays).map(|_| {
            let degrees = random.random_range(0.0..89.9);
            course(&mut random, degrees, end)
        });
        (map, courses.collect())
    };
    (0..maps).map(&mut case).collect()
}

fn bits(march: &March) -> ([u32; 3], u32) {
    ([march.s, march.place[0], march.place[1]].map(f32::to_bits), march.capped)
}

#[test]
fn a_million_rays_meet_the_same_bits_by_nodes_and_by_cells_and_none_slips_through() {
    for (map, courses) in cases(31, 50, 20_000, END) {
        let marches = Marches::new(device(), &map, &courses);
        let [(nodes, _), (cells, _)] = [0.0, ALWAYS_CELLS].map(|setting| marches.run(&SHADERS.exact, setting));
        for (k, (a, b)) in nodes.iter().zip(&cells).enumerate() {
            assert_eq!(bits(a), bits(b), "{:?} over {map:?}", courses[k]);
            assert!(a.s >= 0.0 && a.capped == 0, "{a:?}: {:?} slips through {map:?}", courses[k]);
        }
    }
    assert_eq!(device().validation_messages(), [""; 0]);
}

#[test]
fn what_ends_among_the_heights_meets_the_same_bits_by_nodes_and_by_cells() {
    for (map, mut courses) in cases(32, 12, 4000, 2.0) {
        // Every other one backwards: from among the heights to above them.
        courses.iter_mut().step_by(2).for_each(|course| course.nodes.reverse());
        let marches = Marches::new(device(), &map, &courses);
        let [(nodes, _), (cells, _)] = [0.0, ALWAYS_CELLS].map(|setting| marches.run(&SHADERS.exact, setting));
        for (k, (a, b)) in nodes.iter().zip(&cells).enumerate() {
            assert_eq!(bits(a), bits(b), "{:?} over {map:?}", courses[k]);
        }
    }
}

/// The twin's finds on a course, and on those that rounding may make of it up to there: by an ulp of its height or of
/// its place along its way.
fn candidates(map: &ReliefMap, course: &Course, ulp: f64) -> [Option<DVec2>; 4] {
    let ends = [course.nodes[0], course.nodes[1]];
    let along = (ends[1] - ends[0]).truncate().truncate().normalize_or_zero() * ulp;
    let (along, lift) = (DVec4::new(along.x, along.y, 0.0, 0.0), DVec4::new(0.0, 0.0, ulp_of(ends[0].z), 0.0));
    [lift, -lift, along, -along].map(|offset| {
        let nodes = ends.map(|node| node + offset).to_vec();
        let march = marched(map, &Course { nodes, cosine: course.cosine, is_open: [false; 2] }, 0.0);
        march.is_hit().then_some(march.place)
    })
}

/// Of f32.
fn ulp_of(value: f64) -> f64 {
    let value = (value as f32).abs().max(f32::MIN_POSITIVE);
    f64::from(value.next_up()) - f64::from(value)
}

/// Whether rounding cannot decide, and how far the device is off the twin, or else off the nearest that it may decide
/// for, in 4 ulp of the texel coordinate x max(1, tan θ).
fn compared(map: &ReliefMap, course: &Course, found: &March) -> (bool, f64) {
    let twin = marched(map, course, 0.0).place;
    let start = course.nodes[0].truncate().truncate();
    let way = course.nodes[1] - course.nodes[0];
    let ulp = ulp_of(start.abs().max_element().max(twin.abs().max_element()));
    let tolerance = 4.0 * ulp * f64::max(1.0, way.x.hypot(way.y) / way.z.abs());
    let off = |candidate: DVec2| candidate.distance(place(found)) / tolerance;
    let candidates = candidates(map, course, ulp);
    let decided = candidates.iter().all(|c| c.is_some_and(|c| c.distance(twin) <= tolerance));
    let others = candidates.iter().flatten().map(|c| off(*c));
    (decided, if decided { off(twin) } else { others.fold(off(twin), f64::min) })
}

#[test]
fn the_device_is_within_four_ulp_of_the_twin_wherever_rounding_does_not_decide() {
    let (mut worst, mut undecided, mut rays) = (0.0_f64, 0, 0);
    for (map, courses) in cases(33, 24, 5000, END) {
        let (found, _) = Marches::new(device(), &map, &courses).run(&SHADERS.exact, 0.0);
        let pairs = courses.par_iter().zip(&found);
        let all: Vec<(bool, f64)> = pairs.map(|(course, found)| compared(&map, course, found)).collect();
        let each = all.iter().map(|(_, off)| *off).fold(0.0, f64::max);
        assert!(each <= 1.0, "{each} of what it may be off, over {map:?}");
        worst = worst.max(each);
        undecided += all.iter().filter(|(decided, _)| !decided).count();
        rays += all.len();
    }
    println!("{worst:.2} of what it may be off at most; rounding decides {undecided} of {rays}");
    assert!(undecided * 1000 <= rays, "rounding decides {undecided} of {rays}");
}

fn field(map: &ReliefMap) -> Field {
    let level = &map.level;
    let [width, height] = level.size;
    let wrap = level.repeats.map(|repeats| if repeats { Wrap::Repeat } else { Wrap::Clamp });
    let (texels, sampling) = (level.heights.clone().into(), Sampling::Center);
    Field::new(&Arc::new(Map { width, height, channels: 1, texels, wrap, sampling, source_bits: 32 }))
}

#[test]
fn the_twin_meets_what_the_oracle_meets_within_a_billionth_of_a_texel() {
    for (map, courses) in cases(34, 24, 2000, END) {
        let field = field(&map);
        courses.par_iter().for_each(|course| {
            let [from, to] = [course.nodes[0], course.nodes[1]].map(DVec4::truncate);
            let ray = Segment { origin: from, direction: to - from, from: 0.0, to: 1.0 };
            let hit = walk_cells(&field, 0, &ray).hit.expect("it goes through");
            let found = marched(&map, course, 0.0);
            let apart = (from + (to - from) * hit.t).truncate().distance(found.place);
            assert!(found.is_hit() && apart < 1e-9, "{apart} apart: {course:?} over {map:?}");
        });
    }
}
