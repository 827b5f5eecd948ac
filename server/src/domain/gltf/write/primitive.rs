//! One displaced primitive: its vertices and triangles in the order of the file, its tangents and its skin.

use rayon::prelude::*;

use super::{
    fine::Fine,
    listing::Listing,
    normal_maps::NormalMap,
    pack::Bounds,
    skin::{self, Skin},
    tangents,
};
use crate::domain::{Error, ErrorKind, Result, grid::Grid, mesh::Attribute, report::Warning, scene::Scene};

pub(super) struct Part<'a> {
    pub(super) gltf_mesh: usize,
    pub(super) fine: Fine<'a>,
    pub(super) coding: Coding,
    /// One for each vertex of the file.
    pub(super) tangents: Option<Vec<[f32; 4]>>,
    /// Where the order of the file is not that of the surface.
    pub(super) listing: Option<Listing>,
    pub(super) skin: Option<Skin>,
    /// What its material shows in place of a normal map of the file.
    pub(super) normal_map: Option<&'a NormalMap>,
}

/// How values are written.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Coding {
    /// Whether directions, texture coordinates and colours are in 16 bits.
    pub(super) is_quantized: bool,
    /// That of the mesh, where its positions are quantised.
    pub(super) grid: Option<Grid>,
}

impl<'a> Part<'a> {
    pub(super) fn new(
        scene: &Scene,
        gltf_mesh: usize,
        fine: Fine<'a>,
        coding: Coding,
        normal_map: Option<&'a NormalMap>,
    ) -> Result<(Self, Option<Warning>)> {
        let skin = skin::blend(&fine);
        let mut part = Self { gltf_mesh, coding, tangents: None, listing: None, skin, fine, normal_map };
        part.bounds_of(&part.fine.surface.positions)?;
        let warning = part.make_tangents(scene)?.or_else(|| part.without_tangent_deltas());
        Ok((part, warning))
    }

    /// MikkTSpace where the material has a normal map, else the file's own carried over, else none.
    fn make_tangents(&mut self, scene: &Scene) -> Result<Option<Warning>> {
        let material = self.fine.primitive.material.and_then(|m| scene.materials.get(m));
        let of_file = material.filter(|m| m.has_normal_map).map(|m| m.normal_uv_set);
        let uv_set = self.normal_map.map(|map| map.uv_set).or(of_file);
        let uvs = uv_set.and_then(|set| self.attribute(&format!("TEXCOORD_{set}")));
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
        let split = tangents::made(&self.fine, uvs)?;
        self.tangents = Some(split.tangents);
        self.listing = split.any.then_some(split.listing);
        Ok(())
    }

    /// For caches of vertices and of memory.
    pub(super) fn optimize(&mut self) {
        let former = self.listing.get_or_insert_with(|| Listing::of(&self.fine)).optimize();
        if let Some(tangents) = &mut self.tangents {
            *tangents = former.iter().map(|&vertex| tangents[vertex as usize]).collect();
        }
    }

    /// Without the triangles that are marked.
    pub(super) fn leave_out(&mut self, goes: &[bool]) {
        let listing = self.listing.get_or_insert_with(|| Listing::of(&self.fine));
        let stays = listing.triangles.iter().zip(goes).filter(|(_, goes)| !**goes);
        listing.triangles = stays.map(|(triangle, _)| *triangle).collect();
    }

    pub(super) fn vertices(&self) -> usize {
        self.listing.as_ref().map_or_else(|| self.fine.vertices(), |listing| listing.vertices.len())
    }

    pub(super) fn triangles(&self) -> usize {
        self.listing.as_ref().map_or_else(|| self.fine.triangles().len(), |listing| listing.triangles.len())
    }

    /// Whether it has values that only KHR_mesh_quantization allows.
    pub(super) fn needs_quantization(&self) -> bool {
        self.coding.grid.is_some() || self.has_short_directions()
    }

    /// The fine vertex, numbered within the primitive, of a vertex of the file.
    pub(super) fn fine_vertex(&self, vertex: usize) -> usize {
        self.listing.as_ref().map_or(vertex, |listing| listing.vertices[vertex] as usize)
    }

    /// Positions of a triangle of the file, mesh-local units.
    pub(super) fn corners(&self, triangle: usize) -> [[f32; 3]; 3] {
        let vertices = match &self.listing {
            Some(listing) => listing.triangles[triangle].map(|v| self.fine.global(self.fine_vertex(v as usize))),
            None => self.fine.triangles()[triangle].map(|v| v as usize),
        };
        vertices.map(|v| self.fine.surface.positions[v])
    }

    /// The fine values of an attribute that this primitive has.
    pub(super) fn attribute(&self, semantic: &str) -> Option<&'a [f32]> {
        let mesh = self.fine.mesh;
        let index = mesh.attributes.iter().position(|a| a.semantic == semantic && a.primitives[self.fine.index])?;
        Some(&self.fine.surface.attributes[index])
    }

    /// Exact bounds of a stream of the surface over the vertices of the file; fails where a value is not finite.
    pub(super) fn bounds_of(&self, values: &[[f32; 3]]) -> Result<Bounds> {
        let empty = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        // A NaN compares as neither lower nor higher: it is let through here and caught below.
        let keep = |a: f32, b: f32, better: bool| if better || b.is_nan() { b } else { a };
        let join = |a: Bounds, b: Bounds| {
            let low = [0, 1, 2].map(|k| keep(a.0[k], b.0[k], b.0[k] < a.0[k]));
            (low, [0, 1, 2].map(|k| keep(a.1[k], b.1[k], b.1[k] > a.1[k])))
        };
        let value = |vertex: usize| values[self.fine.global(self.fine_vertex(vertex))];
        let each = (0..self.vertices()).into_par_iter().map(value).map(|p| (p, p));
        let found = each.reduce(|| empty, join);
        if found.0.iter().chain(&found.1).all(|c| c.is_finite()) {
            return Ok(found);
        }
        let name = &self.fine.mesh.name;
        let message = format!("the displaced mesh '{name}' has coordinates that are not finite: lower the scale");
        Err(Error::invalid("details", message))
    }
}
