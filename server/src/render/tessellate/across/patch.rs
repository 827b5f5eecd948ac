//! A surface as meshoptimizer takes it: about its own centre, as large as 1, its vertices and triangles in an order
//! that follows from places alone.

use std::cmp::Ordering;

use glam::DVec3;
use meshopt::{SimplifyOptions, simplify_with_attributes_and_locks_decoder};
use rayon::prelude::*;

use crate::domain::{mesh::Mesh, surface::Surface};

/// What an attribute costs that is off by 1, in tolerances: a normal off by a quarter, some 14 degrees, costs half of one.
const NORMAL: f64 = 2.0;
/// What a texture costs that slides, per length: half as much as a place that is off.
const SLIDE: f64 = 0.5;
/// As `NORMAL`, of a component of a colour.
const COLOR: f64 = 4.0;
const COLORS: usize = 3;

/// A surface's triangles, and what holds its vertices in place beside positions.
pub(super) struct Patch {
    /// Fine vertices, by place.
    vertices: Vec<u32>,
    /// Of `vertices`.
    triangles: Vec<[u32; 3]>,
    /// Of `vertices`.
    positions: Vec<[f32; 3]>,
    values: Vec<f32>,
    weights: Vec<f32>,
    extent: f64,
}

/// A stream of the surface: values, components, how many of them count, and the length (mesh-local units) that a
/// difference of 1 is worth.
type Stream<'a> = (&'a [f32], usize, usize, f64);

fn streams<'a>(mesh: &Mesh, surface: &'a Surface, tolerance_local: f64) -> Vec<Stream<'a>> {
    let mut streams = vec![(surface.normals.as_flattened(), 3, 3, NORMAL * tolerance_local)];
    for (values, attribute) in surface.attributes.iter().zip(&mesh.attributes) {
        let components = attribute.components;
        if attribute.semantic.starts_with("TEXCOORD_") {
            streams.push((values, components, components, SLIDE * length_per_uv(surface, values)));
        } else if attribute.semantic.starts_with("COLOR_") {
            streams.push((values, components, components.min(COLORS), COLOR * tolerance_local));
        }
    }
    streams
}

/// The primitive of each fine vertex that a triangle has.
fn primitives(mesh: &Mesh, surface: &Surface) -> Vec<u32> {
    let mut primitives = vec![0; surface.positions.len()];
    for (number, primitive) in (0..).zip(&mesh.primitives) {
        let triangles = &surface.triangles[surface.layout.triangles_of_primitive(primitive)];
        triangles.as_flattened().iter().for_each(|v| primitives[*v as usize] = number);
    }
    primitives
}

/// How long a difference of 1 in texture coordinates is over the whole surface; 0 where they cover nothing.
fn length_per_uv(surface: &Surface, uvs: &[f32]) -> f64 {
    let uv = |v: u32| DVec3::new(f64::from(uvs[2 * v as usize]), f64::from(uvs[2 * v as usize + 1]), 0.0);
    let areas = surface.triangles.iter().map(|t| {
        let double = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).length();
        (double(t.map(|v| place(surface, v))), double(t.map(uv)))
    });
    let (area, area_uv) = areas.fold((0.0, 0.0), |(a, b), (c, d)| (a + c, b + d));
    if area_uv > 0.0 { (area / area_uv).sqrt() } else { 0.0 }
}

pub(super) fn place(surface: &Surface, vertex: u32) -> DVec3 {
    DVec3::from_array(surface.positions[vertex as usize].map(f64::from))
}

impl Patch {
    pub(super) fn new(mesh: &Mesh, surface: &Surface, tolerance_local: f64) -> Self {
        let streams = streams(mesh, surface, tolerance_local);
        let primitives = primitives(mesh, surface);
        let values =
            |v: u32| streams.iter().flat_map(move |&(all, size, counted, _)| &all[v as usize * size..][..counted]);
        let by_place = |a: &u32, b: &u32| {
            let of = |v: u32| surface.positions[v as usize].into_iter().chain(values(v).copied());
            let values = of(*a).zip(of(*b)).map(|(x, y)| x.total_cmp(&y)).find(|order| order.is_ne());
            values.unwrap_or(Ordering::Equal).then(primitives[*a as usize].cmp(&primitives[*b as usize]))
        };
        let mut all: Vec<u32> = surface.triangles.as_flattened().to_vec();
        all.par_sort_unstable();
        all.dedup();
        all.par_sort_by(by_place);
        // What differs in nothing that counts is one vertex: tangents may differ, and would hold all of them.
        let mut own = vec![0; surface.positions.len()];
        let mut vertices: Vec<u32> = Vec::new();
        for alike in all.chunk_by(|a, b| by_place(a, b).is_eq()) {
            alike.iter().for_each(|v| own[*v as usize] = vertices.len() as u32);
            vertices.push(alike[0]);
        }
        let mut triangles: Vec<[u32; 3]> =
            surface.triangles.par_iter().map(|t| from_least(t.map(|v| own[v as usize]))).collect();
        triangles.par_sort_unstable();
        let at = || vertices.iter().map(|v| place(surface, *v));
        let (low, high) = (at().fold(DVec3::INFINITY, DVec3::min), at().fold(DVec3::NEG_INFINITY, DVec3::max));
        let (centre, extent) = (0.5 * (low + high), (high - low).max_element().max(f64::MIN_POSITIVE));
        let weight = |&(_, _, counted, worth): &Stream<'_>| std::iter::repeat_n((worth / extent) as f32, counted);
        Self {
            positions: at().map(|p| ((p - centre) / extent).as_vec3().to_array()).collect(),
            values: vertices.iter().flat_map(|v| values(*v)).copied().collect(),
            weights: streams.iter().flat_map(weight).collect(),
            vertices,
            triangles,
            extent,
        }
    }

    /// As few triangles as meshoptimizer finds for an error of about `error_local`, of the same vertices.
    pub(super) fn proposal(&self, error_local: f64, is_locked: impl Fn(u32) -> bool) -> Vec<[u32; 3]> {
        let locked: Vec<bool> = self.vertices.iter().map(|v| is_locked(*v)).collect();
        let indices = simplify_with_attributes_and_locks_decoder(
            self.triangles.as_flattened(),
            &self.positions,
            &self.values,
            &self.weights,
            self.weights.len() * size_of::<f32>(),
            &locked,
            0,
            (error_local / self.extent) as f32,
            SimplifyOptions::LockBorder | SimplifyOptions::ErrorAbsolute,
            None,
        );
        let (triangles, _) = indices.as_chunks::<3>();
        triangles.iter().map(|t| t.map(|v| self.vertices[v as usize])).collect()
    }
}

/// The same triangle from its least corner on.
pub(super) fn from_least(mut triangle: [u32; 3]) -> [u32; 3] {
    let least = (0..3).min_by_key(|&k| triangle[k]).unwrap_or(0);
    triangle.rotate_left(least);
    triangle
}
