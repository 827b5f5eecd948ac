//! The same on the device: images from ever flatter views.

use displace_glsl::methods::Method;

use super::{
    images,
    lab::Lab,
    meshes, outlines,
    row::{Asset, Row, curve},
    sweep::STEPS,
};
use crate::{
    domain::{
        Result,
        detail::Wrap,
        image::ReliefSettings,
        stability::{Curve, Worse},
    },
    oracle::metrics::{hit::hit_error, picture::Picture},
};

pub(super) const ROW: Row = Row {
    name: "grazing-images",
    family: "grazing sweep",
    title: "Grazing views on the device",
    story: "Images of the device, from ever flatter views, against as many triangles as the map has half texels. What counts is how far apart the places are \
            that both show at a pixel, as long as they look face-on. Even steps make the same errors here as the f64 twins; what exact is off \
            by is where a pixel sees past a rim in one image alone.",
    asset: Asset::Made("hills 4 texels high on a plane of 64 texels, at 128 x 128 pixels"),
    parameter: ["angle from the normal", "degrees"],
    metric: ["hit error, mean of pixels", "px"],
    line: 1.0,
    worse: Worse::Upwards,
    literature: &[
        ("flat", "off by H / cos \u{3b8} along the ray"),
        ("steep", "more steps the flatter the view (McGuire and McGuire 2005)"),
        ("occlusion", "8 to 50 steps by angle (Tatarchuk 2006)"),
        ("relief", "32 steps of a halving less (Policarpo et al. 2005)"),
        ("cone", "slower at flat rays (Policarpo and Oliveira 2007)"),
        ("exact", "no angle (Tevs, Ihrke and Seidel 2008)"),
    ],
    run,
};

const DEGREES: [f64; 7] = [0.0, 20.0, 40.0, 60.0, 70.0, 78.0, 84.0];
const METHODS: [Method; 6] =
    [Method::Flat, Method::Steep, Method::Occlusion, Method::Relief, Method::Cone, Method::Exact];
const SIDE: u32 = 128;
const TEXELS: u32 = 64;
/// Four texels.
const HIGH: f32 = 0.0625;
const TRUTH_LEVEL: u32 = 7;
const AWAY: f64 = 1.6;
const FOV_DEGREES: f32 = 32.0;

fn run(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    let wave = |x: u32| ((f64::from(x) + 0.5) / 32.0 * std::f64::consts::TAU).sin();
    let map = meshes::height_map([TEXELS; 2], Wrap::Clamp, |x, y| (0.25 * (wave(x) + wave(y)) - 0.5) as f32);
    let sheet = meshes::plane(1);
    let mesh = sheet.welded("plane")?;
    let truth = lab.displaced(&mesh, &meshes::heights(&map, HIGH), &meshes::uniform(TRUTH_LEVEL))?;
    let truth = images::shown(&mesh, &truth);
    let mut curves = METHODS.map(|method| curve(method.name(), Vec::new()));
    for degrees in DEGREES {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let eye = [0.15 * AWAY * sin, AWAY * cos, AWAY * sin].map(|x| x as f32);
        let camera = images::camera([eye[0], eye[1], eye[2] + 1e-3], [0.0; 3], FOV_DEGREES, [SIDE; 2])?;
        let expected = lab.shot(&images::scene(vec![truth.clone()], camera), [SIDE; 2])?;
        let expected = Picture::of_images("truth", &expected)?;
        for (curve, method) in curves.iter_mut().zip(METHODS) {
            let mut scene = images::scene(vec![outlines::base(&sheet)], camera);
            if method != Method::Flat {
                let steps = if method == Method::Exact { 0 } else { STEPS };
                scene.materials = vec![outlines::material(&map, (HIGH, 8.0), steps)];
                scene.relief = ReliefSettings { method, ..ReliefSettings::default() };
            }
            let shown = Picture::of_images("image", &lab.shot(&scene, [SIDE; 2])?)?;
            let off = hit_error(&expected, &shown).map_or(f64::NAN, |error| error.mean);
            curve.values.push([degrees, off]);
        }
    }
    Ok(curves.into())
}
