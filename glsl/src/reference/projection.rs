//! Twin of `projection.glsl`: where a place of a surface lies on maps, by its place in its mesh alone.
//!
//! Places are relative to the centre of the mesh's box before it is displaced, in units of its longest side. +Y is up,
//! and maps are read as they are from outside, v down as in glTF.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

/// Numbers as in `projection.glsl`; 0 stands for texture coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Kind {
    /// u = fract(atan2(-z, x) / 2 pi), v = atan2(hypot(x, z), y) / pi.
    Sphere = 1,
    /// u = arccos(x / hypot(x, z)) / 2 pi, which tells no place from its mirror image in the plane z = 0 (Everson, COM3404).
    SphereAsPrinted,
    PlanarX,
    PlanarY,
    PlanarZ,
    /// Along the axis nearest to the normal.
    Box,
    /// Along all axes, by weights of max(|n| - 0.2, 0)^3 (Mikkelsen 2020).
    Triplanar,
}

/// A place with its derivatives per pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    pub at: DVec3,
    pub dx: DVec3,
    pub dy: DVec3,
    /// Unit, or zero.
    pub normal: DVec3,
}

/// Where that is on a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projected {
    pub uv: DVec2,
    /// Per pixel.
    pub dx: DVec2,
    pub dy: DVec2,
    /// Weights of all projections of a kind have the sum 1.
    pub weight: f64,
    /// Unit, in the mesh's space, towards growing u.
    pub tangent: DVec3,
    /// Unit, towards shrinking v: up on the map.
    pub bitangent: DVec3,
}

impl Kind {
    /// How many projections are blended.
    #[must_use]
    pub fn count(self) -> usize {
        if self == Self::Triplanar { 3 } else { 1 }
    }
}

/// All projections of a kind.
pub fn projections(kind: Kind, place: Place) -> impl Iterator<Item = Projected> {
    (0..kind.count()).map(move |k| projected(kind, &place, k))
}

fn projected(kind: Kind, place: &Place, k: usize) -> Projected {
    let side = |axis: usize| if place.normal[axis] < 0.0 { -1.0 } else { 1.0 };
    match kind {
        Kind::Sphere => sphere(place, false),
        Kind::SphereAsPrinted => sphere(place, true),
        Kind::PlanarX => plane(0, 1.0, place),
        Kind::PlanarY => plane(1, 1.0, place),
        Kind::PlanarZ => plane(2, 1.0, place),
        Kind::Box => {
            let axis = axis_of(place.normal);
            plane(axis, side(axis), place)
        }
        Kind::Triplanar => Projected { weight: weights_of(place.normal)[k], ..plane(k, side(k), place) },
    }
}

fn plane(axis: usize, side: f64, place: &Place) -> Projected {
    let right = side * if axis == 0 { DVec3::NEG_Z } else { DVec3::X };
    let up = if axis == 1 { DVec3::NEG_Z } else { DVec3::Y };
    let on = |p: DVec3| DVec2::new(right.dot(p), -up.dot(p));
    Projected {
        uv: DVec2::splat(0.5) + on(place.at),
        dx: on(place.dx),
        dy: on(place.dy),
        weight: 1.0,
        tangent: right,
        bitangent: up,
    }
}

/// A pixel covers one turn at most, also at a pole.
fn sphere(place: &Place, as_printed: bool) -> Projected {
    let p = place.at;
    let (level, squared) = (p.x.hypot(p.z), p.length_squared());
    let turned = if as_printed && p.z > 0.0 { -1.0 } else { 1.0 };
    let u = turned * (-p.z).atan2(p.x) / TAU;
    let side = |d: DVec3| {
        let turn = if level > 0.0 { ((p.z * d.x - p.x * d.z) / (TAU * level * level)).clamp(-1.0, 1.0) } else { 1.0 };
        let outwards = if level > 0.0 { (p.x * d.x + p.z * d.z) / level } else { d.x.hypot(d.z) };
        let tilt = if squared > 0.0 { (p.y * outwards - level * d.y) / (PI * squared) } else { 1.0 };
        DVec2::new(turned * turn, tilt)
    };
    let along = if level > 0.0 { DVec3::new(p.z, 0.0, -p.x) / level } else { DVec3::NEG_Z };
    let north = DVec3::new(-p.y * p.x / level, level, -p.y * p.z / level);
    Projected {
        uv: DVec2::new(u - u.floor(), level.atan2(p.y) / PI),
        dx: side(place.dx),
        dy: side(place.dy),
        weight: 1.0,
        tangent: turned * along,
        bitangent: if level > 0.0 { north.normalize() } else { DVec3::NEG_X },
    }
}

fn axis_of(normal: DVec3) -> usize {
    let n = normal.abs();
    if n.x >= n.y && n.x >= n.z { 0 } else { 2 - usize::from(n.y >= n.z) }
}

fn weights_of(normal: DVec3) -> DVec3 {
    let w = (normal.abs() - DVec3::splat(0.2)).max(DVec3::ZERO);
    let w = w * w * w;
    let sum = w.element_sum();
    if sum > 0.0 { w / sum } else { DVec3::splat(1.0 / 3.0) }
}

/// What a normal map's value says of the surface: minus its slope, in the mesh's space (surface gradients, Mikkelsen 2020).
#[must_use]
pub fn tilt(at: &Projected, value: DVec3) -> DVec3 {
    (value.x * at.tangent + value.y * at.bitangent) / value.z.max(1.0 / 64.0)
}

#[cfg(test)]
mod tests;
