//! From what was chosen to what is displaced, marched and bent.

use std::sync::Arc;

use displace_glsl::methods::Method;

use super::{Desk, Settled, candidates::Weighing, rest};
use crate::{
    domain::{
        Result,
        bump::Bumps,
        choice::{Candidate, Choice, Picked, Weighed},
        image::{SelfShadow, Silhouettes},
        relief::{Relief, Reliefs},
        request::{Refinement, RenderRequest, Shadows},
        scene::Scene,
    },
    jobs::{inputs::Inputs, plans::Plans},
};

/// Makes the inputs those of what is chosen.
pub(super) fn realise(
    desk: Desk<'_>,
    settled: &mut Settled,
    weighings: &[Weighing<'_>],
    within: &Refinement,
    bent: &Bumps,
) -> Result<()> {
    let Settled { request, inputs, .. } = settled;
    let moves = |weighing: &Weighing<'_>| weighing.chosen().method.moves_vertices();
    let finest = if weighings.iter().any(moves) { within.clone() } else { Refinement::Uniform(0) };
    request.surface.method = shown_by(weighings);
    request.surface.geometry.refinement = finest;
    request.look.relief.silhouettes =
        if weighings.iter().any(|w| w.chosen().shell) { Silhouettes::Shell } else { Silhouettes::None };
    let is_marched = request.surface.method.marcher().is_some_and(|marcher| marcher.finds_depth);
    let takes_light = is_marched && request.look.shadows != Shadows::None;
    request.look.relief.self_shadow = if takes_light { SelfShadow::Hard } else { SelfShadow::None };
    give(inputs, weighings);
    settled.materials = weighings.iter().map(|weighing| weighing.material).collect();
    settled.heights = weighings.iter().filter(|w| w.is_heights).map(|weighing| weighing.material).collect();
    settled.choices = weighings.iter().map(|weighing| told(&inputs.scene, weighing)).collect();
    for (weighing, choice) in weighings.iter().zip(&mut settled.choices) {
        let method = weighing.chosen().method;
        if method.moves_vertices() {
            choice.shades_rest = weighing.is_heights && rest::shade(inputs, request, bent, weighing.material);
        } else if method != Method::Flat {
            rest::give(inputs, weighing.material, bent.of(weighing.material).bump.clone());
        }
    }
    inputs.plans = Plans::make(&mut inputs.scene, &request.surface.geometry, desk.limits)?;
    Ok(())
}

/// The method that decides for the renderer: one that marches, else one that moves vertices, else one that bends normals.
fn shown_by(weighings: &[Weighing<'_>]) -> Method {
    let methods = || weighings.iter().map(|weighing| weighing.chosen().method);
    methods()
        .find(|method| method.marcher().is_some())
        .or_else(|| methods().find(|method| method.moves_vertices()))
        .or_else(|| methods().next())
        .unwrap_or(Method::Flat)
}

/// Takes details from materials that are not displaced, and gives them heights.
fn give(inputs: &mut Inputs, weighings: &[Weighing<'_>]) {
    let still: Vec<&Weighing<'_>> = weighings.iter().filter(|w| !w.chosen().method.moves_vertices()).collect();
    if still.is_empty() {
        return;
    }
    let of = |material: Option<usize>| still.iter().find(|w| w.material == material);
    for (m, details) in inputs.scene.meshes.iter().zip(&mut inputs.details) {
        for (primitive, detail) in m.mesh.primitives.iter().zip(details) {
            if of(primitive.material).is_some() {
                *detail = None;
            }
        }
    }
    let marched = |material: Option<usize>| -> Option<Arc<Relief>> {
        of(material).filter(|w| w.chosen().method.marcher().is_some())?.relief.clone()
    };
    let count = inputs.scene.materials.len();
    inputs.reliefs = Reliefs { of_material: (0..count).map(|m| marched(Some(m))).collect(), of_none: marched(None) };
}

/// All of it as triangles within the tolerance, whatever was chosen before: for where that was measured to be not enough.
pub(in crate::jobs) fn displace_all(
    desk: Desk<'_>,
    asked: &RenderRequest,
    before: &Settled,
    reason: &str,
) -> Result<Settled> {
    let mut asked = asked.clone();
    let has_vectors = before.choices.iter().any(|choice| choice.chosen.method == Method::Vector.name());
    asked.surface.method = if has_vectors { Method::Vector } else { Method::Displacement };
    let mut settled = super::settle(desk, &asked)?;
    settled.choices = before.choices.clone();
    settled.passes = before.passes.clone();
    let bent = rest::bent(desk, &settled.inputs, &settled.request, false)?;
    for (choice, material) in settled.choices.iter_mut().zip(&before.materials) {
        choice.shades_rest =
            before.heights.contains(material) && rest::shade(&mut settled.inputs, &settled.request, &bent, *material);
        if choice.chosen.is_displaced() {
            continue;
        }
        let displaced = Weighed { method: Method::Displacement.name().into(), ..Weighed::default() };
        choice.next_cheaper = Some(std::mem::replace(&mut choice.chosen, displaced));
        choice.next_better = None;
        choice.reason = reason.into();
    }
    Ok(settled)
}

fn told(scene: &Scene, weighing: &Weighing<'_>) -> Choice {
    let Weighing { material, candidates, picked, tolerance_px, reason, .. } = weighing;
    let name = material.and_then(|m| scene.materials.get(m)).and_then(|material| material.name.clone());
    let weighed = |k: &usize| candidates[*k].weighed(*tolerance_px);
    let Picked { chosen, next_better, next_cheaper } = picked;
    Choice {
        material: name.unwrap_or_default(),
        tolerance_px: *tolerance_px,
        chosen: weighed(chosen),
        next_better: next_better.as_ref().map(weighed),
        next_cheaper: next_cheaper.as_ref().map(weighed),
        measured_px: None,
        shades_rest: false,
        reason: reason.clone(),
    }
}

impl Weighing<'_> {
    pub(in crate::jobs) fn chosen(&self) -> &Candidate {
        &self.candidates[self.picked.chosen]
    }
}
