//! Sides of an edge that are not equally fine, and what meets without sharing vertices.

use std::sync::Arc;

use super::{
    judge::Rule,
    lab::Lab,
    meshes::{self, Sheet},
    row::{Asset, Row, curve},
};
use crate::{
    domain::{
        Result,
        detail::{Detail, Map, Wrap},
        mesh::Mesh,
        plan::SurfacePlan,
        request::{Allowed, ErrorAt, Geometry, Quality, Refinement, Tolerance},
        scene::{Instance, Scene, SceneMesh},
        stability::{Curve, Worse},
        surface::Surface,
    },
    jobs::fits,
    oracle::invariants,
};

pub(super) const FACTORS: Row = Row {
    name: "edge-factors",
    family: "edge factors",
    title: "Sides of an edge that are not equally fine",
    story: "Where one side of an edge is cut into more pieces than the other, its vertices in between leave the straight line that the other side draws, and the \
            surface opens. A tolerance makes the rough half finer than the smooth one, up to 64 pieces to one; vertices belong to edges, so both \
            sides have the same. Two halves that are cut by themselves open by most of the height.",
    asset: Asset::Made("a square whose right half is rough, in ever more cells"),
    parameter: ["pieces on one side for each on the other", ""],
    metric: ["widest gap along the edge", "% of the height"],
    line: 0.0,
    worse: Worse::Upwards,
    literature: &[
        ("displacement", "none: split decisions of shared edges (Fisher et al. 2009, DiagSplit)"),
        ("each half by itself", "opens wherever factors differ (Moreton 2001)"),
    ],
    run: factors,
};

pub(super) const JUNCTIONS: Row = Row {
    name: "junctions",
    family: "non-manifold, T-junction, duplicated vertices",
    title: "Meshes that meet without sharing",
    story: "Files repeat vertices, let many sheets end in one edge, and put vertices of one side on edges of the other. Equal places are one place, however \
            often they are repeated, and all sheets of an edge share its vertices. A vertex on another's edge shares nothing with it: such T-junctions \
            open, and only mending the mesh helps.",
    asset: Asset::Made("two sheets that meet in an edge, under noise of 64 x 64 texels"),
    parameter: ["faults along the edge", ""],
    metric: ["widest gap along the edge", "% of the height"],
    line: 0.0,
    worse: Worse::Upwards,
    literature: &[
        ("repeated vertices", "none: welded by position"),
        ("more sheets in the edge", "none: an edge of many triangles is still one edge"),
        ("T-junctions", "open from the first: no tessellation closes them (Moreton 2001; OpenSubdiv refuses them)"),
    ],
    run: junctions,
};

const CELLS: [u32; 7] = [1, 2, 4, 8, 16, 32, 64];
const FAULTS: [u32; 6] = [0, 1, 2, 4, 8, 16];
const HEIGHT: f32 = 0.1;
const LEVEL: u32 = 3;
/// Of the diagonal.
const TOLERANCE: f64 = 2e-4;
const MOST_TRIANGLES: u64 = 60_000;

/// Two halves of a square that meet at x = 0, of so many segments along the edge each.
fn halves([left, right]: [u32; 2]) -> [Sheet; 2] {
    let half = |start: f64, segments: u32| {
        Sheet::grid([1, segments], move |u, v| {
            let x = start + 0.5 * u;
            ([x, 0.0, 0.5 - v], [0.0, 1.0, 0.0], [x + 0.5, 1.0 - v])
        })
    };
    [half(-0.5, left), half(0.0, right)]
}

fn factors(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    let (mut shared, mut apart) = (Vec::new(), Vec::new());
    let [left, right] = halves([1, 1]);
    let square = left.clone().with(&right).welded("square")?;
    for cells in CELLS {
        let detail = meshes::heights(&rough(cells), HEIGHT);
        let surface = within(lab, &square, &detail)?;
        shared.push([f64::from(cells), 100.0 * gap(&along([&surface])) / f64::from(HEIGHT)]);
        let alone = |sheet: &Sheet, level: u32| lab.displaced(&sheet.welded("half")?, &detail, &meshes::uniform(level));
        let both = [alone(&left, 0)?, alone(&right, cells.ilog2())?];
        apart.push([f64::from(cells), 100.0 * gap(&along([&both[0], &both[1]])) / f64::from(HEIGHT)]);
    }
    Ok(vec![curve("displacement", shared), curve("each half by itself", apart)])
}

/// Level on the left, and so many cells up and down on the right.
fn rough(cells: u32) -> Arc<Map> {
    meshes::height_map([128; 2], Wrap::Clamp, |x, y| {
        let is_up = (y * cells / 128) % 2 == 1 && x >= 63;
        if is_up { 1.0 } else { 0.0 }
    })
}

fn within(lab: &Lab<'_>, mesh: &Mesh, detail: &Arc<Detail>) -> Result<Surface> {
    let tolerance =
        Tolerance { allowed: Allowed::Diagonal(TOLERANCE), error_at: ErrorAt::Surface, quality: Quality::Normal };
    let geometry = Geometry { refinement: Refinement::Tolerance(tolerance.clone()), ..meshes::uniform(0) };
    let scene = Scene {
        meshes: vec![SceneMesh { gltf_mesh: 0, mesh: mesh.clone() }],
        instances: vec![Instance::as_it_is(0)],
        diagonal: 2f64.sqrt(),
        bounds: [[-0.5, 0.0, -0.5], [0.5, 0.0, 0.5]],
        ..Scene::default()
    };
    let (plan, _) = SurfacePlan::within_tolerance(0, &scene, &tolerance, &geometry, MOST_TRIANGLES)?;
    let surface = lab.planned(mesh, &[Some(Arc::clone(detail))], &plan)?;
    let told = fits::kept(&plan, &surface);
    let holds = told.is_some_and(|(kept, bound)| bound <= kept * (1.0 + 1e-9) && kept <= TOLERANCE * (1.0 + 1e-9));
    let reported = surface.fit.is_some_and(|fit| fit.budget_reached);
    lab.note(
        Rule::ToleranceKept,
        (!holds && !reported).then(|| format!("{TOLERANCE} asked, {told:?} kept and proven")),
    );
    Ok(surface)
}

/// Heights along x = 0 by z, of the triangles to its left and to its right.
type Sides = [Vec<[f64; 2]>; 2];

fn along<const N: usize>(surfaces: [&Surface; N]) -> Sides {
    let mut sides = Sides::default();
    for surface in surfaces {
        for triangle in &surface.triangles {
            let corners = triangle.map(|v| surface.positions[v as usize]);
            let is_left = corners.iter().map(|p| p[0]).sum::<f32>() < 0.0;
            let on_edge = corners.iter().filter(|p| p[0] == 0.0);
            sides[usize::from(!is_left)].extend(on_edge.map(|p| [f64::from(p[2]), f64::from(p[1])]));
        }
    }
    for side in &mut sides {
        side.sort_by(|a, b| a[0].total_cmp(&b[0]));
        side.dedup();
    }
    sides
}

/// The widest, between vertices of either side and the straight pieces of the other.
fn gap([left, right]: &Sides) -> f64 {
    let off = |vertices: &[[f64; 2]], pieces: &[[f64; 2]]| {
        let one = |[z, y]: &[f64; 2]| {
            let next = pieces.partition_point(|p| p[0] < *z).clamp(1, pieces.len() - 1);
            let [[z0, y0], [z1, y1]] = [pieces[next - 1], pieces[next]];
            let share = if z1 > z0 { ((z - z0) / (z1 - z0)).clamp(0.0, 1.0) } else { 0.0 };
            // A vertex of both is met to the bit.
            pieces
                .iter()
                .find(|p| p[0] == *z)
                .map_or_else(|| (y - (y0 + (y1 - y0) * share)).abs(), |p| (y - p[1]).abs())
        };
        vertices.iter().map(one).fold(0.0, f64::max)
    };
    if left.len() < 2 || right.len() < 2 {
        return f64::NAN;
    }
    off(left, right).max(off(right, left))
}

fn junctions(lab: &Lab<'_>) -> Result<Vec<Curve>> {
    let detail = meshes::heights(&meshes::noise(64, 3), HEIGHT);
    let cases: [(&str, &dyn Fn(u32) -> Sheet); 2] = [("repeated vertices", &repeated), ("T-junctions", &t_junctions)];
    let mut curves = Vec::new();
    for (name, sheet) in cases {
        let one = |faults: u32| {
            let mesh = sheet(faults).welded(name)?;
            let is_torn = name == "T-junctions" && faults > 0;
            let surface = if is_torn {
                lab.displaced_torn(&mesh, &detail, LEVEL)?
            } else {
                lab.displaced(&mesh, &detail, &meshes::uniform(LEVEL))?
            };
            Ok([f64::from(faults), 100.0 * gap(&along([&surface])) / f64::from(HEIGHT)])
        };
        curves.push(curve(name, FAULTS.into_iter().map(one).collect::<Result<_>>()?));
    }
    let one = |faults: u32| {
        let mesh = fan(2 + faults).welded("fan")?;
        let surface = lab.displaced(&mesh, &detail, &meshes::uniform(LEVEL))?;
        Ok([f64::from(faults), 100.0 * invariants::largest_gap(&mesh, &surface) / f64::from(HEIGHT)])
    };
    curves.insert(1, curve("more sheets in the edge", FAULTS.into_iter().map(one).collect::<Result<_>>()?));
    Ok(curves)
}

/// Both halves of 16 segments, whose first triangles have vertices of their own.
fn repeated(faults: u32) -> Sheet {
    let [left, right] = halves([16, 16]);
    let mut sheet = left.with(&right);
    for k in 0..faults as usize {
        for corner in 0..3 {
            let v = sheet.triangles[2 * k][corner] as usize;
            sheet.triangles[2 * k][corner] = sheet.positions.len() as u32;
            sheet.positions.push(sheet.positions[v]);
            sheet.normals.push(sheet.normals[v]);
            sheet.uvs.push(sheet.uvs[v]);
        }
    }
    sheet
}

/// One long edge on the left, and so many vertices on it from the right.
fn t_junctions(faults: u32) -> Sheet {
    let [left, right] = halves([1, faults + 1]);
    left.with(&right)
}

/// So many sheets around the z axis.
fn fan(sheets: u32) -> Sheet {
    let sheet = |k: u32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(sheets)).sin_cos();
        Sheet::grid([1; 2], move |u, v| ([0.5 * u * cos, 0.5 * u * sin, v - 0.5], [sin, -cos, 0.0], [0.5 * u, v]))
    };
    (0..sheets).map(sheet).fold(Sheet::default(), |all, one| all.with(&one))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_is_as_wide_as_the_sides_are_apart() {
        let left = vec![[0.0, 0.0], [1.0, 1.0]];
        assert_eq!(gap(&[left.clone(), vec![[0.0, 0.0], [0.5, 0.5], [1.0, 1.0]]]), 0.0);
        assert_eq!(gap(&[left.clone(), vec![[0.0, 0.0], [0.5, 0.75], [1.0, 1.0]]]), 0.25);
        assert_eq!(gap(&[left, vec![[0.0, 0.5], [1.0, 1.0]]]), 0.5);
    }
}
