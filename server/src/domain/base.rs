//! The smooth surface under the detail: a mesh's triangles bent, corners and edges still shared.
//!
//! | base | a triangle becomes | its directions |
//! |---|---|---|
//! | `pn.rs` | a cubic, normal to the corners' normals (Vlachos et al. 2001) | quadratic, as the normals |
//! | `phong.rs` | a quadratic (Boubekeur and Alexa 2008) | blended, as on the flat base |
//! | `loop_limit.rs`, `fan.rs`, `ring.rs`, `table.rs` | the limit of Loop's subdivision (Loop 1987, Stam 1998) | normals of the limit |
//!
//! No crack can open: the control points along an edge belong to the geometric edge. Where its sides have normals of
//! their own, at hard edges and seams, they are the mean of what the sides ask for.

mod fan;
mod loop_limit;
mod phong;
mod pn;
mod ring;
mod table;

use std::sync::Arc;

use displace_glsl::{
    layout::geometry::NONE,
    patches::{PatchNode, Patches, on_edge},
};
use glam::DVec3;
use rayon::prelude::*;

use super::{Error, Result, cancel::Cancel, mesh::Mesh, request::Base};

/// Triangles whose places fit the tables.
const MOST_TRIANGLES: usize = 1 << 28;

/// Gives the mesh its base. Under [`Base::Loop`] its vertices move to the limit surface, and normals become that
/// surface's. Fails where that takes too much, or the job is cancelled.
pub fn bend(mesh: &mut Mesh, base: Base, cancel: &Cancel) -> Result<()> {
    if base == Base::Flat || mesh.triangles.is_empty() {
        return Ok(());
    }
    if mesh.triangles.len() > MOST_TRIANGLES {
        let message = format!(
            "mesh '{}' has {} triangles; at most {MOST_TRIANGLES} are smoothed: use base flat",
            mesh.name,
            mesh.triangles.len()
        );
        return Err(Error::too_large("geometry.base", message));
    }
    let patches = match base {
        Base::Flat => return Ok(()),
        Base::Pn => pn::patches(mesh),
        Base::Phong => phong::patches(mesh),
        Base::Loop => loop_limit::bend(mesh, cancel)?,
    };
    mesh.patches = Some(Arc::new(patches));
    Ok(())
}

fn wide(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

fn narrow(v: DVec3) -> [f32; 3] {
    v.as_vec3().to_array()
}

fn place(mesh: &Mesh, av: u32) -> DVec3 {
    wide(mesh.gv_position[mesh.av_gv[av as usize] as usize])
}

/// One end of an edge: position, normal and direction.
#[derive(Clone, Copy)]
struct End {
    position: DVec3,
    normal: DVec3,
    direction: DVec3,
}

fn ends(mesh: &Mesh, ae: usize) -> [End; 2] {
    mesh.ae_av[ae].map(|av| End {
        position: place(mesh, av),
        normal: wide(mesh.av_normal[av as usize]),
        direction: wide(mesh.gv_direction[mesh.av_gv[av as usize] as usize]),
    })
}

/// What each geometric edge has, as the mean over the attribute edges that are its sides.
fn of_edges<const N: usize>(mesh: &Mesh, ask: impl Fn([End; 2]) -> [DVec3; N] + Sync) -> Vec<[DVec3; N]> {
    let mean = |ge: usize| {
        let sides = mesh.ge_ae.list(ge);
        let asked = sides.iter().map(|ae| ask(ends(mesh, *ae as usize)));
        let sum = asked.fold([DVec3::ZERO; N], |sum, more| std::array::from_fn(|k| sum[k] + more[k]));
        sum.map(|v| v / sides.len() as f64)
    };
    (0..mesh.ge_gv.len()).into_par_iter().map(mean).collect()
}

/// One patch for each triangle: `points` of its net, then the quadratic nets of its normals and directions.
fn one_each(mesh: &Mesh, degree: u32, points: impl Fn(usize) -> Vec<DVec3> + Sync + Send) -> Patches {
    let nets: Vec<Vec<DVec3>> = (0..mesh.triangles.len()).into_par_iter().map(points).collect();
    let normals_after = displace_glsl::bezier::points(degree as usize) as u32;
    let mut patches = Patches { edges: own_edges(mesh), ..Patches::default() };
    for net in nets {
        let first = patches.points.len() as u32;
        let normals = first + 1 + normals_after;
        patches.nodes.push(PatchNode { parts: NONE, points: first, degree, normals, given: NONE, side: 1.0 });
        patches.points.push([0.0; 3]);
        patches.points.extend(net.into_iter().map(narrow));
    }
    patches
}

/// Where each ae lies: on the first triangle that has it.
fn own_edges(mesh: &Mesh) -> Vec<u32> {
    let mut edges = vec![NONE; mesh.ae_av.len()];
    for (t, triangle) in (0..).zip(&mesh.triangles) {
        for (k, ae) in (0..).zip(triangle.ae) {
            let reversed = mesh.ae_av[ae as usize][0] != triangle.av[k as usize];
            let place = &mut edges[ae as usize];
            *place = if *place == NONE { on_edge(t, k, reversed) } else { *place };
        }
    }
    edges
}

/// What belongs to side k of triangle t, `forward` from corner k to corner k + 1 where true.
fn side(mesh: &Mesh, t: usize, k: usize) -> (usize, usize, bool) {
    let triangle = &mesh.triangles[t];
    let ae = triangle.ae[k] as usize;
    (ae, mesh.ae_ge[ae] as usize, mesh.ae_av[ae][0] == triangle.av[k])
}

/// Quadratic net in the order of `Net` from its corners and its middle points on sides 01, 12, 20.
fn quadratic([a, b, c]: [DVec3; 3], [ab, bc, ca]: [DVec3; 3]) -> [DVec3; 6] {
    [a, ab, b, ca, bc, c]
}
