//! What methods are known to get wrong, and by how much: claims about the twins, which the device agrees with.

use displace_glsl::{
    methods::Method,
    reference::{
        cone_map,
        relief::{Course, March, ReliefMap},
    },
};
use displace_tests::march;
use glam::DVec2;

use super::surfaces::*;

const RAYS: u32 = 3000;

fn marched(method: Method, map: &ReliefMap, course: &Course) -> March {
    (method.marcher().expect("marches").twin)(map, course, 0.0)
}

/// Of so many steps, with cones.
fn stepped(map: ReliefMap, steps: u32) -> ReliefMap {
    ReliefMap { steps, cones: cone_map::cones(&map.level), ..map }
}

/// Down through all heights of a map.
fn down(random: &mut Random, map: &ReliefMap, degrees: f64) -> Course {
    let [low, high] = range(map);
    random.course(degrees, [high + 0.01, low - 0.01])
}

/// Greatest height by which what is found is below what is met.
fn deepest(method: Method, map: &ReliefMap, degrees: f64) -> f64 {
    let mut random = Random::new(3);
    let below = |_| {
        let course = down(&mut random, map, degrees);
        let found = marched(method, map, &course);
        course.place(first_met(map, &course)).z - course.place(found.s).z
    };
    (0..RAYS).map(below).fold(0.0, f64::max)
}

/// Hills of which nothing is hidden, seen at 60 degrees.
#[test]
fn stairs_are_as_high_as_a_step_where_it_is_not_cut() {
    let map = stepped(hills(), 16);
    let [low, high] = range(&map);
    let step = (high - low + 0.02) / 16.0;
    let [steep, occlusion, relief, cone] = [Method::Steep, Method::Occlusion, Method::Relief, Method::Cone]
        .map(|method| deepest(method, &map, 60.0) / step);
    println!("of a step: steep {steep:.3}, occlusion {occlusion:.3}, relief {relief:.3}, cone {cone:.3}");
    assert!((0.98..1.0 + 1e-9).contains(&steep), "{steep}");
    assert!(occlusion < 0.05, "{occlusion}");
    assert!((0.9 / 32.0..1.0 / 32.0 + 1e-9).contains(&relief), "{relief}");
    assert!((0.9 / 32.0..1.0 / 32.0 + 1e-9).contains(&cone), "{cone}");
}

/// Share of rays off by more than half a texel.
fn wrong(method: Method, map: &ReliefMap, degrees: f64) -> f64 {
    let mut random = Random::new(4);
    let off = |_: &u32| {
        let course = down(&mut random, map, degrees);
        let met = course.place(first_met(map, &course)).truncate().truncate();
        marched(method, map, &course).place.distance(met) > 0.5
    };
    (0..RAYS).filter(off).count() as f64 / f64::from(RAYS)
}

/// Sixteen steps, and as many as the angle asks for, which is one for each texel.
#[test]
fn posts_a_texel_wide_are_missed_by_steps_that_are_longer() {
    for (steps, degrees, steep, relief, cone) in
        [(16, 30.0, 0.9, 0.9, 0.9), (16, 60.0, 0.9, 0.9, 0.9), (16, 80.0, 0.9, 0.9, 0.9), (0, 80.0, 0.9, 0.9, 0.9)]
    {
        let map = stepped(posts(), steps);
        let [a, b, c, d] = [Method::Steep, Method::Occlusion, Method::Relief, Method::Cone]
            .map(|method| 100.0 * wrong(method, &map, degrees));
        println!("{steps} steps at {degrees}: steep {a:.2} %, occlusion {b:.2} %, relief {c:.2} %, cone {d:.2} %");
    }
}

/// Mean of what is off, as the viewer sees it, texels; and of what maps show that are read at half the height.
fn seen(method: Method, map: &ReliefMap, degrees: f64) -> [f64; 2] {
    let mut random = Random::new(5);
    let middle = range(map).iter().sum::<f64>() / 2.0;
    let mut sums = [0.0; 2];
    for _ in 0..RAYS {
        let [low, high] = range(map).map(|h| h - middle);
        // Heights from the middle plane, so that a ray that is not shifted shows what is there.
        let level = displace_glsl::reference::relief::HeightLevel {
            heights: map.level.heights.iter().map(|h| h - middle as f32).collect(),
            ..map.level.clone()
        };
        let map = ReliefMap { level, ..map.clone() };
        let course = random.course(degrees, [high + 0.01, low - 0.01]);
        let met = course.place(first_met(&map, &course)).truncate().truncate();
        let shown = [
            marched(method, &map, &course).place,
            course.place((high + 0.01) / (high - low + 0.02)).truncate().truncate(),
        ];
        for (sum, shown) in sums.iter_mut().zip(shown) {
            *sum += (shown.distance(met) * course.cosine).powi(2);
        }
    }
    sums.map(|sum| (sum / f64::from(RAYS)).sqrt())
}

#[test]
fn at_grazing_angles_a_shift_is_worse_than_none() {
    let map = fractal();
    for degrees in [30.0, 60.0, 80.0] {
        for method in [Method::Parallax, Method::ParallaxLimited, Method::ParallaxIterative] {
            let [shifted, flat] = seen(method, &map, degrees);
            println!("{method:?} at {degrees}: {shifted:.2} texels, without {flat:.2}");
        }
    }
}

/// How far what is shown of a place of the surface moves while the view turns by a degree, texels: root of the mean square
/// over places that nothing hides. What is there stays where it is.
fn drift(method: Method, map: &ReliefMap, degrees: f64) -> f64 {
    let mut random = Random::new(6);
    let [low, high] = range(map);
    let mut sum = 0.0;
    for _ in 0..RAYS {
        let (place, way) = (DVec2::new(random.within(0.0, 64.0), random.within(0.0, 64.0)), random.way());
        let shown = [degrees, degrees + 1.0]
            .map(|degrees| marched(method, map, &through(map, place, way, degrees, [low, high])).place);
        sum += shown[0].distance_squared(shown[1]);
    }
    (sum / f64::from(RAYS)).sqrt()
}

/// The course that meets the surface at a place.
fn through(map: &ReliefMap, place: DVec2, way: DVec2, degrees: f64, [low, high]: [f64; 2]) -> Course {
    let (z, tangent) = (map.level.height(place), degrees.to_radians().tan());
    let at = |height: f64| place + way * tangent * (z - height);
    let [from, to] = [at(high + 0.01), at(low - 0.01)];
    march::straight([from.x, from.y, high + 0.01], [to.x, to.y, low - 0.01])
}

#[test]
fn what_is_shifted_swims_while_the_view_turns() {
    let map = stepped(hills(), 16);
    for method in [
        Method::Parallax,
        Method::ParallaxLimited,
        Method::ParallaxIterative,
        Method::Steep,
        Method::Occlusion,
        Method::Relief,
        Method::Cone,
    ] {
        println!(
            "{method:?}: {:.4} texels a degree at 45, {:.4} at 60",
            drift(method, &map, 45.0),
            drift(method, &map, 60.0)
        );
    }
}

const ALL: [Method; 7] = [
    Method::Parallax,
    Method::ParallaxLimited,
    Method::ParallaxIterative,
    Method::Steep,
    Method::Occlusion,
    Method::Relief,
    Method::Cone,
];

/// Rays that cross the border of the tile, and the same a tile further on.
#[test]
fn a_border_of_the_tile_shows_nowhere() {
    for map in [stepped(fractal(), 0), stepped(bricks(), 16)] {
        let mut random = Random::new(7);
        for _ in 0..RAYS {
            let course = down(&mut random, &map, 70.0);
            let tile = glam::DVec4::new(64.0, -128.0, 0.0, 0.0);
            let further = Course { nodes: course.nodes.iter().map(|node| node + tile).collect(), ..course.clone() };
            for method in ALL {
                let [here, there] = [&course, &further].map(|course| marched(method, &map, course));
                assert!((here.s - there.s).abs() < 1e-12, "{method:?}: {here:?} and {there:?} on {course:?}");
                let moved = there.place - here.place;
                assert!(!here.is_hit() || moved.distance(DVec2::new(64.0, -128.0)) < 1e-10, "{method:?}: {moved}");
            }
        }
    }
}
