//! Height maps with what their method needs; materials that share one share it all.

use std::sync::Arc;

use displace_glsl::{
    methods::Needs,
    reference::{
        cone_map::cones,
        relief::{HeightLevel, ReliefMap, exact::bounds},
    },
};

use super::Heights;
use crate::domain::image::{HeightMap, RenderRelief, RenderScene};

/// Of materials.
pub(super) fn heights(scene: &RenderScene) -> Vec<Option<Heights>> {
    let needs = scene.relief.method.marcher().map_or(Needs::Heights, |marcher| marcher.needs);
    let mut known: Vec<(Arc<HeightMap>, Arc<[ReliefMap]>)> = Vec::new();
    let mut made = |relief: &RenderRelief| match known.iter().find(|(other, _)| Arc::ptr_eq(other, &relief.map)) {
        Some((_, map)) => Arc::clone(map),
        None => {
            let map: Arc<[ReliefMap]> = relief_maps(relief, needs).into();
            known.push((Arc::clone(&relief.map), Arc::clone(&map)));
            map
        }
    };
    let mut of_relief = |relief: &RenderRelief| {
        let [low, high] = relief.map.range().map(f64::from);
        let (uv_channel, map_from_uv) = (relief.uv_channel, relief.map_from_uv);
        Heights { levels: made(relief), range: low..high, uv_channel, map_from_uv }
    };
    scene.materials.iter().map(|material| material.relief.as_ref().map(&mut of_relief)).collect()
}

/// Of every level, the finest first.
fn relief_maps(relief: &RenderRelief, needs: Needs) -> Vec<ReliefMap> {
    let HeightMap { width, height, heights, repeats, thinnest_texels } = &*relief.map;
    let finest = HeightLevel { size: [*width, *height], heights: heights.clone(), repeats: *repeats };
    let map = |(k, level): (usize, HeightLevel)| ReliefMap {
        bounds: if needs == Needs::Bounds { bounds(&level) } else { Vec::new() },
        cones: if needs == Needs::Cones { cones(&level) } else { Vec::new() },
        thinnest_texels: f64::from(*thinnest_texels) / 2f64.powi(k as i32),
        steps: relief.steps,
        level,
    };
    finest.chain().into_iter().enumerate().map(map).collect()
}
