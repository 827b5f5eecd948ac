//! What marches took.

use displace_glsl::reference::relief::March;

use super::Pixel;
use crate::domain::image::MarchCounters;

impl Extend<MarchCounters> for MarchCounters {
    fn extend<T: IntoIterator<Item = MarchCounters>>(&mut self, more: T) {
        for MarchCounters { rays, fetches, steps, cap_hits } in more {
            self.rays += rays;
            self.fetches += fetches;
            self.steps += steps;
            self.cap_hits += cap_hits;
        }
    }
}

/// Of a march.
pub(super) fn one(march: &March) -> MarchCounters {
    let March { fetches, steps, capped, .. } = *march;
    MarchCounters { rays: 1, fetches: fetches.into(), steps: steps.into(), cap_hits: capped.into() }
}

/// Of each square of as many columns as there are rows.
pub(super) fn of_squares(rows: &[Vec<Pixel>], side: usize) -> Vec<MarchCounters> {
    let mut squares = vec![MarchCounters::default(); rows.first().map_or(0, Vec::len) / side];
    for (x, pixel) in rows.iter().flat_map(|row| row.iter().enumerate()) {
        squares[x / side].extend([pixel.marches]);
    }
    squares
}

/// As images hold it.
pub(super) fn cost(counters: &MarchCounters) -> [f32; 3] {
    [counters.fetches, counters.steps, counters.cap_hits].map(|count| count as f32)
}
