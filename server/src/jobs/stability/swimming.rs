//! What should stay where it is while the camera moves.

use std::f64::consts::TAU;

use displace_glsl::reference::relief::{Course, ReliefMap};
use glam::DVec2;

use super::{
    lab::Lab,
    rays::{self, Random},
    row::{Asset, Row, curve},
    sweep::{self, ALL, Shown},
};
use crate::domain::{
    Result,
    stability::{Curve, Worse},
};

pub(super) const DRIFT: Row = Row {
    name: "drift",
    family: "swimming",
    title: "Places that drift while the view turns",
    story: "A place of the surface is asked for from two directions a degree apart; what a method shows there should be the same both times. A \
            shift by one height is right for level surfaces alone, so its error changes with the view and the map swims. Only places \
            that both directions see count.",
    asset: Asset::Made("hills 4 texels high, 32 from top to top"),
    parameter: ["angle from the normal", "degrees"],
    metric: ["drift for a degree, root mean square", "texels"],
    line: 0.1,
    worse: Worse::Upwards,
    literature: SWIMS,
    run: drift,
};

pub(super) const SHIMMER: Row = Row {
    name: "shimmer",
    family: "swimming",
    title: "Colours that shimmer under a moving camera",
    story: "A camera comes nearer in 240 frames, its rays from 65 to 45 degrees, and the colour of 40 places is followed through all of them. \
            Whatever a method shows wrongly changes from frame to frame; the deviation of the colour is what an eye sees as swimming. Waves \
            of colour are 8 texels long.",
    asset: Asset::Made("hills of the height that is swept, 32 texels from top to top"),
    parameter: ["height of the hills", "texels"],
    metric: ["standard deviation of colour over 240 frames", "of 255"],
    line: 4.0,
    worse: Worse::Upwards,
    literature: SWIMS,
    run: shimmer,
};

const SWIMS: &[(&str, &str)] = &[
    ("flat", "moves by H for each unit of tan \u{3b8}: no parallax at all (Kaneko et al. 2001 set out to mend it)"),
    ("parallax", "swims where heights are not level (Welsh 2004)"),
    ("parallax-limited", "less at grazing angles, more elsewhere (Welsh 2004)"),
    ("parallax-iterative", "less, by the slope (Premecz 2006)"),
    ("steep", "its stairs move with the view (McGuire and McGuire 2005)"),
    ("occlusion", "still but for the bend within a step (Tatarchuk 2006)"),
    ("relief", "still to 1/32 of a step (Policarpo et al. 2005)"),
    ("cone", "still to 1/32 of a step (Policarpo and Oliveira 2007)"),
    ("exact", "still (Tevs, Ihrke and Seidel 2008)"),
];
const DEGREES: [f64; 9] = [5.0, 15.0, 25.0, 35.0, 45.0, 55.0, 65.0, 75.0, 82.0];
const PLACES: usize = 1000;
const AMPLITUDES: [f64; 6] = [0.5, 1.0, 2.0, 4.0, 8.0, 16.0];
const FOLLOWED: usize = 40;
const FRAMES: usize = 240;
/// Of the camera's way, from the normal.
const DOLLY_DEGREES: [f64; 2] = [65.0, 45.0];
/// Of the waves of colour, texels.
const WAVE: f64 = 8.0;
/// What is met within so many texels of a place is that place.
const SEEN: f64 = 1e-3;

/// Places of the surface, each with a way that rays come.
fn places(map: &ReliefMap, count: usize) -> Vec<(DVec2, DVec2)> {
    let mut random = Random::new(11);
    (0..count).map(|_| (random.place(map), random.way())).collect()
}

fn towards(map: &ReliefMap, (place, way): (DVec2, DVec2), degrees: f64) -> Course {
    rays::through(map, place, map.level.height(place), way, degrees)
}

fn drift(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    let map = rays::hills(4.0);
    let places = places(&map, PLACES);
    let mut curves = ALL.map(|shown| (curve(shown.method.name(), Vec::new()), shown));
    for degrees in DEGREES {
        let views = [degrees, degrees + 1.0]
            .map(|degrees| places.iter().map(|place| towards(&map, *place, degrees)).collect::<Vec<_>>());
        let seen = views.each_ref().map(|courses| rays::truth(&map, courses));
        let both: Vec<bool> =
            (0..PLACES).map(|k| seen.iter().all(|met| met[k].0.distance(places[k].0) < SEEN)).collect();
        for (curve, shown) in &mut curves {
            let found = [sweep::places(lab, *shown, &map, &views[0])?, sweep::places(lab, *shown, &map, &views[1])?];
            let squares: Vec<f64> =
                (0..PLACES).filter(|k| both[*k]).map(|k| found[0][k].distance_squared(found[1][k])).collect();
            let mean = squares.iter().sum::<f64>() / squares.len().max(1) as f64;
            curve.values.push([degrees, mean.sqrt()]);
        }
    }
    Ok(curves.map(|(curve, _)| curve).into())
}

fn shimmer(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    let mut curves = ALL.map(|shown| (curve(shown.method.name(), Vec::new()), shown));
    for amplitude in AMPLITUDES {
        let map = rays::hills(amplitude);
        let places = places(&map, FOLLOWED);
        let courses: Vec<Course> =
            (0..FOLLOWED * FRAMES).map(|k| towards(&map, places[k / FRAMES], dolly_degrees(k % FRAMES))).collect();
        let met = rays::truth(&map, &courses);
        let seen: Vec<bool> = (0..courses.len()).map(|k| met[k].0.distance(places[k / FRAMES].0) < SEEN).collect();
        for (curve, shown) in &mut curves {
            curve.values.push([amplitude, shimmer_of(lab, *shown, &map, &courses, &seen)?]);
        }
    }
    Ok(curves.map(|(curve, _)| curve).into())
}

/// The camera moves evenly along the base: the tangent does.
fn dolly_degrees(frame: usize) -> f64 {
    let [from, to] = DOLLY_DEGREES.map(|degrees| degrees.to_radians().tan());
    (from + (to - from) * frame as f64 / (FRAMES - 1) as f64).atan().to_degrees()
}

fn shimmer_of(lab: &Lab<'_>, shown: Shown, map: &ReliefMap, courses: &[Course], seen: &[bool]) -> Result<f64> {
    let shown = sweep::places(lab, shown, map, courses)?;
    let deviation = |place: usize| {
        let frames = place * FRAMES..(place + 1) * FRAMES;
        let colors: Vec<f64> = frames.filter(|k| seen[*k]).map(|k| color(shown[k])).collect();
        let count = colors.len().max(1) as f64;
        let mean = colors.iter().sum::<f64>() / count;
        (colors.iter().map(|color| (color - mean).powi(2)).sum::<f64>() / count).sqrt()
    };
    Ok((0..FOLLOWED).map(deviation).sum::<f64>() / FOLLOWED as f64)
}

/// 0 to 255.
fn color(place: DVec2) -> f64 {
    127.5 + 127.5 * (TAU * place.x / WAVE).sin() * (TAU * place.y / WAVE).cos()
}
