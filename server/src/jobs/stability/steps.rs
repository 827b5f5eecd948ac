//! Ever fewer even steps: what is missed, and the stairs that steps leave.

use std::f64::consts::TAU;

use displace_glsl::reference::relief::ReliefMap;
use glam::DVec2;

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

pub(super) const MISSES: Row = Row {
    name: "steps",
    family: "step count sweep",
    title: "Too few steps",
    story: "A march by even steps sees heights at its steps alone. What is thinner than a step is passed over, and the ray shows what \
            lies behind: an error of any size, however finely the last step is halved. The rays come in at 60 degrees.",
    asset: Asset::OwnHeights,
    parameter: ["steps", "steps"],
    metric: ["rays off by more than half a texel", "%"],
    line: 1.0,
    worse: Worse::Downwards,
    literature: &[
        ("steep", "as many as the ray crosses texels: N \u{2265} range tan \u{3b8} / width (McGuire and McGuire 2005)"),
        ("occlusion", "8 to 50 steps by angle (Tatarchuk 2006)"),
        ("relief", "ten linear steps and five halvings in its shader (Policarpo et al. 2005)"),
        ("cone", "15 cone steps, then halvings (Policarpo and Oliveira 2007)"),
        ("exact", "takes none"),
    ],
    run: misses,
};

pub(super) const STAIRS: Row = Row {
    name: "stairs",
    family: "step count sweep",
    title: "Stairs",
    story: "On a slope each even step becomes a stair, and a row of pixels shows a saw of as many teeth as there are steps. Its first \
            harmonic is range sin \u{3b8} / (\u{3c0} N); what interpolates or halves the last step has none. The ramp is 8 texels high, \
            the rays come in at 60 degrees.",
    asset: Asset::Made("a ramp, 8 texels high over 64"),
    parameter: ["steps", "steps"],
    metric: ["amplitude of the error at the frequency of the steps", "px"],
    line: 0.25,
    worse: Worse::Downwards,
    literature: &[
        ("steep", "stairs of range / N, unless steps are jittered (McGuire and McGuire 2005)"),
        ("occlusion", "none on a slope: the last step is taken as straight (Tatarchuk 2006)"),
        ("relief", "2^\u{2212}k of a step after k halvings (Policarpo et al. 2005)"),
        ("cone", "the same after its halvings (Policarpo and Oliveira 2007)"),
        ("exact", "none: closed form in each cell (Tevs, Ihrke and Seidel 2008)"),
    ],
    run: stairs,
};

const STEPS: [f64; 7] = [4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0];
const DEGREES: f64 = 60.0;
const RAYS: usize = 1000;
/// Of the ramp, texels.
const HIGH: f64 = 8.0;
const LONG: u32 = 64;
/// By which courses are longer than the heights.
const BEYOND_BOTH: f64 = 2.0 * rays::BEYOND;

fn misses(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    let map = &lab.own.heights;
    let courses = rays::anywhere(map, RAYS, DEGREES);
    let at = |steps: f64| (ReliefMap { steps: steps as u32, ..map.clone() }, courses.clone());
    sweep::over(lab, (&STEPS, &MARCHERS), &at, &|_, rays| sweep::wrong_percent(rays.iter()))
}

fn stairs(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    let ramp = rays::map([LONG, 4], |x, _| HIGH * f64::from(x) / f64::from(LONG));
    // Side by side up the slope, clear of where the ramp falls off: no way is longer than 14 texels.
    let course = |k: usize| {
        // Half of the heights, and so half of the steps: whole waves.
        let x = 0.28 + 0.5 * (1.0 + BEYOND_BOTH / HIGH) * k as f64 / RAYS as f64;
        let place = DVec2::new(x * f64::from(LONG), 1.0);
        rays::through(&ramp, place, HIGH * x, DVec2::X, DEGREES)
    };
    let courses: Vec<_> = (0..RAYS).map(course).collect();
    let at = |steps: f64| (ReliefMap { steps: steps as u32, ..ramp.clone() }, courses.clone());
    sweep::over(lab, (&STEPS, &MARCHERS), &at, &harmonic)
}

/// Amplitude of the error as a wave with one turn for each step.
fn harmonic(map: &ReliefMap, rays: &[Ray<'_>]) -> f64 {
    let sums = rays.iter().fold([0.0; 2], |[a, b], ray| {
        let [from, to] = [ray.course.nodes[0].z, ray.course.nodes[1].z];
        let (sin, cos) = (TAU * f64::from(map.steps) * (from - ray.met.1) / (from - to)).sin_cos();
        [a + cos * ray.error_px(), b + sin * ray.error_px()]
    });
    2.0 * sums[0].hypot(sums[1]) / rays.len() as f64
}
