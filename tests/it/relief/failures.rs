//! What methods are known to get wrong, and by how much: claims about the twins, which the device agrees with.

use displace_glsl::{
    methods::Method,
    reference::{
        cone_map,
        relief::{Course, March, ReliefMap},
    },
};
use displace_tests::march;
use glam::{DVec2, DVec4, IVec2};

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
        course.place(met(map, &course).s).z - course.place(marched(method, map, &course).s).z
    };
    (0..RAYS).map(below).fold(0.0, f64::max)
}

/// Hills of which nothing is hidden, seen at 60 degrees.
#[test]
fn stairs_are_as_high_as_a_step_where_it_is_not_cut() {
    let map = stepped(hills(), 16);
    let [low, high] = range(&map);
    let step = (high - low + 0.02) / 16.0;
    let [steep, occlusion, relief, cone, exact] =
        [Method::Steep, Method::Occlusion, Method::Relief, Method::Cone, Method::Exact]
            .map(|method| deepest(method, &map, 60.0) / step);
    println!("of a step: steep {steep:.3}, occlusion {occlusion:.3}, relief {relief:.3}, cone {cone:.3}");
    assert!((0.98..1.0 + 1e-9).contains(&steep), "{steep}");
    assert!(occlusion < 0.05, "{occlusion}");
    assert!((0.9 / 32.0..1.0 / 32.0 + 1e-9).contains(&relief), "{relief}");
    assert!((0.9 / 32.0..1.0 / 32.0 + 1e-9).contains(&cone), "{cone}");
    assert!(exact < 1e-9, "{exact}");
}

/// Share of rays off by more than half a texel, percent.
fn wrong(method: Method, map: &ReliefMap, degrees: f64) -> f64 {
    let mut random = Random::new(4);
    let off = |_: &u32| {
        let course = down(&mut random, map, degrees);
        marched(method, map, &course).place.distance(met(map, &course).place) > 0.5
    };
    (0..RAYS).filter(off).count() as f64 * 100.0 / f64::from(RAYS)
}

/// Posts 8 high, 8 apart: with 16 steps, and with as many as the angle asks for, which is one for each texel.
#[test]
fn posts_a_texel_wide_are_missed_by_steps_that_are_longer() {
    let posts = tiling(|x, y| if x % 8 == 5 && y % 8 == 1 { 8.0 } else { 0.0 });
    for (steps, degrees, least) in [
        (16, 30.0, [0.1; 4]),
        (16, 60.0, [7.0, 2.0, 2.0, 2.0]),
        (16, 80.0, [35.0, 35.0, 25.0, 25.0]),
        (64, 80.0, [15.0, 5.0, 5.0, 4.0]),
        (0, 80.0, [20.0, 10.0, 8.0, 7.0]),
    ] {
        let map = stepped(posts.clone(), steps);
        let missed =
            [Method::Steep, Method::Occlusion, Method::Relief, Method::Cone].map(|method| wrong(method, &map, degrees));
        println!("{steps} steps at {degrees} degrees: {missed:.2?} % wrong");
        for (missed, least) in missed.into_iter().zip(least) {
            assert!((least..2.0 * least + 1.0).contains(&missed), "{missed} %, not {least} to twice as much");
        }
    }
}

/// Heights around 0, so that a ray that is not shifted shows what is at half of them.
fn centred(map: &ReliefMap, scale: f64) -> ReliefMap {
    let middle = range(map).iter().sum::<f64>() / 2.0;
    tiling(|x, y| (map.level.texel(IVec2::new(x as i32, y as i32)) - middle) * scale)
}

/// How far what is shown is from what is met, as the viewer sees it, texels, root of the mean square: of a method, and where
/// nothing is shifted.
fn seen(method: Method, map: &ReliefMap, degrees: f64) -> [f64; 2] {
    let mut random = Random::new(5);
    let mut sums = [0.0; 2];
    for _ in 0..RAYS {
        let course = down(&mut random, map, degrees);
        let met = met(map, &course).place;
        let shown = marched(method, map, &course);
        let flat = course.place(shown.s).truncate().truncate();
        sums[0] += (shown.place.distance(met) * course.cosine).powi(2);
        sums[1] += (flat.distance(met) * course.cosine).powi(2);
    }
    sums.map(|sum| (sum / f64::from(RAYS)).sqrt())
}

#[test]
fn at_grazing_angles_a_shift_is_worse_than_none() {
    let map = centred(&fractal(), 3.0);
    for degrees in [30.0, 60.0, 80.0] {
        for method in [Method::Parallax, Method::ParallaxLimited, Method::ParallaxIterative] {
            let [shifted, flat] = seen(method, &map, degrees);
            println!("{method:?} at {degrees} degrees: off by {shifted:.2} texels, without a shift {flat:.2}");
            assert!(degrees > 30.0 || shifted < 0.5 * flat, "{shifted} of {flat}");
            assert!(degrees < 80.0 || method != Method::Parallax || shifted > 1.05 * flat, "{shifted} of {flat}");
        }
    }
}

/// A shift has no bound: as the tangent of the angle, the limited one at most the height.
#[test]
fn a_shift_grows_without_a_bound_unless_it_is_limited() {
    let map = tiling(|_, _| 1.0);
    for (degrees, tangent) in [(80.0, 5.67), (89.0, 57.29), (89.9, 572.96)] {
        let course = march::straight([0.0, 0.0, 1.5], [3.0 * f64::to_radians(degrees).tan(), 0.0, -1.5]);
        let base = course.place(0.5).x;
        let [free, limited] =
            [Method::Parallax, Method::ParallaxLimited].map(|method| base - marched(method, &map, &course).place.x);
        assert!((free - tangent).abs() < 0.01 * tangent, "{free}");
        assert!((0.98..1.0).contains(&limited), "{limited}");
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

/// Hills of which nothing is hidden: what marches keeps them in place but for its stairs.
#[test]
fn what_is_shifted_swims_while_the_view_turns() {
    let map = stepped(hills(), 16);
    for (method, least, most) in [
        (Method::Parallax, 0.05, 0.12),
        (Method::ParallaxLimited, 0.1, 0.25),
        (Method::ParallaxIterative, 0.05, 0.12),
        (Method::Steep, 0.005, 0.2),
        (Method::Occlusion, 0.0, 0.002),
        (Method::Relief, 0.0, 0.006),
        (Method::Cone, 0.0, 0.006),
        (Method::Exact, 0.0, 1e-5),
    ] {
        let drift = drift(method, &map, 60.0);
        println!("{method:?}: {drift:.5} texels a degree at 60 degrees");
        assert!((least..most).contains(&drift), "{method:?}: {drift}");
    }
}

const ALL: [Method; 8] = [
    Method::Exact,
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
            let tile = DVec4::new(64.0, -128.0, 0.0, 0.0);
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
