//! An opacity map in the look of a scene. glTF keeps opacity in the alpha of base colour maps, so each of these is made
//! anew with the map's values for its alpha, and materials without one get a white one.

use std::collections::HashMap;

use bytes::Bytes;
use serde_json::{Value, json};

use super::{add_plain_material, add_texture, malformed, push, require_uvs, texture_info};
use crate::domain::{
    Error, Result,
    detail::Wrap,
    encode::encode_rgba8,
    maps::{Pixels, decode},
    request::LookMap,
    scene::{Alpha, Scene, SceneImage, TextureUse},
};

const FIELD: &str = "opacity";

/// Replaces the alpha of every material's base colour, map and factor, by the alpha of `image`, or by its red where it has
/// none; 8 bits are kept. Opaque materials become blended ones; what cuts off goes on to do so. The map is read where the
/// material's base colour is, and is as large. Fails where it is not, where a base colour cannot be read, and,
/// if it is read at texture coordinates, where a mesh has none.
pub fn replace_opacity(scene: &mut Scene, image: &Bytes, reads_uvs: bool) -> Result<()> {
    let map = decode(FIELD, image)?;
    let channel = if map.channels % 2 == 0 { map.channels - 1 } else { 0 };
    let opacity: Vec<u8> = map.texels([channel], |_, value| value).into_iter().map(eight_bits).collect();
    if reads_uvs {
        require_uvs(scene, FIELD, "an opacity map")?;
    }
    add_plain_material(scene, "opacity")?;
    let mut made = HashMap::new();
    for m in 0..scene.materials.len() {
        let source = base_color_image(scene, m)?;
        let (texture_image, index) = match made.get(&source) {
            Some(known) => *known,
            None => {
                let colors = source.map(|index| colors(scene, m, index)).transpose()?;
                let bytes = combined(&map, &opacity, colors.as_ref(), &name(scene, m))?;
                let texture_image = add_texture(scene, "image/png", &bytes)?;
                scene.images.push(SceneImage { media_type: "image/png".into(), bytes: Some(bytes) });
                *made.entry(source).or_insert((texture_image, scene.images.len() - 1))
            }
        };
        show(scene, m, texture_image, index)?;
    }
    Ok(())
}

fn eight_bits(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

fn name(scene: &Scene, material: usize) -> String {
    scene.materials[material].name.clone().unwrap_or_else(|| format!("{material}"))
}

/// The image of a material's base colour map, if it has one.
fn base_color_image(scene: &Scene, material: usize) -> Result<Option<usize>> {
    let used = scene.materials[material].base_color.as_ref().map(|used| used.image);
    let path = format!("/materials/{material}/pbrMetallicRoughness/baseColorTexture");
    if used.is_none() && scene.document.pointer(&path).is_some() {
        let message = format!(
            "the base colour map of material '{}' is in a format of an extension, into which no opacity can be written: convert it to PNG or JPEG",
            name(scene, material)
        );
        return Err(Error::unsupported(FIELD, message));
    }
    Ok(used)
}

fn colors(scene: &Scene, material: usize, image: usize) -> Result<Pixels> {
    let bytes = scene.images.get(image).and_then(|image| image.bytes.clone());
    let missing = || {
        let name = name(scene, material);
        Error::invalid(
            FIELD,
            format!("the base colour map of material '{name}' is missing; opacity goes into its alpha"),
        )
    };
    decode(&format!("images[{image}]"), &bytes.ok_or_else(missing)?)
}

/// A PNG of the colours, white without any, and the opacity.
fn combined(map: &Pixels, opacity: &[u8], colors: Option<&Pixels>, material: &str) -> Result<Bytes> {
    let (width, height) = (map.width, map.height);
    let mut rgba: Vec<[u8; 4]> = opacity.iter().map(|a| [255, 255, 255, *a]).collect();
    if let Some(colors) = colors {
        if (colors.width, colors.height) != (width, height) {
            let message = format!(
                "the map has {width} x {height} pixels and the base colour of material '{material}' has {} x {}, and glTF holds both in one image: scale one to the size of the other",
                colors.width, colors.height
            );
            return Err(Error::invalid(FIELD, message));
        }
        let channels = if colors.channels < 3 { [0; 3] } else { [0, 1, 2] };
        let values = colors.texels(channels, |_, value| value);
        for (texel, color) in rgba.iter_mut().zip(values.chunks_exact(3)) {
            (0..3).for_each(|k| texel[k] = eight_bits(color[k]));
        }
    }
    Ok(encode_rgba8(width, height, rgba.as_flattened())?.into())
}

/// Makes a material show its new image: `texture_image` of the document, `index` of the scene.
fn show(scene: &mut Scene, material: usize, texture: usize, index: usize) -> Result<()> {
    let texture = own_texture(scene, material, texture)?;
    let known = &mut scene.materials[material];
    let plain = || TextureUse {
        image: index,
        uv_set: 0,
        wrap: [Wrap::Repeat; 2],
        map_from_uv: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    };
    known.base_color.get_or_insert_with(plain).image = index;
    known.base_color_factor[3] = 1.0;
    if known.alpha == Alpha::Opaque {
        known.alpha = Alpha::Blend;
    }
    let cuts_off = matches!(known.alpha, Alpha::Mask { .. });
    let path = format!("/materials/{material}");
    let json = scene.document.pointer_mut(&path).ok_or_else(malformed)?;
    let mode = json!(if cuts_off { "MASK" } else { "BLEND" });
    json.as_object_mut().ok_or_else(malformed)?.insert("alphaMode".into(), mode);
    texture_info(json, LookMap::BaseColor)?.insert("index".into(), json!(texture));
    if let Some(alpha) = json.pointer_mut("/pbrMetallicRoughness/baseColorFactor/3") {
        *alpha = json!(1.0);
    }
    Ok(())
}

/// A texture with the sampler of the material's own, of another texture's image.
fn own_texture(scene: &mut Scene, material: usize, other: usize) -> Result<usize> {
    let textures = &scene.document["textures"];
    let path = format!("/materials/{material}/pbrMetallicRoughness/baseColorTexture/index");
    let known = scene.document.pointer(&path).and_then(Value::as_u64);
    let mut texture = textures[other].clone();
    match known.and_then(|index| textures[index as usize].get("sampler")) {
        None => return Ok(other),
        Some(sampler) => texture["sampler"] = sampler.clone(),
    }
    push(&mut scene.document, "textures", texture)
}
