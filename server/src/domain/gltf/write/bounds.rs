//! `min` and `max` of accessors that pass through: made right where they are wrong, added where glTF wants them.

use std::collections::HashSet;

use serde_json::{Map, Value};

use super::document::{elements, index_of, view_bytes};
use crate::domain::{Result, report::Warning, scene::Scene};

/// Read for bounds at most: a million accessors may lie on the same bytes.
const MOST_BYTES: usize = 2 << 30;

/// Mends the accessors for which `kept` is true.
pub(super) fn mend(document: &mut Value, kept: &[bool], scene: &Scene, warnings: &mut Vec<Warning>) -> Result<()> {
    let needed = needed(document);
    let views = document.get("bufferViews").and_then(Value::as_array).cloned().unwrap_or_default();
    let mut left_bytes = MOST_BYTES;
    for (i, accessor) in elements(document, "accessors").enumerate().filter(|(i, _)| kept[*i]) {
        let Some(accessor) = accessor.as_object_mut() else { continue };
        let stated = [accessor.get("min"), accessor.get("max")].map(numbers);
        if !needed.contains(&i) && stated.iter().all(Option::is_none) {
            continue;
        }
        let Some(found) = found(accessor, &views, scene, &mut left_bytes)? else { continue };
        if stated.iter().zip(&found).all(|(stated, found)| stated.as_ref() == Some(found)) {
            continue;
        }
        for (key, found) in ["min", "max"].into_iter().zip(found) {
            accessor.insert(key.into(), found.into());
        }
        let message = format!("accessors[{i}] had no min and max, or wrong ones; they are those of its values now");
        warnings.push(Warning::new("document_mended", message));
    }
    Ok(())
}

/// Positions and the times of animations must have bounds.
fn needed(document: &mut Value) -> HashSet<usize> {
    let mut needed = HashSet::new();
    for primitive in elements(document, "meshes").flat_map(|mesh| elements(mesh, "primitives")) {
        needed.extend(primitive.pointer("/attributes/POSITION").and_then(index_of));
    }
    for sampler in elements(document, "animations").flat_map(|animation| elements(animation, "samplers")) {
        needed.extend(sampler.get("input").and_then(index_of));
    }
    needed
}

/// As single precision, which is all a file means.
fn numbers(list: Option<&Value>) -> Option<Vec<f64>> {
    list?.as_array()?.iter().map(|number| number.as_f64().map(|number| f64::from(number as f32))).collect()
}

/// The least and the greatest of each component; `None` where that takes more than reading a buffer view, or
/// where there is no such thing.
fn found(
    accessor: &Map<String, Value>,
    views: &[Value],
    scene: &Scene,
    left_bytes: &mut usize,
) -> Result<Option<[Vec<f64>; 2]>> {
    let number = |key: &str| accessor.get(key).and_then(index_of);
    let components = match accessor.get("type").and_then(Value::as_str) {
        Some("SCALAR") => 1,
        Some("VEC2") => 2,
        Some("VEC3") => 3,
        Some("VEC4") => 4,
        _ => return Ok(None),
    };
    let view = number("bufferView").filter(|_| !accessor.contains_key("sparse")).and_then(|view| views.get(view));
    let (Some(view), Some(kind), Some(count)) = (view, number("componentType"), number("count")) else {
        return Ok(None);
    };
    let Some(Component { size, read }) = component(kind) else { return Ok(None) };
    let Some(left) = left_bytes.checked_sub(count.saturating_mul(size * components)) else { return Ok(None) };
    *left_bytes = left;
    let bytes = view_bytes(view, scene)?;
    let stride = view.get("byteStride").and_then(index_of).unwrap_or(size * components);
    let mut bounds = [vec![f64::INFINITY; components], vec![f64::NEG_INFINITY; components]];
    for element in 0..count {
        let start = number("byteOffset").unwrap_or(0) + element * stride;
        let Some(element) = bytes.get(start..start + size * components) else { return Ok(None) };
        for (k, value) in element.chunks_exact(size).map(read).enumerate() {
            if !value.is_finite() {
                return Ok(None);
            }
            bounds[0][k] = bounds[0][k].min(value);
            bounds[1][k] = bounds[1][k].max(value);
        }
    }
    Ok((count > 0).then_some(bounds))
}

struct Component {
    /// Bytes.
    size: usize,
    read: fn(&[u8]) -> f64,
}

fn component(kind: usize) -> Option<Component> {
    fn word<const N: usize>(bytes: &[u8]) -> [u8; N] {
        std::array::from_fn(|k| bytes[k])
    }
    Some(match kind {
        5120 => Component { size: 1, read: |b| f64::from(b[0] as i8) },
        5121 => Component { size: 1, read: |b| f64::from(b[0]) },
        5122 => Component { size: 2, read: |b| f64::from(i16::from_le_bytes(word(b))) },
        5123 => Component { size: 2, read: |b| f64::from(u16::from_le_bytes(word(b))) },
        5125 => Component { size: 4, read: |b| f64::from(u32::from_le_bytes(word(b))) },
        5126 => Component { size: 4, read: |b| f64::from(f32::from_le_bytes(word(b))) },
        _ => return None,
    })
}
