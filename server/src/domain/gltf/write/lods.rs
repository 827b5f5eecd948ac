//! Levels of detail in the document (MSFT_lod): meshes beside the mesh, and a node for each.
//!
//! A node that shows the mesh gets a child that shows level 0 and names the nodes of the others. They have no transform of
//! their own and take the child's place, so that the node's other children, its camera and what animates it stay.

use serde_json::{Map, Value, json};

use super::{
    Shown, claims,
    document::{elements, index_of},
    normal_maps::NormalMap,
};
use crate::domain::{grid::Grid, scene::Scene, surface::Surface};

const NAME: &str = "MSFT_lod";

/// The levels below level 0 of one mesh of the scene.
#[derive(Clone, Debug)]
pub struct Chain {
    /// Index into `Scene::meshes`.
    pub mesh: usize,
    /// Level 1 first.
    pub levels: Vec<Level>,
    /// The least share of the image for each level, level 0 first.
    pub coverages: Vec<f64>,
}

/// One level of a mesh.
#[derive(Clone, Debug)]
pub struct Level {
    pub surface: Surface,
    /// Where its positions are quantised.
    pub grid: Option<Grid>,
    /// Of each primitive; empty where none has any.
    pub normal_maps: Vec<Option<NormalMap>>,
}

/// The first node of the file that has levels of its own.
#[must_use]
pub fn node_with_lods(scene: &Scene) -> Option<usize> {
    let nodes = scene.document.get("nodes").and_then(Value::as_array)?;
    nodes.iter().position(|node| node.pointer("/extensions/MSFT_lod").is_some())
}

/// Whether any node shows each mesh of the scene.
#[must_use]
pub fn shown_by_nodes(scene: &Scene) -> Vec<bool> {
    let nodes = scene.document.get("nodes").and_then(Value::as_array).into_iter().flatten();
    let shown: Vec<usize> = nodes.filter_map(|node| node.get("mesh").and_then(index_of)).collect();
    scene.meshes.iter().map(|m| shown.contains(&m.gltf_mesh)).collect()
}

/// Adds meshes, which are still those of level 0, and nodes; returns what the meshes shall show.
pub(super) fn insert<'a>(document: &mut Value, scene: &'a Scene, chains: &'a [Chain]) -> Vec<Shown<'a>> {
    if chains.is_empty() {
        return Vec::new();
    }
    keep_roots(document);
    claims::mention(document, NAME);
    let mut shown = Vec::new();
    for chain in chains {
        let own = &scene.meshes[chain.mesh];
        let meshes: Vec<usize> = chain.levels.iter().filter_map(|_| copy_mesh(document, own.gltf_mesh)).collect();
        let levels = meshes.iter().zip(&chain.levels);
        shown.extend(levels.map(|(&gltf_mesh, level)| Shown {
            gltf_mesh,
            mesh: &own.mesh,
            surface: &level.surface,
            grid: level.grid,
            normal_maps: &level.normal_maps,
        }));
        insert_nodes(document, own.gltf_mesh, &meshes, &chain.coverages);
    }
    shown
}

/// Where a file has no scene, readers take every root for shown: the nodes of lower levels must not be.
fn keep_roots(document: &mut Value) {
    if document.get("scenes").and_then(Value::as_array).is_some_and(|scenes| !scenes.is_empty()) {
        return;
    }
    let nodes = document.get("nodes").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let mut is_root = vec![true; nodes.len()];
    let children = nodes.iter().filter_map(|node| node.get("children")?.as_array()).flatten().filter_map(index_of);
    children.for_each(|child| is_root[child] = false);
    let roots: Vec<usize> = (0..is_root.len()).filter(|&node| is_root[node]).collect();
    document["scenes"] = json!([{ "nodes": roots }]);
    document["scene"] = 0.into();
}

fn copy_mesh(document: &mut Value, mesh: usize) -> Option<usize> {
    let meshes = document.get_mut("meshes")?.as_array_mut()?;
    let copy = meshes.get(mesh)?.clone();
    meshes.push(copy);
    Some(meshes.len() - 1)
}

fn insert_nodes(document: &mut Value, mesh: usize, lower: &[usize], coverages: &[f64]) {
    let count = document.get("nodes").and_then(Value::as_array).map_or(0, Vec::len);
    for node in 0..count {
        let Some(nodes) = document.get_mut("nodes").and_then(Value::as_array_mut) else { return };
        if nodes[node].get("mesh").and_then(index_of) != Some(mesh) {
            continue;
        }
        let first = nodes.len();
        let Some(shows) = take_shown(&mut nodes[node], first) else { continue };
        let ids: Vec<usize> = (first + 1..=first + lower.len()).collect();
        let level = |mesh: usize| {
            let mut level = shows.clone();
            level.insert("mesh".into(), mesh.into());
            level
        };
        let mut highest = level(mesh);
        highest.entry("extensions").or_insert_with(|| json!({}))[NAME] = json!({ "ids": ids });
        highest.insert("extras".into(), json!({ "MSFT_screencoverage": coverages }));
        nodes.push(highest.into());
        nodes.extend(lower.iter().map(|mesh| Value::from(level(*mesh))));
        retarget_weights(document, node, first, lower.len());
    }
}

/// Takes from a node what shows its mesh, and gives it a child instead.
fn take_shown(node: &mut Value, child: usize) -> Option<Map<String, Value>> {
    const INSTANCING: &str = "EXT_mesh_gpu_instancing";
    let node = node.as_object_mut()?;
    let mut shows = Map::new();
    for key in ["mesh", "skin", "weights"] {
        shows.extend(node.remove(key).map(|value| (key.to_owned(), value)));
    }
    if let Some(extensions) = node.get_mut("extensions").and_then(Value::as_object_mut) {
        if let Some(instancing) = extensions.remove(INSTANCING) {
            shows.insert("extensions".into(), json!({ INSTANCING: instancing }));
        }
        if extensions.is_empty() {
            node.remove("extensions");
        }
    }
    match node.get_mut("children").and_then(Value::as_array_mut) {
        Some(children) => children.push(child.into()),
        None => {
            node.insert("children".into(), json!([child]));
        }
    }
    Some(shows)
}

/// What animates the weights of the node's morph targets animates those of all levels.
fn retarget_weights(document: &mut Value, node: usize, first: usize, lower: usize) {
    for animation in elements(document, "animations") {
        let Some(channels) = animation.get_mut("channels").and_then(Value::as_array_mut) else { continue };
        let mut more = Vec::new();
        for channel in channels.iter_mut() {
            let Some(target) = channel.get("target") else { continue };
            let is_of_node = target.get("node").and_then(index_of) == Some(node);
            if !is_of_node || target.get("path").and_then(Value::as_str) != Some("weights") {
                continue;
            }
            channel["target"]["node"] = first.into();
            more.extend((first + 1..=first + lower).map(|level| {
                let mut channel = channel.clone();
                channel["target"]["node"] = level.into();
                channel
            }));
        }
        channels.append(&mut more);
    }
}

#[cfg(test)]
mod tests;
