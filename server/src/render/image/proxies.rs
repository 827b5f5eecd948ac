//! Meshes that are drawn in place of those whose relief changes their outline. They only say where rays are to be
//! followed: what is seen, and its number, is that of the mesh they stand for.

use std::{borrow::Cow, sync::Arc};

use rayon::prelude::*;

use super::{
    shells::{HULL_FACES, Proxies, Raised},
    tables::runs,
};
use crate::domain::image::{RenderAlpha, RenderInstance, RenderMaterial, RenderMesh, RenderScene, Silhouettes};

/// Whether relief changes outlines, so that others are drawn in place of meshes that have any.
pub(crate) fn are_drawn(scene: &RenderScene) -> bool {
    let finds_depth = scene.marcher().is_some_and(|marcher| marcher.finds_depth);
    finds_depth && scene.relief.silhouettes != Silhouettes::None
}

/// Whether a material's relief may change outlines. What is blended is drawn where its base is.
pub(crate) fn is_moved(material: &RenderMaterial) -> bool {
    material.relief.is_some() && material.alpha != RenderAlpha::Blend
}

/// How many triangles stand for each.
pub(crate) fn faces(scene: &RenderScene) -> u32 {
    if scene.relief.silhouettes == Silhouettes::Quadric { 1 } else { HULL_FACES as u32 }
}

/// The scene with proxies behind its meshes and instances, where it needs any.
pub(crate) fn with_proxies(scene: &RenderScene) -> Cow<'_, RenderScene> {
    if !are_drawn(scene) {
        return Cow::Borrowed(scene);
    }
    let heights = heights(scene);
    let proxy = |mesh: &RenderMesh| {
        let raised = raised(mesh, &heights);
        (!raised.is_empty()).then(|| proxy_mesh(scene, mesh, &raised))
    };
    let proxies: Vec<Option<RenderMesh>> = scene.meshes.par_iter().map(proxy).collect();
    let mut more = scene.clone();
    let place_of = |proxy: Option<RenderMesh>| {
        more.meshes.push(proxy?);
        Some(more.meshes.len() - 1)
    };
    let places: Vec<Option<usize>> = proxies.into_iter().map(place_of).collect();
    let instance = |(index, base): (usize, &RenderInstance)| {
        Some(RenderInstance { mesh: places[base.mesh]?, stands_for: Some(index), ..*base })
    };
    more.instances.extend(scene.instances.iter().enumerate().filter_map(instance));
    Cow::Owned(more)
}

/// Of each mesh, by how much it is raised where outlines follow quadrics, mesh-local units.
pub(crate) fn raises(scene: &RenderScene) -> Vec<f32> {
    let heights = heights(scene);
    scene.meshes.par_iter().map(|mesh| raise(&raised(mesh, &heights)) as f32).collect()
}

fn raise(runs: &[(u32, Raised<'_>)]) -> f64 {
    runs.iter().map(|(_, run)| run.raise()).fold(0.0, f64::max)
}

/// Least and greatest height of each material that moves outlines.
fn heights(scene: &RenderScene) -> Vec<Option<[f32; 2]>> {
    let of = |material: &RenderMaterial| Some(material.relief.as_ref()?.map.range()).filter(|_| is_moved(material));
    scene.materials.par_iter().map(of).collect()
}

/// The runs of a mesh whose outline moves, with their materials.
fn raised<'a>(mesh: &'a RenderMesh, heights: &[Option<[f32; 2]>]) -> Vec<(u32, Raised<'a>)> {
    let of = |(triangles, material): (_, u32)| {
        Some((material, Raised { mesh, triangles, heights: heights[material as usize]? }))
    };
    runs(mesh).filter_map(of).collect()
}

fn proxy_mesh(scene: &RenderScene, mesh: &RenderMesh, runs: &[(u32, Raised<'_>)]) -> RenderMesh {
    let raise = f64::from(raise(runs) as f32);
    let (mut positions, mut triangles, mut materials) = (Vec::new(), Vec::new(), Vec::new());
    for (material, run) in runs {
        let is_raised = scene.relief.silhouettes == Silhouettes::Quadric;
        let Proxies { positions: new, triangles: faces, .. } = if is_raised { run.raised(raise) } else { run.hulls() };
        materials.push((triangles.len() as u32, *material));
        let first = positions.len() as u32;
        positions.extend(new);
        triangles.extend(faces.into_iter().map(|face| face.map(|vertex| first + vertex)));
    }
    RenderMesh {
        normals: Arc::new(vec![[0.0; 3]; positions.len()]),
        uvs: Arc::new(vec![[0.0; 2]; positions.len() * scene.uv_channels as usize]),
        positions: Arc::new(positions),
        triangles: Arc::new(triangles),
        material_of_triangles: materials,
        projection_box: mesh.projection_box,
        ..RenderMesh::default()
    }
}

#[cfg(test)]
mod tests {
    use displace_glsl::{layout::raster::PART_UNSEEN, methods::Method};

    use super::*;
    use crate::{
        domain::image::{HeightMap, ImagePlan, ReliefSettings, RenderRelief},
        render::{image::tables::Tables, occluders::Shade},
    };

    const IDENTITY: [f32; 16] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];

    /// Two of a square whose second triangle has relief.
    fn scene(silhouettes: Silhouettes) -> RenderScene {
        let map = HeightMap { width: 1, height: 1, heights: vec![0.5], ..HeightMap::default() };
        let map_from_uv = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let relief = RenderRelief { map: Arc::new(map), uv_channel: 0, map_from_uv, steps: 0 };
        let instance = RenderInstance { mesh: 0, world_from_mesh: IDENTITY, stands_for: None };
        RenderScene {
            meshes: vec![RenderMesh {
                positions: Arc::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]),
                normals: Arc::new(vec![[0.0, 0.0, 1.0]; 4]),
                uvs: Arc::new(vec![[0.0; 2]; 4]),
                triangles: Arc::new(vec![[0, 1, 2], [0, 2, 3]]),
                material_of_triangles: vec![(0, 0), (1, 1)],
                ..RenderMesh::default()
            }],
            instances: vec![instance; 2],
            materials: vec![
                RenderMaterial::default(),
                RenderMaterial { relief: Some(relief), ..RenderMaterial::default() },
            ],
            relief: ReliefSettings { method: Method::Exact, silhouettes, ..ReliefSettings::default() },
            uv_channels: 1,
            ..RenderScene::default()
        }
    }

    fn tables(scene: &RenderScene) -> Tables {
        let plan = ImagePlan::new(16, 16, &scene.contents()).expect("a plan");
        Tables::new(&plan, scene).expect("tables")
    }

    #[test]
    fn what_stands_for_a_part_names_it_and_stops_no_light() {
        for (silhouettes, faces) in [(Silhouettes::Shell, 8), (Silhouettes::Quadric, 1)] {
            let scene = scene(silhouettes);
            let more = with_proxies(&scene);
            let tables = tables(&more);
            let parts: Vec<_> = tables.parts.iter().map(|p| (p.first_triangle, p.stands_for, p.faces)).collect();
            let bases = [(0, 0, 1), (1, 1, 1), (2, 2, 1), (3, 3, 1)];
            assert_eq!(parts, [&bases[..], &[(4, 1, faces), (4 + faces, 3, faces)]].concat());
            let unseen: Vec<_> = tables.parts.iter().map(|part| part.flags & PART_UNSEEN != 0).collect();
            assert_eq!(unseen, [false, true, false, true, false, false]);
            let stopping = Shade::new(&more, &tables).expect("few triangles").occluders;
            assert_eq!(stopping.items.len(), 4);
        }
    }

    #[test]
    fn plans_count_what_stands_for_parts() {
        for (silhouettes, per_vertex) in [(Silhouettes::Shell, 12), (Silhouettes::Quadric, 12 + 24)] {
            let (base, scene) = (scene(Silhouettes::None), scene(silhouettes));
            let more = with_proxies(&scene);
            let sum =
                |of: fn(&RenderMesh) -> usize, scene: &RenderScene| scene.meshes.iter().map(of).sum::<usize>() as u64;
            let [vertices, triangles] =
                [|mesh: &RenderMesh| mesh.positions.len(), |mesh: &RenderMesh| mesh.triangles.len()]
                    .map(|of| (sum(of, &base), sum(of, &more)));
            let bytes = |scene: &RenderScene| ImagePlan::new(16, 16, &scene.contents()).expect("a plan").device_bytes;
            let of_scene = (vertices.1 - vertices.0) * (12 + 12 + 8) + (triangles.1 - triangles.0) * 12;
            // Of two instances: screen vertices, lists, and records of large triangles.
            let of_work = 2 * ((vertices.1 - vertices.0) * 16 + (triangles.1 - triangles.0) * (20 + 7 * (48 + 8)));
            // Where outlines move, rays keep to no charts.
            let of_charts = triangles.0 * 24;
            assert_eq!(bytes(&scene) + of_charts - bytes(&base), of_scene + vertices.1 * per_vertex + of_work);
        }
    }

    #[test]
    fn a_scene_without_silhouettes_is_drawn_as_it_is() {
        let scene = scene(Silhouettes::None);
        assert!(matches!(with_proxies(&scene), Cow::Borrowed(_)));
        assert!(tables(&scene).parts.iter().all(|part| part.flags & PART_UNSEEN == 0));
    }
}
