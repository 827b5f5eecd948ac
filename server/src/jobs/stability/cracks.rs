//! Closed meshes seen from within.

use super::{
    images,
    judge::Rule,
    lab::Lab,
    meshes::{self, Sheet},
    row::{Asset, Row, curve},
};
use crate::domain::{
    Result,
    image::RenderMesh,
    request::{Geometry, SeamRule},
    stability::{Curve, Worse},
};

pub(super) const ROW: Row = Row {
    name: "cracks",
    family: "seam cracks",
    title: "Cracks at seams",
    story: "Where vertices of one place have several normals or texture coordinates, each may move its own way, and the surface opens: \
            through hard edges at once, through seams of the map where its sides disagree. From within a closed mesh every crack is \
            a pixel of the magenta behind it. Noise is the harshest map: no two neighbours agree.",
    asset: Asset::Made("cube, sphere and torus, displaced outwards by noise of 64 x 64 texels, seen from within"),
    parameter: ["height", "of the radius"],
    metric: ["pixels with a crack", "px"],
    line: 0.0,
    worse: Worse::Upwards,
    literature: &[
        (
            "displacement, mean of sides",
            "none: one position for each place, as zippering has it in maps (Sander et al. 2003)",
        ),
        ("displacement, dominant side", "none: the side of one edge decides (PN-AEN, McDonald and Kilgard 2010)"),
        ("displacement, no ramp", "none: the seam alone is averaged"),
        ("each face by its own normals", "opens at hard edges at once (Cook 1984 leaves it to the modeller)"),
    ],
    run,
};

const HEIGHTS: [f64; 5] = [0.0, 0.02, 0.05, 0.1, 0.3];
const LEVEL: u32 = 3;
const SIDE: u32 = 128;

fn run(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    let shared = |rule, feather_texels| Geometry { seams: rule, feather_texels, ..meshes::uniform(LEVEL) };
    let sheets = [
        ("cube", meshes::cube(), [0.0; 3]),
        ("sphere", meshes::sphere([24, 12], false), [0.0; 3]),
        ("torus", meshes::torus([24, 12]), [1.0, 0.0, 0.0]),
    ];
    let mut curves = Vec::new();
    for (method, geometry) in [
        ("displacement, mean of sides", shared(SeamRule::Mean, 3.0)),
        ("displacement, dominant side", shared(SeamRule::Dominant, 3.0)),
        ("displacement, no ramp", shared(SeamRule::Mean, 0.0)),
    ] {
        let one = |height: f64| {
            let mut pixels = 0;
            for (name, sheet, eye) in &sheets {
                let mesh = moved(lab, name, sheet, height, &geometry)?;
                let cracks = cracks(lab, vec![mesh], *eye)?;
                let fault = (cracks > 0).then(|| format!("{cracks} pixels of the {name}, {method}, height {height}"));
                lab.note(Rule::NoCrack, fault);
                pixels += cracks;
            }
            Ok([height, pixels as f64])
        };
        curves.push(curve(method, HEIGHTS.into_iter().map(one).collect::<Result<_>>()?));
    }
    let apart = |height: f64| {
        let faces = meshes::cube_faces();
        let meshes = faces.iter().map(|face| moved(lab, "a face", face, height, &shared(SeamRule::Mean, 3.0)));
        Ok([height, cracks(lab, meshes.collect::<Result<_>>()?, [0.0; 3])? as f64])
    };
    curves.push(curve("each face by its own normals", HEIGHTS.into_iter().map(apart).collect::<Result<_>>()?));
    Ok(curves)
}

fn moved(lab: &Lab<'_>, name: &str, sheet: &Sheet, height: f64, geometry: &Geometry) -> Result<RenderMesh> {
    let mesh = sheet.welded(name)?;
    let detail = meshes::heights(&meshes::noise(64, 1), height as f32);
    Ok(images::shown(&mesh, &lab.displaced(&mesh, &detail, geometry)?))
}

/// Pixels with a crack, from a place within.
fn cracks(lab: &Lab<'_>, meshes: Vec<RenderMesh>, eye: [f32; 3]) -> Result<usize> {
    let target = [eye[0] + 0.1, eye[1] + 0.05, eye[2] - 1.0];
    let camera = images::camera(eye, target, 130.0, [SIDE; 2])?;
    let image = lab.shot(&images::scene(meshes, camera), [SIDE; 2])?;
    Ok(images::magenta_pixels(&image.color))
}
