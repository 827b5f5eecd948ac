//! From the details of a request to heights that are shown per pixel.

use std::sync::Arc;

use super::{
    MAX_COLOR_TEXELS,
    bumps::{axes_of, behind},
    resolve::{AssetBytes, Details, Entries, entries, resolve},
    slopes::Axis,
    thinnest::thinnest,
};
use crate::domain::{
    Error, Result,
    choose::kept,
    detail::{Detail, Layer, LayerSource, Map, Wrap},
    image::HeightMap,
    relief::{Relief, Reliefs},
    request::{MaterialDetail, Method, SourceRequest},
    scene::Scene,
};

/// Of all maps of one job: their levels and cones have up to 3.6 words a texel in one stream of 2^29 words.
const MOST_TEXELS: u64 = 1 << 27;

/// The one height map of each material, of the request's details or the file's (KHR_materials_displacement).
pub fn resolve_reliefs(
    scene: &Scene,
    requests: &[MaterialDetail],
    method: Method,
    assets: &AssetBytes<'_>,
) -> Result<Reliefs> {
    for (index, request) in requests.iter().enumerate() {
        check_layers(index, request, method)?;
    }
    let details = resolve(scene, requests, assets)?;
    check_entries(&entries(scene, requests)?, requests, &details, method)?;
    let reliefs = of_details(&details)?;
    if reliefs.is_empty() {
        let message = format!(
            "neither the request nor the mesh's materials have heights for {}: give a height map, or choose method flat",
            method.name()
        );
        return Err(Error::invalid("details", message));
    }
    if reliefs.texels() > MOST_TEXELS {
        let message = format!(
            "the height maps of one job have {} texels, those of their mirrors counted; allowed are {MOST_TEXELS}: scale them down",
            reliefs.texels()
        );
        return Err(Error::too_large("details", message));
    }
    Ok(reliefs)
}

/// The heights of those details that are one height map and nothing else.
pub fn marchable(details: &[Option<Arc<Detail>>]) -> Result<Vec<Option<Arc<Relief>>>> {
    let is_one =
        |detail: &&Arc<Detail>| matches!(detail.layers.as_slice(), [Layer { source: LayerSource::Height(_), .. }]);
    let of_material = details.iter().map(|detail| detail.as_ref().filter(is_one).cloned()).collect();
    let kept = of_details(&Details { of_material, of_none: None })?;
    Ok(if kept.texels() > MOST_TEXELS { vec![None; details.len()] } else { kept.of_material })
}

/// One map of heights, and what tells normals.
fn check_layers(index: usize, request: &MaterialDetail, method: Method) -> Result<()> {
    let name = method.name();
    let mut heights = 0;
    for (k, layer) in request.layers.iter().enumerate() {
        let (part, message) = match &layer.source {
            SourceRequest::Normal { .. } => continue,
            SourceRequest::Height { .. } => {
                heights += 1;
                if heights == 1 {
                    continue;
                }
                (
                    "height",
                    format!(
                        "is a second height map, and {name} shows one: merge them into one map, or choose method displacement, which adds them"
                    ),
                )
            }
            SourceRequest::Expression { .. } => (
                "expression",
                format!("is a formula, and {name} shows a height map: draw it into one, or choose method displacement"),
            ),
            SourceRequest::Vector { .. } => {
                ("vector", format!("holds vectors, and {name} shows heights: choose method vector"))
            }
            SourceRequest::DirectionMagnitude { .. } => {
                ("direction", format!("holds vectors, and {name} shows heights: choose method vector"))
            }
        };
        return Err(Error::invalid(format!("details[{index}].layers[{k}].{part}"), message));
    }
    Ok(())
}

/// An entry of normal maps alone is for what has heights of the file.
fn check_entries(entries: &Entries, requests: &[MaterialDetail], details: &Details, method: Method) -> Result<()> {
    for (index, request) in requests.iter().enumerate() {
        let is_bare = request.layers.iter().all(|layer| layer.source.is_normal());
        let is_for =
            |(entry, detail): (&Option<usize>, &Option<Arc<Detail>>)| *entry == Some(index) && detail.is_some();
        if is_bare && !entries.of_material.iter().zip(&details.of_material).any(is_for) {
            let message = format!(
                "has a normal map and no heights, which {} shows: give a height map beside it, or choose method normal",
                method.name()
            );
            return Err(Error::invalid(format!("details[{index}].layers"), message));
        }
    }
    Ok(())
}

/// Materials that share a detail share its heights.
fn of_details(details: &Details) -> Result<Reliefs> {
    let mut made: Vec<(Arc<Detail>, Arc<Relief>)> = Vec::new();
    let mut of = |detail: &Option<Arc<Detail>>| -> Result<Option<Arc<Relief>>> {
        let Some(detail) = detail else { return Ok(None) };
        if let Some((_, relief)) = made.iter().find(|(known, _)| Arc::ptr_eq(known, detail)) {
            return Ok(Some(Arc::clone(relief)));
        }
        let relief = Arc::new(relief(detail)?);
        made.push((Arc::clone(detail), Arc::clone(&relief)));
        Ok(Some(relief))
    };
    let of_material = details.of_material.iter().map(&mut of).collect::<Result<_>>()?;
    Ok(Reliefs { of_material, of_none: of(&details.of_none)? })
}

fn relief(detail: &Detail) -> Result<Relief> {
    let [layer @ Layer { source: LayerSource::Height(map), .. }] = detail.layers.as_slice() else {
        return Err(Error::internal("a detail that is shown per pixel is not one height map"));
    };
    let [across, down] = axes_of([map.width, map.height], map.wrap, map.sampling);
    check_texels(&across, &down)?;
    let heights = heights(map, layer, &across, &down)?;
    // What mirrors is unfolded, and repeats.
    let repeats = [&across, &down].map(|axis| axis.wrap != Wrap::Clamp);
    let [width, height] = [&across, &down].map(|axis| axis.texels.len());
    let map = kept::height_map(heights, width, repeats, |heights| {
        let thinnest_texels = thinnest(&heights, width, repeats);
        HeightMap { width: width as u32, height: height as u32, heights, repeats, thinnest_texels }
    });
    let map_from_uv = behind(layer.map_from_uv, &across, &down);
    Ok(Relief { map, uv_set: detail.uv_set, map_from_uv })
}

/// scale x (value - midlevel) of each texel as the axes lay it out, rounded once.
fn heights(map: &Map, layer: &Layer, across: &Axis, down: &Axis) -> Result<Vec<f32>> {
    let (scale, midlevel) = (f64::from(layer.scale), f64::from(layer.midlevel));
    let height = |value: f32| (scale * (f64::from(value) - midlevel)) as f32;
    let rows = down.texels.iter().map(|y| &map.texels[y * map.width as usize..][..map.width as usize]);
    let heights: Vec<f32> = rows.flat_map(|row| across.texels.iter().map(|x| height(row[*x]))).collect();
    if let Some(at) = heights.iter().position(|height| !height.is_finite()) {
        let message = format!(
            "a height is {}, of the scale {scale} times a value less {midlevel}; heights must be finite: scale them down",
            heights[at]
        );
        return Err(Error::invalid("details", message));
    }
    Ok(heights)
}

fn check_texels(across: &Axis, down: &Axis) -> Result<()> {
    let (width, height) = (across.texels.len() as u64, down.texels.len() as u64);
    if width * height <= MAX_COLOR_TEXELS {
        return Ok(());
    }
    let message = format!(
        "a height map that is shown per pixel has {width} x {height} texels, those of its mirror counted; allowed are {MAX_COLOR_TEXELS} in all: scale it down"
    );
    Err(Error::too_large("details", message))
}

#[cfg(test)]
mod tests;
