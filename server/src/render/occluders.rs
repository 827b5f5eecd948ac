//! What stops light on its way: every triangle of every instance in world space, below a hierarchy of boxes that both
//! executors walk in one order. Built by `obvhs`.

use displace_glsl::{
    layout::raster::{BVH_INNER, BvhNode, INSTANCE_ROWS, Part},
    reference::shadow_rays::Occluders,
};
use glam::{DVec4, Vec3A};
use obvhs::{
    BvhBuildParams,
    aabb::Aabb,
    bvh2::{Bvh2, builder::build_bvh2},
};
use rayon::prelude::*;

use super::image::tables::Tables;
use crate::domain::{Error, Result, image::RenderScene};

/// What a stream of corners holds.
const MOST_TRIANGLES: u64 = 1 << 24;
/// More roundings of the largest coordinate than a position on a surface takes.
const OFFSET_ROUNDINGS: f32 = 32.0;

/// Occluders, and how far off a surface a ray begins, world units.
pub(crate) struct Shade {
    pub(crate) occluders: Occluders,
    pub(crate) offset_world: f32,
}

impl Shade {
    /// Fails when the scene has too many triangles.
    pub(crate) fn new(scene: &RenderScene, tables: &Tables) -> Result<Self> {
        let triangles = occluding(scene, tables);
        if triangles > MOST_TRIANGLES {
            let message = format!(
                "shadows by rays are for at most {MOST_TRIANGLES} triangles, and the scene's instances have {triangles}: lower the level, or leave shadows out"
            );
            return Err(Error::too_large("lighting.shadows", message));
        }
        let corners = world_corners(scene, tables);
        let largest = corners.as_flattened().as_flattened().iter().fold(0f32, |most, x| most.max(x.abs()));
        let offset_world = OFFSET_ROUNDINGS * f32::EPSILON * largest;
        // A NaN or an infinity is nowhere: it stops nothing.
        let finite = |t: &[[f32; 3]; 3]| t.as_flattened().iter().all(|x| x.is_finite());
        let bounds =
            |t: &[[f32; 3]; 3]| if finite(t) { bounds(t, offset_world) } else { Aabb::from_point(Vec3A::ZERO) };
        let boxes: Vec<Aabb> = corners.par_iter().map(bounds).collect();
        let tree = build_bvh2(&boxes, BvhBuildParams::fast_build(), &mut std::time::Duration::default());
        Ok(Self { occluders: flattened(&tree, &corners), offset_world })
    }
}

/// How many triangles stop light. What stands for others is behind all that does.
fn occluding(scene: &RenderScene, tables: &Tables) -> u64 {
    let total = tables.batches.last().map_or(0, |batch| batch.triangles.end);
    let stands_for = |part: &&Part| scene.instances[part.instance as usize].stands_for.is_some();
    tables.parts.iter().find(stands_for).map_or(total, |part| u64::from(part.first_triangle))
}

/// By triangle number over all instances.
fn world_corners(scene: &RenderScene, tables: &Tables) -> Vec<[[f32; 3]; 3]> {
    let total = occluding(scene, tables) as usize;
    let mut corners = vec![[[0.0; 3]; 3]; total];
    let is_occluder = |(_, part): &(usize, &Part)| (part.first_triangle as usize) < total;
    for (k, part) in tables.parts.iter().enumerate().take_while(is_occluder) {
        let end = tables.parts.get(k + 1).map_or(total, |next| next.first_triangle as usize);
        let mesh = scene.instances[part.instance as usize].mesh;
        let first = part.triangle_base as usize - tables.meshes[mesh].triangle_base as usize;
        let mesh = &scene.meshes[mesh];
        let rows = &tables.instance_rows[part.instance as usize * INSTANCE_ROWS + 4..][..3];
        let rows = [0, 1, 2].map(|row| DVec4::from_array(rows[row].map(f64::from)));
        let place = |vertex: u32| {
            let [x, y, z] = mesh.positions[vertex as usize].map(f64::from);
            rows.map(|row| row.dot(DVec4::new(x, y, z, 1.0)) as f32)
        };
        let out = &mut corners[part.first_triangle as usize..end];
        out.par_iter_mut().enumerate().for_each(|(t, corners)| *corners = mesh.triangles[first + t].map(place));
    }
    corners
}

fn bounds(corners: &[[f32; 3]; 3], margin: f32) -> Aabb {
    let [a, b, c] = corners.map(Vec3A::from_array);
    Aabb::new(a.min(b).min(c) - margin, a.max(b).max(c) + margin)
}

/// Nodes in the order of a walk, and occluders in the order of their leaves.
fn flattened(tree: &Bvh2, corners: &[[[f32; 3]; 3]]) -> Occluders {
    let mut flat = Occluders::default();
    if tree.nodes.is_empty() {
        return flat;
    }
    // Nodes to visit, and nodes whose end is where the walk then is.
    let mut stack = vec![(0usize, None)];
    while let Some((source, ended)) = stack.pop() {
        if let Some(node) = ended {
            let here = flat.nodes.len() as u32;
            let node: &mut BvhNode = &mut flat.nodes[node];
            node.skip = here;
            continue;
        }
        let node = &tree.nodes[source];
        let number = flat.nodes.len();
        let first = if node.prim_count == 0 { BVH_INNER } else { flat.items.len() as u32 };
        let (low, high) = (node.aabb.min.to_array(), node.aabb.max.to_array());
        flat.nodes.push(BvhNode { low, skip: 0, high, first });
        stack.push((source, Some(number)));
        let begin = node.first_index as usize;
        if node.prim_count == 0 {
            stack.extend([(begin + 1, None), (begin, None)]);
            continue;
        }
        let items = &tree.primitive_indices[begin..begin + node.prim_count as usize];
        for (k, &triangle) in items.iter().enumerate() {
            flat.items.push(triangle << 1 | u32::from(k + 1 == items.len()));
            flat.corners.extend(corners[triangle as usize]);
        }
    }
    flat
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_triangle_lies_below_the_boxes_that_lead_to_it() {
        let corner = |k: u32| [0, 1, 2].map(|axis| (k.wrapping_mul(2_654_435_761 + 7 * axis) >> 8) as f32 / 1e6);
        let corners: Vec<_> = (0..500).map(|k| [corner(3 * k), corner(3 * k + 1), corner(3 * k + 2)]).collect();
        let boxes: Vec<Aabb> = corners.iter().map(|t| bounds(t, 0.0)).collect();
        let tree = build_bvh2(&boxes, BvhBuildParams::fast_build(), &mut std::time::Duration::default());
        let flat = flattened(&tree, &corners);
        let mut found: Vec<u32> = flat.items.iter().map(|item| item >> 1).collect();
        found.sort_unstable();
        assert!(found.into_iter().eq(0..500));
        for (n, node) in flat.nodes.iter().enumerate() {
            assert!(node.skip as usize > n && node.skip as usize <= flat.nodes.len());
            for below in &flat.nodes[n..node.skip as usize] {
                assert!((0..3).all(|k| node.low[k] <= below.low[k] && below.high[k] <= node.high[k]));
            }
        }
        assert_eq!(flat.nodes[0].skip as usize, flat.nodes.len());
    }
}
