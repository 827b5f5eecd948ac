//! One region as meshoptimizer takes it: about its own centre, as large as 1, its vertices and triangles in an order
//! that follows from places alone.

use glam::DVec3;
use meshopt::{SimplifyOptions, simplify_with_attributes_and_locks_decoder};

use crate::domain::surface::Surface;

/// What an attribute costs that is off by 1, in tolerances: a normal off by a quarter, some 14 degrees, costs half of one.
const NORMAL: f64 = 2.0;
/// What a texture costs that slides, per length: half as much as a place that is off.
const SLIDE: f64 = 0.5;
/// As `NORMAL`, of a component of a colour.
const COLOR: f64 = 4.0;
const COLORS: usize = 3;

/// Values that hold vertices in place, beside positions.
pub(super) struct Held<'a> {
    surface: &'a Surface,
    /// Streams with their components and how many of those count, and the length (mesh-local units) that a difference
    /// of 1 is worth.
    streams: Vec<(&'a [f32], usize, usize, f64)>,
}

/// Some triangles of a surface.
pub(super) struct Patch<'a> {
    held: &'a Held<'a>,
    /// Fine vertices, by place.
    vertices: Vec<u32>,
    /// Of `vertices`.
    triangles: Vec<[u32; 3]>,
    locked: Vec<bool>,
    centre: DVec3,
    extent: f64,
}

impl<'a> Held<'a> {
    /// `names` are those of the surface's attributes, with their components.
    pub(super) fn new(surface: &'a Surface, names: &[(&str, usize)], tolerance_local: f64) -> Self {
        let mut streams = vec![(surface.normals.as_flattened(), 3, 3, NORMAL * tolerance_local)];
        for (values, &(name, components)) in surface.attributes.iter().zip(names) {
            if name.starts_with("TEXCOORD_") {
                streams.push((values, components, components, SLIDE * length_per_uv(surface, values)));
            } else if name.starts_with("COLOR_") {
                streams.push((values, components, components.min(COLORS), COLOR * tolerance_local));
            }
        }
        Self { surface, streams }
    }

    fn weights(&self, extent: f64) -> Vec<f32> {
        let of = |(_, _, counted, worth): &(&[f32], usize, usize, f64)| vec![(worth / extent) as f32; *counted];
        self.streams.iter().flat_map(of).collect()
    }

    fn values(&self, vertex: u32) -> impl Iterator<Item = f32> {
        let of = move |&(values, components, counted, _): &(&'a [f32], usize, usize, f64)| {
            values[vertex as usize * components..][..counted].iter().copied()
        };
        self.streams.iter().flat_map(of)
    }
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

impl<'a> Patch<'a> {
    pub(super) fn new(held: &'a Held<'a>, triangles: &[[u32; 3]], is_locked: impl Fn(u32) -> bool) -> Self {
        let position = |v: u32| held.surface.positions[v as usize];
        let mut vertices: Vec<u32> = triangles.as_flattened().to_vec();
        vertices.sort_unstable();
        vertices.dedup();
        let by_place = |a: &u32, b: &u32| {
            let (p, q) = (position(*a), position(*b));
            let along = |k: usize| p[k].total_cmp(&q[k]);
            along(0).then(along(1)).then(along(2)).then(a.cmp(b))
        };
        vertices.sort_unstable_by(by_place);
        let local = |v: u32| vertices.binary_search_by(|own| by_place(own, &v)).map_or(0, |at| at as u32);
        let mut own: Vec<[u32; 3]> = triangles.iter().map(|t| from_least(t.map(local))).collect();
        own.sort_unstable();
        let low = vertices.iter().map(|v| place(held.surface, *v)).fold(DVec3::INFINITY, DVec3::min);
        let high = vertices.iter().map(|v| place(held.surface, *v)).fold(DVec3::NEG_INFINITY, DVec3::max);
        let locked = vertices.iter().map(|v| is_locked(*v)).collect();
        let extent = (high - low).max_element().max(f64::MIN_POSITIVE);
        Self { held, triangles: own, locked, centre: 0.5 * (low + high), extent, vertices }
    }

    /// As few triangles as meshoptimizer finds for an error of about `error_local`, of the same vertices.
    pub(super) fn proposal(&self, error_local: f64) -> Vec<[u32; 3]> {
        let scaled = |v: &u32| ((place(self.held.surface, *v) - self.centre) / self.extent).as_vec3().to_array();
        let positions: Vec<[f32; 3]> = self.vertices.iter().map(scaled).collect();
        let values: Vec<f32> = self.vertices.iter().flat_map(|v| self.held.values(*v)).collect();
        let weights = self.held.weights(self.extent);
        let indices = simplify_with_attributes_and_locks_decoder(
            self.triangles.as_flattened(),
            &positions,
            &values,
            &weights,
            weights.len() * size_of::<f32>(),
            &self.locked,
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
