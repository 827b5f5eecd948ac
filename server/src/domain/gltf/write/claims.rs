//! What the document claims of itself: extensions that it needs or needs no longer, lists that hold nothing.

use serde_json::{Value, json};

use super::document::{elements, index_of, names};
use crate::domain::gltf::extensions::is_compression;

/// The uncompressed data is written; a compressed copy of other data must not stand beside it.
pub(super) fn drop_compression(document: &mut Value) {
    for key in ["buffers", "bufferViews"] {
        elements(document, key).for_each(drop_compression_of);
    }
    elements(document, "meshes").flat_map(|mesh| elements(mesh, "primitives")).for_each(drop_compression_of);
    drop_names(document, is_compression);
}

fn drop_compression_of(value: &mut Value) {
    let Some(object) = value.as_object_mut() else { return };
    if let Some(extensions) = object.get_mut("extensions").and_then(Value::as_object_mut) {
        extensions.retain(|name, _| !is_compression(name));
        if extensions.is_empty() {
            object.remove("extensions");
        }
    }
}

pub(in super::super) fn drop_names(document: &mut Value, unwanted: impl Fn(&str) -> bool) {
    for key in ["extensionsUsed", "extensionsRequired"] {
        let Some(list) = document.get_mut(key).and_then(Value::as_array_mut) else { continue };
        list.retain(|name| !name.as_str().is_some_and(&unwanted));
        if list.is_empty() {
            document.as_object_mut().map(|root| root.remove(key));
        }
    }
}

/// The file cannot be shown without the extension.
pub(super) fn require(document: &mut Value, extension: &str) {
    add_name(document, "extensionsUsed", extension);
    add_name(document, "extensionsRequired", extension);
}

/// The file says something by the extension that may be left unread.
pub(super) fn mention(document: &mut Value, extension: &str) {
    add_name(document, "extensionsUsed", extension);
}

fn add_name(document: &mut Value, key: &str, extension: &str) {
    if names(document, key).any(|name| name == extension) {
        return;
    }
    match document.get_mut(key).and_then(Value::as_array_mut) {
        Some(list) => list.push(extension.into()),
        None => document[key] = json!([extension]),
    }
}

/// Last touches: no empty lists, no claim to quantisation when nothing is quantised any more.
pub(super) fn finish(document: &mut Value) {
    if !has_quantized(document) {
        drop_names(document, |name| name == "KHR_mesh_quantization");
    }
    let empty_buffer = document.pointer("/buffers/0/byteLength").and_then(Value::as_u64) == Some(0);
    let Some(root) = document.as_object_mut() else { return };
    if empty_buffer {
        root.remove("buffers");
    }
    for key in ["accessors", "bufferViews"] {
        if root.get(key).and_then(Value::as_array).is_some_and(Vec::is_empty) {
            root.remove(key);
        }
    }
}

fn has_quantized(document: &mut Value) -> bool {
    const F32: u64 = 5126;
    let quantized: Vec<bool> =
        elements(document, "accessors").map(|a| a.get("componentType").and_then(Value::as_u64) != Some(F32)).collect();
    let is_quantized = |index: &Value| index_of(index).and_then(|i| quantized.get(i)).copied().unwrap_or(false);
    let geometric = |key: &str| ["POSITION", "NORMAL", "TANGENT", "TEXCOORD"].iter().any(|set| key.starts_with(set));
    elements(document, "meshes").flat_map(|mesh| elements(mesh, "primitives")).any(|primitive| {
        let targets = primitive.get("targets").and_then(Value::as_array).into_iter().flatten();
        let parts = primitive.get("attributes").into_iter().chain(targets).filter_map(Value::as_object);
        parts.flatten().any(|(key, index)| geometric(key) && is_quantized(index))
    })
}
