//! KHR_materials_displacement, which is part of the geometry once that is displaced.

use std::collections::HashSet;

use serde_json::Value;

use crate::domain::scene::Scene;

/// Both spellings in use; neither was ever ratified.
pub(super) const SPELLINGS: [&str; 2] = ["KHR_materials_displacement", "KHR_materials_displacements"];

/// Takes the displacement out of `materials`, whose primitives have it in their geometry: whoever reads the
/// result must not displace it again.
pub fn forget_displacement(scene: &mut Scene, materials: &HashSet<usize>) {
    let list = scene.document.get_mut("materials").and_then(Value::as_array_mut).into_iter().flatten();
    let mut left = false;
    for (number, material) in list.enumerate() {
        let Some(material) = material.as_object_mut() else { continue };
        let Some(extensions) = material.get_mut("extensions").and_then(Value::as_object_mut) else { continue };
        if materials.contains(&number) {
            SPELLINGS.iter().for_each(|name| drop(extensions.remove(*name)));
        }
        left |= SPELLINGS.iter().any(|name| extensions.contains_key(*name));
        if extensions.is_empty() {
            material.remove("extensions");
        }
    }
    if !left {
        super::write::drop_names(&mut scene.document, |name| SPELLINGS.contains(&name));
    }
    for (_, material) in scene.materials.iter_mut().enumerate().filter(|(number, _)| materials.contains(number)) {
        material.displacement = None;
    }
}
