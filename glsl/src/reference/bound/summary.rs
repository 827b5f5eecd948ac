//! Smooth bases summed up: each node of patches as one flat triangle, and how far at most it is from that.

use glam::DVec3;

use super::smooth::{blend, field, normals, sized};
use crate::{
    layout::geometry::NONE,
    patches::{PatchNode, Patches, Summary},
};

/// The summaries of all nodes of one triangle's patches, which begin with the whole triangle.
#[must_use]
pub fn summaries(patches: &Patches) -> Vec<Summary> {
    let mut all = vec![Summary::default(); patches.nodes.len()];
    // Parts come after what they are parts of.
    for (k, node) in patches.nodes.iter().enumerate().rev() {
        all[k] = if node.parts == NONE {
            of_leaf(patches, node)
        } else {
            let first = node.parts as usize;
            of_parts([0, 1, 2, 3].map(|part| all[first + part]))
        };
    }
    all
}

fn of_leaf(patches: &Patches, leaf: &PatchNode) -> Summary {
    let (net, origin) = (patches.position(leaf), patches.origin(leaf));
    let corners = net.corners();
    let unit = sized(field(&normals(patches, leaf).0)).unit();
    Summary {
        places: corners.map(|p| origin + p),
        place_radius: net.less(corners).longest(),
        normals: unit.corners,
        normal_radius: unit.curvature,
    }
}

/// Corner k of the middle part lies across from corner k.
fn of_parts(parts: [Summary; 4]) -> Summary {
    let places = [0, 1, 2].map(|k| parts[k].places[k]);
    let normals = [0, 1, 2].map(|k| parts[k].normals[k]);
    let mut whole = Summary { places, normals, ..Summary::default() };
    for (n, part) in parts.iter().enumerate() {
        for k in 0..3 {
            let corner = [DVec3::X, DVec3::Y, DVec3::Z][k];
            let at =
                if n == 3 { 0.5 * (DVec3::ONE - corner) } else { 0.5 * (corner + [DVec3::X, DVec3::Y, DVec3::Z][n]) };
            let place = part.places[k].distance(blend(places, at)) + part.place_radius;
            let normal = part.normals[k].distance(blend(normals, at)) + part.normal_radius;
            whole.place_radius = whole.place_radius.max(place);
            whole.normal_radius = whole.normal_radius.max(normal);
        }
    }
    whole
}
