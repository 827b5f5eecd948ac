//! Meshes and their triangle primitives: attributes checked and decoded, strips and fans unrolled.

use super::{
    Limits,
    accessor::{Accessor, Component},
    json::At,
    node::warn_of_weights,
    source::Source,
};
use crate::domain::{
    Error, Result,
    weld::{PrimitiveInput, VertexAttribute},
};

/// The triangle primitives of one glTF mesh.
pub(super) struct MeshInput {
    pub(super) gltf_mesh: usize,
    pub(super) name: String,
    pub(super) primitives: Vec<PrimitiveInput>,
}

/// Every mesh that has triangle primitives; points and lines are only checked, they pass through.
pub(super) fn read_all(source: &Source<'_>, limits: &Limits) -> Result<Vec<MeshInput>> {
    let mut meshes = Vec::new();
    let mut triangles = 0;
    for (gltf_mesh, mesh) in source.root.list("meshes")?.iter().enumerate() {
        let parts = mesh.need("primitives")?.items()?;
        if parts.is_empty() {
            return Err(mesh.error("has no primitives"));
        }
        let mut primitives = Vec::new();
        for (index, part) in parts.iter().enumerate() {
            if let Some(primitive) = read(source, index, part)? {
                triangles += primitive.triangles.len() as u64;
                check_triangles(part, triangles, limits)?;
                primitives.push(primitive);
            }
        }
        if !primitives.is_empty() {
            warn_of_weights(source, mesh)?;
            let name = mesh.text("name")?.map_or_else(|| format!("mesh {gltf_mesh}"), str::to_owned);
            meshes.push(MeshInput { gltf_mesh, name, primitives });
        }
    }
    Ok(meshes)
}

fn check_triangles(part: &At<'_>, triangles: u64, limits: &Limits) -> Result<()> {
    if triangles <= limits.triangles {
        return Ok(());
    }
    let message = format!("the file has more than {} triangles up to here: reduce or split it", limits.triangles);
    Err(Error::too_large(&part.path, message))
}

fn read(source: &Source<'_>, index: usize, at: &At<'_>) -> Result<Option<PrimitiveInput>> {
    let mode = at.whole("mode")?.unwrap_or(4);
    if mode > 6 {
        return Err(at.error(format!("mode {mode} is unknown; there are 0 to 6")));
    }
    let attributes = at.need("attributes")?;
    let material_count = source.root.count("materials")?;
    let material = at.index("material", material_count, "materials")?;
    let Some(position) = attributes.get("POSITION") else {
        check_references(source, at)?;
        source.warn("no_positions", format!("{} has no POSITION; it stays as it is", at.path));
        return Ok(None);
    };
    let vertices = source.accessor(&position)?.count;
    if mode < 4 {
        check_references(source, at)?;
        return Ok(None);
    }
    let positions = positions(source, &position)?;
    let mut input = PrimitiveInput {
        gltf_primitive: index,
        material,
        positions,
        triangles: triangles(&indices(source, at, vertices)?, mode, at, source),
        ..PrimitiveInput::default()
    };
    read_attributes(source, &attributes, vertices, &mut input)?;
    read_targets(source, at, vertices, &mut input)?;
    Ok(Some(input))
}

/// Indices of a primitive that passes through must still exist.
fn check_references(source: &Source<'_>, at: &At<'_>) -> Result<()> {
    let attributes = at.need("attributes")?;
    for key in attributes.object()?.keys() {
        source.accessor(&attributes.need(key)?)?;
    }
    at.get("indices").map_or(Ok(()), |indices| source.accessor(&indices).map(|_| ()))
}

fn positions(source: &Source<'_>, at: &At<'_>) -> Result<Vec<[f32; 3]>> {
    let accessor = source.accessor(at)?;
    check_type(source, at, accessor, "POSITION")?;
    let positions = accessor.floats(source)?.as_chunks().0.to_vec();
    match positions.iter().position(|p: &[f32; 3]| !p.iter().all(|c| c.is_finite())) {
        Some(vertex) => {
            Err(at.error(format!("vertex {vertex} is {:?}; coordinates must be finite", positions[vertex])))
        }
        None => Ok(positions),
    }
}

fn indices(source: &Source<'_>, at: &At<'_>, vertices: usize) -> Result<Vec<u32>> {
    let Some(indices) = at.get("indices") else {
        source.charge(&at.path, vertices as u64 * 4)?;
        return Ok((0..vertices as u32).collect());
    };
    let values = source.accessor(&indices)?.integers(source)?;
    match values.iter().position(|&i| i as usize >= vertices) {
        Some(k) => Err(indices
            .error(format!("index {} (number {k}) is out of range; the primitive has {vertices} vertices", values[k]))),
        None => Ok(values),
    }
}

fn triangles(indices: &[u32], mode: u64, at: &At<'_>, source: &Source<'_>) -> Vec<[u32; 3]> {
    let triple = |w: &[u32]| [w[0], w[1], w[2]];
    let triangles: Vec<[u32; 3]> = match mode {
        4 => indices.as_chunks().0.to_vec(),
        // Every other triangle of a strip is wound the other way.
        5 => indices
            .windows(3)
            .enumerate()
            .map(|(i, w)| if i % 2 == 0 { triple(w) } else { [w[1], w[0], w[2]] })
            .collect(),
        _ => indices.iter().skip(1).zip(indices.iter().skip(2)).map(|(&b, &c)| [b, c, indices[0]]).collect(),
    };
    if (mode == 4 && !indices.len().is_multiple_of(3)) || triangles.is_empty() {
        let message =
            format!("{}: {} indices do not make whole triangles; the rest was left out", at.path, indices.len());
        source.warn("incomplete_triangles", message);
    }
    triangles
}

fn read_attributes(source: &Source<'_>, at: &At<'_>, vertices: usize, input: &mut PrimitiveInput) -> Result<()> {
    for semantic in at.object()?.keys().filter(|key| *key != "POSITION") {
        let at = at.need(semantic)?;
        let accessor = source.accessor(&at)?;
        if accessor.count != vertices {
            return Err(at.error(format!("has {} elements and POSITION {vertices}", accessor.count)));
        }
        if accessor.is_matrix() || !is_known(semantic) {
            source.warn("attribute_dropped", format!("{} cannot be interpolated and was left out", at.path));
            continue;
        }
        check_type(source, &at, accessor, semantic)?;
        let values = accessor.floats(source)?;
        match semantic.as_str() {
            "NORMAL" => input.normals = Some(values.as_chunks().0.to_vec()),
            "TANGENT" => input.tangents = Some(values.as_chunks().0.to_vec()),
            _ => input.attributes.push(VertexAttribute {
                components: accessor.components(),
                values: mended(source, &at, semantic, values),
                semantic: semantic.clone(),
            }),
        }
    }
    check_skin(at)
}

/// JOINTS_n without WEIGHTS_n says nothing, nor the other way round.
fn check_skin(at: &At<'_>) -> Result<()> {
    for key in at.object()?.keys() {
        let other = match key.split_once('_') {
            Some(("JOINTS", n)) => format!("WEIGHTS_{n}"),
            Some(("WEIGHTS", n)) => format!("JOINTS_{n}"),
            _ => continue,
        };
        if at.get(&other).is_none() {
            return Err(at.error(format!("has {key} and no {other}: both are needed to move a vertex")));
        }
    }
    Ok(())
}

pub(super) fn is_known(semantic: &str) -> bool {
    let numbered = |set: &str| set.strip_suffix(|c: char| c.is_ascii_digit()).is_some();
    semantic == "NORMAL"
        || semantic == "POSITION"
        || semantic == "TANGENT"
        || semantic.starts_with('_')
        || ["TEXCOORD_", "COLOR_", "JOINTS_", "WEIGHTS_"]
            .iter()
            .any(|set| semantic.starts_with(set) && numbered(semantic))
}

/// Values that no viewer can use become ones it can: not a number becomes 0, colours stay within [0, 1].
fn mended(source: &Source<'_>, at: &At<'_>, semantic: &str, mut values: Vec<f32>) -> Vec<f32> {
    let is_color = semantic.starts_with("COLOR_");
    let mut count = 0;
    for value in &mut values {
        let good = if !value.is_finite() {
            0.0
        } else if is_color {
            value.clamp(0.0, 1.0)
        } else {
            *value
        };
        if good.to_bits() != value.to_bits() {
            (*value, count) = (good, count + 1);
        }
    }
    if count > 0 {
        source.warn("attribute_values_mended", format!("{}: {count} values were not finite or out of range", at.path));
    }
    values
}

fn read_targets(source: &Source<'_>, at: &At<'_>, vertices: usize, input: &mut PrimitiveInput) -> Result<()> {
    for (number, target) in at.list("targets")?.iter().enumerate() {
        for semantic in target.object()?.keys() {
            let at = target.need(semantic)?;
            let accessor = source.accessor(&at)?;
            if accessor.count != vertices {
                return Err(at.error(format!("has {} elements and POSITION {vertices}", accessor.count)));
            }
            let known = ["POSITION", "NORMAL", "TANGENT", "TEXCOORD_", "COLOR_", "_"];
            if accessor.is_matrix() || !known.iter().any(|known| semantic.starts_with(known)) {
                source.warn("attribute_dropped", format!("{} cannot be interpolated and was left out", at.path));
                continue;
            }
            check_target(source, &at, accessor, semantic)?;
            let values = mended(source, &at, "", accessor.floats(source)?);
            let semantic = format!("targets/{number}/{semantic}");
            input.attributes.push(VertexAttribute { semantic, components: accessor.components(), values });
        }
    }
    Ok(())
}

/// Deltas have three components, those of tangents as well.
fn check_target(source: &Source<'_>, at: &At<'_>, accessor: &Accessor, semantic: &str) -> Result<()> {
    match semantic {
        "POSITION" => check_type(source, at, accessor, "POSITION"),
        "NORMAL" | "TANGENT" => check_type(source, at, accessor, "NORMAL"),
        _ => Ok(()),
    }
}

/// What the specification allows for each attribute; KHR_mesh_quantization widens it.
fn check_type(source: &Source<'_>, at: &At<'_>, accessor: &Accessor, semantic: &str) -> Result<()> {
    use Component::{F32, I8, I16, U8, U16};
    let n = accessor.components();
    let (component, normalized, quantized) = (accessor.component, accessor.normalized, source.quantized);
    let small = matches!(component, I8 | U8 | I16 | U16);
    let unsigned = matches!(component, U8 | U16);
    let (shape, good, wants) = match semantic.split('_').next().unwrap_or_default() {
        "POSITION" => (n == 3, component == F32 || (quantized && small), "VEC3 of floats"),
        "NORMAL" => (n == 3, component == F32 || (quantized && small && !unsigned && normalized), "VEC3 of floats"),
        "TANGENT" => (n == 4, component == F32 || (quantized && small && !unsigned && normalized), "VEC4 of floats"),
        "TEXCOORD" => (
            n == 2,
            component == F32 || (unsigned && normalized) || (quantized && small),
            "VEC2 of floats or normalized unsigned integers",
        ),
        "COLOR" => (
            n == 3 || n == 4,
            component == F32 || (unsigned && normalized),
            "VEC3 or VEC4 of floats or normalized unsigned integers",
        ),
        "JOINTS" => (n == 4, unsigned && !normalized, "VEC4 of unsigned bytes or shorts"),
        "WEIGHTS" => {
            (n == 4, component == F32 || (unsigned && normalized), "VEC4 of floats or normalized unsigned integers")
        }
        _ => (true, component != Component::U32, "anything but 32-bit integers"),
    };
    if shape && good {
        return Ok(());
    }
    let hint = if small && !quantized { "; other integers need KHR_mesh_quantization in extensionsUsed" } else { "" };
    Err(at.error(format!(
        "has {n} components of type {component:?} (normalized: {normalized}); {semantic} is {wants}{hint}"
    )))
}
