//! Where a fine vertex is looked at: the places in base triangles that shade it.

use displace_glsl::{layout::refine::UNIT, reference::samples::place_in_triangle, tables::Tables};

use crate::domain::surface::Place;

/// Base triangles and the weights of their second and third corner, in units of 2^-24: one for each triangle that
/// shades the vertex, in the order of sums.
pub fn places(tables: &Tables, place: Place) -> impl Iterator<Item = (u32, [u32; 2])> {
    let along = if let Place::Edge { along, .. } = place { along } else { 0 };
    let own = if let Place::Inside { triangle, b } = place { Some((triangle, b)) } else { None };
    let listed = contributions(tables, place).iter();
    listed.map(move |&item| (item / 3, place_in_triangle(tables, item, along, UNIT))).chain(own)
}

/// `triangle * 3 + corner` or side of the base triangles that shade a vertex; none within a triangle.
#[must_use]
pub fn contributions(tables: &Tables, place: Place) -> &[u32] {
    match place {
        Place::Corner { av } => tables.contributions_of(av),
        Place::Edge { ae, .. } => tables.contributions_of(tables.lattice.corners + ae),
        Place::Inside { .. } => &[],
    }
}

/// Whether a triangle that shades the vertex is corrected at its seams.
#[must_use]
pub fn is_corrected(tables: &Tables, place: Place) -> bool {
    places(tables, place).any(|(triangle, _)| tables.correction(triangle).is_some())
}
