//! One displaced primitive as accessors.

use std::collections::HashMap;

use rayon::prelude::*;
use serde_json::{Map, Value};

use super::{
    fine::{Fine, is_skin},
    pack::{ARRAY_BUFFER, Builder, ELEMENT_ARRAY_BUFFER, F32, Stream, U8, U16, U32},
    skin::{self, Skin},
};
use crate::domain::{Error, ErrorKind, Result, mesh::Attribute, report::Warning, scene::Scene, weld::mikk_tangents};

type Bounds = ([f32; 3], [f32; 3]);

pub(super) struct Part<'a> {
    pub(super) gltf_mesh: usize,
    pub(super) fine: Fine<'a>,
    bounds: Bounds,
    tangents: Option<Vec<[f32; 4]>>,
    split: Option<Split>,
    skin: Option<Skin>,
}

/// Vertices doubled because the tangents of their triangles differ.
struct Split {
    /// The vertex each added vertex is a copy of.
    copies: Vec<u32>,
    triangles: Vec<[u32; 3]>,
}

impl<'a> Part<'a> {
    pub(super) fn new(scene: &Scene, gltf_mesh: usize, fine: Fine<'a>) -> Result<(Self, Option<Warning>)> {
        let bounds = bounds(&fine)?;
        let mut part = Self { gltf_mesh, bounds, tangents: None, split: None, skin: skin::blend(&fine), fine };
        let warning = part.make_tangents(scene)?.or_else(|| part.without_tangent_deltas());
        Ok((part, warning))
    }

    /// MikkTSpace where the material has a normal map, else the file's own carried over, else none.
    fn make_tangents(&mut self, scene: &Scene) -> Result<Option<Warning>> {
        let material = self.fine.primitive.material.and_then(|m| scene.materials.get(m));
        let normal_map = material.filter(|m| m.has_normal_map).map(|m| m.normal_uv_set);
        let uvs = normal_map.and_then(|set| self.attribute(&format!("TEXCOORD_{set}")));
        if let Some(uvs) = uvs {
            return match self.mikk(uvs) {
                Ok(()) => Ok(None),
                // Tangents are optional: viewers make their own.
                Err(error) if error.kind == ErrorKind::TooLarge => Ok(Some(self.no_tangents(&error))),
                Err(error) => Err(error),
            };
        }
        if self.fine.mesh.has_tangents(self.fine.primitive) && !self.fine.primitive.made_tangents {
            self.tangents = Some(skin::carried_tangents(&self.fine));
        }
        Ok(None)
    }

    /// Deltas of tangents mean nothing without tangents.
    fn without_tangent_deltas(&self) -> Option<Warning> {
        let is_delta = |a: &&Attribute| a.semantic.starts_with("targets/") && a.semantic.ends_with("/TANGENT");
        let here = |a: &&Attribute| a.primitives[self.fine.index];
        self.fine.mesh.attributes.iter().filter(|_| self.tangents.is_none()).find(|a| is_delta(a) && here(a))?;
        let place = format!("meshes[{}].primitives[{}]", self.gltf_mesh, self.fine.primitive.gltf_primitive);
        let message = format!("{place} has morph targets of tangents and no tangents: those are left out");
        Some(Warning::new("tangent_targets_dropped", message))
    }

    fn no_tangents(&self, error: &Error) -> Warning {
        let place = format!("meshes[{}].primitives[{}]", self.gltf_mesh, self.fine.primitive.gltf_primitive);
        Warning::new("no_tangents", format!("{place} has no tangents: {}", error.message))
    }

    fn mikk(&mut self, uvs: &'a [f32]) -> Result<()> {
        let fine = &self.fine;
        let mut triangles: Vec<[u32; 3]> = fine.triangles().par_iter().map(|t| t.map(|v| fine.local(v))).collect();
        let surface = fine.surface;
        let of_corners = mikk_tangents(
            &triangles,
            |v| surface.positions[fine.global(v as usize)],
            |v| surface.normals[fine.global(v as usize)],
            |v| [uvs[2 * fine.global(v as usize)], uvs[2 * fine.global(v as usize) + 1]],
        )?;
        let mut tangents = vec![[0.0f32; 4]; fine.vertices()];
        let mut copies = Vec::new();
        let mut copy_of = HashMap::new();
        for (vertex, tangent) in triangles.as_flattened_mut().iter_mut().zip(of_corners) {
            let known = &mut tangents[*vertex as usize];
            if known[3] == 0.0 {
                *known = tangent;
            } else if *known != tangent {
                let next = (fine.vertices() + copies.len()) as u32;
                let copy = *copy_of.entry((*vertex, tangent.map(f32::to_bits))).or_insert(next);
                if copy == next {
                    copies.push(*vertex);
                    tangents.push(tangent);
                }
                *vertex = copy;
            }
        }
        self.tangents = Some(tangents);
        self.split = (!copies.is_empty()).then_some(Split { copies, triangles });
        Ok(())
    }

    /// The fine values of an attribute that this primitive has.
    fn attribute(&self, semantic: &str) -> Option<&'a [f32]> {
        let mesh = self.fine.mesh;
        let index = mesh.attributes.iter().position(|a| a.semantic == semantic && a.primitives[self.fine.index])?;
        Some(&self.fine.surface.attributes[index])
    }

    fn vertices(&self) -> usize {
        self.fine.vertices() + self.copies().len()
    }

    fn copies(&self) -> &[u32] {
        self.split.as_ref().map_or(&[], |split| &split.copies)
    }

    /// Adds all accessors; returns the primitive's attributes, indices and morph targets.
    pub(super) fn write<'b>(&'b self, builder: &mut Builder<'b>) -> Result<(Map<String, Value>, usize, Vec<Value>)> {
        let surface = self.fine.surface;
        let mut attributes = Map::new();
        let mut targets = Targets::default();
        attributes.insert(
            "POSITION".into(),
            self.floats(builder, surface.positions.as_flattened(), 3, Some(self.bounds)).into(),
        );
        attributes.insert("NORMAL".into(), self.floats(builder, surface.normals.as_flattened(), 3, None).into());
        if let Some(tangents) = &self.tangents {
            attributes.insert("TANGENT".into(), self.own(builder, F32, 4, tangents.as_flattened()).into());
        }
        for (attribute, fine) in self.fine.mesh.attributes.iter().zip(&surface.attributes) {
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
        Ok((attributes, self.write_indices(builder), targets.list))
    }

    fn plain<'b>(&'b self, builder: &mut Builder<'b>, attribute: &Attribute, fine: &'b [f32]) -> usize {
        if !skin::is_identifier(attribute) {
            return self.floats(builder, fine, attribute.components, None);
        }
        let mut values = skin::nearest(&self.fine, attribute);
        let n = attribute.components;
        for &copy in self.copies() {
            values.extend_from_within(copy as usize * n..(copy as usize + 1) * n);
        }
        let stream = self.stream(F32, n, None);
        builder.stream(stream, Box::new(move |out| out.copy_from_slice(bytemuck::cast_slice(&values))))
    }

    fn target<'b>(
        &'b self,
        builder: &mut Builder<'b>,
        attribute: &Attribute,
        fine: &'b [f32],
        semantic: &str,
    ) -> Result<usize> {
        let bounds = (semantic == "POSITION").then(|| bounds_of(&self.fine, fine.as_chunks().0)).transpose()?;
        Ok(self.floats(builder, fine, attribute.components, bounds))
    }

    fn stream(&self, component: u32, components: usize, bounds: Option<Bounds>) -> Stream {
        Stream { target: ARRAY_BUFFER, component, components, count: self.vertices(), bounds }
    }

    /// A stream of the surface: its three ranges, then the copies.
    fn floats<'b>(
        &'b self,
        builder: &mut Builder<'b>,
        values: &'b [f32],
        components: usize,
        bounds: Option<Bounds>,
    ) -> usize {
        let fill = move |out: &mut [u8]| {
            let bytes: &[u8] = bytemuck::cast_slice(values);
            let size = 4 * components;
            let (plain, copied) = out.split_at_mut(self.fine.vertices() * size);
            self.fine.gather(bytes, size, plain);
            for (out, &copy) in copied.chunks_exact_mut(size).zip(self.copies()) {
                out.copy_from_slice(&bytes[self.fine.global(copy as usize) * size..][..size]);
            }
        };
        builder.stream(self.stream(F32, components, bounds), Box::new(fill))
    }

    /// A stream that this part owns, copies included.
    fn own<'b, T: bytemuck::NoUninit + Sync>(
        &'b self,
        builder: &mut Builder<'b>,
        component: u32,
        components: usize,
        values: &'b [T],
    ) -> usize {
        let fill = move |out: &mut [u8]| out.copy_from_slice(bytemuck::cast_slice(values));
        builder.stream(self.stream(component, components, None), Box::new(fill))
    }

    fn write_skin<'b>(&'b self, builder: &mut Builder<'b>, attributes: &mut Map<String, Value>) {
        let Some(skin) = &self.skin else { return };
        let bytes = skin.joints.par_iter().all(|joint| *joint <= 255);
        for set in 0..skin.sets {
            let slots = move |vertex: usize| (vertex * skin.sets + set) * 4..(vertex * skin.sets + set) * 4 + 4;
            let joints = move |out: &mut [u8]| {
                let size = if bytes { 4 } else { 8 };
                for (vertex, out) in self.all_vertices().zip(out.chunks_exact_mut(size)) {
                    for (joint, out) in skin.joints[slots(vertex)].iter().zip(out.chunks_exact_mut(size / 4)) {
                        out.copy_from_slice(&joint.to_le_bytes()[..size / 4]);
                    }
                }
            };
            let weights = move |out: &mut [u8]| {
                for (vertex, out) in self.all_vertices().zip(out.chunks_exact_mut(16)) {
                    out.copy_from_slice(bytemuck::cast_slice(&skin.weights[slots(vertex)]));
                }
            };
            let joints = builder.stream(self.stream(if bytes { U8 } else { U16 }, 4, None), Box::new(joints));
            attributes.insert(format!("JOINTS_{set}"), joints.into());
            attributes
                .insert(format!("WEIGHTS_{set}"), builder.stream(self.stream(F32, 4, None), Box::new(weights)).into());
        }
    }

    /// Every vertex of the file as the vertex whose values it has.
    fn all_vertices(&self) -> impl Iterator<Item = usize> {
        (0..self.fine.vertices()).chain(self.copies().iter().map(|&copy| copy as usize))
    }

    fn write_indices<'b>(&'b self, builder: &mut Builder<'b>) -> usize {
        // 65535 itself would mean a primitive restart.
        let short = self.vertices() <= 65535;
        let fine = &self.fine;
        let fill = move |out: &mut [u8]| match &self.split {
            Some(split) => fill_indices(out, short, &split.triangles, |v| v),
            None => fill_indices(out, short, fine.triangles(), |v| fine.local(v)),
        };
        let stream = Stream {
            target: ELEMENT_ARRAY_BUFFER,
            component: if short { U16 } else { U32 },
            components: 1,
            count: 3 * fine.triangles().len(),
            bounds: None,
        };
        builder.stream(stream, Box::new(fill))
    }
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

fn bounds(fine: &Fine<'_>) -> Result<Bounds> {
    bounds_of(fine, &fine.surface.positions)
}

/// Exact bounds; fails where a value is not finite.
fn bounds_of(fine: &Fine<'_>, values: &[[f32; 3]]) -> Result<Bounds> {
    let empty = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    // A NaN compares as neither lower nor higher: it is let through here and caught below.
    let keep = |a: f32, b: f32, better: bool| if better || b.is_nan() { b } else { a };
    let join = |a: Bounds, b: Bounds| {
        let low = [0, 1, 2].map(|k| keep(a.0[k], b.0[k], b.0[k] < a.0[k]));
        (low, [0, 1, 2].map(|k| keep(a.1[k], b.1[k], b.1[k] > a.1[k])))
    };
    let add = |bounds: Bounds, p: &[f32; 3]| join(bounds, (*p, *p));
    let found =
        fine.ranges.iter().map(|range| values[range.clone()].par_iter().fold(|| empty, add).reduce(|| empty, join));
    let found = found.fold(empty, join);
    if found.0.iter().chain(&found.1).all(|c| c.is_finite()) {
        return Ok(found);
    }
    let message =
        format!("the displaced mesh '{}' has coordinates that are not finite: lower the scale", fine.mesh.name);
    Err(Error::invalid("details", message))
}
