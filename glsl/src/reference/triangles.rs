//! Fine triangles and the numbers of their vertices. The twin of `triangles.comp`.

use glam::DVec3;

use super::site::vector;
use crate::{lattice, tables::Tables};

/// Fine vertex number of lattice point (i, j) of base triangle t.
#[must_use]
pub fn fine_vertex(tables: &Tables, t: u32, i: u32, j: u32) -> u32 {
    let (n, base) = (tables.segments(), &tables.base_triangles[t as usize]);
    let k = n - i - j;
    let lattice = &tables.lattice;
    if i > 0 && j > 0 && k > 0 {
        let rank = lattice::interior_rank(lattice.level, u64::from(i), u64::from(j)) as u32;
        let points = lattice::interior_points(lattice.level) as u32;
        return lattice.corners + lattice.edges * (n - 1) + t * points + rank;
    }
    if let Some(corner) = [k, i, j].iter().position(|c| *c == n) {
        return base.av[corner];
    }
    let side = if j == 0 {
        0
    } else if k == 0 {
        1
    } else {
        2
    };
    let along = [i, j, k][side];
    let along = if base.reversed >> side & 1 == 1 { n - along } else { along };
    lattice.corners + base.ae[side] * (n - 1) + along - 1
}

/// The vertices of a fine triangle: rows of constant j, upright and inverted triangles in turn.
#[must_use]
pub fn triangle(tables: &Tables, index: u32) -> [u32; 3] {
    let n = tables.segments();
    let (t, rank) = (index / (n * n), index % (n * n));
    let mut j = 0;
    let mut first = 0;
    while first + 2 * (n - j) - 1 <= rank {
        first += 2 * (n - j) - 1;
        j += 1;
    }
    let i = (rank - first) / 2;
    let corners = if (rank - first) % 2 == 0 {
        [[i, j], [i + 1, j], [i, j + 1]]
    } else {
        [[i + 1, j], [i + 1, j + 1], [i, j + 1]]
    };
    corners.map(|[i, j]| fine_vertex(tables, t, i, j))
}

/// Positive where a fine triangle of base triangle t faces as it should, negative where it is flipped.
#[must_use]
pub fn facing(tables: &Tables, t: u32, [a, b, c]: [DVec3; 3]) -> f64 {
    (b - a).cross(c - a).dot(vector(&tables.triangle_facing[t as usize]))
}
