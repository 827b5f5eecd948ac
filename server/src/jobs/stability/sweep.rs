//! Methods that work per pixel, asked along the same rays while one parameter goes.

use displace_glsl::{
    methods::Method,
    reference::relief::{Course, ReliefMap},
};
use glam::DVec2;

use super::{lab::Lab, rays, row::curve};
use crate::domain::{Result, stability::Curve};

/// A method, and in how many even steps, where it takes any.
#[derive(Clone, Copy)]
pub(super) struct Shown {
    pub(super) method: Method,
    /// 0: as many as the angle asks for.
    steps: u32,
}

const fn shown(method: Method, steps: u32) -> Shown {
    Shown { method, steps }
}

/// Even steps where a scenario does not sweep them.
pub(super) const STEPS: u32 = 16;

pub(super) const MARCHERS: [Shown; 5] = [
    shown(Method::Steep, STEPS),
    shown(Method::Occlusion, STEPS),
    shown(Method::Relief, STEPS),
    shown(Method::Cone, STEPS),
    shown(Method::Exact, 0),
];

pub(super) const ALL: [Shown; 9] = [
    shown(Method::Flat, 0),
    shown(Method::Parallax, 0),
    shown(Method::ParallaxLimited, 0),
    shown(Method::ParallaxIterative, 0),
    MARCHERS[0],
    MARCHERS[1],
    MARCHERS[2],
    MARCHERS[3],
    MARCHERS[4],
];

/// What became of a ray.
pub(super) struct Ray<'c> {
    pub(super) course: &'c Course,
    /// Where it meets the surface, and how high.
    pub(super) met: (DVec2, f64),
    /// What the method shows.
    pub(super) shown: DVec2,
}

impl Ray<'_> {
    /// How far both are apart as the viewer sees it, where a texel is a pixel face-on.
    pub(super) fn error_px(&self) -> f64 {
        self.met.0.distance(self.shown) * self.course.cosine
    }
}

/// What a method shows along courses; what is missed is shown where the course ends.
pub(super) fn places(lab: &Lab<'_>, shown: Shown, map: &ReliefMap, courses: &[Course]) -> Result<Vec<DVec2>> {
    if shown.method == Method::Flat {
        return Ok(courses.iter().map(|course| rays::at_height(course, 0.0)).collect());
    }
    let stepped;
    let map = if map.steps == 0 && shown.steps != 0 {
        stepped = ReliefMap { steps: shown.steps, ..map.clone() };
        &stepped
    } else {
        map
    };
    let marches = lab.marches(shown.method, map, courses)?;
    let place = |(march, course): (&displace_glsl::reference::relief::March, &Course)| {
        let end = course.nodes[course.nodes.len() - 1];
        if march.is_hit() { march.place } else { DVec2::new(end.x, end.y) }
    };
    Ok(marches.iter().zip(courses).map(place).collect())
}

/// A curve for each method: `at` gives the map and the rays of a parameter, `measure` the metric of all rays.
pub(super) fn over(
    lab: &Lab<'_>,
    (parameters, methods): (&[f64], &[Shown]),
    at: &dyn Fn(f64) -> (ReliefMap, Vec<Course>),
    measure: &dyn Fn(&ReliefMap, &[Ray<'_>]) -> f64,
) -> Result<Vec<Curve>> {
    let mut curves: Vec<Curve> = methods.iter().map(|shown| curve(shown.method.name(), Vec::new())).collect();
    for parameter in parameters {
        let (map, courses) = at(*parameter);
        let met = rays::truth(&map, &courses);
        for (curve, shown) in curves.iter_mut().zip(methods) {
            let places = places(lab, *shown, &map, &courses)?;
            let all = courses.iter().zip(&met).zip(places);
            let rays: Vec<Ray<'_>> = all.map(|((course, met), shown)| Ray { course, met: *met, shown }).collect();
            curve.values.push([*parameter, measure(&map, &rays)]);
        }
    }
    Ok(curves)
}

/// Percent of rays that show a place more than half a texel from what they meet; of no ray 0.
pub(super) fn wrong_percent<'r>(rays: impl Iterator<Item = &'r Ray<'r>>) -> f64 {
    let (mut wrong, mut all) = (0.0, 0.0);
    for ray in rays {
        wrong += f64::from(u8::from(ray.met.0.distance(ray.shown) > 0.5));
        all += 1.0;
    }
    100.0 * wrong / f64::max(all, 1.0)
}
