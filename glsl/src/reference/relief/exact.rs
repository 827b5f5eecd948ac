//! Twin of `exact`: the first root of ray and bilinear surface, found over a pyramid of greatest heights (Tevs, Ihrke
//! and Seidel 2008) or cell by cell. Both find the same bits: which cell a ray is in, and over which range of t, follows
//! from the numbers of lattice lines alone, and a node is passed by only where rounding can find nothing in it.

mod bounds;
mod leaf;
#[cfg(test)]
mod tests;
mod walk;

pub use bounds::bounds;

use super::{Course, March, ReliefMap};
use walk::{Piece, Walk};

/// Nodes and cells that a march reads at most: 4 (W + H) of a map of 8192 x 8192, or of 32 of 256 x 256 in a row. A
/// piece over n lattice lines reads no node twice, 2 n + 64 in all at most.
pub const MOST_READS: u32 = 1 << 16;

/// Over a map of one texel, which is as high everywhere, however often it is repeated.
fn level_march(height: f64, course: &Course) -> March {
    let mut above = false;
    for (k, pair) in course.nodes.windows(2).enumerate() {
        let (from, fall) = (pair[0].z, pair[1].z - pair[0].z);
        above |= from >= height;
        if above && pair[1].z < from.min(height) {
            let t = ((height - from) / fall).clamp(0.0, 1.0);
            let place = pair[0].lerp(pair[1], t).truncate().truncate();
            return March { s: k as f64 + t, place, fetches: 1, steps: 1, capped: false };
        }
    }
    March::missed(1, 1)
}

/// The setting: pieces that cross fewer lattice lines than this are walked cell by cell.
#[must_use]
pub fn marched(map: &ReliefMap, course: &Course, setting: f64) -> March {
    if map.level.size == [1, 1] {
        return level_march(f64::from(map.level.heights[0]), course);
    }
    let last = course.nodes.len() - 2;
    let mut march = March::missed(0, 0);
    let mut above = false;
    for (k, pair) in course.nodes.windows(2).enumerate() {
        let piece = Piece::new(map, pair[0], pair[1], [k == 0 && !course.is_open[0], k == last && !course.is_open[1]]);
        let mut walk = Walk::new(map, &piece, above, setting);
        let met = walk.run(&mut march);
        above = walk.above;
        if let Some(t) = met {
            march.s = k as f64 + t;
            march.place = piece.place(t);
            return march;
        }
    }
    march
}
