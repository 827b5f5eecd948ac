//! PN triangles (Vlachos, Peters, Boyd and Mitchell 2001), with edges that all sides share as in PN-AEN (McDonald and
//! Kilgard 2010).

use displace_glsl::{bezier::Net, patches::Patches};
use glam::DVec3;

use super::{End, ends, of_edges, one_each, place, quadratic, side, wide};
use crate::domain::mesh::Mesh;

/// Normals whose sum is shorter point apart: nothing can be told from it.
const SHORTEST_SUM: f64 = 1e-6;

pub(super) fn patches(mesh: &Mesh) -> Patches {
    let edges = of_edges(mesh, |[a, b]| [control(&a, &b), control(&b, &a)]);
    one_each(mesh, 3, |t| {
        let av = mesh.triangles[t].av;
        let sides: [[DVec3; 2]; 3] = std::array::from_fn(|k| {
            let (_, ge, forward) = side(mesh, t, k);
            let [a, b] = edges[ge];
            if forward { [a, b] } else { [b, a] }
        });
        let middles: [[DVec3; 2]; 3] = std::array::from_fn(|k| middle(&ends(mesh, side(mesh, t, k).0)));
        let normals = av.map(|av| wide(mesh.av_normal[av as usize]));
        let directions = av.map(|av| wide(mesh.gv_direction[mesh.av_gv[av as usize] as usize]));
        let mut points = cubic(av.map(|av| place(mesh, av)), sides).points().to_vec();
        points.extend(quadratic(normals, middles.map(|m| m[0])));
        points.extend(quadratic(directions, middles.map(|m| m[1])));
        points
    })
}

/// The control point next to `a` on the way to `b`.
fn control(a: &End, b: &End) -> DVec3 {
    let w = (b.position - a.position).dot(a.normal);
    (2.0 * a.position + b.position - w * a.normal) / 3.0
}

/// Control points of the normal and the direction halfway: the sum of the ends', turned over at the plane across the
/// edge. The direction keeps its length as against the normal's.
fn middle([a, b]: &[End; 2]) -> [DVec3; 2] {
    let along = b.position - a.position;
    let turned = |sum: DVec3| sum - along * (2.0 * along.dot(sum) / along.length_squared());
    let (normal, direction) = (turned(a.normal + b.normal), turned(a.direction + b.direction));
    let length = normal.length();
    let by = if length > SHORTEST_SUM { 1.0 / length } else { 0.5 };
    [normal * by, direction * by]
}

/// From corners and the two points on each side, in its direction.
fn cubic(corners: [DVec3; 3], sides: [[DVec3; 2]; 3]) -> Net {
    let on_sides = sides.as_flattened().iter().sum::<DVec3>() / 6.0;
    let inside = on_sides + 0.5 * (on_sides - corners.iter().sum::<DVec3>() / 3.0);
    Net::new(3, |j, k| match (3 - j - k, j, k) {
        (3, ..) => corners[0],
        (_, 3, _) => corners[1],
        (.., 3) => corners[2],
        (1, 1, 1) => inside,
        (i, j, 0) => sides[0][usize::from(j > i)],
        (0, j, k) => sides[1][usize::from(k > j)],
        (i, _, k) => sides[2][usize::from(i > k)],
    })
}
