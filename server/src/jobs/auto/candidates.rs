//! What there is to show a material by, its predicted errors and cost.

use std::sync::Arc;

use displace_glsl::methods::Method;

use super::Desk;
use crate::{
    domain::{
        Error, Result,
        choice::{self, Candidate, Picked},
        cost::Work,
        detail::{Detail, LayerSource},
        image::RenderCamera,
        relief::Relief,
        request::RenderRequest,
    },
    jobs::inputs::Inputs,
};

/// One material with a detail, and what shows it.
pub(super) struct Weighing {
    /// None of primitives without one.
    pub(super) material: Option<usize>,
    /// Its heights, where they can be shown per pixel.
    pub(super) relief: Option<Arc<Relief>>,
    pub(super) candidates: Vec<Candidate>,
    pub(super) picked: Picked,
    pub(super) tolerance_px: f64,
    /// Why it is what it is, where cost did not decide; else empty.
    pub(super) reason: String,
}

pub(super) fn weigh(
    desk: Desk<'_>,
    inputs: &Inputs,
    request: &RenderRequest,
    camera: &RenderCamera,
    tolerance_px: f64,
) -> Result<Vec<Weighing>> {
    let _ = (request, camera);
    details(inputs)
        .into_iter()
        .map(|(material, detail)| {
            let method = if is_vector(&detail) { Method::Vector } else { Method::Displacement };
            let work = Work::default();
            let displaced = Candidate {
                method,
                shell: false,
                error_px: tolerance_px,
                outline_px: tolerance_px,
                cost_ms: desk.model.ms(&work),
                work,
            };
            let candidates = vec![displaced];
            let picked =
                choice::pick(&candidates, tolerance_px).ok_or_else(|| Error::internal("nothing to choose from"))?;
            Ok(Weighing { material, relief: None, candidates, picked, tolerance_px, reason: String::new() })
        })
        .collect()
}

/// Of each material that is shown and has one.
fn details(inputs: &Inputs) -> Vec<(Option<usize>, Arc<Detail>)> {
    let mut all: Vec<(Option<usize>, Arc<Detail>)> = Vec::new();
    for (index, (m, details)) in inputs.scene.meshes.iter().zip(&inputs.details).enumerate() {
        if !inputs.scene.instances.iter().any(|instance| instance.mesh == index) {
            continue;
        }
        for (primitive, detail) in m.mesh.primitives.iter().zip(details) {
            let Some(detail) = detail else { continue };
            if !all.iter().any(|(known, _)| *known == primitive.material) {
                all.push((primitive.material, Arc::clone(detail)));
            }
        }
    }
    all.sort_by_key(|(material, _)| material.map_or(usize::MAX, |m| m));
    all
}

fn is_vector(detail: &Detail) -> bool {
    detail
        .layers
        .iter()
        .any(|layer| matches!(layer.source, LayerSource::VectorTangent(_) | LayerSource::VectorObject(_)))
}
