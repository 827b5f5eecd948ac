//! Twin of `bump`: normals bent by surface gradients, which add (Mikkelsen 2010, 2020).

use glam::{DMat2, DMat3, DVec2, DVec3, DVec4};

use super::surface::unit_or_zero;
use crate::layout::bump::{BUMP_HEIGHT, BUMP_OBJECT, BUMP_TANGENT};

/// The steepest slope of a normal map; as in `bump.glsl`.
const STEEPEST: f64 = 128.0;

/// A triangle, and the normal that is bent.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Mesh-local, from the first vertex to the second and to the third.
    pub sides: [DVec3; 2],
    /// Mesh-local, unit.
    pub normal: DVec3,
    /// The same in the world, on the side of the front.
    pub front: DVec3,
    /// Tangent in world space, of any length, and handedness; w is 0 where there is none.
    pub tangent: DVec4,
    pub world_from_mesh: DMat3,
    /// The inverse transpose of that, up to a positive factor.
    pub world_from_normal: DMat3,
}

/// What a map shows there.
#[derive(Clone, Copy, Debug)]
pub struct Shown {
    /// `BUMP_*`.
    pub kind: u32,
    pub scale: f64,
    pub value: DVec3,
    /// Changes of u and v of the map along a side, in the columns.
    pub map_changes: DMat2,
    /// The same of the mesh's own u and v.
    pub uv_changes: DMat2,
}

/// `own`: the normal before it is bent, unit; `rises`: of formulas. Zero where there is no direction.
#[must_use]
pub fn bent(place: &Place, own: DVec3, rises: DVec2, maps: &[Shown]) -> DVec3 {
    let (mut along_sides, mut direction) = (rises, homogeneous(own, place.front));
    for map in maps {
        match map.kind {
            BUMP_HEIGHT => along_sides += map.scale * (map.map_changes.transpose() * map.value.truncate()),
            BUMP_TANGENT => direction += in_mikktspace(place, map.scale * leaning(map.value)),
            BUMP_OBJECT => direction += map.scale * in_object_space(place, map.value),
            _ => direction += in_cyslice(place, map.uv_changes, map.scale * leaning(map.value)),
        }
    }
    unit_or_zero(direction + tilted(place, along_sides))
}

/// The gradient along the surface of what rises so along two sides of a triangle, across unit `n`.
#[must_use]
pub fn surface_gradient([side_1, side_2]: [DVec3; 2], n: DVec3, rises: DVec2) -> DVec3 {
    let a = side_2.cross(n);
    let volume = side_1.dot(a);
    if volume == 0.0 {
        return DVec3::ZERO;
    }
    (rises.x * a + rises.y * n.cross(side_1)) / volume
}

/// Of a normal of a tangent frame: how much x and y there is for one z.
#[must_use]
pub fn leaning(m: DVec3) -> DVec2 {
    let least = (m.x.abs().max(m.y.abs()) / STEEPEST).max(1e-20);
    m.truncate() / m.z.abs().max(least)
}

fn homogeneous(direction: DVec3, n: DVec3) -> DVec3 {
    direction / direction.dot(n).max(1.0 / STEEPEST)
}

fn tilted(place: &Place, along_sides: DVec2) -> DVec3 {
    let gradient = surface_gradient(place.sides, place.normal, along_sides);
    let enlarged = (place.world_from_normal * place.normal).length();
    if enlarged > 0.0 { -(place.world_from_normal * gradient) / enlarged } else { DVec3::ZERO }
}

fn in_mikktspace(place: &Place, lean: DVec2) -> DVec3 {
    let t = unit_or_zero(place.tangent.truncate());
    if place.tangent.w == 0.0 {
        return DVec3::ZERO;
    }
    lean.x * t + lean.y * (place.tangent.w.signum() * place.front.cross(t))
}

fn in_object_space(place: &Place, m: DVec3) -> DVec3 {
    let n = unit_or_zero(place.world_from_normal * m);
    if n == DVec3::ZERO { n } else { homogeneous(n, place.front) - place.front }
}

/// As CySlice's shader prints it: dPdu Dv(t) - dPdv Du(t) points along S times the sign of the UVs' determinant.
fn in_cyslice(place: &Place, changes: DMat2, lean: DVec2) -> DVec3 {
    let along = place.sides[1] * changes.x_axis.y - place.sides[0] * changes.y_axis.y;
    let t = unit_or_zero(place.front.cross(place.world_from_mesh * along));
    lean.x * t + lean.y * t.cross(place.front)
}

#[cfg(test)]
mod tests;
