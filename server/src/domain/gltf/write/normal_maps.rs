//! Normal maps in the document: each gets an image, a texture and a material of its own, since the primitives beside its
//! own must not show it.

use bytes::Bytes;
use serde_json::{Value, json};

use super::{document, pack::Builder, primitive::Part};

/// A normal map of one displaced primitive.
#[derive(Clone, Debug)]
pub struct NormalMap {
    /// RGB of 8 bits.
    pub png: Bytes,
    /// It is read at TEXCOORD_n, which repeats.
    pub uv_set: u32,
}

/// Gives the parts that have maps their materials. Call when the file's own images are in place.
pub(super) fn insert(document: &mut Value, builder: &mut Builder<'_>, parts: &[Part<'_>]) {
    for part in parts {
        let Some(map) = part.normal_map else { continue };
        let view = builder.bytes(map.png.clone());
        let image = push(document, "images", json!({ "bufferView": view, "mimeType": "image/png" }));
        let texture = push(document, "textures", json!({ "source": image }));
        let mut material = part.fine.primitive.material.map_or(json!({}), |m| document["materials"][m].clone());
        material["normalTexture"] = json!({ "index": texture, "texCoord": map.uv_set });
        let material = push(document, "materials", material);
        document::use_material(document, part.gltf_mesh, part.fine.primitive.gltf_primitive, material);
    }
}

fn push(document: &mut Value, key: &str, value: Value) -> usize {
    match document.get_mut(key).and_then(Value::as_array_mut) {
        Some(list) => {
            list.push(value);
            list.len() - 1
        }
        None => {
            document[key] = json!([value]);
            0
        }
    }
}
