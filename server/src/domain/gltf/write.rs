//! Scene and surfaces to one self-contained GLB: displaced primitives get fresh accessors, everything else
//! of the document stays, and data nobody refers to any more is left out.
//!
//! | file | holds |
//! |---|---|
//! | `document.rs`, `bounds.rs`, `claims.rs` | what of the document is kept, mended and claimed |
//! | `fine.rs`, `primitive.rs`, `skin.rs` | one displaced primitive: its part of the surface, tangents, skin |
//! | `listing.rs`, `collapsed.rs` | its vertices and triangles in the order of the file, without what quantising undid |
//! | `streams.rs`, `pack.rs` | its accessors; the bytes of the file, plain or compressed |
//! | `lods.rs` | levels of detail: more meshes and nodes |
//! | `tangents.rs`, `sheet.rs`, `normal_maps.rs` | tangents; what normal maps are made from; their materials |
//! | `packing.rs`, `dequantize.rs` | which meshes are quantised, and the nodes that take them back |
//! | `painted.rs` | a file of its own: a mesh painted by a figure |

mod bounds;
mod claims;
mod collapsed;
mod dequantize;
mod document;
mod fine;
mod listing;
mod lods;
mod normal_maps;
mod pack;
mod packing;
mod painted;
mod primitive;
mod sheet;
mod skin;
mod streams;
mod tangents;

use rayon::prelude::*;
use serde_json::Value;

use super::images;
use crate::domain::{
    Error, Result,
    grid::Grid,
    mesh::Mesh,
    report::Warning,
    request::Compression,
    scene::{Scene, SceneMesh},
    surface::{Layout, Surface},
};
pub(super) use claims::drop_names;
use document::Kept;
use fine::Fine;
pub use lods::{Chain, Level, node_with_lods, shown_by_nodes};
pub use normal_maps::NormalMap;
use pack::Builder;
pub use packing::{Packing, obstacles};
pub use painted::{Painted, write_painted};
use primitive::{Coding, Part};
pub use sheet::sheet;

/// A GLB and what could not be kept in it.
#[derive(Clone, Debug, Default)]
pub struct Written {
    pub bytes: Vec<u8>,
    pub warnings: Vec<Warning>,
}

/// One mesh of the file and what it shows.
#[derive(Clone, Copy)]
struct Shown<'a> {
    gltf_mesh: usize,
    mesh: &'a Mesh,
    surface: &'a Surface,
    grid: Option<Grid>,
    /// Of each primitive; empty where none has any.
    normal_maps: &'a [Option<NormalMap>],
}

/// What is written of a scene.
#[derive(Clone, Copy, Debug)]
pub struct Contents<'a> {
    /// In place of each mesh of the scene.
    pub surfaces: &'a [Surface],
    pub packing: &'a Packing,
    /// At most one for each mesh.
    pub chains: &'a [Chain],
    /// Of each mesh, of each of its primitives; both may be empty where none has any.
    pub normal_maps: &'a [Vec<Option<NormalMap>>],
}

/// Writes the scene with `surfaces[i]` in place of `scene.meshes[i]`.
pub fn write(scene: &Scene, surfaces: &[Surface], packing: &Packing) -> Result<Written> {
    write_contents(scene, &Contents { surfaces, packing, chains: &[], normal_maps: &[] })
}

/// The same with lower levels of detail and normal maps.
pub fn write_contents(scene: &Scene, contents: &Contents<'_>) -> Result<Written> {
    let Contents { packing, chains, .. } = *contents;
    let mut document = scene.document.clone();
    let mut shown = shown(scene, contents)?;
    shown.extend(lods::insert(&mut document, scene, chains));
    let mut warnings = Vec::new();
    let parts = parts(scene, &shown, packing, &mut warnings)?;
    claims::drop_compression(&mut document);
    for part in &parts {
        document::clear_primitive(&mut document, part.gltf_mesh, part.fine.primitive.gltf_primitive);
    }
    let mut builder = Builder::default();
    let kept = Kept::of(&mut document);
    kept.copy(&mut document, scene, &mut builder, &mut warnings)?;
    embed_images(&mut document, scene, &mut builder);
    normal_maps::insert(&mut document, &mut builder, &parts);
    for part in &parts {
        let data = part.write(&mut builder)?;
        document::fill_primitive(&mut document, part.gltf_mesh, part.fine.primitive.gltf_primitive, data);
    }
    declare(&mut document, &shown, packing, &parts);
    if packing.compression == Compression::Meshopt {
        builder.compress()?;
    }
    document["accessors"] = Value::Array(std::mem::take(&mut builder.accessors));
    document["bufferViews"] = Value::Array(std::mem::take(&mut builder.views));
    document["buffers"] = builder.buffers();
    document["asset"]["generator"] = concat!("displaced ", env!("CARGO_PKG_VERSION")).into();
    claims::finish(&mut document);
    Ok(Written { bytes: builder.pack(&document)?, warnings })
}

fn shown<'a>(scene: &'a Scene, contents: &Contents<'a>) -> Result<Vec<Shown<'a>>> {
    let Contents { surfaces, packing, normal_maps, .. } = *contents;
    if surfaces.len() != scene.meshes.len() {
        let message = format!("{} surfaces for {} meshes", surfaces.len(), scene.meshes.len());
        return Err(Error::internal(message));
    }
    let pairs = scene.meshes.iter().zip(surfaces).enumerate();
    let of_mesh = |(i, (SceneMesh { gltf_mesh, mesh }, surface)): (usize, (&'a SceneMesh, &'a Surface))| Shown {
        gltf_mesh: *gltf_mesh,
        mesh,
        surface,
        grid: packing.grid(i),
        normal_maps: normal_maps.get(i).map_or(&[], Vec::as_slice),
    };
    Ok(pairs.map(of_mesh).collect())
}

/// Names the extensions that the packing takes, and adds the nodes.
fn declare(document: &mut Value, shown: &[Shown<'_>], packing: &Packing, parts: &[Part<'_>]) {
    let grids = shown.iter().filter_map(|shown| Some((shown.gltf_mesh, shown.grid?)));
    dequantize::insert_nodes(document, &grids.collect());
    if parts.iter().any(Part::needs_quantization) {
        claims::require(document, "KHR_mesh_quantization");
    }
    if packing.compression == Compression::Meshopt && !parts.is_empty() {
        claims::require(document, pack::MESHOPT);
    }
}

fn parts<'a>(
    scene: &'a Scene,
    shown: &[Shown<'a>],
    packing: &Packing,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<Part<'a>>> {
    let of_mesh = |shown: &Shown<'a>| parts_of(scene, *shown, packing);
    let all: Vec<Vec<(Part<'a>, Option<Warning>)>> = shown.par_iter().map(of_mesh).collect::<Result<_>>()?;
    let keep = |(part, warning): (Part<'a>, Option<Warning>)| {
        warnings.extend(warning);
        part
    };
    Ok(all.into_iter().flatten().map(keep).collect())
}

fn parts_of<'a>(scene: &'a Scene, shown: Shown<'a>, packing: &Packing) -> Result<Vec<(Part<'a>, Option<Warning>)>> {
    let Shown { gltf_mesh, mesh, surface, grid, normal_maps } = shown;
    fine::check(mesh, surface)?;
    let coding = Coding { is_quantized: packing.is_quantized(), grid };
    // A primitive that lost all its triangles stays as the file has it.
    let solid: Vec<usize> = (0..mesh.primitives.len()).filter(|p| !mesh.primitives[*p].triangles.is_empty()).collect();
    let map = |p: usize| normal_maps.get(p).and_then(Option::as_ref);
    let part = |p: usize| Part::new(scene, gltf_mesh, Fine::new(mesh, surface, p), coding, map(p));
    let (mut parts, warnings): (Vec<_>, Vec<_>) =
        solid.into_par_iter().map(part).collect::<Result<Vec<_>>>()?.into_iter().unzip();
    if let Some(grid) = coding.grid {
        collapsed::remove(&mut parts, &grid);
    }
    // Uniform levels come in rows.
    if coding.is_quantized || matches!(surface.layout, Layout::Pieces(_)) {
        parts.par_iter_mut().for_each(Part::optimize);
    }
    Ok(parts.into_iter().zip(warnings).collect())
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
