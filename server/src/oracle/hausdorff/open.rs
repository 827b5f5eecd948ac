//! The pieces that may still hold a farther place.

use std::collections::BinaryHeap;

use super::Piece;

/// About a gigabyte.
const MOST: usize = 3_000_000;

/// Pieces by their bounds, and the largest bound of those that need no cut.
#[derive(Default)]
pub(super) struct Open {
    heap: BinaryHeap<Piece>,
    settled: f64,
}

impl Open {
    /// Keeps a piece whose bound is above `enough`.
    pub(super) fn add(&mut self, piece: Piece, enough: f64) {
        if piece.upper <= enough {
            self.settled = self.settled.max(piece.upper);
            return;
        }
        self.heap.push(piece);
        if self.heap.len() > MOST {
            self.halve();
        }
    }

    /// The pieces with the lower bounds stay as they are: their bounds hold, only no longer sharp.
    fn halve(&mut self) {
        let mut pieces = std::mem::take(&mut self.heap).into_vec();
        pieces.select_nth_unstable_by(MOST / 2, |a, b| b.cmp(a));
        self.settled = pieces.drain(MOST / 2..).map(|piece| piece.upper).fold(self.settled, f64::max);
        self.heap = pieces.into();
    }

    /// Up to `count` pieces with the largest bounds, those above `enough`; none where what is settled is above them.
    pub(super) fn take(&mut self, count: usize, enough: f64) -> Vec<Piece> {
        let enough = enough.max(self.settled);
        let next = || self.heap.peek().is_some_and(|piece| piece.upper > enough).then(|| self.heap.pop()).flatten();
        std::iter::from_fn(next).take(count).collect()
    }

    /// No place of any piece is farther.
    pub(super) fn most(&self) -> f64 {
        self.heap.peek().map_or(self.settled, |piece| piece.upper.max(self.settled))
    }
}
