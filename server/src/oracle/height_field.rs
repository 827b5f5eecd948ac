//! Where a ray meets a map first: exact, in texel space, cell by cell (`walk_cells`) or down a hierarchy
//! (`pyramid.rs`).
//!
//! Over one cell the gap between the ray and the bilinear surface is a quadratic in t, and its first root has a closed
//! form. Both walkers see a cell over the same range of t, which follows from the cell's number alone, and solve it by
//! the same code: their hits are the same to the bit. The ranges of all cells have no gaps between them, and a cell in
//! which the ray is already through counts as hit at its start: no ray slips through between two cells.

use self::course::Course;
use super::{bvh::Segment, field::Field};

mod course;
mod pyramid;
#[cfg(test)]
mod tests;

pub use pyramid::Pyramid;

/// Where a ray is on the surface first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Of the ray, in `from..=to`.
    pub t: f64,
    /// The cell of the field.
    pub cell: [i64; 2],
    /// Whether the ray starts on or above the surface; else it comes out from below.
    pub from_above: bool,
}

/// What became of a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Walk {
    pub hit: Option<Hit>,
    /// Nodes and cells that were read.
    pub fetches: u64,
}

/// Where `ray` first meets z = h(x, y), h being one channel of the field: every cell on its way is looked at.
/// x and y of the ray are texel space, within ±2^40 for all of it; z is in the units of the channel: for a surface
/// at scale · (h − midlevel), pass z / scale + midlevel, and a scale below 0 turns above into below.
///
/// A ray that starts on or above the surface meets it at the first t with z ≤ h, one that starts below it at the
/// first t with z ≥ h; on the surface that is its start. Whoever leaves a surface starts a little off it. A range
/// without length meets nothing. Direction may be 0 in any component; from and to are finite.
///
/// Cost: a cell for every lattice line crossed until the hit.
#[must_use]
pub fn walk_cells(field: &Field, channel: u32, ray: &Segment) -> Walk {
    let course = Course::new(field, channel, ray);
    let mut fetches = 0;
    let hit = course.blocks([1; 2]).find_map(|(cell, spans)| {
        fetches += 1;
        course.hit(field, channel, cell, course.within(spans)?)
    });
    Walk { hit, fetches }
}
