//! Maps whose borders disagree, and directions that point nowhere.

use std::sync::Arc;

use glam::DVec3;

use super::{
    judge::Rule,
    lab::Lab,
    meshes,
    row::{Asset, Row, curve},
};
use crate::{
    domain::{
        Digest, Error, Result,
        detail::{Sampling, Wrap},
        encode, maps,
        request::{LayerRequest, MapRequest, MaterialDetail, Preset, SeamRule, SourceRequest, Space, Swizzle},
        scene::Scene,
        stability::{Curve, Worse},
        surface::Surface,
        weld::with_tangents,
    },
    oracle::invariants,
};

pub(super) const TILING: Row = Row {
    name: "tiling",
    family: "tiling wrap",
    title: "Maps that do not tile",
    story: "Around a closed tube the map begins where it ends, and where its borders disagree each side of the seam asks for a height of its own. Left alone the \
            seam opens by the disagreement. One height for each place closes it; a ramp of three texels takes the step out of the surface.",
    asset: Asset::Made("the inside of a tube under a ramp that is clamped at its ends"),
    parameter: ["disagreement of the borders", "of the height"],
    metric: ["widest gap", "% of the height"],
    line: 0.0,
    worse: Worse::Upwards,
    literature: &[
        ("displacement, mean of sides", "none: the mean of both sides"),
        ("displacement, dominant side", "none: the height of one side (PN-AEN, McDonald and Kilgard 2010)"),
        (
            "each side by itself",
            "opens by the disagreement (micro-mesh toolkit's manual: maps that do not tile crack at the wrap)",
        ),
    ],
    run: tiling,
};

pub(super) const DIRECTIONS: Row = Row {
    name: "directions",
    family: "black or undefined RGB direction",
    title: "Directions that point nowhere",
    story: "A map of directions has texels where nothing was drawn: black, or the grey that stands for no direction. Making such a vector unit \
            length divides nothing by nothing, and one value that is no number spreads over every triangle and pixel that reads it.",
    asset: Asset::Made("a sphere under directions of 32 x 32 texels, a share of them undefined"),
    parameter: ["undefined texels", "%"],
    metric: ["coordinates that are no numbers", "%"],
    line: 0.0,
    worse: Worse::Upwards,
    literature: &[
        ("vector, black", "none: black is a direction like any other"),
        ("vector, grey", "none: grey moves nothing (West 2007 leaves it open)"),
        ("made unit length without a guard", "all that is undefined (IEEE 754: 0 / 0)"),
    ],
    run: directions,
};

const DISAGREEMENTS: [f64; 6] = [0.0, 0.05, 0.1, 0.25, 0.5, 1.0];
const SHARES: [f64; 6] = [0.0, 1.0, 5.0, 20.0, 50.0, 100.0];
const HEIGHT: f32 = 0.2;
const SIDE: u32 = 32;

fn tiling(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    let mesh = meshes::tube([24, 4]).welded("tube")?;
    let made = |rule: SeamRule, disagreement: f64| {
        let map = meshes::height_map([64, 4], Wrap::Clamp, |x, _| (disagreement * f64::from(x) / 63.0) as f32);
        let geometry = crate::domain::request::Geometry { seams: rule, ..meshes::uniform(3) };
        lab.displaced(&mesh, &meshes::heights(&map, HEIGHT), &geometry)
    };
    let swept = |rule: SeamRule, of: &dyn Fn(&Surface) -> f64| {
        let one = |disagreement: f64| {
            let surface = made(rule, disagreement)?;
            Ok([disagreement, 100.0 * of(&surface) / f64::from(HEIGHT)])
        };
        DISAGREEMENTS.into_iter().map(one).collect::<Result<Vec<[f64; 2]>>>()
    };
    let gap = |surface: &Surface| invariants::largest_gap(&mesh, surface);
    Ok(vec![
        curve("displacement, mean of sides", swept(SeamRule::Mean, &gap)?),
        curve("displacement, dominant side", swept(SeamRule::Dominant, &gap)?),
        // What both sides ask for before they are reconciled.
        curve("each side by itself", swept(SeamRule::Mean, &|surface| f64::from(surface.mismatch_max))?),
    ])
}

fn directions(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    let (mut black, mut grey, mut naive) = (Vec::new(), Vec::new(), Vec::new());
    for share in SHARES {
        black.push([share, undefined_percent(lab, share, [0; 3])?]);
        grey.push([share, undefined_percent(lab, share, [128, 128, 128])?]);
        naive.push([share, unguarded_percent(share)]);
    }
    Ok(vec![
        curve("vector, black", black),
        curve("vector, grey", grey),
        curve("made unit length without a guard", naive),
    ])
}

/// Whether a texel is one of the undefined, spread evenly.
fn is_undefined(texel: u32, share: f64) -> bool {
    f64::from((texel * 37) % 100) < share
}

/// Of coordinates of positions and normals, through the service's own decoding.
fn undefined_percent(lab: &Lab<'_>, share: f64, undefined: [u8; 3]) -> Result<f64> {
    let texel = |k: u32| if is_undefined(k, share) { undefined } else { [180, 128, 220] };
    let direction = encode::encode_rgb8(SIDE, SIDE, &(0..SIDE * SIDE).flat_map(texel).collect::<Vec<_>>())?;
    let magnitude = encode::encode_rgb8(SIDE, SIDE, &vec![128; 3 * (SIDE * SIDE) as usize])?;
    let assets = [direction, magnitude].map(|bytes| (Digest::of(&bytes), bytes::Bytes::from(bytes)));
    let map = |k: usize| MapRequest { asset: assets[k].0, wrap: None, sampling: Sampling::Center };
    let source = SourceRequest::DirectionMagnitude {
        direction: map(0),
        magnitude: map(1),
        space: Space::Tangent,
        swizzle: Swizzle::default(),
    };
    let layer = LayerRequest {
        source,
        scale: HEIGHT,
        midlevel: None,
        invert_height: false,
        flip_v: false,
        preset: Preset::Right,
    };
    let request = MaterialDetail { material: None, layers: vec![layer], uv_set: 0 };
    let read = |digest: &Digest| {
        let found = assets.iter().find(|(own, _)| own == digest);
        found.map(|(_, bytes)| bytes.clone()).ok_or_else(|| Error::internal("a map that was not made"))
    };
    let details = maps::resolve(&Scene::default(), &[request], &read)?;
    let detail = details.of(None).map(Arc::clone).ok_or_else(|| Error::internal("directions without a detail"))?;
    let mesh = with_tangents(&meshes::sphere([24, 12], false).welded("sphere")?, |_| Some(0))?;
    let surface = lab.displaced(&mesh, &detail, &meshes::uniform(2))?;
    let values = surface.positions.iter().chain(&surface.normals).flatten();
    let (bad, all) = values.fold((0.0, 0.0), |(bad, all), x| (bad + f64::from(u8::from(!x.is_finite())), all + 1.0));
    lab.note(Rule::Finite, (bad > 0.0).then(|| format!("{share} % of directions are {undefined:?}")));
    Ok(100.0 * bad / all)
}

/// What 16-bit grey decodes to is nothing, and nothing has no direction.
fn unguarded_percent(share: f64) -> f64 {
    let texels = SIDE * SIDE;
    let bad = (0..texels).filter(|k| {
        let direction = if is_undefined(*k, share) { DVec3::ZERO } else { DVec3::new(0.4, 0.0, 0.7) };
        !(direction / direction.length()).is_finite()
    });
    100.0 * bad.count() as f64 / f64::from(texels)
}
