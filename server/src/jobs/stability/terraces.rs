//! A slow slope in maps of few bits.

use std::sync::Arc;

use glam::DVec3;

use super::{
    lab::Lab,
    meshes::{self, Sheet},
    row::{Asset, Row, curve},
};
use crate::domain::{
    Result,
    detail::{Map, Wrap},
    stability::{Curve, Worse},
    surface::Surface,
};

pub(super) const STEPS: Row = Row {
    name: "terraces",
    family: "bit depth",
    title: "Terraces of maps with few bits",
    story: "A map holds a slope in levels, and a slow one stays on each for many texels: it becomes terraces as high as a level, whose \
            rims catch the light. The ramp rises by a 16th of the range over 256 texels. With 8 bits a level is a 255th of the range and 16 texels \
            long; half floats are coarse near the top, where a level is a 2048th.",
    asset: Asset::Made("a ramp over 256 texels, displaced at every half texel"),
    parameter: ["height of the whole range", "texels"],
    metric: ["height off by", "texels"],
    line: 0.05,
    worse: Worse::Upwards,
    literature: LITERATURE,
    run: heights,
};

pub(super) const NORMALS: Row = Row {
    name: "terrace-normals",
    family: "bit depth",
    title: "Normals of maps with few bits",
    story: "Shading sees slopes, and between terraces they are all wrong: level on each, steep at its rim. Central differences over \
            one texel see half a level as slope, so that an angle of a degree is reached by heights that move nothing that can be seen.",
    asset: Asset::Made("a ramp over 256 texels, displaced at every half texel"),
    parameter: ["height of the whole range", "texels"],
    metric: ["normal off by", "degrees"],
    line: 1.0,
    worse: Worse::Upwards,
    literature: LITERATURE,
    run: normals,
};

const LITERATURE: &[(&str, &str)] = &[
    ("8 bits", "bands on slow slopes; heights ask for 16 (ZBrush and Arnold manuals)"),
    ("16 bits", "none that can be seen"),
    ("half float", "11 bits near the top of the range (IEEE 754)"),
    ("float", "none"),
];
const AMPLITUDES: [f64; 8] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0];
const TEXELS: u32 = 256;
/// Of the whole range.
const RISE: f64 = 1.0 / 16.0;
/// From 0 to 1, to the nearest value that a format has.
type Rounded = fn(f64) -> f64;
const FORMATS: [(&str, Rounded); 4] =
    [("8 bits", |v| levels(v, 255.0)), ("16 bits", |v| levels(v, 65535.0)), ("half float", half), ("float", |v| v)];

/// So many texels along the ramp, in the upper half of the range.
fn value(texels: f64) -> f64 {
    0.5 + RISE * texels / f64::from(TEXELS)
}

fn levels(value: f64, count: f64) -> f64 {
    (value * count).round() / count
}

/// Rounded to eleven bits.
fn half(value: f64) -> f64 {
    let unit = 2f64.powi(value.max(f64::MIN_POSITIVE).log2().floor() as i32 - 10);
    (value / unit).round() * unit
}

fn heights(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    swept(lab, |place, _, amplitude| (place.y - amplitude * value(place.x)).abs())
}

fn normals(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    swept(lab, |_, normal, amplitude| {
        let truth = DVec3::new(-amplitude * RISE / f64::from(TEXELS), 1.0, 0.0);
        normal.cross(truth).length().atan2(normal.dot(truth)).to_degrees()
    })
}

fn swept(lab: &Lab<'_>, off: fn(DVec3, DVec3, f64) -> f64) -> Result<Vec<Curve>> {
    let long = f64::from(TEXELS);
    let strip = Sheet::grid([64, 1], |u, v| ([long * u, 0.0, 4.0 - 4.0 * v], [0.0, 1.0, 0.0], [u, 1.0 - v]));
    let mesh = strip.welded("strip")?;
    let of_format = |(name, rounded): (&str, Rounded)| {
        let map = ramp(rounded);
        let one = |amplitude: f64| {
            let detail = meshes::heights(&map, amplitude as f32);
            Ok([amplitude, worst(&lab.displaced(&mesh, &detail, &meshes::uniform(3))?, amplitude, off)])
        };
        Ok(curve(name, AMPLITUDES.into_iter().map(one).collect::<Result<_>>()?))
    };
    FORMATS.into_iter().map(of_format).collect()
}

fn ramp(rounded: Rounded) -> Arc<Map> {
    meshes::height_map([TEXELS, 4], Wrap::Clamp, |x, _| rounded(value(f64::from(x) + 0.5)) as f32)
}

/// Away from the ends, where texels go on level.
fn worst(surface: &Surface, amplitude: f64, off: fn(DVec3, DVec3, f64) -> f64) -> f64 {
    let wide = |p: &[f32; 3]| DVec3::from_array(p.map(f64::from));
    let all = surface.positions.iter().zip(&surface.normals).map(|(p, n)| (wide(p), wide(n)));
    let inner = all.filter(|(p, _)| (2.0..f64::from(TEXELS) - 2.0).contains(&p.x));
    inner.map(|(p, n)| off(p, n, amplitude)).fold(0.0, f64::max)
}
