//! What there is to show a material by: each method that goes with it, its predicted errors and its cost.

mod seen;

use std::sync::Arc;

use displace_glsl::methods::Method;

use super::{Desk, rest};
use crate::{
    domain::{
        Error, Result,
        chart::Setting,
        choice::{self, Candidate, Picked},
        choose::{facts::HeightFacts, kept},
        detail::{Detail, LayerSource},
        image::{AlphaMode, RenderCamera},
        maps,
        projection::Projection,
        relief::Relief,
        request::{Base, RenderRequest},
        scene::{Alpha, Scene},
    },
    jobs::inputs::Inputs,
};
pub(in crate::jobs) use seen::Seen;

/// What is known of a map takes about 50 bytes a texel, and twice that while it is made.
pub(in crate::jobs) const MOST_TEXELS: usize = 1 << 24;

/// One material with a detail, and what shows it.
pub(in crate::jobs) struct Weighing<'a> {
    /// None of primitives without one.
    pub(super) material: Option<usize>,
    /// Its detail is heights alone.
    pub(super) is_heights: bool,
    /// Its heights, where they can be shown per pixel.
    pub(super) relief: Option<Arc<Relief>>,
    /// The same as the image sees them.
    pub(in crate::jobs) seen: Option<Seen<'a>>,
    pub(super) candidates: Vec<Candidate>,
    pub(super) picked: Picked,
    pub(super) tolerance_px: f64,
    /// Why it is what it is, where cost did not decide; else empty.
    pub(super) reason: String,
}

/// A material with a detail, and what is known of it whatever sees it.
pub(in crate::jobs) struct Ground {
    material: Option<usize>,
    detail: Arc<Detail>,
    /// Where heights can be shown per pixel.
    heights: Option<(Arc<Relief>, Arc<HeightFacts>)>,
    /// Why they are not; else empty.
    refused: &'static str,
}

/// A material and its detail.
type Known = (Option<usize>, Arc<Detail>);

/// Of every material with a detail, those without a name last.
pub(in crate::jobs) fn grounds(desk: Desk<'_>, inputs: &Inputs, request: &RenderRequest) -> Result<Vec<Ground>> {
    let of = details(inputs);
    let reliefs = maps::marchable(&of.iter().map(|(_, detail)| Some(Arc::clone(detail))).collect::<Vec<_>>())?;
    let ground = |(of, relief): (Known, Option<Arc<Relief>>)| {
        let (material, detail) = of;
        let refused = refused(desk, &inputs.scene, request, material, relief.as_ref());
        let heights = relief.filter(|_| refused.is_none()).map(|relief| {
            let facts = kept::facts_of(&relief.map);
            (relief, facts)
        });
        Ground { material, detail, heights, refused: refused.unwrap_or_default() }
    };
    Ok(of.into_iter().zip(reliefs).map(ground).collect())
}

/// What there is to show each by, and what is picked.
pub(in crate::jobs) fn weigh<'a>(
    desk: Desk<'_>,
    inputs: &Inputs,
    grounds: &[Ground],
    (request, camera): (&'a RenderRequest, &RenderCamera),
    tolerance_px: f64,
) -> Result<Vec<Weighing<'a>>> {
    let mut all = Vec::with_capacity(grounds.len());
    for Ground { material, detail, heights, refused } in grounds {
        desk.job.cancel.check()?;
        let seen = heights
            .as_ref()
            .map(|(relief, facts)| Seen::new(&inputs.scene, *material, (relief, Arc::clone(facts)), camera, request));
        // Where materials have to agree, what one of them would not take another may make it take.
        let wanted = if grounds.len() > 1 { Wanted::All } else { Wanted::Picked };
        let candidates = candidates(desk, seen.as_ref(), is_vector(detail), (tolerance_px, wanted));
        let picked = picked(&candidates, tolerance_px)?;
        let relief = heights.as_ref().map(|(relief, _)| Arc::clone(relief));
        let reason = (*refused).into();
        let is_heights = rest::is_heights(detail);
        all.push(Weighing { material: *material, is_heights, relief, seen, candidates, picked, tolerance_px, reason });
    }
    agree_on_march(&mut all)?;
    agree_on_motion(&inputs.scene, &mut all);
    Ok(all)
}

fn picked(candidates: &[Candidate], tolerance_px: f64) -> Result<Picked> {
    choice::pick(candidates, tolerance_px).ok_or_else(|| Error::internal("nothing to choose from"))
}

/// Why heights are not shown per pixel.
fn refused(
    desk: Desk<'_>,
    scene: &Scene,
    request: &RenderRequest,
    material: Option<usize>,
    relief: Option<&Arc<Relief>>,
) -> Option<&'static str> {
    let is_blended = material.is_some_and(|m| matches!(scene.materials[m].alpha, Alpha::Blend));
    [
        (relief.is_none(), "its detail is not one height map, so that triangles alone hold it"),
        (
            request.surface.maps.projection != Projection::Uv,
            "maps are projected, and heights per pixel are read at texture coordinates",
        ),
        (
            request.surface.geometry.base != Base::Flat,
            "the base is curved, and errors per pixel are predicted over flat triangles",
        ),
        (desk.traces_rays && request.rays().is_some(), "samples are rays, which meet triangles"),
        (
            relief.is_some_and(|relief| relief.map.heights.len() > MOST_TEXELS),
            "its map has more texels than errors are predicted for",
        ),
        (is_blended && request.look.alpha == AlphaMode::Blend, "it is blended, and heights per pixel are not"),
    ]
    .into_iter()
    .find_map(|(applies, reason)| applies.then_some(reason))
}

/// Of which candidates errors are predicted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wanted {
    All,
    /// The one that is picked, and those that stand beside it.
    Picked,
}

/// Triangles always; what shows heights otherwise where it is known how they look, the cheapest first.
fn candidates(
    desk: Desk<'_>,
    seen: Option<&Seen<'_>>,
    is_vector: bool,
    (tolerance_px, wanted): (f64, Wanted),
) -> Vec<Candidate> {
    let method = if is_vector { Method::Vector } else { Method::Displacement };
    let of = |method: Method, setting: Setting| {
        let work = seen.map(|seen| seen.work(method, setting)).unwrap_or_default();
        let (shell, cost_ms) = (setting == Setting::Shell, desk.model.ms(&work));
        Candidate { method, shell, error_px: tolerance_px, outline_px: tolerance_px, cost_ms, work }
    };
    let mut all = vec![of(method, Setting::TolerancePx(tolerance_px))];
    let Some(seen) = seen else { return all };
    let mut rest = PER_PIXEL.map(|(method, setting)| of(method, setting)).to_vec();
    rest.sort_by(|a, b| a.cost_ms.total_cmp(&b.cost_ms));
    let is_enough = |all: &[Candidate], next: &Candidate| {
        wanted == Wanted::Picked && choice::is_settled(all, next.cost_ms, tolerance_px)
    };
    while rest.first().is_some_and(|next| !is_enough(&all, next)) {
        // Most often the first or the second is enough; of more it is faster to predict all at once.
        let count = if wanted == Wanted::Picked && all.len() < 3 { 1 } else { rest.len() };
        let next: Vec<Candidate> = rest.drain(..count).collect();
        let settings: Vec<(Method, Setting)> = next.iter().map(|c| (c.method, c.setting(tolerance_px))).collect();
        let predicted = seen.predicted(&settings);
        all.extend(next.into_iter().zip(predicted).map(|(candidate, [error_px, outline_px])| Candidate {
            error_px,
            outline_px,
            ..candidate
        }));
    }
    all
}

/// What shows heights pixel by pixel.
const PER_PIXEL: [(Method, Setting); 5] = [
    (Method::Bump, Setting::None),
    (Method::Parallax, Setting::None),
    (Method::ParallaxIterative, Setting::None),
    (Method::Exact, Setting::None),
    (Method::Exact, Setting::Shell),
];

/// An image has one method that marches, and outlines for all of it or none: where materials differ, exact is what all take.
fn agree_on_march(all: &mut [Weighing<'_>]) -> Result<()> {
    let marched =
        |w: &Weighing<'_>| Some(w.chosen()).filter(|c| c.method.marcher().is_some()).map(|c| (c.method, c.shell));
    let mut kinds: Vec<(Method, bool)> = Vec::new();
    for kind in all.iter().filter_map(marched) {
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    if kinds.len() < 2 {
        return Ok(());
    }
    let shell = kinds.iter().any(|(_, shell)| *shell);
    for weighing in all.iter_mut().filter(|w| marched(w).is_some()) {
        weighing.candidates.retain(|c| c.method.marcher().is_none() || (c.method, c.shell) == (Method::Exact, shell));
        weighing.picked = picked(&weighing.candidates, weighing.tolerance_px)?;
        weighing.reason = "materials of one image share the method that marches and how it shows outlines".into();
    }
    Ok(())
}

/// Where one material of a mesh is displaced all are: they share vertices.
fn agree_on_motion(scene: &Scene, all: &mut [Weighing<'_>]) {
    let together = |mesh: usize, w: &Weighing<'_>| {
        scene.meshes[mesh].mesh.primitives.iter().any(|primitive| primitive.material == w.material)
    };
    // What one mesh forces on a material another may have to follow.
    for _ in 0..all.len() {
        for mesh in 0..scene.meshes.len() {
            let moves = |w: &Weighing<'_>| together(mesh, w) && w.chosen().method.moves_vertices();
            if !all.iter().any(moves) {
                continue;
            }
            for weighing in all.iter_mut().filter(|w| together(mesh, w) && !w.chosen().method.moves_vertices()) {
                weighing.displace("another material of its mesh is displaced, and they share vertices");
            }
        }
    }
}

impl Weighing<'_> {
    fn displace(&mut self, reason: &str) {
        let displaced = self.candidates.iter().position(|c| c.method.moves_vertices()).unwrap_or(0);
        let before = self.picked.chosen;
        self.picked = Picked { chosen: displaced, next_better: None, next_cheaper: Some(before) };
        self.reason = reason.into();
    }
}

/// Of each material that is shown and has one.
fn details(inputs: &Inputs) -> Vec<Known> {
    let mut all: Vec<Known> = Vec::new();
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
    let holds = |source: &LayerSource| matches!(source, LayerSource::VectorTangent(_) | LayerSource::VectorObject(_));
    detail.layers.iter().any(|layer| holds(&layer.source))
}
