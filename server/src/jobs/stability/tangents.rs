//! Texture coordinates that give no frame.

use std::{f64::consts::TAU, sync::Arc};

use glam::DVec3;

use super::{
    judge::Rule,
    lab::Lab,
    meshes::{self, Sheet},
    row::{Asset, Row, curve},
};
use crate::{
    domain::{
        Result,
        detail::{Detail, LayerSource, Map, Sampling, Wrap},
        mesh::Mesh,
        request::Geometry,
        stability::{Curve, Worse},
        surface::{Place, Surface},
        weld::{PrimitiveInput, VertexAttribute, weld, with_tangents},
    },
    oracle::{self, surface::SeamChoice},
};

pub(super) const ROW: Row = Row {
    name: "tangents",
    family: "mirrored UV, zero-area UV, pole, NaN tangents",
    title: "Texture coordinates that collapse",
    story: "A frame on the surface comes from its texture coordinates, and where these have no area, at poles and in squeezed or mirrored charts, there is \
            none: tangents divide by nothing. The map is squeezed along u until it has no area at all. What moves along the normal needs no \
            frame; vectors need one, and may lose their direction but not become no number.",
    asset: Asset::Made("a sphere with poles under smooth waves, its map squeezed along u"),
    parameter: ["width of the map", "of its length"],
    metric: ["normal off by, 99th percentile", "degrees"],
    line: 1.0,
    worse: Worse::Downwards,
    literature: &[
        ("displacement", "none: N + gradients need no tangents (Mikkelsen 2010)"),
        ("displacement, mirrored", "none: the determinant's sign cancels (Mikkelsen 2010)"),
        ("vector", "frames are those of neighbours where the determinant is 0 (MikkTSpace, Mikkelsen 2008)"),
    ],
    run,
};

const WIDTHS: [f64; 8] = [0.0, 1e-7, 1e-6, 1e-5, 1e-4, 1e-2, 0.1, 1.0];
const LEVEL: u32 = 2;

fn run(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    nan_tangents(lab)?;
    let heights = meshes::heights(&waves(1), 0.05);
    let vectors = meshes::detail(LayerSource::VectorTangent(waves(3)), 0.05);
    [("displacement", false, &heights), ("displacement, mirrored", true, &heights), ("vector", false, &vectors)]
        .into_iter()
        .map(|(name, mirrored, detail)| {
            let one = |width: f64| {
                let mesh = squeezed(mirrored, width).welded("sphere")?;
                let mesh = if name == "vector" { with_tangents(&mesh, |_| Some(0))? } else { mesh };
                Ok([width, worst_degrees(lab, &mesh, detail)?])
            };
            Ok(curve(name, WIDTHS.into_iter().map(one).collect::<Result<_>>()?))
        })
        .collect()
}

fn squeezed(mirrored: bool, width: f64) -> Sheet {
    let mut sheet = meshes::sphere([24, 12], mirrored);
    sheet.uvs.iter_mut().for_each(|uv| uv[0] *= width as f32);
    sheet
}

/// Smooth, repeated; of vectors the heights are the last.
fn waves(channels: u32) -> Arc<Map> {
    let turn = |k: u32| TAU * (f64::from(k) + 0.5) / 64.0;
    let height = |x: u32, y: u32| (0.5 + 0.5 * turn(x).sin() * (2.0 * turn(y)).cos()) as f32;
    let texel = |k: u32| {
        let height = height(k % 64, k / 64);
        (0..channels).map(move |channel| if channel + 1 == channels { height } else { 0.0 })
    };
    let texels: Vec<f32> = (0..64 * 64).flat_map(texel).collect();
    let (wrap, sampling) = ([Wrap::Repeat; 2], Sampling::Center);
    Arc::new(Map { width: 64, height: 64, channels, texels: texels.into(), wrap, sampling, source_bits: 32 })
}

/// Of vertices within base triangles, against the surface's own normals in f64.
fn worst_degrees(lab: &Lab<'_>, mesh: &Mesh, detail: &Arc<Detail>) -> Result<f64> {
    let geometry = meshes::uniform(LEVEL);
    let surface = lab.displaced(mesh, detail, &geometry)?;
    let truth = oracle::surface::Surface::new(mesh, &[Some(Arc::clone(detail))], choice(&geometry));
    let angles = (0..surface.positions.len()).filter_map(|vertex| degrees_off(mesh, &surface, &truth, vertex));
    Ok(super::rays::percentile(angles.collect(), 0.99))
}

fn choice(geometry: &Geometry) -> SeamChoice {
    geometry.into()
}

fn degrees_off(mesh: &Mesh, surface: &Surface, truth: &oracle::surface::Surface<'_>, vertex: usize) -> Option<f64> {
    let place = surface.layout.place(mesh, vertex);
    let Place::Inside { triangle, .. } = place else { return None };
    let units = DVec3::from_array(place.within(mesh, triangle as usize)?.map(f64::from));
    let (_, expected) = truth.position_and_normal(triangle as usize, units / units.element_sum());
    let normal = DVec3::from_array(surface.normals[vertex].map(f64::from));
    Some(normal.cross(expected).length().atan2(normal.dot(expected)).to_degrees())
}

/// Tangents that are no numbers are refused by name, or do not reach a result.
fn nan_tangents(lab: &Lab<'_>) -> Result<()> {
    let sheet = meshes::sphere([12, 6], false);
    let primitive = PrimitiveInput {
        tangents: Some(vec![[f32::NAN, 0.0, 0.0, 1.0]; sheet.positions.len()]),
        positions: sheet.positions,
        normals: Some(sheet.normals),
        attributes: vec![VertexAttribute {
            semantic: "TEXCOORD_0".into(),
            components: 2,
            values: sheet.uvs.into_iter().flatten().collect(),
        }],
        triangles: sheet.triangles,
        ..PrimitiveInput::default()
    };
    let made = weld("NaN tangents", &[primitive]).and_then(|mesh| with_tangents(&mesh, |_| Some(0)));
    match made {
        Ok(mesh) => {
            let vectors = meshes::detail(LayerSource::VectorTangent(waves(3)), 0.05);
            let _ = lab.displaced(&mesh, &vectors, &meshes::uniform(1))?;
        }
        Err(_) => lab.note(Rule::Finite, None),
    }
    Ok(())
}
