//! What maps show of a place that is projected onto them: the twins of `texture_pass.glsl` and `projection.glsl` put together.

use displace_glsl::{
    layout::raster::MAP_NORMAL,
    reference::{
        mip::Level,
        projection::{Kind, Place as At, projections, tilt},
        surface::{Barycentrics, unit_or_zero},
        texture::{self, Filter},
    },
};
use glam::{DVec2, DVec3, DVec4};

use super::{
    place::{Place, blend, vec3},
    textures::on_map,
};
use crate::{
    domain::image::{RenderMap, RenderMesh},
    render::image::tables::wrap_numbers,
};

/// A place on a triangle as projections see it.
pub(super) fn at(place: &Place<'_>, b: &Barycentrics) -> At {
    let mesh: &RenderMesh = place.mesh;
    let (centre, side) = (vec3(mesh.projection_box.centre), f64::from(mesh.projection_box.side));
    let corners = place.vertices().map(|v| (vec3(mesh.positions[v]) - centre) / side);
    let normal = unit_or_zero(blend(b.at, place.vertices().map(|v| vec3(mesh.normals[v]))));
    At { at: blend(b.at, corners), dx: blend(b.dx, corners), dy: blend(b.dy, corners), normal }
}

/// What a map shows there; of a normal map, minus the slope in the mesh's space.
pub(super) fn filtered(filter: Filter, kind: Kind, at: At, slot: usize, map: &RenderMap, levels: &[Level]) -> DVec4 {
    let mut sum = DVec4::ZERO;
    for found in projections(kind, at).filter(|found| found.weight > 0.0) {
        let on = |uv: DVec2, one: f64| on_map(map, uv, one);
        let (uv, dx, dy) = (on(found.uv, 1.0), on(found.dx, 0.0), on(found.dy, 0.0));
        let value = DVec4::from_array(texture::filtered(filter, levels, uv, dx, dy, wrap_numbers(map.wrap)));
        sum += found.weight * if slot == MAP_NORMAL { tilt(&found, value.truncate()).extend(1.0) } else { value };
    }
    sum
}

/// Alpha at the finest level.
pub(super) fn alpha(kind: Kind, at: At, map: &RenderMap, finest: &Level) -> f64 {
    let of = |found: displace_glsl::reference::projection::Projected| {
        let uv = on_map(map, found.uv, 1.0);
        found.weight * texture::bilinear(finest, uv, wrap_numbers(map.wrap))[3]
    };
    projections(kind, at).map(of).sum()
}

/// A slope in the mesh's space, as steep in the world.
pub(super) fn in_world(place: &Place<'_>, tilt: DVec3) -> DVec3 {
    unit_or_zero(place.world(4, tilt.extend(0.0))) * tilt.length()
}
