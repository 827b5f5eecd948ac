//! How a result is packed: which meshes are quantised, and on what grid.

use std::collections::HashSet;

use serde_json::Value;

use super::document::index_of;
use crate::domain::{
    gltf::extensions::refers_to_no_data, grid::Grid, mesh::Mesh, request::Compression, scene::Scene, surface::Surface,
};

/// How a result is packed. The default is f32 throughout.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Packing {
    pub compression: Compression,
    /// For each mesh of the scene, where its positions are quantised; those that are left out are not.
    pub grids: Vec<Option<Grid>>,
}

impl Packing {
    /// Quantises all that may be, on the finest grids.
    #[must_use]
    pub fn finest(scene: &Scene, surfaces: &[Surface], compression: Compression) -> Self {
        if compression == Compression::None {
            return Self::default();
        }
        let free = obstacles(scene).into_iter().zip(surfaces);
        let grids = free.map(|(obstacle, surface)| obstacle.is_none().then(|| Grid::around(&surface.positions)));
        Self { compression, grids: grids.collect() }
    }

    pub(super) fn grid(&self, mesh: usize) -> Option<Grid> {
        self.grids.get(mesh).copied().flatten()
    }

    pub(super) fn is_quantized(&self) -> bool {
        self.compression != Compression::None
    }
}

/// What keeps the positions of each mesh of the scene from being quantised: that they are another scale of the mesh's
/// own, which a node above it takes back, is not for all that use them.
#[must_use]
pub fn obstacles(scene: &Scene) -> Vec<Option<&'static str>> {
    let document = &scene.document;
    if !list(document, "extensionsUsed").filter_map(Value::as_str).all(refers_to_no_data) {
        return vec![Some("the file uses an extension that is not known and may use them"); scene.meshes.len()];
    }
    let uses = Uses::of(document);
    let of_mesh = |gltf_mesh: usize, displaced: usize| {
        let mesh = document.pointer(&format!("/meshes/{gltf_mesh}")).unwrap_or(&Value::Null);
        let primitives = || list(mesh, "primitives");
        match () {
            () if primitives().any(|p| p.get("targets").is_some()) => Some("morph targets move them"),
            () if uses.skinned.contains(&gltf_mesh) => Some("a skin places them"),
            () if uses.instanced.contains(&gltf_mesh) => Some("EXT_mesh_gpu_instancing places them"),
            () if !uses.shown.contains(&gltf_mesh) => Some("no node shows the mesh"),
            () if primitives().count() != displaced => Some("the mesh has primitives that are not displaced"),
            () => None,
        }
    };
    let displaced = |mesh: &Mesh| mesh.primitives.iter().filter(|p| !p.triangles.is_empty()).count();
    scene.meshes.iter().map(|m| of_mesh(m.gltf_mesh, displaced(&m.mesh))).collect()
}

/// The glTF meshes that nodes use, and how.
#[derive(Default)]
struct Uses {
    shown: HashSet<usize>,
    skinned: HashSet<usize>,
    instanced: HashSet<usize>,
}

impl Uses {
    fn of(document: &Value) -> Self {
        let mut uses = Self::default();
        for node in list(document, "nodes") {
            let Some(mesh) = node.get("mesh").and_then(index_of) else { continue };
            uses.shown.insert(mesh);
            if node.get("skin").is_some() {
                uses.skinned.insert(mesh);
            }
            if node.pointer("/extensions/EXT_mesh_gpu_instancing").is_some() {
                uses.instanced.insert(mesh);
            }
        }
        uses
    }
}

fn list<'a>(value: &'a Value, key: &str) -> impl Iterator<Item = &'a Value> {
    value.get(key).and_then(Value::as_array).into_iter().flatten()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::domain::{mesh::Primitive, scene::SceneMesh};

    /// One mesh of one displaced primitive, in a file of one plain node.
    fn obstacle(edit: impl FnOnce(&mut Value)) -> Option<&'static str> {
        let mut document = json!({
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
            "nodes": [{ "mesh": 0, "children": [1] }, { "camera": 0 }],
        });
        edit(&mut document);
        let primitives = vec![Primitive { triangles: 0..1, ..Primitive::default() }];
        let mesh = Mesh { primitives, ..Mesh::default() };
        let scene = Scene { document, meshes: vec![SceneMesh { gltf_mesh: 0, mesh }], ..Scene::default() };
        obstacles(&scene)[0]
    }

    #[test]
    fn nothing_keeps_a_plain_mesh_from_being_quantised() {
        assert_eq!(obstacle(|_| ()), None);
        let known = json!(["KHR_lights_punctual", "KHR_materials_ior", "KHR_texture_basisu"]);
        assert_eq!(obstacle(|d| d["extensionsUsed"] = known), None);
        assert_eq!(obstacle(|d| d["nodes"][1] = json!({ "skin": 0, "mesh": 1 })), None);
    }

    #[test]
    fn what_places_positions_in_another_way_keeps_them_as_they_are() {
        let instancing = json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": 1 } } });
        let reasons = [
            obstacle(|d| d["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": 1 }])),
            obstacle(|d| d["nodes"][0]["skin"] = json!(0)),
            obstacle(|d| d["nodes"][0]["extensions"] = instancing),
            obstacle(|d| d["nodes"] = json!([])),
            obstacle(|d| d["meshes"][0]["primitives"] = json!([{}, { "mode": 0 }])),
            obstacle(|d| d["extensionsUsed"] = json!(["VENDOR_colliders"])),
        ];
        let told = ["morph", "skin", "instancing", "no node", "not displaced", "extension"];
        for (reason, told) in reasons.iter().zip(told) {
            assert!(reason.is_some_and(|reason| reason.contains(told)), "{told}: {reason:?}");
        }
    }
}
