//! What is thin: posts that stand out, slots that are cut in.

use super::{
    lab::Lab,
    rays,
    row::{Asset, Row},
    sweep::{self, MARCHERS, Ray},
};
use crate::domain::{
    Result,
    stability::{Curve, Worse},
};

pub(super) const POSTS: Row = Row {
    name: "posts",
    family: "thin posts and slots",
    title: "Thin posts",
    story: "A post that is thinner than a step stands between two steps unseen: of the rays that strike one, the share that pass it by is \
            about 1 \u{2212} (width + 1) / step, however exact the method is elsewhere. The rays come in at 80 degrees, and 16 steps \
            are 2.8 texels long.",
    asset: Asset::Made("posts 8 texels high, 16 apart"),
    parameter: ["width", "texels"],
    metric: ["rays that strike a post and are off by more than half a texel", "%"],
    line: 1.0,
    worse: Worse::Downwards,
    literature: &[
        ("steep", "missed where thinner than a step (McGuire and McGuire 2005)"),
        ("occlusion", "missed where thinner than a step (Tatarchuk 2006)"),
        ("relief", "the linear search misses thin structures (Policarpo et al. 2005, said again in GPU Gems 3, chapter 18)"),
        ("cone", "cones never skip, but short ones use up their steps (Policarpo and Oliveira 2007)"),
        ("exact", "never (Tevs, Ihrke and Seidel 2008)"),
    ],
    run: posts,
};

pub(super) const SLOTS: Row = Row {
    name: "slots",
    family: "thin posts and slots",
    title: "Thin slots",
    story: "A slot that is thinner than a step is stepped across: the march is above the heights before it and below them after it, and \
            strikes the far rim where the ray went down the slot. Only rays that go below half of the depth count. They come in at 75 degrees.",
    asset: Asset::Made("slots 8 texels deep, 16 apart"),
    parameter: ["width", "texels"],
    metric: ["rays that go down a slot and are off by more than half a texel", "%"],
    line: 1.0,
    worse: Worse::Downwards,
    literature: POSTS.literature,
    run: slots,
};

const WIDTHS: [f64; 7] = [0.5, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0];
const HIGH: f64 = 8.0;
const APART: u32 = 16;
const SIDE: u32 = 64;
const RAYS: usize = 6000;
/// From the normal.
const POSTS_DEGREES: f64 = 80.0;
const SLOTS_DEGREES: f64 = 75.0;

/// How much of a texel a bar of so many texels covers.
fn covered(texel: u32, width: f64) -> f64 {
    let within = f64::from(texel % APART) - 4.0;
    if within < 0.0 { 0.0 } else { (width - within).clamp(0.0, 1.0) }
}

fn posts(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    let at = |width: f64| {
        let map = rays::map([SIDE; 2], |x, y| HIGH * covered(x, width).min(covered(y, width)));
        let courses = rays::anywhere(&map, RAYS, POSTS_DEGREES);
        (map, courses)
    };
    sweep::over(lab, (&WIDTHS, &MARCHERS), &at, &|map, rays| {
        let [_, high] = rays::range(map);
        sweep::wrong_percent(rays.iter().filter(|ray: &&Ray<'_>| ray.met.1 > 0.25 * high))
    })
}

fn slots(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    let at = |width: f64| {
        let map = rays::map([SIDE; 2], |x, _| HIGH * (1.0 - covered(x, width)));
        let courses = rays::anywhere(&map, RAYS, SLOTS_DEGREES);
        (map, courses)
    };
    sweep::over(lab, (&WIDTHS, &MARCHERS), &at, &|map, rays| {
        let [low, high] = rays::range(map);
        sweep::wrong_percent(rays.iter().filter(|ray: &&Ray<'_>| ray.met.1 < 0.5 * (low + high)))
    })
}
