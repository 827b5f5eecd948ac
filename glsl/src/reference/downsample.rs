//! Twin of `downsample`: pixels as means over squares of a finer image.

use glam::DVec3;

/// Rows of a finer image, `side` of them, to one row.
#[must_use]
pub fn downsample(rows: &[Vec<DVec3>], side: usize) -> Vec<DVec3> {
    let mean = |x: usize| {
        let square = rows.iter().flat_map(|row| &row[x * side..(x + 1) * side]);
        square.sum::<DVec3>() / (side * side) as f64
    };
    (0..rows.first().map_or(0, Vec::len) / side).map(mean).collect()
}
