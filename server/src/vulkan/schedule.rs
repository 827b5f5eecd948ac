//! Cuts dispatches into pieces and learns how long each shader takes, so that every submission stays
//! short enough to cancel. No Vulkan here.

use std::collections::HashMap;

/// Threads of a workgroup: `local_size_x` of every shader.
pub(crate) const GROUP_THREADS: u64 = 64;
/// Groups in a row of the grid, as `thread_index` in `common.glsl` has it.
pub(crate) const ROW_GROUPS: u64 = 4096;
/// Rows of a grid: the least every implementation must allow.
const MAX_ROWS: u64 = 65_535;
/// Thread numbers stay far from wrapping at 2^32.
pub(crate) const MAX_THREADS: u64 = 1 << 31;

/// Computing time of one submission. Two of them and the time to notice stay under 250 ms.
pub(crate) const SUBMISSION_NS: f64 = 60e6;
/// Groups of the first piece of a shader nobody has measured.
const FIRST_GROUPS: u64 = 32;
/// A piece has at most this many times the groups of the largest one measured: threads differ.
const GROWTH: u64 = 16;

/// A box of workgroups within the grid of a dispatch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Piece {
    pub(crate) base: [u32; 2],
    pub(crate) count: [u32; 2],
}

/// Groups for `elements`, of which a thread handles `batch`.
pub(crate) fn groups_of(elements: u64, batch: u32) -> u64 {
    elements.div_ceil(GROUP_THREADS * u64::from(batch))
}

/// The boxes that make up groups `first..end`: the rest of a row, whole rows, the start of a row.
pub(crate) fn pieces(first: u64, end: u64) -> impl Iterator<Item = Piece> {
    let mut next = first;
    std::iter::from_fn(move || {
        let (row, column) = (next / ROW_GROUPS, next % ROW_GROUPS);
        let left = end.checked_sub(next).filter(|left| *left > 0)?;
        let count = if column > 0 || left < ROW_GROUPS {
            [left.min(ROW_GROUPS - column), 1]
        } else {
            [ROW_GROUPS, (left / ROW_GROUPS).min(MAX_ROWS)]
        };
        next += count[0] * count[1];
        Some(Piece { base: [column as u32, row as u32], count: count.map(|n| n as u32) })
    })
}

#[derive(Clone, Copy, Debug)]
struct Rate {
    ns_per_group: f64,
    /// Groups of the largest piece measured.
    groups: u64,
}

/// What was measured, by shader.
#[derive(Debug, Default)]
pub(crate) struct Rates(HashMap<&'static str, Rate>);

impl Rates {
    /// Expected time; unmeasured shaders are taken to be slow.
    pub(crate) fn estimate_ns(&self, shader: &str, groups: u64) -> f64 {
        let ns_per_group = self.0.get(shader).map_or(SUBMISSION_NS / FIRST_GROUPS as f64, |rate| rate.ns_per_group);
        groups as f64 * ns_per_group
    }

    /// Groups that may follow in a submission with `left_ns` left. At least one, lest nothing ever moves.
    pub(crate) fn groups_within(&self, shader: &str, left_ns: f64) -> u64 {
        let most =
            self.0.get(shader).map_or(FIRST_GROUPS, |rate| rate.groups.saturating_mul(GROWTH).max(FIRST_GROUPS / 4));
        let fit = (left_ns / self.estimate_ns(shader, 1)) as u64;
        fit.min(most).max(1)
    }

    /// Learns from a piece of `groups` that took `ns`. Slower is believed at once, faster by half, and
    /// small pieces, which mostly measure their overhead, give way to larger ones.
    pub(crate) fn learn(&mut self, shader: &'static str, groups: u64, ns: f64) {
        if groups == 0 {
            return;
        }
        let ns_per_group = (ns / groups as f64).max(0.1);
        let rate = self.0.entry(shader).or_insert(Rate { ns_per_group, groups });
        if groups >= rate.groups * 4 || (groups * 4 >= rate.groups && ns_per_group > rate.ns_per_group) {
            rate.ns_per_group = ns_per_group;
        } else if groups * 4 >= rate.groups {
            rate.ns_per_group = 0.5 * (rate.ns_per_group + ns_per_group);
        }
        rate.groups = rate.groups.max(groups);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn covered(first: u64, end: u64) -> Vec<u64> {
        let mut groups = Vec::new();
        for piece in pieces(first, end) {
            for y in 0..u64::from(piece.count[1]) {
                for x in 0..u64::from(piece.count[0]) {
                    groups.push((u64::from(piece.base[1]) + y) * ROW_GROUPS + u64::from(piece.base[0]) + x);
                }
            }
        }
        groups
    }

    #[test]
    fn pieces_cover_every_group_once_and_in_order() {
        for (first, end) in
            [(0, 0), (0, 1), (0, 4095), (0, 4096), (0, 4097), (7, 4096), (7, 9000), (4095, 12_289), (4096, 8192)]
        {
            assert_eq!(covered(first, end), (first..end).collect::<Vec<_>>(), "{first}..{end}");
            assert!(pieces(first, end).count() <= 3);
        }
    }

    #[test]
    fn pieces_respect_the_smallest_grid_every_device_allows() {
        for piece in pieces(0, groups_of(MAX_THREADS, 1)) {
            assert!(piece.count[0] <= 65_535 && piece.count[1] <= 65_535);
        }
    }

    #[test]
    fn an_unknown_shader_starts_small_and_grows_with_what_is_measured() {
        let mut rates = Rates::default();
        assert_eq!(rates.groups_within("x", SUBMISSION_NS), FIRST_GROUPS);
        rates.learn("x", FIRST_GROUPS, 1e6);
        assert_eq!(rates.groups_within("x", SUBMISSION_NS), FIRST_GROUPS * GROWTH);
        rates.learn("x", FIRST_GROUPS * GROWTH, 16e6);
        let within = rates.groups_within("x", SUBMISSION_NS);
        assert!((within as f64 - 60.0 * FIRST_GROUPS as f64).abs() < 2.0, "{within}");
    }

    #[test]
    fn slower_is_believed_at_once() {
        let mut rates = Rates::default();
        rates.learn("x", 1000, 1e6);
        rates.learn("x", 1000, 100e6);
        assert_eq!(rates.groups_within("x", SUBMISSION_NS), 600);
        assert_eq!(rates.groups_within("x", 0.0), 1);
    }

    #[test]
    fn a_tiny_piece_does_not_spoil_what_a_large_one_has_shown() {
        let mut rates = Rates::default();
        rates.learn("x", 100_000, 10e6);
        rates.learn("x", 1, 1e6);
        assert!(rates.estimate_ns("x", 100_000) < 11e6);
    }
}
