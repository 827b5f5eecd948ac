//! What the samples of a pixel see: solid triangles, and blended ones before them, in order.

use displace_glsl::reference::composite::MAX_LAYERS;

use crate::domain::image::MarchCounters;

pub(super) const NOTHING: u32 = u32::MAX;

/// A triangle that a sample meets: reversed depth and id.
#[derive(Clone, Copy)]
pub(super) struct Seen {
    pub(super) depth: f64,
    pub(super) id: u32,
}

impl Seen {
    pub(super) fn is_before(&self, other: &Self) -> bool {
        self.depth > other.depth || (self.depth == other.depth && self.id < other.id)
    }
}

#[derive(Clone)]
pub(super) struct Samples {
    /// The nearest.
    pub(super) solid: [Seen; 4],
    /// All, in any order.
    pub(super) blended: [Vec<Seen>; 4],
    /// How often one was covered.
    pub(super) covered: u32,
    /// That said how far away they are.
    pub(super) marches: MarchCounters,
}

impl Default for Samples {
    fn default() -> Self {
        let solid = [Seen { depth: -1.0, id: NOTHING }; 4];
        Self { solid, blended: Default::default(), covered: 0, marches: MarchCounters::default() }
    }
}

impl Samples {
    /// Blended triangles by sample, the nearest first, and whether there are more.
    pub(super) fn layers(&self) -> (Vec<[u32; 4]>, bool) {
        let in_order: [Vec<Seen>; 4] = std::array::from_fn(|s| {
            let mut seen = self.blended[s].clone();
            seen.retain(|seen| seen.is_before(&self.solid[s]));
            seen.sort_by(|a, b| b.depth.total_cmp(&a.depth).then(a.id.cmp(&b.id)));
            seen
        });
        let most = in_order.iter().map(Vec::len).max().unwrap_or(0);
        let layer = |k: usize| std::array::from_fn(|s| in_order[s].get(k).map_or(NOTHING, |seen: &Seen| seen.id));
        ((0..most.min(MAX_LAYERS)).map(layer).collect(), most > MAX_LAYERS)
    }

    pub(super) fn solid(&self) -> [u32; 4] {
        self.solid.map(|seen| seen.id)
    }
}

/// Each triangle of four samples with those it covers, in the order of its first; of relief each sample alone.
pub(super) fn distinct(ids: &[u32; 4], is_relief: impl Fn(u32) -> bool) -> Vec<(u32, Vec<usize>)> {
    let is_same = |s: usize, other: usize| ids[s] == ids[other] && (s == other || !is_relief(ids[s]));
    let is_first = |s: &usize| ids[*s] != NOTHING && !(0..*s).any(|before| is_same(before, *s));
    (0..4).filter(is_first).map(|s| (ids[s], (0..4).filter(|&other| is_same(s, other)).collect())).collect()
}
