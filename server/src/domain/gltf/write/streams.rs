//! The accessors of one displaced primitive.

use rayon::prelude::*;
use serde_json::{Map, Value};

use super::{
    fine::is_skin,
    pack::{Bounds, Builder, Component, Stream},
    primitive::Part,
    skin,
};
use crate::domain::{Result, grid::Grid, mesh::Attribute};

/// What a primitive of the document refers to.
pub(super) struct References {
    pub(super) attributes: Map<String, Value>,
    pub(super) indices: usize,
    pub(super) targets: Vec<Value>,
}

impl Part<'_> {
    /// Adds all accessors.
    pub(super) fn write<'b>(&'b self, builder: &mut Builder<'b>) -> Result<References> {
        let mut attributes = Map::new();
        let mut targets = Targets::default();
        attributes.insert("POSITION".into(), self.write_positions(builder)?.into());
        attributes.insert("NORMAL".into(), self.write_normals(builder).into());
        if let Some(tangents) = &self.tangents {
            attributes.insert("TANGENT".into(), self.write_tangents(builder, tangents).into());
        }
        for (attribute, fine) in self.fine.mesh.attributes.iter().zip(&self.fine.surface.attributes) {
            if !attribute.primitives[self.fine.index] || is_skin(&attribute.semantic) {
                continue;
            }
            match attribute.semantic.strip_prefix("targets/").and_then(|rest| rest.split_once('/')) {
                // Told of by `without_tangent_deltas`.
                Some((_, "TANGENT")) if self.tangents.is_none() => {}
                Some((number, semantic)) => {
                    targets.put(number, semantic, self.target(builder, attribute, fine, semantic)?)
                }
                None => {
                    attributes.insert(attribute.semantic.clone(), self.plain(builder, attribute, fine).into());
                }
            }
        }
        self.write_skin(builder, &mut attributes);
        Ok(References { attributes, indices: self.write_indices(builder), targets: targets.list })
    }

    fn write_positions<'b>(&'b self, builder: &mut Builder<'b>) -> Result<usize> {
        let positions = &self.fine.surface.positions;
        let bounds = self.bounds_of(positions)?;
        Ok(match self.coding.grid {
            None => self.floats(builder, positions.as_flattened(), 3, Some(bounds)),
            Some(grid) => self.places(builder, grid, bounds),
        })
    }

    fn places<'b>(&'b self, builder: &mut Builder<'b>, grid: Grid, (low, high): Bounds) -> usize {
        let place = |position: [f32; 3]| grid.place(position).map(f32::from);
        let bounds = Some((place(low), place(high)));
        let positions = &self.fine.surface.positions;
        let stream = Stream { bounds, ..self.stream(Component::U16, 3) };
        self.each(builder, stream, move |vertex, out| {
            put(grid.place(positions[self.global(vertex)]).into_iter().map(u16::to_le_bytes), out);
        })
    }

    fn write_normals<'b>(&'b self, builder: &mut Builder<'b>) -> usize {
        let normals = &self.fine.surface.normals;
        if !self.has_short_directions() {
            return self.floats(builder, normals.as_flattened(), 3, None);
        }
        let stream = Stream { is_directions: true, ..self.stream(Component::Snorm16, 3) };
        self.each(builder, stream, |vertex, out| put(normals[self.global(vertex)].into_iter().map(snorm), out))
    }

    fn write_tangents<'b>(&'b self, builder: &mut Builder<'b>, tangents: &'b [[f32; 4]]) -> usize {
        if !self.has_short_directions() {
            let stream = self.stream(Component::F32, 4);
            return self
                .each(builder, stream, |vertex, out| out.copy_from_slice(bytemuck::bytes_of(&tangents[vertex])));
        }
        let stream = Stream { is_directions: true, ..self.stream(Component::Snorm16, 4) };
        self.each(builder, stream, |vertex, out| put(tangents[vertex].into_iter().map(snorm), out))
    }

    /// Deltas of morph targets are added to what they are of: both stay as they are.
    pub(super) fn has_short_directions(&self) -> bool {
        let is_target = |a: &Attribute| a.semantic.starts_with("targets/") && a.primitives[self.fine.index];
        self.coding.is_quantized && !self.fine.mesh.attributes.iter().any(is_target)
    }

    fn plain<'b>(&'b self, builder: &mut Builder<'b>, attribute: &Attribute, fine: &'b [f32]) -> usize {
        let n = attribute.components;
        if skin::is_identifier(attribute) {
            let values = skin::nearest(&self.fine, attribute);
            return self.each(builder, self.stream(Component::F32, n), move |vertex, out| {
                out.copy_from_slice(bytemuck::cast_slice(&values[self.fine_vertex(vertex) * n..][..n]));
            });
        }
        if !self.is_within_unit(attribute, fine) {
            return self.floats(builder, fine, n, None);
        }
        self.each(builder, self.stream(Component::Unorm16, n), move |vertex, out| {
            put(fine[self.global(vertex) * n..][..n].iter().copied().map(unorm), out);
        })
    }

    /// Whether 16 bits from 0 to 1 hold all values, and viewers know such.
    fn is_within_unit(&self, attribute: &Attribute, fine: &[f32]) -> bool {
        let known = attribute.semantic.starts_with("TEXCOORD_") || attribute.semantic.starts_with("COLOR_");
        let n = attribute.components;
        let of_range = |range: &std::ops::Range<usize>| &fine[range.start * n..range.end * n];
        let within = |values: &[f32]| values.par_iter().all(|value| (0.0..=1.0).contains(value));
        self.coding.is_quantized && known && self.fine.ranges.iter().map(of_range).all(within)
    }

    fn target<'b>(
        &'b self,
        builder: &mut Builder<'b>,
        attribute: &Attribute,
        fine: &'b [f32],
        semantic: &str,
    ) -> Result<usize> {
        let bounds = (semantic == "POSITION").then(|| self.bounds_of(fine.as_chunks().0)).transpose()?;
        Ok(self.floats(builder, fine, attribute.components, bounds))
    }

    fn write_skin<'b>(&'b self, builder: &mut Builder<'b>, attributes: &mut Map<String, Value>) {
        let Some(skin) = &self.skin else { return };
        let bytes = skin.joints.par_iter().all(|joint| *joint <= 255);
        let component = if bytes { Component::U8 } else { Component::U16 };
        for set in 0..skin.sets {
            let first = move |vertex: usize| (self.fine_vertex(vertex) * skin.sets + set) * 4;
            let joints = self.each(builder, self.stream(component, 4), move |vertex, out| {
                let size = out.len() / 4;
                for (joint, out) in skin.joints[first(vertex)..].iter().zip(out.chunks_exact_mut(size)) {
                    out.copy_from_slice(&joint.to_le_bytes()[..size]);
                }
            });
            let weights = self.each(builder, self.stream(Component::F32, 4), move |vertex, out| {
                out.copy_from_slice(bytemuck::cast_slice(&skin.weights[first(vertex)..][..4]));
            });
            attributes.insert(format!("JOINTS_{set}"), joints.into());
            attributes.insert(format!("WEIGHTS_{set}"), weights.into());
        }
    }

    fn write_indices<'b>(&'b self, builder: &mut Builder<'b>) -> usize {
        // 65535 itself would mean a primitive restart.
        let short = self.vertices() <= 65535;
        let fine = &self.fine;
        let fill = move |out: &mut [u8]| match &self.listing {
            Some(listing) => fill_indices(out, short, &listing.triangles, |v| v),
            None => fill_indices(out, short, fine.triangles(), |v| fine.local(v)),
        };
        let component = if short { Component::U16 } else { Component::U32 };
        builder.stream(Stream::of_indices(component, 3 * self.triangles()), Box::new(fill))
    }

    fn stream(&self, component: Component, components: usize) -> Stream {
        Stream::of_vertices(component, components, self.vertices())
    }

    /// The vertex of the surface of a vertex of the file.
    fn global(&self, vertex: usize) -> usize {
        self.fine.global(self.fine_vertex(vertex))
    }

    /// A stream of the surface as it is.
    fn floats<'b>(
        &'b self,
        builder: &mut Builder<'b>,
        values: &'b [f32],
        components: usize,
        bounds: Option<Bounds>,
    ) -> usize {
        let stream = Stream { bounds, ..self.stream(Component::F32, components) };
        let (bytes, size): (&[u8], usize) = (bytemuck::cast_slice(values), stream.stride());
        if self.listing.is_none() {
            return builder.stream(stream, Box::new(move |out| self.fine.gather(bytes, size, out)));
        }
        self.each(builder, stream, move |vertex, out| {
            out.copy_from_slice(&bytes[self.global(vertex) * size..][..size]);
        })
    }

    /// A stream whose elements `put` makes, each from the number of its vertex in the file.
    fn each<'b>(
        &'b self,
        builder: &mut Builder<'b>,
        stream: Stream,
        put: impl Fn(usize, &mut [u8]) + Send + Sync + 'b,
    ) -> usize {
        const BLOCK: usize = 1 << 12;
        let (stride, size) = (stream.stride(), stream.element_bytes());
        let fill = move |out: &mut [u8]| {
            let elements = out.par_chunks_exact_mut(stride).with_min_len(BLOCK).enumerate();
            elements.for_each(|(vertex, out)| put(vertex, &mut out[..size]));
        };
        builder.stream(stream, Box::new(fill))
    }
}

/// Moves by at most 1/65534.
fn snorm(value: f32) -> [u8; 2] {
    ((value.clamp(-1.0, 1.0) * f32::from(i16::MAX)).round() as i16).to_le_bytes()
}

/// Of 0 to 1; moves by at most 1/131070.
fn unorm(value: f32) -> [u8; 2] {
    ((value * f32::from(u16::MAX)).round() as u16).to_le_bytes()
}

fn put(values: impl Iterator<Item = [u8; 2]>, out: &mut [u8]) {
    out.as_chunks_mut().0.iter_mut().zip(values).for_each(|(out, value)| *out = value);
}

fn fill_indices(out: &mut [u8], short: bool, triangles: &[[u32; 3]], local: impl Fn(u32) -> u32 + Sync) {
    const BLOCK: usize = 1 << 14;
    let size = if short { 2 } else { 4 };
    let indices = triangles.as_flattened();
    out.par_chunks_mut(BLOCK * size).zip(indices.par_chunks(BLOCK)).for_each(|(out, indices)| {
        for (out, &index) in out.chunks_exact_mut(size).zip(indices) {
            out.copy_from_slice(&local(index).to_le_bytes()[..size]);
        }
    });
}

#[derive(Default)]
struct Targets {
    list: Vec<Value>,
}

impl Targets {
    fn put(&mut self, number: &str, semantic: &str, accessor: usize) {
        let number = number.parse::<usize>().unwrap_or(0);
        if self.list.len() <= number {
            self.list.resize(number + 1, Value::Object(Map::new()));
        }
        self.list[number][semantic] = accessor.into();
    }
}
