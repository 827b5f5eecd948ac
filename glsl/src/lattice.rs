//! The numbering of a uniformly subdivided triangle, shared by every pass and its twin.
//!
//! A lattice point of a base triangle with n = 2^level segments per edge is (i, j), 0 <= i + j <= n, with
//! barycentrics ((n − i − j) / n, i / n, j / n): dyadic, so exact in f32. Fine vertices are numbered in
//! three blocks: corners (base avs), edges ((n − 1) per ae), interiors ((n − 1)(n − 2) / 2 per triangle).

/// Number of fine vertices strictly inside one base triangle.
#[must_use]
pub const fn interior_points(level: u32) -> u64 {
    let n = 1u64 << level;
    if n < 3 { 0 } else { (n - 1) * (n - 2) / 2 }
}

/// Number of fine vertices strictly inside one base edge.
#[must_use]
pub const fn edge_points(level: u32) -> u64 {
    (1u64 << level) - 1
}

/// Rank of the interior lattice point (i, j), i, j >= 1, i + j <= n − 1, among its triangle's interior
/// points: rows of constant j, in rising i.
#[must_use]
pub const fn interior_rank(level: u32, i: u64, j: u64) -> u64 {
    let n = 1u64 << level;
    // Row j (from 1) holds n − 1 − j points.
    (j - 1) * (n - 1) - (j - 1) * j / 2 + (i - 1)
}

/// The inverse of [`interior_rank`]: the last row that starts no later, by a square root.
#[must_use]
pub fn interior_point(level: u32, rank: u64) -> (u64, u64) {
    let m = 2 * (1u64 << level) - 3;
    // Row k (from 0) starts at rank k (m − k) / 2: at `rank` or before where (m − 2k)² >= m² − 8 rank.
    let square = m * m - 8 * rank;
    let root = square.isqrt();
    let root = root + u64::from(root * root < square);
    let k = (m - root) / 2;
    (rank - k * (m - k) / 2 + 1, k + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_count_the_interior_points_without_gaps() {
        for level in 0..8 {
            let n = 1u64 << level;
            let mut expected = 0;
            for j in 1..n {
                for i in 1..n - j {
                    assert_eq!(interior_rank(level, i, j), expected);
                    assert_eq!(interior_point(level, expected), (i, j));
                    expected += 1;
                }
            }
            assert_eq!(expected, interior_points(level));
        }
    }
}
