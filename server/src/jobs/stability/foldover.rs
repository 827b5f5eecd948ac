//! Heights that reach the axis of a bend.

use std::sync::Arc;

use super::{
    lab::Lab,
    meshes,
    row::{Asset, Row, curve},
};
use crate::{
    domain::{
        Result,
        detail::{Map, Wrap},
        stability::{Curve, Worse},
        surface::Surface,
    },
    oracle::facts::self_intersections,
};

pub(super) const INVERTED: Row = Row {
    name: "foldover",
    family: "foldover",
    title: "Triangles that turn over inside a bend",
    story: "On the concave side all normals run towards the centre of curvature, and a height that goes beyond it comes out on the other \
            side with its triangles turned over. The offset is singular where H times the curvature is 1. Clamping heights to 0.95 of the \
            radius keeps every triangle the right way round.",
    asset: Asset::Made("the inside of a tube of radius 1, one bump around it"),
    parameter: ["height", "of the radius"],
    metric: ["triangles that face against their base", "%"],
    line: 0.0,
    worse: Worse::Upwards,
    literature: &[
        ("displacement", "offsets are singular at the radius of curvature (Farouki and Neff 1990)"),
        ("displacement, clamped", "none below it"),
    ],
    run: inverted,
};

pub(super) const MEETING: Row = Row {
    name: "self-intersection",
    family: "foldover",
    title: "Surfaces that run through themselves",
    story: "Where part of a bend goes beyond its centre and part does not, the surface crosses itself on the way. No tessellation mends \
            that: the surface itself is not simple there. Counted are pairs of triangles that run through each other.",
    asset: Asset::Made("the inside of a tube of radius 1, one bump around it"),
    parameter: ["height", "of the radius"],
    metric: ["pairs of triangles that meet", "pairs"],
    line: 0.0,
    worse: Worse::Upwards,
    literature: INVERTED.literature,
    run: meeting,
};

const HEIGHTS: [f64; 9] = [0.5, 0.7, 0.8, 0.9, 0.98, 1.02, 1.1, 1.25, 1.5];
const SEGMENTS: [u32; 2] = [48, 8];
const LEVEL: u32 = 2;
/// Of the radius, the most that is not folded over.
const CLAMP: f64 = 0.95;

fn inverted(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    both(lab, &|surface| 100.0 * surface.flipped as f64 / surface.triangles.len() as f64)
}

fn meeting(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    both(lab, &|surface| self_intersections(&surface.positions, &surface.triangles, 0).count as f64)
}

fn both(lab: &Lab<'_>, measure: &dyn Fn(&Surface) -> f64) -> Result<Vec<Curve>> {
    let mesh = meshes::tube(SEGMENTS).welded("tube")?;
    let swept = |most: f64| {
        let one = |height: f64| {
            let detail = meshes::heights(&bump(height, most), 1.0);
            let surface = lab.displaced(&mesh, &detail, &meshes::uniform(LEVEL))?;
            Ok([height, measure(&surface)])
        };
        HEIGHTS.into_iter().map(one).collect::<Result<_>>()
    };
    Ok(vec![curve("displacement", swept(f64::INFINITY)?), curve("displacement, clamped", swept(CLAMP)?)])
}

/// From 0 to its height and back, once around.
fn bump(height: f64, most: f64) -> Arc<Map> {
    meshes::height_map([64, 4], Wrap::Repeat, |x, _| {
        let turn = (f64::from(x) + 0.5) / 64.0 * std::f64::consts::TAU;
        (height * (0.5 - 0.5 * turn.cos())).min(most) as f32
    })
}
