//! A mesh painted by a figure, with a scale beside it: unlit, so that every colour is the figure's.

use serde_json::{Map, Value, json};

use super::pack::{Bounds, Builder, Component, Stream};
use crate::domain::Result;

/// Triangles in world space with a colour for each vertex.
pub struct Painted<'a> {
    pub positions: &'a [[f32; 3]],
    pub triangles: &'a [[u32; 3]],
    /// sRGB.
    pub colors: &'a [[u8; 3]],
    /// What the first and the last colour of the scale stand for, world units.
    pub range: [f64; 2],
    /// The colours between them, evenly.
    pub scale: &'a [[u8; 3]],
}

/// The painted mesh, and a bar of the scale's colours to its right. The range is in `extras` of the asset, and the
/// names of the bar's nodes tell it.
pub fn write_painted(painted: &Painted<'_>) -> Result<Vec<u8>> {
    let mut builder = Builder::default();
    let linear = linear_table();
    let body = primitive(&mut builder, painted.positions, painted.triangles, painted.colors, &linear);
    let (positions, triangles, colors) = bar(painted);
    let bar = primitive(&mut builder, &positions, &triangles, &colors, &linear);
    let [low, high] = painted.range;
    let mut document = json!({
        "asset": {
            "version": "2.0",
            "generator": "displace",
            "extras": { "distance": { "low": low, "high": high, "unit": "world", "colors": "magma" } },
        },
        "extensionsUsed": ["KHR_materials_unlit"],
        "materials": [{ "doubleSided": true, "extensions": { "KHR_materials_unlit": {} } }],
        "meshes": [{ "primitives": [body] }, { "primitives": [bar] }],
        "nodes": [
            { "name": "distance", "mesh": 0 },
            { "name": format!("scale from {low:e} at the bottom to {high:e} at the top, world units"), "mesh": 1 },
        ],
        "scenes": [{ "nodes": [0, 1] }],
        "scene": 0,
    });
    document["accessors"] = Value::Array(std::mem::take(&mut builder.accessors));
    document["bufferViews"] = Value::Array(std::mem::take(&mut builder.views));
    document["buffers"] = builder.buffers();
    builder.pack(&document)
}

fn primitive<'a>(
    builder: &mut Builder<'a>,
    positions: &[[f32; 3]],
    triangles: &[[u32; 3]],
    colors: &[[u8; 3]],
    linear: &[u16; 256],
) -> Value {
    let bounds = Some(bounds(positions));
    let count = positions.len();
    let place: Vec<u8> = positions.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    let stream = Stream { bounds, ..Stream::of_vertices(Component::F32, 3, count) };
    let place = builder.stream(stream, Box::new(move |out| out.copy_from_slice(&place)));
    // Vertex colours are linear, where 8 bits would merge the dark ones.
    let light =
        colors.iter().flat_map(|c| [linear[c[0] as usize], linear[c[1] as usize], linear[c[2] as usize], u16::MAX]);
    let light: Vec<u8> = light.flat_map(u16::to_le_bytes).collect();
    let stream = Stream::of_vertices(Component::Unorm16, 4, count);
    let color = builder.stream(stream, Box::new(move |out| out.copy_from_slice(&light)));
    let corners: Vec<u8> = triangles.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    let stream = Stream::of_indices(Component::U32, 3 * triangles.len());
    let indices = builder.stream(stream, Box::new(move |out| out.copy_from_slice(&corners)));
    let mut attributes = Map::new();
    attributes.insert("POSITION".into(), place.into());
    attributes.insert("COLOR_0".into(), color.into());
    json!({ "attributes": attributes, "indices": indices, "material": 0 })
}

fn bounds(positions: &[[f32; 3]]) -> Bounds {
    positions.iter().fold(([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]), |(low, high), p| {
        (std::array::from_fn(|k| low[k].min(p[k])), std::array::from_fn(|k| high[k].max(p[k])))
    })
}

/// Positions, triangles and colours.
type Bar = (Vec<[f32; 3]>, Vec<[u32; 3]>, Vec<[u8; 3]>);

/// A strip as high as the mesh, a tenth as wide, a tenth to its right.
fn bar(painted: &Painted<'_>) -> Bar {
    let (low, high) = bounds(painted.positions);
    let size = (0..3).map(|k| high[k] - low[k]).fold(0.0, f32::max);
    let (left, right) = (high[0] + 0.1 * size, high[0] + 0.2 * size);
    let depth = 0.5 * (low[2] + high[2]);
    let steps = painted.scale.len().max(2) - 1;
    let (mut positions, mut triangles, mut colors) = (Vec::new(), Vec::new(), Vec::new());
    for (step, color) in painted.scale.iter().enumerate() {
        let y = low[1] + size * step as f32 / steps as f32;
        positions.extend([[left, y, depth], [right, y, depth]]);
        colors.extend([*color; 2]);
    }
    for step in 0..painted.scale.len().saturating_sub(1) as u32 {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| 2 * step + k);
        triangles.extend([[a, b, c], [b, d, c]]);
    }
    (positions, triangles, colors)
}

/// sRGB bytes to linear words (IEC 61966-2-1).
fn linear_table() -> [u16; 256] {
    std::array::from_fn(|byte| {
        let encoded = byte as f64 / 255.0;
        let linear = if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) };
        (linear * 65535.0).round() as u16
    })
}
