//! Which required extensions are honoured, and which are refused by name.

use super::json::At;
use crate::domain::{Error, ErrorKind, Result, report::Warning};

/// Understood, or without effect on geometry and passed through whole.
const HONOURED: [&str; 11] = [
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    "KHR_materials_displacement",
    "KHR_materials_displacements",
    "EXT_mesh_gpu_instancing",
    "KHR_lights_punctual",
    "KHR_animation_pointer",
    "KHR_node_visibility",
    "KHR_xmp_json_ld",
    "KHR_xmp",
    "MSFT_lod",
];

/// Refuses what `extensionsRequired` names and this server does not honour.
pub(super) fn check(root: &At<'_>, warnings: &mut Vec<Warning>) -> Result<()> {
    for required in root.list("extensionsRequired")? {
        let name = required.text_here()?;
        if !honours(name) {
            return Err(refusal(name, &required));
        }
    }
    for used in root.list("extensionsUsed")? {
        let name = used.text_here()?;
        if is_compression(name) {
            let message = format!("{name} is optional here: the uncompressed data is used and written");
            warnings.push(Warning::new("compression_dropped", message));
        }
    }
    Ok(())
}

fn honours(name: &str) -> bool {
    // Materials are never touched, whatever describes them.
    HONOURED.contains(&name) || name.starts_with("KHR_materials_")
}

/// Whether everything the extension says is free of accessor and buffer view numbers, or known here.
pub(super) fn refers_to_no_data(name: &str) -> bool {
    let texture = ["KHR_texture_basisu", "EXT_texture_webp", "EXT_texture_avif", "MSFT_texture_dds"];
    honours(name) || texture.contains(&name) || is_compression(name)
}

pub(super) fn is_compression(name: &str) -> bool {
    name == "KHR_draco_mesh_compression"
}

fn refusal(name: &str, at: &At<'_>) -> Error {
    let message = if is_compression(name) {
        format!("the file requires {name}, which this server does not decode: export it without compression")
    } else {
        format!("the file requires the extension {name}, which this server does not know: export it without")
    };
    Error::new(ErrorKind::Unsupported, message).with_field(at.path.clone())
}
