//! What is finer than displaced triangles: its heights bend the base's normals, pixel by pixel, as those of what is not
//! displaced do. Triangles that are as few as a tolerance allows have too few normals of their own.

use std::sync::Arc;

use displace_glsl::methods::Method;

use super::Desk;
use crate::{
    domain::{
        Digest, Result,
        bump::{Bump, BumpSource, Bumps},
        detail::{Detail, LayerSource},
        maps,
        projection::Projection,
        request::{Normals, RenderRequest},
    },
    jobs::inputs::Inputs,
};

/// What heights bend normals by, whatever shows them: as those that are marched do, unless a normal map tells of them.
pub(super) fn bent(desk: Desk<'_>, inputs: &Inputs, request: &RenderRequest) -> Result<Bumps> {
    let read = |digest: &Digest| desk.assets.read(digest);
    maps::resolve_bumps(&inputs.scene, &request.surface.details, Method::Exact, &read)
}

/// Whether normals can tell of all of a detail: of maps of heights, read where vertices have their heights.
pub(super) fn is_heights(detail: &Detail) -> bool {
    detail.layers.iter().all(|layer| matches!(layer.source, LayerSource::Height(_)))
}

/// Bends normals of a displaced material, whose detail is heights; whether it does.
pub(super) fn shade(inputs: &mut Inputs, request: &RenderRequest, bent: &Bumps, material: Option<usize>) -> bool {
    let geometry = &request.surface.geometry;
    let is_asked = geometry.normals == Normals::Analytic && request.surface.maps.projection == Projection::Uv;
    if !is_asked || inputs.bumps.of(material).tells_normals() {
        return false;
    }
    let bump = bent.of(material).bump.clone().filter(is_of_maps);
    let shades = bump.is_some();
    give(inputs, material, bump);
    shades
}

/// Formulas would be read where vertices have come to.
fn is_of_maps(bump: &Arc<Bump>) -> bool {
    bump.layers.iter().all(|layer| matches!(layer.source, BumpSource::Map { .. }))
}

/// What bends the normals of a material.
pub(super) fn give(inputs: &mut Inputs, material: Option<usize>, bump: Option<Arc<Bump>>) {
    match material.and_then(|m| inputs.bumps.of_material.get_mut(m)) {
        Some(shading) => shading.bump = bump,
        None => inputs.bumps.of_none.bump = bump,
    }
}
