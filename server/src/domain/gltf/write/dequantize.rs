//! What takes quantised positions back to their places: a child for each node that shows the mesh, so that nothing else
//! at the node, its other children, its camera and light, or what animates it, notices.

use std::collections::HashMap;

use serde_json::{Value, json};

use super::document::index_of;
use crate::domain::grid::Grid;

/// `grids` are by glTF mesh.
pub(super) fn insert_nodes(document: &mut Value, grids: &HashMap<usize, Grid>) {
    let Some(nodes) = document.get_mut("nodes").and_then(Value::as_array_mut) else { return };
    for number in 0..nodes.len() {
        let mesh = nodes[number].get("mesh").and_then(index_of);
        let Some((mesh, grid)) = mesh.and_then(|mesh| Some((mesh, grids.get(&mesh)?))) else { continue };
        let (child, scale) = (nodes.len(), [f64::from(grid.step); 3]);
        nodes.push(json!({
            "mesh": mesh,
            "translation": grid.offset.map(f64::from),
            "scale": scale,
        }));
        let Some(node) = nodes[number].as_object_mut() else { continue };
        node.remove("mesh");
        match node.get_mut("children").and_then(Value::as_array_mut) {
            Some(children) => children.push(child.into()),
            None => {
                node.insert("children".into(), json!([child]));
            }
        }
    }
}
