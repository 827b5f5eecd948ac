//! Lights of KHR_lights_punctual, where nodes put them.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use glam::{DMat4, DVec3};

use super::json::At;
use crate::domain::{
    Result,
    scene::{PunctualKind, PunctualLight},
};

const NAME: &str = "KHR_lights_punctual";

/// The light of a node, if it has one. It shines along the node's -z; scale does not matter.
pub(super) fn of_node(root: &At<'_>, node: &At<'_>, world: &DMat4) -> Result<Option<PunctualLight>> {
    let Some(extension) = node.extension(NAME) else { return Ok(None) };
    let Some(lights) = root.extension(NAME) else {
        return Err(extension.error("names a light, and the file's root has no KHR_lights_punctual"));
    };
    let index = extension.need("light")?.index_here(lights.count("lights")?, "lights")?;
    let light = lights.element("lights", index)?;
    let color = light.numbers::<3>("color")?.unwrap_or([1.0; 3]);
    let intensity = light.number("intensity")?.unwrap_or(1.0);
    let range = light.number("range")?;
    if color.iter().chain([&intensity]).any(|x| *x < 0.0) || range.is_some_and(|range| range <= 0.0) {
        return Err(light.error("has a negative colour or intensity, or a range that is not above 0"));
    }
    Ok(Some(PunctualLight {
        kind: kind(&light)?,
        color: color.map(|c| c as f32),
        intensity: intensity as f32,
        range: range.map(|range| range as f32),
        position_world: world.transform_point3(DVec3::ZERO).as_vec3().to_array(),
        direction_world: world.transform_vector3(DVec3::NEG_Z).normalize_or(DVec3::NEG_Z).as_vec3().to_array(),
    }))
}

fn kind(light: &At<'_>) -> Result<PunctualKind> {
    let kind = light.need("type")?;
    match kind.text_here()? {
        "directional" => Ok(PunctualKind::Directional),
        "point" => Ok(PunctualKind::Point),
        "spot" => {
            let cone = light.get("spot");
            let angle = |key: &str| cone.as_ref().map_or(Ok(None), |cone| cone.number(key));
            let (inner, outer) =
                (angle("innerConeAngle")?.unwrap_or(0.0), angle("outerConeAngle")?.unwrap_or(FRAC_PI_4));
            if !(0.0 <= inner && inner < outer && outer <= FRAC_PI_2) {
                return Err(light.error(format!(
                    "has cone angles {inner} and {outer}; allowed are 0 <= inner < outer <= pi/2 radians"
                )));
            }
            Ok(PunctualKind::Spot { inner_cone_radians: inner as f32, outer_cone_radians: outer as f32 })
        }
        other => Err(kind.error(format!("'{other}' is none of directional, point and spot"))),
    }
}
