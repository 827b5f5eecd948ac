//! Small faults of a document that a reader can live with and a validator cannot: mended, each with a warning.

use std::collections::HashSet;

use serde_json::{Map, Value};

use crate::domain::report::Warning;

/// Mends what would make the written file invalid. The document has passed every check of loading.
pub(super) fn mend(document: &mut Value, warnings: &mut Vec<Warning>) {
    let mut mender = Mender { warnings };
    if let Some(root) = document.as_object_mut() {
        mender.scene_roots(root);
        mender.nodes(root);
        mender.empty_lists(root);
        mender.unknown_semantics(root);
    }
}

struct Mender<'a> {
    warnings: &'a mut Vec<Warning>,
}

impl Mender<'_> {
    fn warn(&mut self, message: String) {
        self.warnings.push(Warning::new("document_mended", message));
    }

    /// Scenes list roots: a listed child leaves the list where an ancestor is listed too, and otherwise
    /// leaves its parent, which is how viewers show it.
    fn scene_roots(&mut self, root: &mut Map<String, Value>) {
        let parents = parents(root);
        let mut orphans = HashSet::new();
        for (number, scene) in list_mut(root, "scenes").iter_mut().enumerate() {
            let Some(nodes) = scene.get_mut("nodes").and_then(Value::as_array_mut) else { continue };
            let listed: Vec<usize> = nodes.iter().filter_map(index).collect();
            let shown = super::node::below(&listed, &parents);
            let mut seen = HashSet::new();
            nodes.retain(|node| {
                let Some(node) = index(node) else { return false };
                if shown[node] || !seen.insert(node) {
                    self.warn(format!("scenes[{number}] listed nodes[{node}] although the scene has it already"));
                    return false;
                }
                if parents[node].is_some() && orphans.insert(node) {
                    self.warn(format!("scenes[{number}] listed nodes[{node}], a child: it was taken from its parent"));
                }
                true
            });
        }
        for node in list_mut(root, "nodes") {
            if let Some(children) = node.get_mut("children").and_then(Value::as_array_mut) {
                children.retain(|child| index(child).is_none_or(|child| !orphans.contains(&child)));
            }
        }
    }

    fn nodes(&mut self, root: &mut Map<String, Value>) {
        for (number, node) in list_mut(root, "nodes").iter_mut().enumerate() {
            let Some(node) = node.as_object_mut() else { continue };
            if node.contains_key("matrix") {
                for key in ["translation", "rotation", "scale"] {
                    if node.remove(key).is_some() {
                        self.warn(format!("nodes[{number}] has a matrix and {key}: the matrix counts"));
                    }
                }
            }
            if let Some(rotation) = node.get_mut("rotation") {
                self.rotation(number, rotation);
            }
        }
    }

    fn rotation(&mut self, number: usize, rotation: &mut Value) {
        let numbers: Vec<f64> = rotation.as_array().into_iter().flatten().filter_map(Value::as_f64).collect();
        let length = numbers.iter().map(|x| x * x).sum::<f64>().sqrt();
        // The validator allows 5e-4.
        if numbers.len() != 4 || (length - 1.0).abs() < 4e-4 {
            return;
        }
        self.warn(format!("nodes[{number}].rotation was not a unit quaternion; its length was {length}"));
        *rotation =
            if length > 1e-9 { numbers.iter().map(|x| x / length).collect() } else { serde_json::json!([0, 0, 0, 1]) };
    }

    /// glTF has no empty lists: what is empty is left out.
    fn empty_lists(&mut self, root: &mut Map<String, Value>) {
        for key in ["scenes", "nodes", "meshes", "skins"] {
            for (number, item) in list_mut(root, key).iter_mut().enumerate() {
                for part in ["nodes", "children", "weights"] {
                    if let Some(item) = item.as_object_mut()
                        && is_empty_list(item.get(part))
                    {
                        item.remove(part);
                        self.warn(format!("{key}[{number}].{part} was an empty list"));
                    }
                }
            }
        }
        let empty: Vec<String> =
            root.iter().filter(|(_, value)| is_empty_list(Some(value))).map(|(key, _)| key.clone()).collect();
        for key in empty {
            root.remove(&key);
            self.warn(format!("{key} was an empty list"));
        }
        if !root.contains_key("scenes") {
            root.remove("scene");
        }
    }

    /// Attributes that are neither of the specification nor marked as custom by an underscore.
    fn unknown_semantics(&mut self, root: &mut Map<String, Value>) {
        for (number, mesh) in list_mut(root, "meshes").iter_mut().enumerate() {
            for primitive in mesh.get_mut("primitives").and_then(Value::as_array_mut).into_iter().flatten() {
                let Some(attributes) = primitive.get_mut("attributes").and_then(Value::as_object_mut) else { continue };
                let unknown: Vec<String> =
                    attributes.keys().filter(|key| !super::primitive::is_known(key)).cloned().collect();
                for key in unknown {
                    attributes.remove(&key);
                    self.warn(format!("meshes[{number}] has an attribute {key}, which glTF does not know"));
                }
            }
        }
    }
}

fn parents(root: &Map<String, Value>) -> Vec<Option<usize>> {
    let nodes = root.get("nodes").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let mut parents = vec![None; nodes.len()];
    for (parent, node) in nodes.iter().enumerate() {
        for child in node.get("children").and_then(Value::as_array).into_iter().flatten().filter_map(index) {
            parents[child] = Some(parent);
        }
    }
    parents
}

fn index(value: &Value) -> Option<usize> {
    value.as_f64().map(|x| x as usize)
}

fn is_empty_list(value: Option<&Value>) -> bool {
    value.and_then(Value::as_array).is_some_and(Vec::is_empty)
}

fn list_mut<'a>(root: &'a mut Map<String, Value>, key: &str) -> &'a mut [Value] {
    root.get_mut(key).and_then(Value::as_array_mut).map_or(&mut [], Vec::as_mut_slice)
}
