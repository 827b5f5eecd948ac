//! Heights that are shown per pixel: read before anything moves, given to the renderer.

use std::sync::Arc;

use super::{
    AssetReader, WorkContext,
    inputs::{self, Inputs},
    looks::UvSets,
};
use crate::domain::{
    Error, Result,
    image::{ReliefSettings, RenderMaterial, RenderRelief, Silhouettes},
    maps,
    mesh::Mesh,
    relief::{Relief, Reliefs},
    request::{DisplaceRequest, RenderRequest},
    scene::Scene,
    surface::Surface,
};

use displace_glsl::reference::frame::MIN_BLENDED_NORMAL;
use glam::DVec3;
use rayon::prelude::*;

/// Of a method that shows them.
pub(super) fn load(assets: &dyn AssetReader, scene: &Scene, request: &DisplaceRequest) -> Result<Reliefs> {
    let read = |digest: &crate::domain::Digest| assets.read(digest);
    let reliefs = maps::resolve_reliefs(scene, &request.details, request.method, &read)?;
    for m in &scene.meshes {
        for (p, primitive) in m.mesh.primitives.iter().enumerate() {
            if let Some(relief) = reliefs.of(primitive.material) {
                inputs::require_uv_set(&m.mesh, p, relief.uv_set)?;
            }
        }
    }
    Ok(reliefs)
}

/// What of an image its heights do not go with.
pub(super) fn check(inputs: &Inputs, request: &RenderRequest, context: &WorkContext<'_>) -> Result<()> {
    if inputs.reliefs.is_empty() {
        return Ok(());
    }
    let method = request.surface.method.name();
    if request.rays().is_some() && context.executor.traces_rays() {
        let message = format!(
            "are rays on this device, and rays meet triangles, not what {method} shows: leave them out, which rasterises, or take --method displacement, or another device"
        );
        return Err(Error::unsupported("samples", message));
    }
    Ok(())
}

/// Whether all that is drawn has any.
pub(super) fn cover(inputs: &Inputs) -> bool {
    let materials = inputs.scene.meshes.iter().flat_map(|m| m.mesh.primitives.iter().map(|p| p.material));
    let mut of = materials.map(|material| inputs.reliefs.of(material).is_some());
    of.all(|has_relief| has_relief)
}

/// How all of it is shown.
pub(super) fn settings(request: &RenderRequest, reliefs: &Reliefs) -> ReliefSettings {
    if reliefs.is_empty() {
        return ReliefSettings::default();
    }
    let look = request.look.relief;
    ReliefSettings { method: request.surface.method, silhouettes: look.silhouettes, self_shadow: look.self_shadow }
}

/// Gives the renderer's materials, those of the scene and one for none, their heights.
pub(super) fn give(
    (reliefs, steps): (&Reliefs, u32),
    sets: &UvSets,
    scene: &Scene,
    materials: &mut [RenderMaterial],
) -> Result<()> {
    let last = materials.len() - 1;
    for (index, material) in materials.iter_mut().enumerate() {
        let Some(relief) = reliefs.of((index < last).then_some(index)) else { continue };
        if material.alpha == crate::domain::image::RenderAlpha::Blend {
            return Err(blended(scene.materials.get(index).and_then(|m| m.name.as_deref()).unwrap_or_default()));
        }
        material.relief = Some(render_relief(relief, steps, sets));
    }
    Ok(())
}

fn blended(name: &str) -> Error {
    let message = format!(
        "is blend, and material '{name}', which is blended, has heights that are shown per pixel: take --alpha mask or stochastic, or --method displacement"
    );
    Error::unsupported("lighting.alpha", message)
}

fn render_relief(relief: &Relief, steps: u32, sets: &UvSets) -> RenderRelief {
    let (uv_channel, map_from_uv) = (sets.channel(relief.uv_set), relief.map_from_uv);
    RenderRelief { map: Arc::clone(&relief.map), uv_channel, map_from_uv, steps }
}

/// Of a surface's vertices, as displacement moves them (see `displace_glsl::reference::subdivide`); empty where outlines
/// do not change. Over a smooth base blended between its corners'.
pub(super) fn directions(mesh: &Mesh, surface: &Surface, settings: ReliefSettings) -> Vec<[f32; 3]> {
    if settings.silhouettes == Silhouettes::None {
        return Vec::new();
    }
    (0..surface.positions.len()).into_par_iter().map(|vertex| direction(mesh, surface, vertex)).collect()
}

fn direction(mesh: &Mesh, surface: &Surface, vertex: usize) -> [f32; 3] {
    let welded = |av: u32| mesh.gv_direction[mesh.av_gv[av as usize] as usize];
    if vertex < mesh.av_gv.len() {
        return welded(vertex as u32);
    }
    let (avs, weights) = surface.site(mesh, vertex);
    let blend = |of: &dyn Fn(u32) -> [f32; 3]| -> DVec3 {
        avs.iter().zip(weights).map(|(av, weight)| weight * DVec3::from_array(of(*av).map(f64::from))).sum()
    };
    let normal = blend(&|av| mesh.av_normal[av as usize]);
    (blend(&welded) / normal.length().max(MIN_BLENDED_NORMAL)).as_vec3().to_array()
}

#[cfg(test)]
mod tests;
