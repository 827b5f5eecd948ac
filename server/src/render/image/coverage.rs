//! Scales of alpha by mip level for maps that are cut off, so that they cover as much from afar as from near.

use displace_glsl::{
    layout::raster::MAP_BASE_COLOR,
    reference::mip::{Level, keep_coverage},
};

use super::tables::wrap_numbers;
use crate::domain::image::{ColorMap, RenderAlpha, RenderMaterial};

/// Of each level of the material's base colour map; `None` where nothing is cut off.
pub(crate) fn alpha_scales(material: &RenderMaterial) -> Option<Vec<f32>> {
    let map = material.maps[MAP_BASE_COLOR].as_ref()?;
    let RenderAlpha::Mask { cutoff } = material.alpha else { return None };
    // What the map must reach; above 1 or at 0 nothing is decided by it.
    let cutoff = f64::from(cutoff) / f64::from(material.base_color_factor[3]);
    if !(cutoff > 0.0 && cutoff <= 1.0) || map.map.texels.iter().all(|texel| texel[3] == 1.0) {
        return None;
    }
    let mut levels = alpha(&map.map).chain();
    keep_coverage(&mut levels, cutoff, wrap_numbers(map.wrap));
    Some(levels.iter().map(|level| level.alpha_scale as f32).collect())
}

fn alpha(map: &ColorMap) -> Level {
    let texels = map.texels.iter().map(|texel| [0.0, 0.0, 0.0, f64::from(texel[3])]).collect();
    Level { width: map.width as usize, height: map.height as usize, texels, alpha_scale: 1.0 }
}
