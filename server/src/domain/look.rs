//! What a request changes in the look of a scene before it is rendered or written.

mod normal;
mod opacity;

use bytes::Bytes;
use serde_json::{Map, Value, json};

use super::{
    Error, Result,
    detail::Wrap,
    maps,
    scene::{Material, Scene, SceneImage, TextureUse},
};

pub use normal::replace_normals;
pub use opacity::replace_opacity;

/// Makes `image` (an encoded PNG or JPEG) the base colour map of every material, and gives primitives
/// without a material one that has it.
pub fn replace_base_color(scene: &mut Scene, image: Bytes) -> Result<()> {
    let media_type = media_type(&image)?;
    // A file that nobody can show must not get into a result.
    maps::color_map("base_color", &image)?;
    require_uvs(scene, "base_color", "a base colour map")?;
    let texture = add_texture(scene, media_type, &image)?;
    add_plain_material(scene, "base color")?;
    for material in scene.document.get_mut("materials").and_then(Value::as_array_mut).into_iter().flatten() {
        *base_color_texture(material)? = Map::from_iter([("index".into(), json!(texture))]);
    }
    let index = scene.images.len();
    scene.images.push(SceneImage { media_type: media_type.into(), bytes: Some(image.to_vec().into()) });
    for material in &mut scene.materials {
        material.base_color = Some(TextureUse {
            image: index,
            uv_set: 0,
            wrap: [Wrap::Repeat; 2],
            map_from_uv: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        });
    }
    Ok(())
}

fn media_type(image: &[u8]) -> Result<&'static str> {
    match image {
        [0x89, b'P', b'N', b'G', ..] => Ok("image/png"),
        [0xff, 0xd8, ..] => Ok("image/jpeg"),
        _ => Err(Error::invalid(
            "base_color",
            "the image is neither PNG nor JPEG, the two that glTF materials hold: convert it",
        )),
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
                        "mesh '{}' primitive {} has no TEXCOORD_0, which {map} reads: unwrap the mesh, or leave the map out",
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

/// Where a material of the document says which texture its base colour has; made where it says nothing.
fn base_color_texture(material: &mut Value) -> Result<&mut Map<String, Value>> {
    let mut at = material;
    for key in ["pbrMetallicRoughness", "baseColorTexture"] {
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
