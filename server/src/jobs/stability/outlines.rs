//! Posts against the sky, on the device.

use std::sync::Arc;

use displace_glsl::methods::Method;

use super::{
    images,
    lab::Lab,
    meshes::{self, Sheet},
    row::{Asset, Row, curve},
    sweep::STEPS,
};
use crate::{
    domain::{
        Error, Result,
        detail::{Map, Wrap},
        image::{HeightMap, ReliefSettings, RenderCamera, RenderMaterial, RenderMesh, RenderRelief, Silhouettes},
        stability::{Curve, Worse},
    },
    oracle::metrics::{picture::Picture, silhouette::xor_px},
};

pub(super) const ROW: Row = Row {
    name: "outlines",
    family: "thin posts and slots",
    title: "Posts against the sky",
    story: "What is shown within the base's own triangles cannot stand out beyond them: without silhouettes posts at the horizon are cut off. \
            With them rays are followed through prisms above the base, and what is left is what the march misses. Device images against \
            as many triangles as the map has half texels; some pixels of every edge are on one side of it alone.",
    asset: Asset::Made("posts 8 texels high, 16 apart, on a plane of 64 texels, seen along it at 128 x 128 pixels"),
    parameter: ["width", "texels"],
    metric: ["pixels inside one outline alone", "px"],
    line: 100.0,
    worse: Worse::Downwards,
    literature: &[
        ("exact", "the base's outline (Oliveira and Policarpo 2005 name it as what relief lacks)"),
        ("exact, shell", "the surface's (Porumbescu et al. 2005)"),
        ("relief, shell", "less what 16 steps pass over (Policarpo et al. 2005)"),
        ("cone, shell", "less what cones are too short for (Policarpo and Oliveira 2007)"),
    ],
    run,
};

const WIDTHS: [f64; 4] = [1.0, 2.0, 4.0, 8.0];
const SIDE: u32 = 128;
const TEXELS: u32 = 64;
/// Eight texels.
const HIGH: f32 = 0.125;
/// Half a texel.
const TRUTH_LEVEL: u32 = 7;

fn run(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    let camera = images::camera([0.05, 0.17, 0.95], [0.0, 0.07, 0.0], 45.0, [SIDE; 2])?;
    let mut curves = [
        ("exact", Method::Exact, Silhouettes::None),
        ("exact, shell", Method::Exact, Silhouettes::Shell),
        ("relief, shell", Method::Relief, Silhouettes::Shell),
        ("cone, shell", Method::Cone, Silhouettes::Shell),
    ]
    .map(|(name, method, silhouettes)| (curve(name, Vec::new()), method, silhouettes));
    for width in WIDTHS {
        let map = posts(width);
        let truth = truth(lab, &map, camera)?;
        for (curve, method, silhouettes) in &mut curves {
            let shown = in_relief(lab, (&map, width), (*method, *silhouettes), camera)?;
            let apart = xor_px(&truth, &shown).ok_or_else(|| Error::internal("an image without depth"))?;
            curve.values.push([width, apart as f64]);
        }
    }
    Ok(curves.map(|(curve, ..)| curve).into())
}

fn posts(width: f64) -> Arc<Map> {
    let covered =
        |texel: u32| (width - f64::from(texel % 16) + 4.0).clamp(0.0, 1.0) * f64::from(u8::from(texel % 16 >= 4));
    meshes::height_map([TEXELS; 2], Wrap::Clamp, |x, y| covered(x).min(covered(y)) as f32)
}

fn truth(lab: &Lab<'_>, map: &Arc<Map>, camera: RenderCamera) -> Result<Picture> {
    let mesh = meshes::plane(1).welded("plane")?;
    let surface = lab.displaced(&mesh, &meshes::heights(map, HIGH), &meshes::uniform(TRUTH_LEVEL))?;
    let image = lab.shot(&images::scene(vec![images::shown(&mesh, &surface)], camera), [SIDE; 2])?;
    Picture::of_images("truth", &image)
}

fn in_relief(
    lab: &Lab<'_>,
    (map, width): (&Arc<Map>, f64),
    (method, silhouettes): (Method, Silhouettes),
    camera: RenderCamera,
) -> Result<Picture> {
    let mut scene = images::scene(vec![base(&meshes::plane(1))], camera);
    let steps = if method == Method::Exact { 0 } else { STEPS };
    scene.materials = vec![material(map, (HIGH, width), steps)];
    scene.relief = ReliefSettings { method, silhouettes, ..ReliefSettings::default() };
    Picture::of_images("image", &lab.shot(&scene, [SIDE; 2])?)
}

/// The sheet itself, with the directions that outlines need.
pub(super) fn base(sheet: &Sheet) -> RenderMesh {
    RenderMesh {
        positions: Arc::new(sheet.positions.clone()),
        normals: Arc::new(sheet.normals.clone()),
        directions: Arc::new(sheet.normals.clone()),
        uvs: Arc::new(sheet.uvs.clone()),
        triangles: Arc::new(sheet.triangles.clone()),
        material_of_triangles: vec![(0, 0)],
        ..RenderMesh::default()
    }
}

/// Grey, with heights.
pub(super) fn material(map: &Arc<Map>, (scale, thinnest_texels): (f32, f64), steps: u32) -> RenderMaterial {
    let heights = HeightMap {
        width: map.width,
        height: map.height,
        heights: map.texels.iter().map(|value| scale * value).collect(),
        repeats: map.wrap.map(|wrap| wrap == Wrap::Repeat),
        thinnest_texels: thinnest_texels.max(1.0) as f32,
    };
    let map_from_uv = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    RenderMaterial {
        relief: Some(RenderRelief { map: Arc::new(heights), uv_channel: 0, map_from_uv, steps }),
        ..images::grey()
    }
}
