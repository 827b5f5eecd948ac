//! Surfaces that reach far beyond their base.

use displace_glsl::methods::Method;
use glam::DVec3;
use rayon::prelude::*;

use super::{
    images,
    lab::Lab,
    meshes, outlines,
    row::{Asset, Row, curve},
};
use crate::{
    domain::{
        Result,
        detail::Wrap,
        image::{ImageSet, ReliefSettings, Silhouettes},
        stability::{Curve, Worse},
        surface::Surface,
    },
    oracle::{bvh::Segment, ray::Tracer},
};

pub(super) const ROW: Row = Row {
    name: "bounds",
    family: "displaced bounds culling",
    title: "Surfaces that reach beyond their base",
    story: "Whatever is left out of an image because the base's box or triangle does not reach there is missing where the displaced surface does. Triangles are \
            binned after they moved, and prisms are as high as the heights; without silhouettes all that stands out is cut. Against rays in f64, at \
            pixels whose neighbours, two around, are covered too.",
    asset: Asset::Made("a sphere of radius 1 under hills, at 128 x 128 pixels"),
    parameter: ["height", "of the radius"],
    metric: ["pixels missing of those the surface covers", "%"],
    line: 0.1,
    worse: Worse::Upwards,
    literature: &[
        ("displacement", "none: bounds are of what moved"),
        ("exact, base outline", "all beyond the base (Oliveira and Policarpo 2005)"),
        ("exact, shell", "none: prisms hold all heights (Porumbescu et al. 2005)"),
        ("exact, quadric", "where the surface is no quadric (Oliveira and Policarpo 2005)"),
    ],
    run,
};

const HEIGHTS: [f64; 6] = [0.02, 0.05, 0.1, 0.2, 0.5, 1.0];
const SIDE: u32 = 128;
const FOV_DEGREES: f32 = 40.0;
const SEGMENTS: [u32; 2] = [32, 16];
const LEVEL: u32 = 3;
/// From the middle, in radii of base and height together.
const AWAY: f64 = 3.6;

fn run(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    let names = ["displacement", "exact, base outline", "exact, shell", "exact, quadric"];
    let mut curves = names.map(|name| curve(name, Vec::new()));
    let sheet = meshes::sphere(SEGMENTS, false);
    let mesh = sheet.welded("sphere")?;
    let wave = |x: u32| (f64::from(x) + 0.5) / 64.0 * std::f64::consts::TAU;
    let map = meshes::height_map([64; 2], Wrap::Repeat, |x, y| {
        (0.5 + 0.5 * (4.0 * wave(x)).sin() * (2.0 * wave(y)).sin()) as f32
    });
    for height in HEIGHTS {
        let detail = meshes::heights(&map, height as f32);
        let surface = lab.displaced(&mesh, &detail, &meshes::uniform(LEVEL))?;
        let eye = DVec3::new(0.5, 0.6, 0.8).normalize() * AWAY * (1.0 + height);
        let truth = inner(&covered_by_rays(&surface, eye));
        let camera = images::camera(eye.as_vec3().to_array(), [0.0; 3], FOV_DEGREES, [SIDE; 2])?;
        let moved = images::scene(vec![images::shown(&mesh, &surface)], camera);
        let in_relief = |silhouettes: Silhouettes| {
            let mut scene = images::scene(vec![outlines::base(&sheet)], camera);
            scene.materials = vec![outlines::material(&map, (height as f32, 8.0), 0)];
            scene.relief = ReliefSettings { method: Method::Exact, silhouettes, ..ReliefSettings::default() };
            scene
        };
        let scenes =
            [moved, in_relief(Silhouettes::None), in_relief(Silhouettes::Shell), in_relief(Silhouettes::Quadric)];
        for (curve, scene) in curves.iter_mut().zip(&scenes) {
            curve.values.push([height, missing_percent(&truth, &lab.shot(scene, [SIDE; 2])?)]);
        }
    }
    Ok(curves.into())
}

/// By a ray through the middle of each pixel, towards the origin.
fn covered_by_rays(surface: &Surface, eye: DVec3) -> Vec<bool> {
    let positions = surface.positions.iter().map(|p| DVec3::from_array(p.map(f64::from))).collect();
    let tracer = Tracer::new(positions, surface.triangles.clone());
    let ahead = -eye.normalize();
    let right = ahead.cross(DVec3::Y).normalize();
    let up = right.cross(ahead);
    let reach = (0.5 * f64::from(FOV_DEGREES)).to_radians().tan();
    let at = |k: u32| 2.0 * (f64::from(k) + 0.5) / f64::from(SIDE) - 1.0;
    let covers = |k: u32| {
        let direction = ahead + reach * (at(k % SIDE) * right - at(k / SIDE) * up);
        tracer.any_hit(&Segment { origin: eye, direction, from: 0.0, to: 1e3 })
    };
    (0..SIDE * SIDE).into_par_iter().map(covers).collect()
}

/// Those whose neighbours, two around, are covered too: no edge runs near them.
fn inner(covered: &[bool]) -> Vec<bool> {
    let at = |x: i64, y: i64| {
        let side = i64::from(SIDE);
        (0..side).contains(&x) && (0..side).contains(&y) && covered[(y * side + x) as usize]
    };
    let is_inner = |k: i64| {
        let (x, y) = (k % i64::from(SIDE), k / i64::from(SIDE));
        (-2..=2).all(|dy| (-2..=2).all(|dx| at(x + dx, y + dy)))
    };
    (0..i64::from(SIDE * SIDE)).map(is_inner).collect()
}

fn missing_percent(truth: &[bool], image: &ImageSet) -> f64 {
    let shows = |k: usize| image.color[k][1] > 0.25;
    let missing = (0..truth.len()).filter(|k| truth[*k] && !shows(*k)).count();
    100.0 * missing as f64 / truth.iter().filter(|covered| **covered).count().max(1) as f64
}
