//! What rays that decide outlines need to know of meshes.

use std::sync::Arc;

use rayon::prelude::*;

use crate::{
    domain::{
        Result,
        image::{RenderMesh, RenderScene, Silhouettes, curvatures},
    },
    vulkan::{Device, Stream},
};

use super::proxies;

/// Of vertices, meshes one after the other, and of instances.
pub(crate) struct SilhouetteStreams {
    /// Of vertices: along which heights are, of any length. Empty where no outline changes.
    pub(crate) directions: Stream,
    /// Of vertices, two for each: xx, xy, xz and yy, yz, zz of how the mesh bends. Empty without quadrics.
    pub(crate) bends: Stream,
    /// Of instances: by how much their triangles are raised, mesh-local units. Empty without quadrics.
    pub(crate) raises: Stream,
}

impl SilhouetteStreams {
    /// Of a scene with its proxies.
    pub(crate) fn upload(device: &Arc<Device>, scene: &RenderScene) -> Result<Self> {
        let are_drawn = proxies::are_drawn(scene);
        let is_quadric = are_drawn && scene.relief.silhouettes == Silhouettes::Quadric;
        let directions: Vec<[f32; 3]> =
            if are_drawn { scene.meshes.iter().flat_map(directions).copied().collect() } else { Vec::new() };
        let bends = if is_quadric { bends(scene) } else { Vec::new() };
        let raises = if is_quadric { raises(scene) } else { Vec::new() };
        Ok(Self {
            directions: Stream::from_slice(device, "directions", &directions)?,
            bends: Stream::from_slice(device, "bends", bends.as_flattened())?,
            raises: Stream::from_slice(device, "raises", &raises)?,
        })
    }
}

fn directions(mesh: &RenderMesh) -> &[[f32; 3]] {
    if mesh.directions.is_empty() { &mesh.normals } else { &mesh.directions }
}

/// 0 where nothing stands for a mesh: none is read.
fn bends(scene: &RenderScene) -> Vec<[[f32; 3]; 2]> {
    let mut is_read = vec![false; scene.meshes.len()];
    let bases = scene.instances.iter().filter_map(|instance| instance.stands_for);
    bases.for_each(|base| is_read[scene.instances[base].mesh] = true);
    let of = |(mesh, is_read): (&RenderMesh, &bool)| {
        if !is_read {
            return vec![[[0.0; 3]; 2]; mesh.positions.len()];
        }
        let rows = curvatures(&mesh.positions, directions(mesh), &mesh.triangles).into_iter();
        rows.map(|[xx, xy, xz, yy, yz, zz]| [[xx, xy, xz], [yy, yz, zz]]).collect()
    };
    scene.meshes.par_iter().zip(&is_read).flat_map_iter(of).collect()
}

fn raises(scene: &RenderScene) -> Vec<f32> {
    let raises = proxies::raises(scene);
    scene.instances.iter().map(|instance| raises[instance.mesh]).collect()
}
