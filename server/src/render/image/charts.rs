//! Which triangles go on where others end, on the map of their heights: what keeps rays over relief within their charts.

use std::collections::HashMap;

use displace_glsl::layout::relief::{CHART_OPEN, CHART_SEAM, ChartSides, Crossing, MOST_TURNS};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::tables::runs;
use crate::domain::image::{RenderMesh, RenderRelief, RenderScene};

/// Of the map: places of one vertex are no farther apart, and what their own rounding adds.
const SAME_PLACE: f64 = 1e-5;
/// Of the longest side of the box around a mesh's borders: positions there that are no farther apart are one, as those of sin(2 pi) and of 0.
const SAME_POSITION: f64 = 1e-6;
/// Of its longest side squared: a triangle with less area on the map has no direction there.
const LEAST_AREA: f64 = 1e-9;
/// Cosine between triangles: where the surface folds by more than 60 degrees, it does not go on.
const LEAST_COSINE: f64 = 0.5;

/// Nothing lies beyond any side.
const ALONE: ChartSides = ChartSides { across: [CHART_OPEN; 3], how: [0; 3] };

/// Of the triangles of each mesh, which are numbered as the mesh does; empty where no heights are shown per pixel.
pub(crate) fn sides(scene: &RenderScene) -> Vec<Vec<ChartSides>> {
    if scene.marcher().is_none() {
        return Vec::new();
    }
    let stands_for = |mesh: usize| scene.instances.iter().any(|i| i.mesh == mesh && i.stands_for.is_some());
    let of = |(index, mesh): (usize, &RenderMesh)| {
        // What only says where rays are followed is no surface.
        if stands_for(index) { vec![ALONE; mesh.triangles.len()] } else { of_mesh(scene, mesh) }
    };
    scene.meshes.par_iter().enumerate().map(of).collect()
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
    if runs(mesh).all(|(_, material)| scene.materials[material as usize].relief.is_none()) {
        return sides;
    }
    let mut material_of = vec![0; mesh.triangles.len()];
    runs(mesh).for_each(|(run, material)| material_of[run].fill(material));
    let (numbers, uv_channels) = (joined(mesh, numbers(mesh)), scene.uv_channels as usize);
    let charted = |relief| Charted { mesh, relief, uv_channels, numbers: &numbers };
    for same in edges(mesh, &numbers).chunk_by(|a, b| a.0 == b.0) {
        for (_, this) in same {
            let [t, k] = *this;
            let Some(relief) = &scene.materials[material_of[t] as usize].relief else { continue };
            let mut others = same.iter().map(|side| side.1).filter(|other| other != this);
            let mut alike = others.clone().filter(|[other, _]| material_of[*other] == material_of[t]);
            let joined = match (alike.next(), alike.next()) {
                (Some(other), None) => charted(relief).crossing(*this, other),
                _ => None,
            };
            (sides[t].across[k], sides[t].how[k]) = match joined {
                Some((triangle, crossing)) => (triangle, crossing.packed()),
                None => (if others.next().is_some() { CHART_SEAM } else { CHART_OPEN }, 0),
            };
        }
    }
    sides
}

/// Of all sides of all triangles the numbers of their ends, in order; those that are equal beside each other.
fn edges(mesh: &RenderMesh, numbers: &[u32]) -> Vec<([u32; 2], [usize; 2])> {
    let of_side = |t: usize, k: usize| {
        let [a, b] = [k, (k + 1) % 3].map(|k| numbers[mesh.triangles[t][k] as usize]);
        ([a.min(b), a.max(b)], [t, k])
    };
    let mut edges: Vec<_> = (0..mesh.triangles.len()).flat_map(|t| (0..3).map(move |k| of_side(t, k))).collect();
    edges.par_sort_unstable();
    edges
}

/// Of vertices, the same for those at the same position.
fn numbers(mesh: &RenderMesh) -> Vec<u32> {
    let mut known = HashMap::with_capacity(mesh.positions.len());
    // Adding 0 makes -0 one with it.
    let key = |position: &[f32; 3]| position.map(|x| (x + 0.0).to_bits());
    let number = |(v, position)| *known.entry(key(position)).or_insert(v as u32);
    mesh.positions.iter().enumerate().map(number).collect()
}

/// The same number for vertices of borders that are nearly at one position: the first that is found, cell by cell of a
/// lattice.
fn joined(mesh: &RenderMesh, mut numbers: Vec<u32>) -> Vec<u32> {
    let edges = edges(mesh, &numbers);
    let alone = edges.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() == 1);
    let mut border: Vec<u32> = alone.flat_map(|same| same[0].0).collect();
    border.sort_unstable();
    border.dedup();
    let position = |v: u32| DVec3::from_array(mesh.positions[v as usize].map(f64::from));
    let (low, high) = border
        .iter()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &v| (low.min(position(v)), high.max(position(v))));
    let near = (high - low).max_element() * SAME_POSITION;
    if !(near > 0.0 && near.is_finite()) {
        return numbers;
    }
    let mut lattice: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    let mut joined: HashMap<u32, u32> = HashMap::new();
    for &v in &border {
        let (at, cell) = (position(v), ((position(v) - low) / near).floor().to_array().map(|x| x as i64));
        let around = (0..27_i64).map(|n| [cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1]);
        let mut known = around.filter_map(|cell| lattice.get(&cell)).flatten();
        match known.find(|other| (position(**other) - at).abs().max_element() <= near) {
            Some(first) => drop(joined.insert(v, *first)),
            None => lattice.entry(cell).or_default().push(v),
        }
    }
    numbers.iter_mut().for_each(|number| *number = joined.get(number).copied().unwrap_or(*number));
    numbers
}

/// A mesh as one of its materials sees it.
struct Charted<'a> {
    mesh: &'a RenderMesh,
    relief: &'a RenderRelief,
    uv_channels: usize,
    numbers: &'a [u32],
}

impl Charted<'_> {
    fn ends(&self, triangle: usize, side: usize) -> [usize; 2] {
        [side, (side + 1) % 3].map(|k| self.mesh.triangles[triangle][k] as usize)
    }

    /// How the second triangle goes on where the first ends; none where it does not on the map.
    fn crossing(&self, [this, k]: [usize; 2], [other, side]: [usize; 2]) -> Option<(u32, Crossing)> {
        let ([a, b], [d, c]) = (self.ends(this, k), self.ends(other, side));
        let [from, to] = [a, b].map(|v| self.numbers[v]);
        let is_turned = from != to && from == self.numbers[c] && to == self.numbers[d];
        let goes_on = is_turned && self.normal(this).dot(self.normal(other)) >= LEAST_COSINE;
        let (area, beyond) = (self.area(this)?, self.area(other)?);
        let turns = self.turns([a, c].map(|v| self.place(v)), [b, d].map(|v| self.place(v)))?;
        let mirrored = (area < 0.0) != (beyond < 0.0);
        goes_on.then_some((other as u32, Crossing { side: side as u32, mirrored, turns }))
    }

    /// What two places of each end of a side are apart, where that is as if there were one map.
    fn turns(&self, a: [DVec2; 2], b: [DVec2; 2]) -> Option<[i32; 2]> {
        let repeats = DVec2::from_array(self.relief.map.repeats.map(|repeats| if repeats { 1.0 } else { 0.0 }));
        let turns = (a[0] - a[1]).round() * repeats;
        let rounding = |[p, q]: [DVec2; 2]| p.abs().max(q.abs()).max_element() * 4.0 * f64::from(f32::EPSILON);
        let is_same = |ends: [DVec2; 2]| (ends[0] - ends[1] - turns).abs().max_element() <= SAME_PLACE + rounding(ends);
        let fits = turns.abs().max_element() <= f64::from(MOST_TURNS);
        (is_same(a) && is_same(b) && fits).then_some([turns.x as i32, turns.y as i32])
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
