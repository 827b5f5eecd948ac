//! Normal maps in the look of a scene: each becomes the normalTexture of its materials, and replaces their own.

use std::{collections::HashMap, sync::Arc};

use serde_json::{Value, json};

use super::{add_plain_material, add_texture, array, malformed, push};
use crate::domain::{
    Result,
    bump::{Bumps, NormalTexture, Shading},
    detail::Wrap,
    report::Warning,
    scene::{Scene, SceneImage, TextureUse},
};

const IDENTITY: [[f32; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// Puts normal maps into the materials; primitives without a material get one where they have a map.
pub fn replace_normals(scene: &mut Scene, bumps: &mut Bumps) -> Result<()> {
    if bumps.of_none.texture.is_some() {
        add_plain_material(scene, "normal map")?;
        let plain = std::mem::take(&mut bumps.of_none);
        bumps.of_material.resize(scene.materials.len(), plain);
    }
    let mut added = HashMap::new();
    for (material, Shading { texture, .. }) in bumps.of_material.iter().enumerate() {
        let Some(texture) = texture else { continue };
        let (index, image) = match added.get(&Arc::as_ptr(texture)) {
            Some(known) => *known,
            None => *added.entry(Arc::as_ptr(texture)).or_insert(add(scene, texture)?),
        };
        if scene.materials[material].has_normal_map {
            let message = format!("materials[{material}] has a normal map; the one given takes its place");
            scene.warnings.push(Warning::new("normal_map_replaced", message));
        }
        show(scene, material, texture, index, image)?;
    }
    Ok(())
}

/// The texture in the document, and the image in the scene.
fn add(scene: &mut Scene, texture: &NormalTexture) -> Result<(usize, usize)> {
    let index = add_texture(scene, texture.media_type, &texture.image)?;
    if texture.wrap != [Wrap::Repeat; 2] {
        let [s, t] = texture.wrap.map(wrap_number);
        let sampler = push(&mut scene.document, "samplers", json!({ "wrapS": s, "wrapT": t }))?;
        array(&mut scene.document, "textures")?[index]["sampler"] = json!(sampler);
    }
    scene.images.push(SceneImage { media_type: texture.media_type.into(), bytes: Some(texture.image.clone()) });
    Ok((index, scene.images.len() - 1))
}

fn show(scene: &mut Scene, material: usize, texture: &NormalTexture, index: usize, image: usize) -> Result<()> {
    let json = json!({ "index": index, "texCoord": texture.uv_set, "scale": texture.scale });
    let of_document = array(&mut scene.document, "materials")?.get_mut(material).and_then(Value::as_object_mut);
    of_document.ok_or_else(malformed)?.insert("normalTexture".into(), json);
    let material = &mut scene.materials[material];
    material.normal = Some(TextureUse { image, uv_set: texture.uv_set, wrap: texture.wrap, map_from_uv: IDENTITY });
    material.normal_scale = texture.scale;
    material.has_normal_map = true;
    material.normal_uv_set = texture.uv_set;
    Ok(())
}

/// As samplers of glTF have it.
fn wrap_number(wrap: Wrap) -> u32 {
    match wrap {
        Wrap::Repeat => 10497,
        Wrap::Mirror => 33648,
        Wrap::Clamp => 33071,
    }
}
