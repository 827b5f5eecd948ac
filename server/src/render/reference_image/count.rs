//! What marches took.

use displace_glsl::reference::relief::March;

use crate::domain::image::MarchCounters;

/// Of a march.
pub(super) fn one(march: &March) -> MarchCounters {
    let March { fetches, steps, capped, .. } = *march;
    MarchCounters { rays: 1, fetches: fetches.into(), steps: steps.into(), cap_hits: capped.into() }
}

pub(super) fn sum(all: impl IntoIterator<Item = MarchCounters>) -> MarchCounters {
    all.into_iter().fold(MarchCounters::default(), |a, b| MarchCounters {
        rays: a.rays + b.rays,
        fetches: a.fetches + b.fetches,
        steps: a.steps + b.steps,
        cap_hits: a.cap_hits + b.cap_hits,
    })
}

/// As images hold it.
pub(super) fn cost(counters: &MarchCounters) -> [f32; 3] {
    [counters.fetches, counters.steps, counters.cap_hits].map(|count| count as f32)
}
