//! Bent normals where a ray hits: by the tangents of the surface as if it were displaced (Blinn 1978).

use displace_glsl::{expression::Dual, expression::evaluate, layout::raster::MAP_DETAIL};
use glam::{DMat3, DVec2, DVec3};

use super::{material::Corners, world::blend};
use crate::domain::image::{BumpKind, RenderFormula, RenderMap, RenderMaterial};

/// The steepest slope of a normal map; a normal within half a degree of the surface has it.
const STEEPEST: f64 = 128.0;

/// A place on a triangle, mesh-local, and its normal in the world.
struct Place<'a> {
    at: &'a Corners<'a>,
    sides: [DVec3; 2],
    /// Unit.
    normal: DVec3,
    /// Unit, of the front, world.
    front: DVec3,
    world_from_mesh: DMat3,
}

/// The normal of the front, unit, world; `own` is as the material's own normal map has it, `front` without that.
pub(super) fn bent(
    m: &RenderMaterial,
    at: &Corners<'_>,
    own: DVec3,
    front: DVec3,
    world_from_mesh: DMat3,
) -> Option<DVec3> {
    let [a, b, c] = at.vertices.map(|v| at.mesh.positions[v]);
    let sides = [b - a, c - a];
    let facet = sides[0].cross(sides[1]).normalize_or_zero();
    let smooth = at.normals().0;
    let in_world = |n: DVec3| (world_from_mesh.inverse().transpose() * n).try_normalize();
    let (normal, front, own) = match m.bump.faceted {
        true => (facet, in_world(facet)?, in_world(facet)?),
        false => (smooth, front, own),
    };
    let place = Place { at, sides, normal, front, world_from_mesh };
    let (mut rises, mut direction) = (DVec2::ZERO, own / own.dot(front).max(1.0 / STEEPEST));
    for formula in &m.bump.formulas {
        rises += place.rises_of(formula);
    }
    for (used, slot) in m.bump.uses.iter().zip(MAP_DETAIL..) {
        let Some(map) = m.maps[slot].as_ref().filter(|_| used.kind != BumpKind::None) else { continue };
        let (value, scale) = (at.read(map).truncate(), f64::from(used.scale));
        match used.kind {
            BumpKind::Height => rises += scale * place.rises(map, value),
            kind => direction += scale * place.leaning(kind, map, value),
        }
    }
    (direction + place.tilted(rises)?).try_normalize()
}

impl Place<'_> {
    /// What the value of a map of slopes makes of the sides.
    fn rises(&self, map: &RenderMap, slopes: DVec3) -> DVec2 {
        let on_map = |k: usize| {
            let uv = self.uv_change(map.uv_channel, k);
            let [u, v] = map.map_from_uv.map(|row| f64::from(row[0]) * uv.x + f64::from(row[1]) * uv.y);
            slopes.x * u + slopes.y * v
        };
        DVec2::new(on_map(0), on_map(1))
    }

    fn rises_of(&self, formula: &RenderFormula) -> DVec2 {
        let along = |value: f64, changes: [f64; 2]| Dual::new(value, changes);
        let channel = formula.uv_channel;
        let (uv, by) = (self.at.uv(channel as usize), [0, 1].map(|k| self.uv_change(channel, k)));
        let on_map = |row: [f32; 3]| {
            let [a, b, c] = row.map(f64::from);
            along(a * uv.x + b * uv.y + c, by.map(|by| a * by.x + b * by.y))
        };
        let place = blend(self.at.weights, self.at.vertices.map(|v| self.at.mesh.positions[v]));
        let (normal, turns) = self.at.normals();
        let p = |k: usize| along(place[k], self.sides.map(|side| side[k]));
        let n = |k: usize| along(normal[k], turns.map(|turn| turn[k]));
        let [u, v] = formula.map_from_uv.map(on_map);
        let height: Dual<2> = evaluate(&formula.program.code, &[u, v, p(0), p(1), p(2), n(0), n(1), n(2)]);
        DVec2::from_array(height.derivative) * f64::from(formula.scale)
    }

    /// From the first corner along a side.
    fn uv_change(&self, channel: u32, side: usize) -> DVec2 {
        let [a, corner] = [0, side + 1].map(|k| self.at.uv_of_corner(channel as usize, k));
        corner - a
    }

    /// What the normal gains, for one of its length: the tangents are laid across the normal, raised, and crossed.
    fn tilted(&self, rises: DVec2) -> Option<DVec3> {
        let across = self.sides.map(|side| side - self.normal * self.normal.dot(side));
        let raised = [across[0] + rises.x * self.normal, across[1] + rises.y * self.normal];
        let (flat, bent) = (across[0].cross(across[1]), raised[0].cross(raised[1]));
        let share = flat.dot(self.normal);
        if share == 0.0 {
            return Some(DVec3::ZERO);
        }
        let normals = self.world_from_mesh.inverse().transpose();
        let length = (normals * self.normal).length();
        Some(normals * (bent / share - self.normal) / length)
    }

    /// What a normal of a map adds to the front's.
    fn leaning(&self, kind: BumpKind, map: &RenderMap, m: DVec3) -> DVec3 {
        let steep = m.truncate().abs().max_element() / STEEPEST;
        let lean = m.truncate() / m.z.abs().max(steep).max(1e-20);
        match kind {
            BumpKind::Object => {
                let n = (self.world_from_mesh.inverse().transpose() * m).normalize_or_zero();
                n / n.dot(self.front).max(1.0 / STEEPEST) - self.front
            }
            BumpKind::CySlice => {
                let [by_1, by_2] = [0, 1].map(|k| self.uv_change(map.uv_channel, k).y);
                let s = self.world_from_mesh * (self.sides[1] * by_1 - self.sides[0] * by_2);
                let t = self.front.cross(s).normalize_or_zero();
                lean.x * t + lean.y * t.cross(self.front)
            }
            _ => self.at.tangent().map_or(DVec3::ZERO, |(tangent, sign)| {
                let tangent = (self.world_from_mesh * tangent).normalize_or_zero();
                lean.x * tangent + lean.y * sign * self.front.cross(tangent)
            }),
        }
    }
}

impl Corners<'_> {
    /// The unit normal, mesh-local, and how it turns along the two sides.
    fn normals(&self) -> (DVec3, [DVec3; 2]) {
        let [a, b, c] = self.vertices.map(|v| DVec3::from_array(self.mesh.normals[v].map(f64::from)));
        let sum = blend(self.weights, [a, b, c]);
        let (n, length) = (sum.normalize_or_zero(), sum.length().max(1e-12));
        (n, [b - a, c - a].map(|by| by.reject_from_normalized(n) / length))
    }
}
