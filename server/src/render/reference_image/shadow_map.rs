//! Shadow maps by the twins: depths of the samples that each side of each light sees.

use displace_glsl::reference::shadow_map::ShadowMaps;
use rayon::prelude::{IntoParallelIterator, ParallelIterator};

use super::{BAND_ROWS, Oracle, bands, layers::Samples};
use crate::{
    domain::{Result, image::RenderScene},
    render::shadow_map::{ShadowPlan, Side, image_plan, stopping},
};

/// What lights see, where the scene asks for shadow maps.
pub(super) fn made(scene: &RenderScene) -> Result<Option<ShadowMaps>> {
    let Some(plan) = ShadowPlan::new(scene)? else { return Ok(None) };
    let mut maps = ShadowMaps { faces: plan.faces, depths: Vec::new() };
    let mut scene = stopping(scene);
    for Side { camera, face } in &plan.sides {
        scene.camera = *camera;
        let oracle = Oracle::new(&image_plan(&scene, face)?, &scene, &[])?;
        maps.depths.extend(depths(&oracle, face.size));
    }
    Ok(Some(maps))
}

fn depths(oracle: &Oracle<'_>, size: u32) -> Vec<[f64; 4]> {
    let triangles = oracle.screen_triangles();
    let bands = bands(&triangles, size);
    let row = |y: u32| {
        let mut seen = vec![Samples::default(); size as usize];
        for &index in &bands[(y / BAND_ROWS) as usize] {
            oracle.cover_row(y, &triangles[index as usize], &mut seen);
        }
        seen.iter().map(|samples| samples.solid.map(|seen| seen.depth.max(0.0))).collect::<Vec<_>>()
    };
    (0..size).into_par_iter().flat_map_iter(row).collect()
}
