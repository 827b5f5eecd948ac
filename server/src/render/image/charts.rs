//! Which triangles go on where others end, on the map of their heights: what keeps rays over relief within their charts.

use std::collections::HashMap;

use displace_glsl::layout::relief::{CHART_OPEN, CHART_SEAM, ChartSides, Crossing, MOST_TURNS};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::tables::runs;
use crate::domain::image::{RenderMesh, RenderRelief, RenderScene, Silhouettes};

/// Of the map: places of one vertex are no farther apart.
const SAME_PLACE: f64 = 1e-5;
/// Of its longest side squared: a triangle with less area on the map has no direction there.
const LEAST_AREA: f64 = 1e-9;
/// Cosine between triangles: where the surface folds by more than 60 degrees, it does not go on.
const LEAST_COSINE: f64 = 0.5;

/// Nothing lies beyond any side.
const ALONE: ChartSides = ChartSides { across: [CHART_OPEN; 3], how: [0; 3] };

/// Of the triangles of each mesh, which are numbered as the mesh does; empty where rays do not keep to charts.
pub(crate) fn sides(scene: &RenderScene) -> Vec<Vec<ChartSides>> {
    if scene.marcher().is_none() || scene.relief.silhouettes != Silhouettes::None {
        return Vec::new();
    }
    scene.meshes.par_iter().map(|mesh| of_mesh(scene, mesh)).collect()
}

/// The same for all meshes one after the other.
pub(crate) fn concatenated(scene: &RenderScene) -> Vec<ChartSides> {
    let mut all = Vec::new();
    for sides in sides(scene) {
        let first = all.len() as u32;
        let moved = |across: u32| if across >= CHART_SEAM { across } else { across + first };
        all.extend(sides.into_iter().map(|s| ChartSides { across: s.across.map(moved), ..s }));
    }
    all
}

fn of_mesh(scene: &RenderScene, mesh: &RenderMesh) -> Vec<ChartSides> {
    let mut sides = vec![ALONE; mesh.triangles.len()];
    let mut materials: Vec<u32> = runs(mesh).map(|run| run.1).collect();
    materials.sort_unstable();
    materials.dedup();
    let relief = |material: u32| Some((material, scene.materials[material as usize].relief.as_ref()?));
    let reliefs: Vec<_> = materials.into_iter().filter_map(relief).collect();
    if reliefs.is_empty() {
        return sides;
    }
    let numbers = numbers(mesh);
    for (material, relief) in reliefs {
        let uv_channels = scene.uv_channels as usize;
        Charted { mesh, relief, uv_channels, numbers: &numbers }.join(material, &mut sides);
    }
    sides
}

/// Of vertices, the same for those at the same position.
fn numbers(mesh: &RenderMesh) -> Vec<u32> {
    let mut known = HashMap::with_capacity(mesh.positions.len());
    // Adding 0 makes -0 one with it.
    let key = |position: &[f32; 3]| position.map(|x| (x + 0.0).to_bits());
    let number = |(v, position)| *known.entry(key(position)).or_insert(v as u32);
    mesh.positions.iter().enumerate().map(number).collect()
}

/// A mesh as one of its materials sees it.
struct Charted<'a> {
    mesh: &'a RenderMesh,
    relief: &'a RenderRelief,
    uv_channels: usize,
    numbers: &'a [u32],
}

impl Charted<'_> {
    /// Finds what lies beyond the sides of the material's triangles.
    fn join(&self, material: u32, sides: &mut [ChartSides]) {
        let of_material = runs(self.mesh).filter(|run| run.1 == material).flat_map(|run| run.0);
        let mut edges: Vec<([u32; 2], u32)> = of_material
            .flat_map(|t| (0..3).map(move |k| (t, k)))
            .map(|(t, k)| (self.edge(t, k), (3 * t + k) as u32))
            .collect();
        edges.par_sort_unstable();
        for same in edges.chunk_by(|a, b| a.0 == b.0) {
            for (this, side) in same {
                let (t, k) = (*side as usize / 3, *side as usize % 3);
                let other = same.iter().map(|edge| edge.1).find(|other| other != side);
                let joined = match (same.len(), other) {
                    (1, _) => None,
                    (2, Some(other)) if this[0] != this[1] => {
                        Some(self.crossing([t, k], [other as usize / 3, other as usize % 3]))
                    }
                    _ => Some(None),
                };
                (sides[t].across[k], sides[t].how[k]) = match joined {
                    None => (CHART_OPEN, 0),
                    Some(None) => (CHART_SEAM, 0),
                    Some(Some((triangle, crossing))) => (triangle, crossing.packed()),
                };
            }
        }
    }

    /// Numbers of the ends of a side, in order.
    fn edge(&self, triangle: usize, side: usize) -> [u32; 2] {
        let [a, b] = self.ends(triangle, side).map(|v| self.numbers[v]);
        [a.min(b), a.max(b)]
    }

    fn ends(&self, triangle: usize, side: usize) -> [usize; 2] {
        [side, (side + 1) % 3].map(|k| self.mesh.triangles[triangle][k] as usize)
    }

    /// How the second triangle goes on where the first ends; none where it does not on the map.
    fn crossing(&self, [this, k]: [usize; 2], [other, side]: [usize; 2]) -> Option<(u32, Crossing)> {
        let ([a, b], [d, c]) = (self.ends(this, k), self.ends(other, side));
        let is_turned = self.numbers[a] == self.numbers[c] && self.numbers[b] == self.numbers[d];
        let goes_on = is_turned && self.normal(this).dot(self.normal(other)) >= LEAST_COSINE;
        let (area, beyond) = (self.area(this)?, self.area(other)?);
        let turns = self.turns(self.place(a) - self.place(c), self.place(b) - self.place(d))?;
        let mirrored = (area < 0.0) != (beyond < 0.0);
        goes_on.then_some((other as u32, Crossing { side: side as u32, mirrored, turns }))
    }

    /// What two places of each end of a side are apart, where that is as if there were one map.
    fn turns(&self, a: DVec2, b: DVec2) -> Option<[i32; 2]> {
        let repeats = DVec2::from_array(self.relief.map.repeats.map(|repeats| if repeats { 1.0 } else { 0.0 }));
        let turns = a.round() * repeats;
        let is_same = |d: DVec2| (d - turns).abs().max_element() <= SAME_PLACE;
        let fits = turns.abs().max_element() <= f64::from(MOST_TURNS);
        (is_same(a) && is_same(b) && fits).then(|| [turns.x as i32, turns.y as i32])
    }

    fn place(&self, vertex: usize) -> DVec2 {
        let uv = self.mesh.uvs[vertex * self.uv_channels + self.relief.uv_channel as usize].map(f64::from);
        DVec2::from_array(self.relief.map_from_uv.map(|row| {
            let [u, v, one] = row.map(f64::from);
            u * uv[0] + v * uv[1] + one
        }))
    }

    /// Twice that on the map; none where there is hardly any.
    fn area(&self, triangle: usize) -> Option<f64> {
        let [a, b, c] = self.mesh.triangles[triangle].map(|v| self.place(v as usize));
        let (area, longest) = ((b - a).perp_dot(c - a), (b - a).length_squared().max((c - a).length_squared()));
        (area.abs() > LEAST_AREA * longest).then_some(area)
    }

    fn normal(&self, triangle: usize) -> DVec3 {
        let corner = |v: u32| DVec3::from_array(self.mesh.positions[v as usize].map(f64::from));
        let [a, b, c] = self.mesh.triangles[triangle].map(corner);
        (b - a).cross(c - a).normalize_or_zero()
    }
}

#[cfg(test)]
mod tests;
