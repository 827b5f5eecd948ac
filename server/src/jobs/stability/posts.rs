//! What is thin: posts that stand out, slots that are cut in.

use displace_glsl::reference::relief::{Course, ReliefMap};
use glam::DVec2;

use super::{
    lab::Lab,
    rays::{self, Random},
    row::{Asset, Row},
    sweep::{self, MARCHERS, Ray, STEPS},
};
use crate::domain::{
    Result,
    stability::{Curve, Worse},
};

pub(super) const POSTS: Row = Row {
    name: "posts",
    family: "thin posts and slots",
    title: "Thin posts",
    story: "A post that is thinner than a step stands between two steps unseen, and the ray shows what lies behind, however finely its last step \
            is halved. The rays come in at 80 degrees towards the middles of posts, and 16 steps are 2.8 texels long; what is off by more \
            than a step was missed.",
    asset: Asset::Made("posts 8 texels high, 64 apart, so that no other stands in the way"),
    parameter: ["width", "texels"],
    metric: ["rays that are off by more than a step", "%"],
    line: 1.0,
    worse: Worse::Downwards,
    literature: &[
        ("steep", "missed where thinner than a step (McGuire and McGuire 2005)"),
        ("occlusion", "missed where thinner than a step (Tatarchuk 2006)"),
        (
            "relief",
            "the linear search misses thin structures (Policarpo et al. 2005, said again in GPU Gems 3, chapter 18)",
        ),
        ("cone", "cones never skip, but short ones use up their steps (Policarpo and Oliveira 2007)"),
        ("exact", "never (Tevs, Ihrke and Seidel 2008)"),
    ],
    run: posts,
};

pub(super) const SLOTS: Row = Row {
    name: "slots",
    family: "thin posts and slots",
    title: "Thin slots",
    story: "A slot is the kinder case: a ray that steps across it is below the heights on its far side, and halving finds the rim that it went \
            past. Only the stairs of plain steps show, and straight last steps where a wall begins. The rays come in at 75 degrees, and those \
            that go below half of the depth count.",
    asset: Asset::Made("slots 8 texels deep, 16 apart"),
    parameter: ["width", "texels"],
    metric: ["rays off by more than half a texel", "%"],
    line: 2.0,
    worse: Worse::Downwards,
    literature: POSTS.literature,
    run: slots,
};

const WIDTHS: [f64; 7] = [0.5, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0];
const HIGH: f64 = 8.0;
const APART: u32 = 16;
const SIDE: u32 = 64;
const RAYS: usize = 4000;
/// From the normal.
const POSTS_DEGREES: f64 = 80.0;
const SLOTS_DEGREES: f64 = 75.0;

/// How much of a texel a bar of so many texels covers.
fn covered(texel: u32, width: f64) -> f64 {
    let within = f64::from(texel) - 4.0;
    if within < 0.0 { 0.0 } else { (width - within).clamp(0.0, 1.0) }
}

fn posts(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    let at = |width: f64| {
        let map = rays::map([SIDE; 2], |x, y| HIGH * covered(x, width).min(covered(y, width)));
        let courses = towards_posts(&map, width);
        (map, courses)
    };
    sweep::over(lab, (&WIDTHS, &MARCHERS), &at, &|_, rays| {
        let missed = |ray: &&Ray<'_>| ray.met.0.distance(ray.shown) > step(ray.course);
        100.0 * rays.iter().filter(missed).count() as f64 / rays.len() as f64
    })
}

/// At any height of their middles, and any way round.
fn towards_posts(map: &ReliefMap, width: f64) -> Vec<Course> {
    let mut random = Random::new(13);
    let middle = DVec2::splat(4.0 + 0.5 * (width.ceil() - 1.0));
    let mut one = |_| {
        let (z, way) = ((0.1 + 0.8 * random.next()) * rays::range(map)[1], random.way());
        rays::through(map, middle, z, way, POSTS_DEGREES)
    };
    (0..RAYS).map(&mut one).collect()
}

/// Texels across.
fn step(course: &Course) -> f64 {
    course.travel() / f64::from(STEPS)
}

fn slots(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    let at = |width: f64| {
        let map = rays::map([SIDE; 2], |x, _| HIGH * (1.0 - covered(x % APART, width)));
        let courses = rays::anywhere(&map, RAYS, SLOTS_DEGREES);
        (map, courses)
    };
    sweep::over(lab, (&WIDTHS, &MARCHERS), &at, &|map, rays| {
        let [low, high] = rays::range(map);
        sweep::wrong_percent(rays.iter().filter(|ray: &&Ray<'_>| ray.met.1 < 0.5 * (low + high)))
    })
}
