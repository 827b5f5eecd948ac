//! Editing the document: what refers to accessors and buffer views, what is kept, what is renumbered.

use std::collections::HashSet;

use serde_json::{Map, Value};

use super::{bounds, pack::Builder, streams::References};
use crate::domain::{Error, Result, gltf::extensions::refers_to_no_data, report::Warning, scene::Scene};

/// Which accessors and buffer views of the file are still referred to.
pub(super) struct Kept {
    accessors: Vec<bool>,
    views: Vec<bool>,
}

impl Kept {
    /// Call when the displaced primitives refer to nothing any more. An extension nobody here knows may
    /// refer to anything: then everything is kept, under its old number.
    pub(super) fn of(document: &mut Value) -> Self {
        let count = |document: &Value, key: &str| document.get(key).and_then(Value::as_array).map_or(0, Vec::len);
        let all = !names(document, "extensionsUsed").all(refers_to_no_data);
        let mut kept = Self {
            accessors: vec![all; count(document, "accessors")],
            views: vec![all; count(document, "bufferViews")],
        };
        for_each_accessor_index(document, &mut |index| mark(&mut kept.accessors, index));
        let accessors = kept.accessors.clone();
        for_each_view_index(document, &accessors, &mut |index| mark(&mut kept.views, index));
        kept
    }

    /// Hands the kept accessors and views with their bytes to the builder and renumbers all references.
    pub(super) fn copy(
        &self,
        document: &mut Value,
        scene: &Scene,
        builder: &mut Builder<'_>,
        warnings: &mut Vec<Warning>,
    ) -> Result<()> {
        bounds::mend(document, &self.accessors, scene, warnings)?;
        let views = document.get("bufferViews").and_then(Value::as_array).cloned().unwrap_or_default();
        let new_view = renumbered(&self.views);
        for (view, _) in views.iter().zip(&self.views).filter(|(_, kept)| **kept) {
            let bytes = view_bytes(view, scene)?;
            let mut properties: Map<String, Value> = view.as_object().cloned().unwrap_or_default();
            properties.remove("byteOffset");
            builder.view(properties, bytes.len(), Box::new(move |out| out.copy_from_slice(&bytes)));
        }
        for_each_view_index(document, &self.accessors, &mut |index| renumber(&new_view, index));
        let new_accessor = renumbered(&self.accessors);
        for_each_accessor_index(document, &mut |index| renumber(&new_accessor, index));
        let accessors =
            document.get_mut("accessors").and_then(Value::as_array_mut).map(std::mem::take).unwrap_or_default();
        builder.accessors.extend(accessors.into_iter().zip(&self.accessors).filter(|(_, kept)| **kept).map(|(a, _)| a));
        Ok(())
    }
}

pub(super) fn view_bytes(view: &Value, scene: &Scene) -> Result<bytes::Bytes> {
    let number = |key: &str| view.get(key).map_or(Some(0), index_of);
    let range = number("byteOffset").zip(number("byteLength")).map(|(start, length)| start..start + length);
    let buffer = number("buffer").and_then(|buffer| scene.buffers.get(buffer));
    match (range, buffer) {
        (Some(range), Some(buffer)) if range.end <= buffer.len() => Ok(buffer.slice(range)),
        _ => Err(Error::internal("a checked buffer view reaches outside its buffer")),
    }
}

fn mark(kept: &mut [bool], index: &mut Value) {
    if let Some(slot) = index_of(index).and_then(|i| kept.get_mut(i)) {
        *slot = true;
    }
}

fn renumbered(kept: &[bool]) -> Vec<usize> {
    kept.iter().scan(0, |next, kept| Some(std::mem::replace(next, *next + usize::from(*kept)))).collect()
}

fn renumber(new: &[usize], index: &mut Value) {
    if let Some(&number) = index_of(index).and_then(|i| new.get(i)) {
        *index = number.into();
    }
}

/// Files may print 3 as 3.0.
pub(super) fn index_of(value: &Value) -> Option<usize> {
    value.as_u64().or_else(|| value.as_f64().map(|x| x as u64)).map(|x| x as usize)
}

type Visit<'a> = &'a mut dyn FnMut(&mut Value);

fn for_each_accessor_index(document: &mut Value, visit: Visit<'_>) {
    for primitive in elements(document, "meshes").flat_map(|mesh| elements(mesh, "primitives")) {
        members(primitive.get_mut("attributes"), visit);
        primitive.get_mut("indices").into_iter().for_each(&mut *visit);
        elements(primitive, "targets").for_each(|target| members(Some(target), visit));
    }
    for sampler in elements(document, "animations").flat_map(|animation| elements(animation, "samplers")) {
        sampler.get_mut("input").into_iter().for_each(&mut *visit);
        sampler.get_mut("output").into_iter().for_each(&mut *visit);
    }
    elements(document, "skins").filter_map(|skin| skin.get_mut("inverseBindMatrices")).for_each(&mut *visit);
    for node in elements(document, "nodes") {
        members(node.pointer_mut("/extensions/EXT_mesh_gpu_instancing/attributes"), visit);
    }
}

/// Of images and of those accessors that `accessors` marks.
fn for_each_view_index(document: &mut Value, accessors: &[bool], visit: Visit<'_>) {
    elements(document, "images").filter_map(|image| image.get_mut("bufferView")).for_each(&mut *visit);
    for (accessor, _) in elements(document, "accessors").zip(accessors).filter(|(_, kept)| **kept) {
        for path in ["/bufferView", "/sparse/indices/bufferView", "/sparse/values/bufferView"] {
            accessor.pointer_mut(path).into_iter().for_each(&mut *visit);
        }
    }
}

pub(super) fn elements<'a>(value: &'a mut Value, key: &str) -> impl Iterator<Item = &'a mut Value> {
    value.get_mut(key).and_then(Value::as_array_mut).into_iter().flatten()
}

fn members(value: Option<&mut Value>, visit: Visit<'_>) {
    value.and_then(Value::as_object_mut).into_iter().flat_map(Map::values_mut).for_each(visit);
}

pub(super) fn names<'a>(document: &'a Value, key: &str) -> impl Iterator<Item = &'a str> {
    document.get(key).and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str)
}

fn primitive_mut(document: &mut Value, mesh: usize, primitive: usize) -> Option<&mut Map<String, Value>> {
    document.pointer_mut(&format!("/meshes/{mesh}/primitives/{primitive}"))?.as_object_mut()
}

/// Takes all references to data from a primitive that gets new ones.
pub(super) fn clear_primitive(document: &mut Value, mesh: usize, primitive: usize) {
    if let Some(primitive) = primitive_mut(document, mesh, primitive) {
        for key in ["attributes", "indices", "targets", "mode"] {
            primitive.remove(key);
        }
    }
}

pub(super) fn fill_primitive(document: &mut Value, mesh: usize, primitive: usize, data: References) {
    if let Some(primitive) = primitive_mut(document, mesh, primitive) {
        primitive.insert("attributes".into(), data.attributes.into());
        primitive.insert("indices".into(), data.indices.into());
        if !data.targets.is_empty() {
            primitive.insert("targets".into(), data.targets.into());
        }
    }
}

pub(super) fn use_material(document: &mut Value, mesh: usize, primitive: usize, material: usize) {
    if let Some(primitive) = primitive_mut(document, mesh, primitive) {
        primitive.insert("material".into(), material.into());
    }
}

/// Images that some texture called normal map shows, the core one or an extension's.
pub(super) fn images_of_normal_maps(document: &Value) -> HashSet<usize> {
    let mut textures = HashSet::new();
    find_normal_textures(document.get("materials"), &mut textures);
    let list = document.get("textures").and_then(Value::as_array);
    let source = |(i, texture): (usize, &Value)| {
        textures.contains(&i).then(|| texture.get("source").and_then(index_of)).flatten()
    };
    list.into_iter().flatten().enumerate().filter_map(source).collect()
}

fn find_normal_textures(value: Option<&Value>, textures: &mut HashSet<usize>) {
    match value {
        Some(Value::Array(list)) => list.iter().for_each(|item| find_normal_textures(Some(item), textures)),
        Some(Value::Object(object)) => {
            for (key, member) in object {
                if key.ends_with("ormalTexture") {
                    textures.extend(member.get("index").and_then(index_of));
                }
                find_normal_textures(Some(member), textures);
            }
        }
        _ => {}
    }
}
