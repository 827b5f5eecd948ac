//! What materials' maps show of a place.

use std::sync::Arc;

use displace_glsl::{
    layout::raster::{MAP_BASE_COLOR, MAP_SLOTS},
    reference::{mip::Level, surface::Barycentrics, texture},
};
use glam::{DVec2, DVec3, DVec4};

use super::place::Place;
use crate::{
    domain::image::{ColorMap, Filter, RenderMap, RenderMaterial, RenderScene},
    render::image::{coverage, tables::wrap_numbers},
};

/// Where a pixel's corners lie apart on a map, texels.
pub(super) fn sides(place: &Place<'_>, map: &RenderMap, b: &Barycentrics) -> [DVec2; 2] {
    let size = DVec2::new(map.map.width.into(), map.map.height.into());
    [b.dx, b.dy].map(|weights| DVec2::from_array(on_map(map, place.uv(map.uv_channel, weights), 0.0)) * size)
}

pub(super) fn filtered(
    filter: texture::Filter,
    place: &Place<'_>,
    map: &RenderMap,
    levels: &[Level],
    b: &Barycentrics,
) -> DVec4 {
    let uv = |weights: DVec3, one: f64| on_map(map, place.uv(map.uv_channel, weights), one);
    let (at, dx, dy) = (uv(b.at, 1.0), uv(b.dx, 0.0), uv(b.dy, 0.0));
    DVec4::from_array(texture::filtered(filter, levels, at, dx, dy, wrap_numbers(map.wrap)))
}

/// A place without change.
pub(super) fn still(at: DVec3) -> Barycentrics {
    Barycentrics { at, dx: DVec3::ZERO, dy: DVec3::ZERO, clockwise: true }
}

pub(super) fn twin(filter: Filter) -> texture::Filter {
    match filter {
        Filter::Nearest => texture::Filter::Nearest,
        Filter::Bilinear => texture::Filter::Bilinear,
        Filter::Trilinear => texture::Filter::Trilinear,
        Filter::Anisotropic => texture::Filter::Anisotropic,
        Filter::Ewa => texture::Filter::Ewa,
    }
}

/// Where a UV lies on the map; `one` is 0 for differences.
pub(super) fn on_map(map: &RenderMap, uv: DVec2, one: f64) -> [f64; 2] {
    map.map_from_uv.map(|row| row.map(f64::from)).map(|r| r[0] * uv.x + r[1] * uv.y + r[2] * one)
}

/// Mip levels per material; materials that share a map share its levels, unless they cut it off.
pub(super) fn map_levels(scene: &RenderScene) -> Vec<[Option<Arc<Vec<Level>>>; MAP_SLOTS]> {
    let mut known: Vec<(Arc<ColorMap>, Arc<Vec<Level>>)> = Vec::new();
    let mut levels = |map: &Arc<ColorMap>| match known.iter().find(|(other, _)| Arc::ptr_eq(other, map)) {
        Some((_, levels)) => levels.clone(),
        None => {
            let levels = Arc::new(finest_level(map).chain());
            known.push((map.clone(), levels.clone()));
            levels
        }
    };
    let of_material = |material: &RenderMaterial| {
        let mut all: [Option<Arc<Vec<Level>>>; MAP_SLOTS] =
            std::array::from_fn(|slot| material.maps[slot].as_ref().map(|used| levels(&used.map)));
        if let (Some(scales), Some(levels)) = (coverage::alpha_scales(material), &mut all[MAP_BASE_COLOR]) {
            let scaled =
                levels.iter().zip(scales).map(|(level, scale)| Level { alpha_scale: scale.into(), ..level.clone() });
            *levels = Arc::new(scaled.collect());
        }
        all
    };
    scene.materials.iter().map(of_material).collect()
}

fn finest_level(map: &ColorMap) -> Level {
    let texels = map.texels.iter().map(|texel| texel.map(f64::from)).collect();
    Level { width: map.width as usize, height: map.height as usize, texels, alpha_scale: 1.0 }
}
