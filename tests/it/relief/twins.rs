//! Each method on the device against its f64 twin, from the same f32 inputs.
//!
//! Methods that march decide by the signs of gaps. What rounding may do to a gap is bounded; where a gap is nearer to 0
//! than that, either answer is right, and the device has to give the one or the other.

use displace_glsl::{
    SHADERS,
    layout::relief::{ConeMapParams, March as Found, ReliefLevel},
    methods::Method,
    reference::{
        cone_map,
        relief::{
            self, Course, HeightLevel, March, ReliefMap, parallax_iterative,
            search::{Asked, Gauge},
        },
    },
};
use displace_server::{
    domain::cancel::{Cancel, NoProgress},
    vulkan::Stream,
};
use displace_tests::march::{self, Marches};
use glam::{DVec2, IVec2};

use super::{device, surfaces::*};

type Searched = fn(&mut Gauge<'_>) -> March;

const MARCHING: [(Method, Searched); 3] = [
    (Method::Steep, relief::steep::searched),
    (Method::Relief, relief::relief::searched),
    (Method::Cone, relief::cone::searched),
];

const SHIFTING: [Method; 3] = [Method::Parallax, Method::ParallaxLimited, Method::ParallaxIterative];

/// Rays of each map.
const RAYS: usize = 4000;

/// With cones, of steps that are told and of as many as the angle asks for, and one that goes on at its border.
fn maps() -> Vec<(&'static str, ReliefMap)> {
    let maps = [("fractal", fractal()), ("bricks", bricks()), ("posts", posts()), ("hills", hills())];
    let mut all: Vec<_> = maps
        .into_iter()
        .flat_map(|(name, map)| [16, 0].map(|steps| (name, ReliefMap { steps, ..map.clone() })))
        .collect();
    all[1].1.level.repeats = [false, true];
    for (_, map) in &mut all {
        map.cones = cone_map::cones(&map.level);
    }
    all
}

/// At up to 85 degrees; every fourth bent, over nine nodes.
fn courses(map: &ReliefMap, seed: u64) -> Vec<Course> {
    let mut random = Random::new(seed);
    let high = f64::from(map.level.heights.iter().fold(0f32, |high, h| high.max(*h)));
    let course = |k: usize| {
        let degrees = random.within(0.0, 85.0);
        let course = random.course(degrees, [high * 1.01, -0.01]);
        if k % 4 == 3 { bent(&course, high * random.within(0.0, 0.2)) } else { course }
    };
    (0..RAYS).map(course).collect()
}

/// Nine nodes, the middle ones lower.
fn bent(course: &Course, sag: f64) -> Course {
    let node = |k: i32| {
        let s = f64::from(k) / 8.0;
        let mut node = course.place(s);
        node.z -= 4.0 * sag * s * (1.0 - s);
        node.as_vec4().as_dvec4()
    };
    Course { nodes: (0..9).map(node).collect(), ..course.clone() }
}

/// The distance of an f32 from the next.
fn ulp(value: f64) -> f64 {
    let value = (value.abs() as f32).max(f32::MIN_POSITIVE);
    f64::from(value.next_up() - value)
}

/// Of the greatest coordinate of a course.
fn ulp_of(course: &Course) -> f64 {
    ulp(course.nodes.iter().map(|node| node.x.abs().max(node.y.abs())).fold(0.0, f64::max))
}

/// Texels across for each unit of height, at least 1.
fn tangent(course: &Course) -> f64 {
    let [first, last] = [course.nodes[0], course.nodes[course.nodes.len() - 1]];
    (course.travel() / (first.z - last.z).abs()).max(1.0)
}

/// What rounding may do to the gap at a part: places are off by up to two units in the last place, and heights as their
/// slopes have it.
fn doubt(gauge: &Gauge<'_>, part: u32) -> f64 {
    let place = gauge.course.place(gauge.s(part));
    let off = 2.0 * ulp_of(gauge.course);
    let across = place.truncate().truncate();
    let slope = |aside: DVec2| {
        let [a, b, c, d] = gauge.map.level.corners((across + aside * off).floor().as_ivec2());
        (b - a).abs().max((d - c).abs()) + (c - a).abs().max((d - b).abs())
    };
    let slopes = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].map(|aside| slope(aside.into()));
    slopes.into_iter().fold(0.0, f64::max) * off + 4.0 * ulp(place.z.abs().max(gauge.map.level.height(across).abs()))
}

/// Whether rounding may answer otherwise.
fn is_in_doubt(gauge: &Gauge<'_>, asked: &Asked) -> bool {
    match *asked {
        Asked::Gap { part, gap } => gap.abs() <= doubt(gauge, part),
        // As many as the gap is wide, which is asked for just before.
        Asked::Parts { part, parts } => {
            let place = gauge.course.place(gauge.s(part));
            let gap = place.z - gauge.map.level.height(place.truncate().truncate());
            (parts - parts.round()).abs() <= parts * (doubt(gauge, part) / gap + 1e-6)
        }
    }
}

/// As many steps as the angle asks for are rounded up; where that is in doubt, both numbers are right.
fn counts(map: &ReliefMap, course: &Course) -> Vec<u32> {
    let wanted = course.travel() / map.thinnest_texels;
    if map.steps != 0 || (wanted - wanted.round()).abs() > 8.0 * ulp(wanted) {
        return vec![map.steps(course)];
    }
    [0, 1].map(|more| (wanted.round() as u32 + more).max(relief::LEAST_STEPS)).to_vec()
}

/// What rounding may make of a march: without and with each decision that is in doubt taken the other way.
fn candidates(searched: Searched, map: &ReliefMap, course: &Course) -> Vec<March> {
    let of_count = |steps: u32| {
        let mut gauge = Gauge { steps, ..Gauge::new(map, course) };
        let march = searched(&mut gauge);
        let doubted = (0..gauge.asked.len()).filter(|k| is_in_doubt(&gauge, &gauge.asked[*k]));
        let others: Vec<March> = doubted.map(|k| searched(&mut gauge.clone().turning(k))).collect();
        [vec![march], others].concat()
    };
    counts(map, course).into_iter().flat_map(of_count).collect()
}

/// What comes of comparing rays.
#[derive(Default)]
struct Tally {
    rays: u32,
    /// Where decisions that are in doubt lead elsewhere.
    excluded: u32,
    /// Of the others, the greatest part of the tolerance.
    worst: f64,
}

impl Tally {
    /// 4 units in the last place of the coordinates, at slant times as much across; and where the slope of heights carries over
    /// what their places are off by, as much steeper.
    fn add(&mut self, found: &Found, candidates: &[March], course: &Course, steepest: f64) {
        let tolerance = 4.0 * ulp_of(course) * tangent(course) * steepest.max(1.0);
        let agreeing: Vec<bool> = candidates.iter().map(|twin| agrees(found, twin, tolerance)).collect();
        assert!(agreeing.contains(&true), "{found:?} is none of {candidates:?} on {course:?}");
        self.rays += 1;
        self.excluded += u32::from(agreeing.contains(&false));
        if found.s >= 0.0 && !agreeing.contains(&false) {
            self.worst = self.worst.max(march::place(found).distance(candidates[0].place) / tolerance);
        }
    }
}

fn agrees(found: &Found, twin: &March, tolerance: f64) -> bool {
    let hit = found.s >= 0.0;
    hit == twin.is_hit() && (!hit || march::place(found).distance(twin.place) <= tolerance)
}

/// Rays of all maps, each by its candidates.
fn tally(
    method: Method,
    steepest: impl Fn(&HeightLevel) -> f64,
    candidates: impl Fn(&ReliefMap, &Course) -> Vec<March>,
) {
    let (marcher, mut tally) = (method.marcher().expect("marches"), Tally::default());
    for (seed, (_, map)) in maps().iter().enumerate() {
        let mut courses = courses(map, seed as u64);
        courses.retain(|course| marcher.finds_depth || course.nodes.len() == 2);
        let (found, _) = Marches::new(device(), map, &courses).run(marcher.shader, 0.0);
        let steepest = steepest(&map.level);
        found
            .iter()
            .zip(&courses)
            .for_each(|(found, course)| tally.add(found, &candidates(map, course), course, steepest));
    }
    println!(
        "{method:?}: {} of {} rays in doubt; the others within {:.2} of what is allowed",
        tally.excluded, tally.rays, tally.worst
    );
    assert!(tally.excluded * 1000 <= tally.rays, "{} of {}", tally.excluded, tally.rays);
}

/// The most that heights change for a texel along x and along y.
fn steepest(level: &HeightLevel) -> f64 {
    let cells = (0..64 * 64).map(|i| level.corners(IVec2::new(i % 64, i / 64)));
    cells.map(|[a, b, c, d]| (b - a).abs().max((d - c).abs()) + (c - a).abs().max((d - b).abs())).fold(0.0, f64::max)
}

#[test]
fn what_ends_at_a_step_or_a_bisection_agrees_with_its_twin_but_for_decisions_in_doubt() {
    for (method, searched) in MARCHING {
        tally(method, |_| 1.0, |map, course| candidates(searched, map, course));
    }
}

#[test]
fn what_ends_at_a_secant_agrees_with_its_twin_but_for_decisions_in_doubt() {
    tally(Method::Occlusion, steepest, |map, course| candidates(relief::occlusion::searched, map, course));
}

/// What rounding may make of a march that reads slopes: those of a cell at whose border it may be of the one beside it.
fn shifted_candidates(method: Method, map: &ReliefMap, course: &Course) -> Vec<March> {
    let twin = method.marcher().expect("marches").twin;
    let mut candidates = vec![twin(map, course, 0.0)];
    if method != Method::ParallaxIterative {
        return candidates;
    }
    let off = 2.0 * ulp_of(course) * tangent(course);
    let mut doubted = Vec::new();
    parallax_iterative::turned(map, course, |turn, place| {
        let border = place.round();
        let near = (place - border).abs().cmplt(DVec2::splat(off));
        doubted
            .extend([near.x, near.y].into_iter().enumerate().filter(|(_, near)| *near).map(|(axis, _)| (turn, axis)));
        place.floor().as_ivec2()
    });
    for (turn, axis) in doubted {
        candidates.push(parallax_iterative::turned(map, course, |k, place| {
            let cell = place.floor().as_ivec2();
            let other = if place[axis].round() > place[axis] { 1 } else { -1 };
            if k == turn { cell + IVec2::AXES[axis] * other } else { cell }
        }));
    }
    candidates
}

#[test]
fn what_shifts_agrees_with_its_twin_but_for_slopes_at_borders() {
    for method in SHIFTING {
        tally(method, steepest, |map, course| shifted_candidates(method, map, course));
    }
}

/// Cones of a level, made on the device.
fn cones_of(level: &HeightLevel) -> Vec<f32> {
    let count = level.heights.len() as u32;
    let texels =
        Stream::of_texels(device(), &[level.heights.clone(), vec![0.0; count as usize]].concat()).expect("fits");
    let wrap = level.repeats.map(|repeats| u32::from(!repeats));
    let high = level.heights.iter().fold(f32::NEG_INFINITY, |high, h| high.max(*h));
    let level = ReliefLevel { size: level.size, height_first: 0, bound_first: 0, cone_first: count };
    let params = ConeMapParams { count, wrap: wrap[0] | wrap[1] << 2, high, level };
    let (cancel, progress) = (Cancel::default(), NoProgress);
    let mut recorder = device().recorder(&cancel, &progress);
    recorder.dispatch(&SHADERS.cone_map, count.into(), &params, &[("texels", &texels)]).expect("records");
    recorder.finish().expect("runs");
    texels.read_range(count.into()..2 * u64::from(count)).expect("reads")
}

#[test]
fn cones_agree_with_their_twin() {
    for (name, map) in maps() {
        let found = cones_of(&map.level);
        for (i, (found, twin)) in found.iter().zip(&map.cones).enumerate() {
            assert!((found - twin).abs() <= 1e-5 * twin, "{name}, cell {i}: {found} for {twin}");
        }
    }
}

/// Milliseconds of a map of 512 x 512 texels, the first of a device with nothing learnt.
#[test]
#[ignore = "a measurement, run by hand"]
fn cones_of_a_large_map() {
    for (name, map) in maps() {
        let heights = (0..512 * 512).map(|i| map.level.texel(IVec2::new(i % 512, i / 512))).map(|h| h as f32).collect();
        let start = std::time::Instant::now();
        cones_of(&HeightLevel { size: [512, 512], heights, repeats: map.level.repeats });
        println!("{name}: {:.0} ms", start.elapsed().as_secs_f64() * 1e3);
    }
}
