//! Rays that come in ever flatter.

use super::{
    lab::Lab,
    rays,
    row::{Asset, Row},
    sweep::{self, ALL, Ray},
};
use crate::domain::{
    Result,
    stability::{Curve, Worse},
};

pub(super) const ROW: Row = Row {
    name: "grazing",
    family: "grazing sweep",
    title: "Grazing rays",
    story: "The flatter a ray comes in, the farther a height moves what is seen, and the longer its way over the heights: a shift \
            that reads one height is off by the whole range, and even steps grow until they pass over what is thin. A texel is a \
            pixel wide face-on, and the error is foreshortened as the viewer sees it.",
    asset: Asset::OwnHeights,
    parameter: ["angle from the normal", "degrees"],
    metric: ["error on the screen, 99th percentile", "px"],
    line: 1.0,
    worse: Worse::Upwards,
    literature: &[
        ("flat", "off by H sin \u{3b8} (Cohen, Olano and Manocha 1998 bound it as texture deviation)"),
        (
            "parallax",
            "assumes a level surface, off by min(range, slope \u{d7} shift) in height; unbounded at grazing angles (Welsh 2004)",
        ),
        (
            "parallax-limited",
            "bounded by the height, for H sin \u{3b8} (1 \u{2212} cos \u{3b8}) more error (Welsh 2004)",
        ),
        ("parallax-iterative", "3 to 4 turns where slopes are small; may find a wrong crossing (Premecz 2006)"),
        ("steep", "more steps the flatter the view; stairs of range / N (McGuire and McGuire 2005)"),
        ("occlusion", "8 to 50 steps by angle, and none at a distance (Tatarchuk 2006)"),
        ("relief", "linear steps may miss thin features, which halving cannot mend (Policarpo et al. 2005)"),
        ("cone", "relaxed cones miss nothing but converge slower at flat rays (Policarpo and Oliveira 2007)"),
        ("exact", "no angle: bounds skip only what cannot be met (Tevs, Ihrke and Seidel 2008)"),
    ],
    run,
};

const DEGREES: [f64; 13] = [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 75.0, 80.0, 84.0, 87.0, 89.0];
const RAYS: usize = 1000;

fn run(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    let map = &lab.own.heights;
    let at = |degrees: f64| (map.clone(), rays::anywhere(map, RAYS, degrees));
    sweep::over(lab, (&DEGREES, &ALL), &at, &|_, rays| rays::percentile(rays.iter().map(Ray::error_px).collect(), 0.99))
}
