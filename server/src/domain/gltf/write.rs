//! Scene and surfaces to one self-contained GLB: displaced primitives get fresh accessors, everything else
//! of the document stays, and data nobody refers to any more is left out.

pub(super) use document::drop_names;
mod bounds;
mod document;
mod fine;
mod pack;
mod painted;
mod primitive;
mod skin;

use rayon::prelude::*;
use serde_json::{Value, json};

use super::images;
use crate::domain::{
    Error, Result,
    report::Warning,
    scene::{Scene, SceneMesh},
    surface::Surface,
};
use document::Kept;
use fine::Fine;
use pack::Builder;
pub use painted::{Painted, write_painted};
use primitive::Part;

/// A GLB and what could not be kept in it.
#[derive(Clone, Debug, Default)]
pub struct Written {
    pub bytes: Vec<u8>,
    pub warnings: Vec<Warning>,
}

/// Writes the scene with `surfaces[i]` in place of `scene.meshes[i]`.
pub fn write(scene: &Scene, surfaces: &[Surface]) -> Result<Written> {
    if surfaces.len() != scene.meshes.len() {
        let message = format!("{} surfaces for {} meshes", surfaces.len(), scene.meshes.len());
        return Err(Error::internal(message));
    }
    let mut warnings = Vec::new();
    let parts = parts(scene, surfaces, &mut warnings)?;
    let mut document = scene.document.clone();
    document::drop_compression(&mut document);
    for part in &parts {
        document::clear_primitive(&mut document, part.gltf_mesh, part.fine.primitive.gltf_primitive);
    }
    let mut builder = Builder::default();
    let kept = Kept::of(&mut document);
    kept.copy(&mut document, scene, &mut builder, &mut warnings)?;
    embed_images(&mut document, scene, &mut builder);
    for part in &parts {
        let (attributes, indices, targets) = part.write(&mut builder)?;
        document::fill_primitive(
            &mut document,
            part.gltf_mesh,
            part.fine.primitive.gltf_primitive,
            attributes,
            indices,
            targets,
        );
    }
    document["accessors"] = Value::Array(std::mem::take(&mut builder.accessors));
    document["bufferViews"] = Value::Array(std::mem::take(&mut builder.views));
    document["buffers"] = json!([{ "byteLength": builder.length }]);
    document["asset"]["generator"] = concat!("displaced ", env!("CARGO_PKG_VERSION")).into();
    document::finish(&mut document);
    Ok(Written { bytes: builder.pack(&document)?, warnings })
}

fn parts<'a>(scene: &'a Scene, surfaces: &'a [Surface], warnings: &mut Vec<Warning>) -> Result<Vec<Part<'a>>> {
    let mut parts = Vec::new();
    for (SceneMesh { gltf_mesh, mesh }, surface) in scene.meshes.iter().zip(surfaces) {
        fine::check(mesh, surface)?;
        // A primitive that lost all its triangles stays as the file has it.
        let solid = (0..mesh.primitives.len()).filter(|p| !mesh.primitives[*p].triangles.is_empty());
        parts.extend(solid.map(|p| (*gltf_mesh, Fine::new(mesh, surface, p))));
    }
    let parts: Vec<(Part<'a>, Option<Warning>)> =
        parts.into_par_iter().map(|(gltf_mesh, fine)| Part::new(scene, gltf_mesh, fine)).collect::<Result<_>>()?;
    let keep = |(part, warning): (Part<'a>, Option<Warning>)| {
        warnings.extend(warning);
        part
    };
    Ok(parts.into_iter().map(keep).collect())
}

/// Images by URI become buffer views; one that is missing becomes a single pixel that changes nothing.
fn embed_images(document: &mut Value, scene: &Scene, builder: &mut Builder<'_>) {
    let normals = document::images_of_normal_maps(document);
    let Some(list) = document.get_mut("images").and_then(Value::as_array_mut) else { return };
    for (number, (image, known)) in list.iter_mut().zip(&scene.images).enumerate() {
        let Some(image) = image.as_object_mut() else { continue };
        if !known.media_type.is_empty() {
            image.insert("mimeType".into(), known.media_type.as_str().into());
        }
        if image.remove("uri").is_none() {
            continue;
        }
        let bytes = known.bytes.clone().unwrap_or_else(|| images::stand_in(normals.contains(&number)));
        if known.bytes.is_none() || known.media_type.is_empty() {
            let media_type = images::media_type_of(&bytes).unwrap_or("application/octet-stream");
            image.insert("mimeType".into(), media_type.into());
        }
        image.insert("bufferView".into(), builder.bytes(bytes).into());
    }
}
