//! What a request changes in the look of a scene before it is rendered or written.

mod normal;
mod opacity;

use bytes::Bytes;
use serde_json::{Map, Value, json};

use super::{
    Error, Result,
    detail::Wrap,
    maps,
    request::LookMap,
    scene::{Material, Scene, SceneImage, TextureUse},
};

pub use normal::replace_normals;
pub use opacity::replace_opacity;

impl LookMap {
    fn field(self) -> &'static str {
        match self {
            Self::BaseColor => "base_color",
            Self::MetallicRoughness => "metallic_roughness",
            Self::Occlusion => "occlusion",
            Self::Emissive => "emissive",
        }
    }

    fn noun(self) -> &'static str {
        match self {
            Self::BaseColor => "a base colour map",
            Self::MetallicRoughness => "a metallic-roughness map",
            Self::Occlusion => "an occlusion map",
            Self::Emissive => "an emissive map",
        }
    }

    /// Where a material of the document says which texture it has.
    fn keys(self) -> &'static [&'static str] {
        match self {
            Self::BaseColor => &["pbrMetallicRoughness", "baseColorTexture"],
            Self::MetallicRoughness => &["pbrMetallicRoughness", "metallicRoughnessTexture"],
            Self::Occlusion => &["occlusionTexture"],
            Self::Emissive => &["emissiveTexture"],
        }
    }

    fn of(self, material: &mut Material) -> &mut Option<TextureUse> {
        match self {
            Self::BaseColor => &mut material.base_color,
            Self::MetallicRoughness => &mut material.metallic_roughness,
            Self::Occlusion => &mut material.occlusion,
            Self::Emissive => &mut material.emissive,
        }
    }
}

/// Makes `image` (an encoded PNG or JPEG) this map of every material, and gives primitives without a material one that has
/// it. Factors go on to multiply, but for those of 0, which would hide the map: they become 1. Fails where a mesh lacks
/// texture coordinates, if these are read.
pub fn replace_map(scene: &mut Scene, map: LookMap, image: Bytes, reads_uvs: bool) -> Result<()> {
    let media_type = require_media_type(map.field(), &image)?;
    // A file that nobody can show must not get into a result.
    maps::color_map(map.field(), &image)?;
    if reads_uvs {
        require_uvs(scene, map.field(), map.noun())?;
    }
    let texture = add_texture(scene, media_type, &image)?;
    add_plain_material(scene, &map.field().replace('_', " "))?;
    for material in scene.document.get_mut("materials").and_then(Value::as_array_mut).into_iter().flatten() {
        *texture_info(material, map)? = Map::from_iter([("index".into(), json!(texture))]);
        show_factors(material, map)?;
    }
    let index = scene.images.len();
    scene.images.push(SceneImage { media_type: media_type.into(), bytes: Some(image.to_vec().into()) });
    for m in 0..scene.materials.len() {
        let strength = emissive_strength(scene, m);
        let material = &mut scene.materials[m];
        *map.of(material) = Some(TextureUse {
            image: index,
            uv_set: 0,
            wrap: [Wrap::Repeat; 2],
            map_from_uv: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        });
        show_known_factors(material, map, strength);
    }
    Ok(())
}

/// Of KHR_materials_emissive_strength.
fn emissive_strength(scene: &Scene, material: usize) -> f32 {
    let path = format!("/materials/{material}/extensions/KHR_materials_emissive_strength/emissiveStrength");
    scene.document.pointer(&path).and_then(Value::as_f64).map_or(1.0, |strength| strength.max(0.0) as f32)
}

/// In the document.
fn show_factors(material: &mut Value, map: LookMap) -> Result<()> {
    let object = material.as_object_mut().ok_or_else(malformed)?;
    match map {
        LookMap::BaseColor | LookMap::Occlusion => {}
        LookMap::MetallicRoughness => {
            let pbr = object.get_mut("pbrMetallicRoughness").and_then(Value::as_object_mut).ok_or_else(malformed)?;
            for key in ["metallicFactor", "roughnessFactor"] {
                if pbr.get(key).and_then(Value::as_f64) == Some(0.0) {
                    pbr.insert(key.into(), json!(1.0));
                }
            }
        }
        LookMap::Emissive => {
            let factor = object.get("emissiveFactor").and_then(Value::as_array);
            if factor.is_none_or(|factor| factor.iter().all(|c| c.as_f64() == Some(0.0))) {
                object.insert("emissiveFactor".into(), json!([1.0, 1.0, 1.0]));
            }
        }
    }
    Ok(())
}

/// As `show_factors`, in what is known of the material.
fn show_known_factors(material: &mut Material, map: LookMap, emissive_strength: f32) {
    match map {
        LookMap::BaseColor => {}
        // It lies in what the map replaces.
        LookMap::Occlusion => material.occlusion_strength = 1.0,
        LookMap::MetallicRoughness => {
            for factor in [&mut material.metallic_factor, &mut material.roughness_factor] {
                *factor = if *factor == 0.0 { 1.0 } else { *factor };
            }
        }
        LookMap::Emissive => {
            if material.emissive_factor == [0.0; 3] {
                material.emissive_factor = [emissive_strength; 3];
            }
        }
    }
}

fn require_media_type(field: &str, image: &[u8]) -> Result<&'static str> {
    media_type(image).ok_or_else(|| {
        Error::invalid(field, "the image is neither PNG nor JPEG, the two that glTF materials hold: convert it")
    })
}

/// Of the two that glTF materials hold, by the first bytes.
pub(super) fn media_type(image: &[u8]) -> Option<&'static str> {
    match image {
        [0x89, b'P', b'N', b'G', ..] => Some("image/png"),
        [0xff, 0xd8, ..] => Some("image/jpeg"),
        _ => None,
    }
}

fn require_uvs(scene: &Scene, field: &str, map: &str) -> Result<()> {
    for mesh in scene.meshes.iter().map(|m| &m.mesh) {
        let uvs = mesh.attribute("TEXCOORD_0");
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            if !uvs.is_some_and(|a| a.primitives[p]) {
                return Err(Error::invalid(
                    field,
                    format!(
                        "mesh '{}' primitive {} has no TEXCOORD_0, which {map} reads: unwrap the mesh, project the map (--projection, in images), or leave it out",
                        mesh.name, primitive.gltf_primitive
                    ),
                ));
            }
        }
    }
    Ok(())
}

/// Adds buffer, view, image and texture; returns the texture's index.
fn add_texture(scene: &mut Scene, media_type: &str, image: &Bytes) -> Result<usize> {
    let document = &mut scene.document;
    let buffer = push(document, "buffers", json!({ "byteLength": image.len() }))?;
    scene.buffers.push(image.clone());
    let view = push(document, "bufferViews", json!({ "buffer": buffer, "byteLength": image.len() }))?;
    let source = push(document, "images", json!({ "bufferView": view, "mimeType": media_type }))?;
    push(document, "textures", json!({ "source": source }))
}

/// Gives primitives without a material one of this name.
fn add_plain_material(scene: &mut Scene, name: &str) -> Result<()> {
    let plain = scene.materials.len();
    if use_plain_material(scene, plain)? {
        array(&mut scene.document, "materials")?.push(json!({ "name": name }));
        scene.materials.push(Material { name: Some(name.into()), ..Material::default() });
    }
    Ok(())
}

/// Where a material of the document says which texture its map has; made where it says nothing.
fn texture_info(material: &mut Value, map: LookMap) -> Result<&mut Map<String, Value>> {
    let mut at = material;
    for &key in map.keys() {
        let object = at.as_object_mut().ok_or_else(malformed)?;
        at = object.entry(key).or_insert_with(|| Value::Object(Map::new()));
    }
    at.as_object_mut().ok_or_else(malformed)
}

/// Points primitives without a material to `plain`; tells whether there were any.
fn use_plain_material(scene: &mut Scene, plain: usize) -> Result<bool> {
    let mut any = false;
    for scene_mesh in &mut scene.meshes {
        for primitive in scene_mesh.mesh.primitives.iter_mut().filter(|p| p.material.is_none()) {
            primitive.material = Some(plain);
            let path = format!("/meshes/{}/primitives/{}", scene_mesh.gltf_mesh, primitive.gltf_primitive);
            let json = scene.document.pointer_mut(&path).and_then(Value::as_object_mut).ok_or_else(malformed)?;
            json.insert("material".into(), json!(plain));
            any = true;
        }
    }
    Ok(any)
}

fn push(document: &mut Value, key: &str, value: Value) -> Result<usize> {
    let array = array(document, key)?;
    array.push(value);
    Ok(array.len() - 1)
}

fn array<'d>(document: &'d mut Value, key: &str) -> Result<&'d mut Vec<Value>> {
    let root = document.as_object_mut().ok_or_else(malformed)?;
    root.entry(key).or_insert_with(|| Value::Array(Vec::new())).as_array_mut().ok_or_else(malformed)
}

fn malformed() -> Error {
    Error::internal("a checked glTF document is not what the checks promise")
}
