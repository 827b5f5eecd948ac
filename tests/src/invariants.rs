//! What every displaced mesh must keep: no crack, no NaN, one position per place.
//!
//! Positions are compared by their bits (−0 counts as +0): a crack of one unit in the last place is a crack.

use std::collections::HashMap;

use displace_server::domain::{mesh::Mesh, surface::Surface};

type Place = [u32; 3];

fn place(position: [f32; 3]) -> Place {
    position.map(|x| (x + 0.0).to_bits())
}

/// Number of undirected edges, by exact position, with exactly one triangle.
#[must_use]
pub fn boundary_edges(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> u64 {
    edge_uses(positions, triangles).values().filter(|&&uses| uses == 1).count() as u64
}

/// How many triangles use each edge; edges whose ends coincide are left out.
fn edge_uses(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> HashMap<(Place, Place), u32> {
    let mut uses = HashMap::new();
    for triangle in triangles {
        let corners = triangle.map(|i| place(positions[i as usize]));
        for side in 0..3 {
            let (a, b) = (corners[side], corners[(side + 1) % 3]);
            if a != b {
                *uses.entry((a.min(b), a.max(b))).or_insert(0) += 1;
            }
        }
    }
    uses
}

/// Distinct places minus edges plus triangles: topology is kept when this is.
#[must_use]
pub fn euler_characteristic(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> i64 {
    let places: std::collections::HashSet<Place> =
        triangles.iter().flatten().map(|&i| place(positions[i as usize])).collect();
    places.len() as i64 - edge_uses(positions, triangles).len() as i64 + triangles.len() as i64
}

/// # Panics
/// At the first value that is not finite.
pub fn assert_finite(what: &str, values: &[[f32; 3]]) {
    let bad = values.iter().position(|v| v.iter().any(|x| !x.is_finite()));
    assert!(bad.is_none(), "{what}[{}] is {:?}", bad.unwrap_or(0), values[bad.unwrap_or(0)]);
}

/// Fine attribute vertices of one place share the bits of their position, and so do the points along
/// the attribute edges of one geometric edge.
///
/// # Panics
/// At the first place with two positions.
pub fn assert_one_position_per_place(mesh: &Mesh, surface: &Surface) {
    let mut position_of_place = HashMap::new();
    for (vertex, &gv) in mesh.av_gv.iter().enumerate() {
        check_place(&mut position_of_place, (0, u64::from(gv), 0), surface.positions[vertex], vertex);
    }
    let inner = (1u64 << surface.level) - 1;
    for (ae, &ge) in mesh.ae_ge.iter().enumerate() {
        for k in 0..inner {
            let vertex = mesh.av_gv.len() + ae * inner as usize + k as usize;
            check_place(&mut position_of_place, (1, u64::from(ge), k), surface.positions[vertex], vertex);
        }
    }
}

fn check_place(seen: &mut HashMap<(u8, u64, u64), Place>, key: (u8, u64, u64), position: [f32; 3], vertex: usize) {
    let here = position.map(f32::to_bits);
    let first = *seen.entry(key).or_insert(here);
    assert_eq!(first, here, "fine vertex {vertex} at {position:?} is apart from another vertex of its place");
}

/// The largest distance between two vertices that share a place of the base mesh.
#[must_use]
pub fn largest_gap(mesh: &Mesh, surface: &Surface) -> f32 {
    let mut first = HashMap::new();
    let mut gap = 0f32;
    for (vertex, &gv) in mesh.av_gv.iter().enumerate() {
        let here = glam::Vec3::from(surface.positions[vertex]);
        gap = gap.max(here.distance(*first.entry(gv).or_insert(here)));
    }
    gap
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshes;

    #[test]
    fn the_procedural_meshes_have_the_boundaries_they_are_named_for() {
        for mesh in [
            meshes::cube(),
            meshes::torus(16, 8),
            meshes::uv_sphere(16, 8),
            meshes::icosphere(2),
            meshes::mirrored_uv_sphere(16, 8),
        ] {
            assert_eq!(boundary_edges(&mesh.positions, &mesh.triangles), 0, "{}", mesh.name);
        }
        let plane = meshes::plane(3);
        assert_eq!(boundary_edges(&plane.positions, &plane.triangles), 12);
        let strip = meshes::moebius(24, 4);
        assert_eq!(boundary_edges(&strip.positions, &strip.triangles), 48, "one border that runs round twice");
    }

    #[test]
    fn euler_characteristics_are_those_of_the_surfaces() {
        for (mesh, expected) in
            [(meshes::cube(), 2), (meshes::uv_sphere(12, 6), 2), (meshes::torus(12, 6), 0), (meshes::moebius(12, 2), 0)]
        {
            assert_eq!(euler_characteristic(&mesh.positions, &mesh.triangles), expected, "{}", mesh.name);
        }
    }
}
