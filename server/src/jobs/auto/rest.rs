//! What is finer than displaced triangles: its heights bend the base's normals, pixel by pixel, as those of what is not
//! displaced do. Triangles that are as few as a tolerance allows have too few normals of their own.

use std::sync::Arc;

use displace_glsl::methods::Method;

use super::{Desk, MOST_TEXELS};
use crate::{
    domain::{
        Digest, Result,
        bump::{Bump, BumpLayer, BumpSource, Bumps},
        detail::{Detail, LayerSource},
        maps,
        projection::Projection,
        request::{Normals, RenderRequest},
    },
    jobs::inputs::Inputs,
};

/// What heights bend normals by, whatever shows them: as those that are marched do, unless a normal map tells of them. Where
/// nothing `needs` it, what cannot bend normals, as more maps than a material has places for, is displaced without.
pub(super) fn bent(desk: Desk<'_>, inputs: &Inputs, request: &RenderRequest, needs: bool) -> Result<Bumps> {
    let read = |digest: &Digest| desk.assets.read(digest);
    let bent = maps::resolve_bumps(&inputs.scene, &request.surface.details, Method::Exact, &read);
    if needs { bent } else { Ok(bent.unwrap_or_default()) }
}

/// Whether normals can tell of all of a detail: of maps of heights, read where vertices have their heights.
pub(super) fn is_heights(detail: &Detail) -> bool {
    detail.layers.iter().all(|layer| matches!(layer.source, LayerSource::Height(_)))
}

/// Bends normals of a displaced material, whose detail is heights, where they can be bent and nothing else was asked for; whether
/// it does.
pub(super) fn shade(inputs: &mut Inputs, request: &RenderRequest, bent: &Bumps, material: Option<usize>) -> bool {
    let geometry = &request.surface.geometry;
    let is_asked = geometry.normals == Normals::Analytic && request.surface.maps.projection == Projection::Uv;
    if !is_asked || inputs.bumps.of(material).tells_normals() {
        return false;
    }
    let bump = bent.of(material).bump.clone().filter(is_small);
    let shades = bump.is_some();
    give(inputs, material, bump);
    shades
}

/// Slopes are four words a texel, which must not be what an image has no memory for.
fn is_small(bump: &Arc<Bump>) -> bool {
    let texels = |layer: &BumpLayer| match &layer.source {
        BumpSource::Map { map, .. } => map.texels.len(),
        BumpSource::Formula(_) => 0,
    };
    bump.layers.iter().map(texels).sum::<usize>() <= MOST_TEXELS
}

/// What bends the normals of a material.
pub(super) fn give(inputs: &mut Inputs, material: Option<usize>, bump: Option<Arc<Bump>>) {
    match material.and_then(|m| inputs.bumps.of_material.get_mut(m)) {
        Some(shading) => shading.bump = bump,
        None => inputs.bumps.of_none.bump = bump,
    }
}
