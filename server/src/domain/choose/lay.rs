//! How the triangles of a mesh lie on a map and beside each other.

mod around;
mod rim;

use glam::{DMat2, DVec2, DVec3};
use rayon::prelude::*;

use super::{
    facts::Window,
    patch::{BaseTriangle, Patch},
};
use crate::domain::{mesh::Mesh, relief::Relief};
use around::Across;
pub(super) use around::Around;
pub(super) use rim::Rim;

/// A mesh, and where its vertices lie on the map of its relief.
pub(super) struct Lay<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) repeats: [bool; 2],
    /// Texels of the map.
    pub(super) size: DVec2,
    /// Of attribute vertices, texels; none without texture coordinates.
    texels: Option<Vec<DVec2>>,
    /// The greatest height, up or down.
    highest: f64,
    of_triangles: Vec<Local>,
    /// Of their sides.
    across: Vec<[Across; 3]>,
}

/// What one triangle tells of itself.
#[derive(Clone, Copy, Debug)]
struct Local {
    normal: DVec3,
    direction_rate: f64,
    /// What a texel along u and along v is; not finite where it has no area on the map.
    texel_axes: [DVec3; 2],
}

impl<'a> Lay<'a> {
    pub(super) fn new(mesh: &'a Mesh, relief: &Relief) -> Self {
        let map = &relief.map;
        let size = DVec2::new(f64::from(map.width), f64::from(map.height));
        let place = |uv: &[f32]| {
            let [s, t] = relief.map_from_uv.map(|row| {
                let [a, b, c] = row.map(f64::from);
                a * f64::from(uv[0]) + b * f64::from(uv[1]) + c
            });
            DVec2::new(s, t) * size - 0.5
        };
        let uvs = mesh.attribute(&format!("TEXCOORD_{}", relief.uv_set));
        let texels = uvs.map(|uvs| uvs.values.chunks(uvs.components).map(place).collect());
        let highest = map.range().iter().fold(0.0, |most: f64, h| most.max(f64::from(h.abs())));
        let mut lay =
            Self { mesh, repeats: map.repeats, size, texels, highest, of_triangles: Vec::new(), across: Vec::new() };
        let count = if lay.texels.is_some() { mesh.triangles.len() } else { 0 };
        lay.of_triangles = (0..count).into_par_iter().map(|t| Local::of(&lay, t)).collect();
        lay.across = (0..count).into_par_iter().map(|t| [0, 1, 2].map(|side| Across::of(&lay, t, side))).collect();
        lay
    }

    /// How far heights reach from the base at most, mitres at their longest.
    pub(super) fn reach(&self) -> f64 {
        2.0 * self.highest
    }

    pub(super) fn corners(&self, t: usize) -> [DVec3; 3] {
        self.mesh.triangles[t].av.map(|av| vector(self.mesh.gv_position[self.mesh.av_gv[av as usize] as usize]))
    }

    pub(super) fn texels(&self, t: usize) -> Option<[DVec2; 3]> {
        let texels = self.texels.as_ref()?;
        Some(self.mesh.triangles[t].av.map(|av| texels[av as usize]))
    }

    /// Normals and directions.
    fn vectors(&self, t: usize) -> [[DVec3; 3]; 2] {
        let av = self.mesh.triangles[t].av;
        let direction = |av: u32| vector(self.mesh.gv_direction[self.mesh.av_gv[av as usize] as usize]);
        [av.map(|av| vector(self.mesh.av_normal[av as usize])), av.map(direction)]
    }

    pub(super) fn patch(&self, t: usize) -> Option<Patch> {
        let (corners, texels) = (self.corners(t), self.texels(t)?);
        let [normals, directions] = self.vectors(t);
        let base = BaseTriangle::new(corners, normals, directions, texels);
        Some(Patch { corners, normals, directions, texels, base, seam_distance: f64::INFINITY, is_rim: false })
    }

    pub(super) fn around(&self, t: usize) -> Around {
        Around::of(self, t)
    }
}

impl Local {
    fn of(lay: &Lay<'_>, t: usize) -> Self {
        let (corners, vectors) = (lay.corners(t), lay.vectors(t));
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let [p, q, r] = lay.texels(t).unwrap_or_default();
        let from_texels = DMat2::from_cols(q - p, r - p).inverse();
        let texel_axes = [from_texels.x_axis, from_texels.y_axis].map(|share| (b - a) * share.x + (c - a) * share.y);
        let direction_rate = direction_rate(corners, vectors[0], vectors[1]);
        Self { normal, direction_rate, texel_axes }
    }
}

impl BaseTriangle {
    /// Of a triangle around which nothing bends and no chart ends.
    #[must_use]
    pub fn new(corners: [DVec3; 3], normals: [DVec3; 3], directions: [DVec3; 3], texels: [DVec2; 3]) -> Self {
        let longest_side = (0..3).map(|k| corners[k].distance(corners[(k + 1) % 3])).fold(0.0, f64::max);
        let direction_rate = direction_rate(corners, normals, directions);
        Self { texels, window: Window::around(texels), longest_side, direction_rate, bend_rate: 0.0 }
    }
}

pub(super) fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

/// Orthonormal, in the plane of a triangle; and what takes them to shares of its sides.
pub(super) fn frame([a, b, c]: [DVec3; 3]) -> Option<([DVec3; 2], DMat2)> {
    let (e, f) = (b - a, c - a);
    let x = e.try_normalize()?;
    let y = f.reject_from_normalized(x).try_normalize()?;
    let shares = DMat2::from_cols(DVec2::new(e.length(), 0.0), DVec2::new(f.dot(x), f.dot(y))).inverse();
    Some(([x, y], shares))
}

/// Greatest singular value of two columns.
pub(super) fn norm(a: DVec3, b: DVec3) -> f64 {
    let (half, apart) = (0.5 * (a.dot(a) + b.dot(b)), 0.5 * (a.dot(a) - b.dot(b)));
    (half + apart.hypot(a.dot(b))).sqrt()
}

/// How much what is linear over a triangle changes for each unit of length, at most.
fn rate(corners: [DVec3; 3], values: [DVec3; 3]) -> f64 {
    let Some((_, shares)) = frame(corners) else { return 0.0 };
    let changes = [values[1] - values[0], values[2] - values[0]];
    let [a, b] = [shares.x_axis, shares.y_axis].map(|share| changes[0] * share.x + changes[1] * share.y);
    norm(a, b)
}

/// Of directions over the length of the normal; of unit normals alone where they are the same.
pub(super) fn direction_rate(corners: [DVec3; 3], normals: [DVec3; 3], directions: [DVec3; 3]) -> f64 {
    let middle = normals.iter().sum::<DVec3>().normalize_or_zero();
    let shortest = normals.iter().fold(f64::INFINITY, |least, n| least.min(n.dot(middle))).max(1e-3);
    let of_normals = rate(corners, normals) / shortest;
    if normals == directions {
        return of_normals;
    }
    let longest = directions.iter().fold(0.0, |most: f64, d| most.max(d.length()));
    rate(corners, directions) / shortest + longest / shortest * of_normals
}
