//! Cracks: where the border of a mesh runs although the surface goes on.

use std::collections::HashMap;

use glam::DVec3;

use super::{
    bvh::{Bounds, Bvh},
    sheet::{Sheet, distance_to_triangle},
};

/// The widest crack of `sheet`, world units; 0 where it has none. A border edge is a crack's where it is farther
/// than `tolerance` from every border of `reference`; the crack is as wide as the way from the middle of its edges to
/// the nearest other border edge.
#[must_use]
pub fn widest(reference: &Sheet<'_>, sheet: &Sheet<'_>, tolerance: f64) -> f64 {
    let (of_reference, own) = (Borders::of(reference), Borders::of(sheet));
    let is_crack = |e: &usize| of_reference.distance(own.middle(*e), |_| true).is_none_or(|d| d > tolerance);
    let width = |e: usize| own.distance(own.middle(e), |other| other != e).unwrap_or(0.0);
    (0..own.ends.len()).filter(is_crack).map(width).fold(0.0, f64::max)
}

/// Edges with one triangle.
struct Borders {
    ends: Vec<[u32; 2]>,
    places: Vec<[DVec3; 2]>,
    bvh: Bvh,
}

impl Borders {
    fn of(sheet: &Sheet<'_>) -> Self {
        let mut uses: HashMap<[u32; 2], u32> = HashMap::new();
        for t in &sheet.triangles {
            for k in 0..3 {
                let (a, b) = (t[k], t[(k + 1) % 3]);
                *uses.entry([a.min(b), a.max(b)]).or_default() += 1;
            }
        }
        let mut ends: Vec<[u32; 2]> = uses.into_iter().filter(|(_, uses)| *uses == 1).map(|(ends, _)| ends).collect();
        ends.sort_unstable();
        let places: Vec<[DVec3; 2]> = ends.iter().map(|e| e.map(|v| sheet.positions[v as usize])).collect();
        let boxes: Vec<Bounds> = places.iter().map(|ends| Bounds::of(ends)).collect();
        Self { ends, places, bvh: Bvh::build(&boxes) }
    }

    fn middle(&self, edge: usize) -> DVec3 {
        let [a, b] = self.places[edge];
        0.5 * (a + b)
    }

    /// To the nearest border edge of those that count.
    fn distance(&self, place: DVec3, counts: impl Fn(usize) -> bool) -> Option<f64> {
        let square = self.bvh.nearest(place, f64::INFINITY, |edge, least| {
            let [a, b] = self.places[edge as usize];
            if counts(edge as usize) { distance_to_triangle(place, [a, b, b]).powi(2) } else { least }
        });
        square.is_finite().then(|| square.sqrt())
    }
}
