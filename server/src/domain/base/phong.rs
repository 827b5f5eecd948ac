//! Phong tessellation (Boubekeur and Alexa 2008): each place is drawn towards the mean of its projections onto the
//! corners' tangent planes.

use displace_glsl::patches::Patches;
use glam::DVec3;

use super::{End, of_edges, one_each, place, quadratic, side, wide};
use crate::domain::mesh::Mesh;

/// How far: 0 is flat, 1 is all the way. That of the paper.
const ALPHA: f64 = 0.75;

pub(super) fn patches(mesh: &Mesh) -> Patches {
    let middles = of_edges(mesh, |ends| [middle(ends)]);
    one_each(mesh, 2, |t| {
        let av = mesh.triangles[t].av;
        let on_side = [0, 1, 2].map(|k| middles[side(mesh, t, k).1][0]);
        let normals = av.map(|av| wide(mesh.av_normal[av as usize]));
        let directions = av.map(|av| wide(mesh.gv_direction[mesh.av_gv[av as usize] as usize]));
        let halfway = |v: [DVec3; 3]| [0.5 * (v[0] + v[1]), 0.5 * (v[1] + v[2]), 0.5 * (v[2] + v[0])];
        let nets = [
            quadratic(av.map(|av| place(mesh, av)), on_side),
            quadratic(normals, halfway(normals)),
            quadratic(directions, halfway(directions)),
        ];
        nets.concat()
    })
}

/// The control point between two corners.
fn middle([a, b]: [End; 2]) -> DVec3 {
    let projected = |at: DVec3, plane: &End| at - plane.normal * (at - plane.position).dot(plane.normal);
    let bent = projected(b.position, &a) + projected(a.position, &b);
    0.5 * ((1.0 - ALPHA) * (a.position + b.position) + ALPHA * bent)
}
