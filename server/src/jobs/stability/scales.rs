//! Nodes that stretch, mirror, shrink and enlarge.

use std::sync::Arc;

use glam::{DMat3, DVec3, Vec3};

use super::{
    images,
    judge::Rule,
    lab::Lab,
    rays,
    row::{Asset, Row, curve},
};
use crate::domain::{
    Error, ErrorKind, Result,
    detail::{Detail, Layer, LayerSource},
    image::{ImageSet, RenderMesh},
    mesh::Mesh,
    plan::SurfacePlan,
    request::Aov,
    stability::{Curve, Worse},
    surface::Surface,
};

pub(super) const STRETCHED: Row = Row {
    name: "stretched",
    family: "scale",
    title: "Nodes that stretch one way",
    story: "Under a node that stretches z alone, points go by its matrix and normals by the transpose of its inverse: going by the matrix they lean the wrong \
            way, by up to the stretch itself. The displaced mesh is drawn under the node, and against it with the node worked into \
            its vertices. A mirroring node is asked for the same pixels besides.",
    asset: Asset::OwnSurface,
    parameter: ["scale of z", ""],
    metric: ["normal off by, 99th percentile of pixels", "degrees"],
    line: 1.0,
    worse: Worse::Upwards,
    literature: &[
        ("displacement", "none: the inverse transpose (Turkowski 1990)"),
        ("normals by the matrix itself", "off by up to atan s \u{2212} atan 1/s (Turkowski 1990)"),
    ],
    run: stretched,
};

pub(super) const UNITS: Row = Row {
    name: "units",
    family: "huge and small units",
    title: "Units from a tenth of a millimetre to a hundred kilometres",
    story: "A mesh in other units is the same mesh: positions and heights are multiplied alike, and the result should be, to the rounding of its \
            numbers. Any length written into the code, such as an epsilon in metres, shows as an error that grows one way.",
    asset: Asset::OwnSurface,
    parameter: ["units to a unit of the file", ""],
    metric: ["largest distance to the scaled result", "of the diagonal"],
    line: 2e-6,
    worse: Worse::Upwards,
    literature: &[("displacement", "none; fixed epsilons are the usual fault (Ericson 2005, chapter 11)")],
    run: units,
};

const SCALES: [f32; 6] = [1.0, 1.25, 1.5, 2.0, 4.0, 8.0];
const UNITS_SWEPT: [f64; 10] = [1e-4, 1e-3, 1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3, 1e4, 1e5];
const SIDE: u32 = 96;
/// Of the surface that is asked, at most.
const MOST_TRIANGLES: u64 = 30_000;

/// The first mesh, displaced as finely as stays small.
fn surface(lab: &Lab<'_>, mesh: &Mesh, details: &[Option<Arc<Detail>>]) -> Result<Surface> {
    let base = mesh.triangles.len() as u64;
    let Some(level) = (0..=5).rev().find(|level| base << (2 * level) <= MOST_TRIANGLES) else {
        let message =
            format!("the first mesh has {base} triangles; at most {MOST_TRIANGLES} are asked: take a coarser mesh");
        return Err(Error::new(ErrorKind::TooLarge, message));
    };
    lab.planned(mesh, details, &SurfacePlan::uniform(0, mesh, level, &super::meshes::uniform(level))?)
}

fn first<'l>(lab: &'l Lab<'_>) -> Result<(&'l Mesh, &'l [Option<Arc<Detail>>])> {
    let inputs = &lab.own.inputs;
    let mesh = inputs.scene.meshes.first().ok_or_else(|| Error::new(ErrorKind::Unsupported, "the file has no mesh"))?;
    Ok((&mesh.mesh, &inputs.details[0]))
}

fn stretched(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    let (mesh, details) = first(lab)?;
    let surface = surface(lab, mesh, details)?;
    let shown = images::shown(mesh, &surface);
    let (mut right, mut naive) = (Vec::new(), Vec::new());
    for scale in SCALES {
        let by = [1.0, 1.0, scale];
        let by_node = shot(lab, shown.clone(), by)?;
        let [truth, by_matrix] = [true, false].map(|rightly| shot(lab, worked_in(&shown, by, rightly), [1.0; 3]));
        let truth = truth?;
        right.push([scale.into(), off_degrees(&truth, &by_node)]);
        naive.push([scale.into(), off_degrees(&truth, &by_matrix?)]);
        mirrored(lab, &shown, scale)?;
    }
    Ok(vec![curve("displacement", right), curve("normals by the matrix itself", naive)])
}

/// The node turns triangles over, and the renderer turns them back.
fn mirrored(lab: &Lab<'_>, shown: &RenderMesh, scale: f32) -> Result<()> {
    let by = [-1.0, 1.0, scale];
    let by_node = shot(lab, shown.clone(), by)?;
    let mut turned = worked_in(shown, by, true);
    Arc::make_mut(&mut turned.triangles).iter_mut().for_each(|triangle| triangle.swap(1, 2));
    let worked_in = shot(lab, turned, [1.0; 3])?;
    let covers = |image: &ImageSet, k: usize| image.depth.as_ref().is_some_and(|depth| depth[k].is_finite());
    let apart = (0..by_node.color.len()).filter(|k| covers(&by_node, *k) != covers(&worked_in, *k)).count();
    // Of points that are rounded before and after the node, some on edges.
    let fault = (apart > SIDE as usize / 8).then(|| format!("{apart} pixels under a mirroring node, scale {scale}"));
    lab.note(Rule::NoCrack, fault);
    Ok(())
}

/// A mesh under a scaling node.
fn shot(lab: &Lab<'_>, mesh: RenderMesh, by: [f32; 3]) -> Result<ImageSet> {
    let places = mesh.positions.iter().map(|p| Vec3::from(*p) * Vec3::from(by));
    let nothing = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let (low, high) = places.fold(nothing, |(low, high), p| (low.min(p), high.max(p)));
    let (middle, radius) = (0.5 * (low + high), 0.5 * (high - low).length());
    let eye = middle + Vec3::new(0.6, 0.9, 1.0).normalize() * 2.6 * radius;
    let camera = images::camera(eye.to_array(), middle.to_array(), 40.0, [SIDE; 2])?;
    let mut scene = images::scene(vec![mesh], camera);
    for (axis, scale) in by.into_iter().enumerate() {
        scene.instances[0].world_from_mesh[5 * axis] = scale;
    }
    scene.materials[0].double_sided = false;
    scene.aovs.push(Aov::Normal);
    lab.shot(&scene, [SIDE; 2])
}

/// Scaled in its vertices; normals by the inverse transpose, or wrongly by the matrix itself. Their lengths stay as they
/// come out, so that between vertices they blend as under a node.
fn worked_in(mesh: &RenderMesh, by: [f32; 3], rightly: bool) -> RenderMesh {
    let matrix = DMat3::from_diagonal(DVec3::from_array(by.map(f64::from)));
    let of_normals = if rightly { matrix.inverse().transpose() } else { matrix };
    let moved = |p: &[f32; 3]| (Vec3::from(*p) * Vec3::from(by)).to_array();
    let turned = |n: &[f32; 3]| (of_normals * DVec3::from_array(n.map(f64::from))).as_vec3().to_array();
    RenderMesh {
        positions: Arc::new(mesh.positions.iter().map(moved).collect()),
        normals: Arc::new(mesh.normals.iter().map(turned).collect()),
        ..mesh.clone()
    }
}

/// Over pixels that both cover.
fn off_degrees(a: &ImageSet, b: &ImageSet) -> f64 {
    let (Some(a), Some(b)) = (&a.normal, &b.normal) else { return f64::NAN };
    let wide = |n: &[f32; 3]| DVec3::from_array(n.map(f64::from));
    let pairs = a.iter().zip(b).map(|(a, b)| (wide(a), wide(b)));
    let both = pairs.filter(|(a, b)| a.length_squared() > 0.25 && b.length_squared() > 0.25);
    let angles = both.map(|(a, b)| a.cross(b).length().atan2(a.dot(b)).to_degrees());
    rays::percentile(angles.filter(|angle| !angle.is_nan()).collect(), 0.99)
}

fn units(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    let (mesh, details) = first(lab)?;
    let truth = surface(lab, mesh, details)?;
    let wide = |p: &[f32; 3]| DVec3::from_array(p.map(f64::from));
    let nothing = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (low, high) = truth.positions.iter().map(wide).fold(nothing, |(low, high), p| (low.min(p), high.max(p)));
    let diagonal = (high - low).length();
    let is_formula = |layer: &Layer| matches!(layer.source, LayerSource::Expression(_));
    if details.iter().flatten().any(|detail| detail.layers.iter().any(is_formula)) {
        return Err(Error::new(ErrorKind::Unsupported, "a formula of x, y and z has units of its own: give a map"));
    }
    let one = |unit: f64| {
        let (mesh, details) = in_units(mesh, details, unit as f32);
        let scaled = surface(lab, &mesh, &details)?;
        let pairs = truth.positions.iter().zip(&scaled.positions);
        let farthest = pairs.map(|(p, q)| wide(p).distance(wide(q) / f64::from(unit as f32))).fold(0.0, f64::max);
        Ok([unit, farthest / diagonal])
    };
    Ok(vec![curve("displacement", UNITS_SWEPT.into_iter().map(one).collect::<Result<_>>()?)])
}

fn in_units(mesh: &Mesh, details: &[Option<Arc<Detail>>], unit: f32) -> (Mesh, Vec<Option<Arc<Detail>>>) {
    let mut mesh = mesh.clone();
    mesh.gv_position.iter_mut().flatten().for_each(|x| *x *= unit);
    let scaled = |detail: &Arc<Detail>| {
        let mut detail = Detail::clone(detail);
        detail.layers.iter_mut().for_each(|layer| layer.scale *= unit);
        Arc::new(detail)
    };
    (mesh, details.iter().map(|detail| detail.as_ref().map(scaled)).collect())
}
