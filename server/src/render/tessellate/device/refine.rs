//! Refinement on the device: the rounds of `render::refine`, and what is split by the bound.

use std::sync::Arc;

use displace_glsl::{
    SHADERS,
    layout::{
        bound::FacetPlace,
        refine::{RefineJudgeParams, RefineNewParams, RefinePlacesParams},
    },
    reference::refine::{Base, Refined},
};

use super::bounds::Bounds;
use crate::{
    domain::Result,
    render::{
        JobContext,
        lists::compact::Compact,
        refine::{Refinement, Round},
    },
    vulkan::{Device, Recorder, Stream},
};

const WORD: u32 = 4;

/// Splits triangles until the bound of each is at most `allowed`, local units, or its sides cannot be halved; returns how
/// many rounds that took. None where it takes more than `limit` triangles.
///
/// f32 decides: a bound may be off by some 2^-20 of the heights for each texel of the triangle's extent.
pub fn refine(
    job: &JobContext<'_>,
    device: &Arc<Device>,
    bounds: &Bounds,
    base: &Base,
    allowed: f64,
    limit: u64,
) -> Result<Option<(Refined, u32)>> {
    let mut refinement = Refinement::new(device, base)?;
    let mut rounds = 0;
    loop {
        job.cancel.check()?;
        job.progress.pass("refine", u64::from(rounds), u64::from(rounds) + 1);
        let wanted = wanted(job, device, bounds, &refinement, allowed as f32)?;
        match refinement.round(job, &wanted, limit)? {
            Round::Split(_) => rounds += 1,
            Round::Done | Round::TooFine if refinement.triangles() <= limit => {
                return Ok(Some((refinement.read()?, rounds)));
            }
            Round::Done | Round::TooFine | Round::OverBudget(_) => return Ok(None),
        }
    }
}

/// 1 for each triangle that is to be split; states of new ones are found out.
fn wanted(
    job: &JobContext<'_>,
    device: &Arc<Device>,
    bounds: &Bounds,
    refinement: &Refinement,
    allowed: f32,
) -> Result<Stream> {
    let (list, count) = new_triangles(job, device, refinement)?;
    let wanted = Stream::new(device, "wanted", WORD, refinement.triangles())?;
    let mut recorder = device.recorder(job.cancel, job.progress);
    recorder.fill(&wanted, 0)?;
    let facets = record_places(device, &mut recorder, refinement, &list, count)?;
    let (mut recorder, found) = bounds.record(job, recorder, &facets, count, allowed)?;
    let params = RefineJudgeParams { count: count as u32, allowed };
    let streams = [("list", &list), ("bounds", &found), ("states", &refinement.states), ("wanted", &wanted)];
    recorder.dispatch(&SHADERS.refine_judge, count, &params, &streams)?;
    recorder.finish()?;
    Ok(wanted)
}

/// The numbers of the triangles that the last round made, and how many they are.
fn new_triangles(job: &JobContext<'_>, device: &Arc<Device>, refinement: &Refinement) -> Result<(Stream, u64)> {
    let triangles = refinement.triangles();
    let flags = Stream::new(device, "flags", WORD, triangles)?;
    let list = Stream::new(device, "list", WORD, triangles)?;
    let compact = Compact::new(device, triangles)?;
    let mut recorder = device.recorder(job.cancel, job.progress);
    let streams = [("states", &refinement.states), ("flags", &flags)];
    recorder.dispatch(&SHADERS.refine_new, triangles, &RefineNewParams { count: triangles as u32 }, &streams)?;
    compact.record(&mut recorder, &flags, &list, triangles)?;
    recorder.finish()?;
    Ok((list, compact.total()?))
}

fn record_places(
    device: &Arc<Device>,
    recorder: &mut Recorder<'_>,
    refinement: &Refinement,
    list: &Stream,
    count: u64,
) -> Result<Stream> {
    let facets = Stream::new(device, "facets", size_of::<FacetPlace>() as u32, count)?;
    let streams = [
        ("list", list),
        ("triangles", &refinement.triangles),
        ("vertices", &refinement.vertices),
        ("bases", &refinement.bases),
        ("facets", &facets),
    ];
    recorder.dispatch(&SHADERS.refine_places, count, &RefinePlacesParams { count: count as u32 }, &streams)?;
    Ok(facets)
}
