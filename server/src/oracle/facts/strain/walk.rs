//! The order of the fine triangles of a uniform surface.

/// Goes through the fine triangles in their order: rows of constant j, upright and inverted in turn.
pub(super) struct Walk {
    pub(super) base: usize,
    /// Triangles from here to the end of the base triangle.
    left: u64,
    /// Of them, those beyond this row: the square of the rows that follow.
    beyond: u64,
    segments: u64,
}

impl Walk {
    pub(super) fn from(first: u64, level: u32) -> Self {
        let segments = 1u64 << level;
        let all = segments * segments;
        let left = all - first % all;
        let rows = (left - 1).isqrt();
        Self { base: (first / all) as usize, left, beyond: rows * rows, segments }
    }

    /// A row has one upright triangle more than inverted ones.
    #[inline]
    pub(super) fn upright(&self) -> bool {
        (self.left - self.beyond) % 2 == 1
    }

    /// Is the next one in another base triangle?
    #[inline]
    pub(super) fn advance(&mut self) -> bool {
        self.left -= 1;
        if self.left == 0 {
            *self = Self { base: self.base + 1, left: self.segments * self.segments, ..*self };
            self.beyond = (self.segments - 1) * (self.segments - 1);
            return true;
        }
        if self.left == self.beyond {
            let rows = self.beyond.isqrt() - 1;
            self.beyond = rows * rows;
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_walked_in_order_from_anywhere() {
        for level in 0..4 {
            let n = 1u64 << level;
            let rows = (0..n).flat_map(|j| (0..2 * (n - j) - 1).map(|k| k % 2 == 0));
            let twice: Vec<bool> = rows.clone().chain(rows).collect();
            for first in 0..twice.len() {
                let mut walk = Walk::from(first as u64, level);
                for (at, &upright) in twice.iter().enumerate().skip(first) {
                    assert_eq!((walk.upright(), walk.base as u64), (upright, at as u64 / (n * n)), "{level} {at}");
                    walk.advance();
                }
            }
        }
    }
}
