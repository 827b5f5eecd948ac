//! glTF 2.0 in: bytes to a [`Scene`], everything checked before it is used or allocated. And out: a scene
//! and its displaced surfaces to one self-contained GLB.
//!
//! The document stays JSON all the way, so that what is not understood passes through untouched. Every
//! error names the JSON path it is about. Decoding maps is `maps`' matter, welding `weld`'s.

mod accessor;
mod animation;
mod compression;
mod container;
mod displacement;
mod extensions;
mod images;
mod json;
mod light;
mod material;
mod node;
mod primitive;
mod repair;
mod source;
mod write;

use std::collections::HashMap;

use bytes::Bytes;
use rayon::prelude::*;

use super::{
    Error, Result,
    mesh::Mesh,
    report::Warning,
    scene::{Instance, Scene, SceneMesh},
    weld::weld,
};
pub use animation::{CameraWay, camera_way};
pub use displacement::forget_displacement;
use json::At;
use source::Source;
pub use write::{
    Chain, Contents, Level, NormalMap, Packing, Painted, Written, node_with_lods, obstacles, sheet, shown_by_nodes,
    write, write_contents, write_painted,
};

/// External files by the URI the document uses.
pub type Resources<'a> = dyn Fn(&str) -> Option<Bytes> + 'a;

/// What a file may ask for; checked before anything is allocated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of the JSON text, data URIs included.
    pub json_bytes: usize,
    /// Values in the JSON text.
    pub json_values: usize,
    /// Bytes of all accessors once decoded.
    pub decoded_bytes: u64,
    /// Triangles of all meshes.
    pub triangles: u64,
    /// Uses of meshes by nodes and by EXT_mesh_gpu_instancing.
    pub instances: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            json_bytes: 512 << 20,
            json_values: 8 << 20,
            decoded_bytes: 4 << 30,
            triangles: 64 << 20,
            instances: 1 << 16,
        }
    }
}

/// Reads a GLB or a glTF JSON file.
pub fn load(bytes: &Bytes, resources: &Resources<'_>, limits: &Limits) -> Result<Scene> {
    let container = container::split(bytes, limits)?;
    let mut document = container.document;
    let mut warnings = container.warnings;
    check_version(&At::root(&document))?;
    let decoded = compression::decode_all(&mut document, container.bin.as_ref(), resources, limits, &mut warnings)?;
    let limits = &Limits { decoded_bytes: limits.decoded_bytes.saturating_sub(decoded.bytes()), ..*limits };
    let resources = &|uri: &str| decoded.find(uri).or_else(|| resources(uri));
    let root = At::root(&document);
    extensions::check(&root, &mut warnings)?;
    let source = Source::open(&root, container.bin, resources, limits)?;
    let inputs = primitive::read_all(&source, limits)?;
    let materials = material::read_all(&root)?;
    let images = images::read_all(&root, &source, resources)?;
    let graph = node::read(&source, limits)?;
    warnings.extend(source.take_warnings());
    let meshes = weld_all(inputs, &mut warnings)?;
    let buffers = source.into_buffers();
    repair::mend(&mut document, &mut warnings);
    shorten(&mut warnings);
    let mut scene = Scene {
        instances: instances(&graph.uses, &meshes),
        document,
        buffers,
        meshes,
        materials,
        images,
        cameras: graph.cameras,
        lights: graph.lights,
        warnings,
        ..Scene::default()
    };
    node::measure(&mut scene);
    Ok(scene)
}

/// A file can be wrong in a million places; nobody reads more than the first of them.
fn shorten(warnings: &mut Vec<Warning>) {
    const MOST: usize = 200;
    if warnings.len() > MOST {
        let rest = warnings.len() - MOST;
        warnings.truncate(MOST);
        warnings.push(Warning::new("more_warnings", format!("and {rest} more")));
    }
}

fn check_version(root: &At<'_>) -> Result<()> {
    let asset = root.need("asset")?;
    let wanted = asset.need("version")?;
    let (major, _) = version(&wanted)?;
    if major != 2 {
        return Err(wanted.unsupported(format!("glTF version {major} is not read; give a glTF 2.0 file")));
    }
    if let Some(least) = asset.get("minVersion")
        && version(&least)? > (2, 0)
    {
        return Err(least.unsupported(format!("the file needs glTF {}; this server reads 2.0", least.text_here()?)));
    }
    Ok(())
}

fn version(at: &At<'_>) -> Result<(u32, u32)> {
    let text = at.text_here()?;
    let parts = text.split_once('.').and_then(|(major, minor)| Some((major.parse().ok()?, minor.parse().ok()?)));
    parts.ok_or_else(|| at.error(format!("'{text}' is not a version such as 2.0")))
}

fn weld_all(inputs: Vec<primitive::MeshInput>, warnings: &mut Vec<Warning>) -> Result<Vec<SceneMesh>> {
    let welded: Vec<(usize, Mesh)> = inputs
        .into_par_iter()
        .map(|input| {
            let field = format!("meshes[{}]", input.gltf_mesh);
            let mesh = weld(&input.name, &input.primitives).map_err(|e| within(&field, e))?;
            Ok((input.gltf_mesh, mesh))
        })
        .collect::<Result<_>>()?;
    for (gltf_mesh, mesh) in &welded {
        warn_of(*gltf_mesh, mesh, warnings);
    }
    let solid = welded.into_iter().filter(|(_, mesh)| !mesh.triangles.is_empty());
    Ok(solid.map(|(gltf_mesh, mesh)| SceneMesh { gltf_mesh, mesh }).collect())
}

fn within(field: &str, error: Error) -> Error {
    let inner = error.field.as_ref().map(|f| format!("{field} ({f})"));
    error.with_field(inner.unwrap_or_else(|| field.into()))
}

fn warn_of(gltf_mesh: usize, mesh: &Mesh, warnings: &mut Vec<Warning>) {
    let health = &mesh.health;
    let mut warn = |code: &str, count: u32, what: &str| {
        if count > 0 {
            warnings.push(Warning::new(code, format!("meshes[{gltf_mesh}] '{}': {count} {what}", mesh.name)));
        }
    };
    warn("degenerate_triangles", health.degenerate_triangles, "triangles with two corners in one place were left out");
    warn("normals_repaired", health.normals_repaired, "normals were not unit vectors and have been mended");
    warn("non_manifold_edges", health.non_manifold_edges, "edges have more than two triangles");
    warn("opposite_winding", health.opposite_winding_edges, "edges join triangles wound against each other");
    warn("no_triangles", u32::from(mesh.triangles.is_empty()), "mesh has no triangle with area; it stays as it is");
}

/// Uses of the meshes that have triangles, by their index in the scene.
fn instances(uses: &[node::Use], meshes: &[SceneMesh]) -> Vec<Instance> {
    let index: HashMap<usize, usize> = meshes.iter().enumerate().map(|(i, mesh)| (mesh.gltf_mesh, i)).collect();
    let used = uses.iter().filter_map(|one| {
        let mesh = *index.get(&one.gltf_mesh)?;
        Some(Instance { mesh, world_from_mesh: one.world_from_mesh })
    });
    used.collect()
}

#[cfg(test)]
mod tests;
