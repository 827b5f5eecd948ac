//! What is wrong with a proposal: what opens or joins anything, what turns triangles over or leaves them without area,
//! and what is not shown to be near enough. Each fault names places of the mesh that the next proposal must keep.

use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::*;

use super::patch::{from_least, place};
use crate::{
    domain::{Result, cancel::Cancel, mesh::Csr, surface::Surface},
    oracle::{
        hausdorff::{self, Shown},
        overlay::Overlay,
        sheet::{Sheet, distance_to_triangle},
    },
};

/// Cuts for each triangle that folds lie over before the search for its bound is given up.
const CUTS: u64 = 64;
/// Twice the area of a triangle, as a share of its longest side squared, below which f32 places tell nothing of its
/// normal.
const THIN: f64 = 1e-5;

/// The mesh that proposals are to stand for.
pub(super) struct Reference<'a> {
    surface: &'a Surface,
    /// Of every fine vertex.
    places: &'a [u32],
    sheet: &'a PlacedSheet,
    overlay: Overlay<'a>,
    edges: Vec<Edge>,
    bad: usize,
    /// Triangles around each place of the sheet.
    stars: Csr,
    tolerance_local: f64,
}

/// Triangles between places, each place once, both in an order that follows from places alone.
pub(super) struct PlacedSheet {
    sheet: Sheet<'static>,
    /// The place of each vertex of the sheet, rising.
    places: Vec<u32>,
}

/// What was shown of earlier proposals. Triangles are named by their places, the least first.
#[derive(Default)]
pub(super) struct Known {
    /// Of each triangle of the mesh: its bound, and the triangles of the proposal that show it.
    there: Vec<Option<(f64, [[u32; 3]; 4])>>,
    back: HashMap<[u32; 3], f64>,
}

pub(super) enum Verdict {
    /// The proposal is no farther than this from what it stands for, both ways, mesh-local units.
    Kept(f64),
    /// Places that another proposal shall keep.
    Refused(Vec<u32>),
}

/// An edge that is not one of two triangles that run along it both ways: its places, the difference of the two ways,
/// and all its triangles.
type Edge = ([u32; 2], i32, u32);

impl PlacedSheet {
    pub(super) fn new(surface: &Surface, places: &[u32], triangles: &[[u32; 3]]) -> Self {
        let mut used: Vec<(u32, u32)> = triangles.as_flattened().iter().map(|&v| (places[v as usize], v)).collect();
        used.par_sort_unstable();
        used.dedup_by_key(|(place, _)| *place);
        let own = |v: u32| used.partition_point(|(place, _)| *place < places[v as usize]) as u32;
        let mut triangles: Vec<[u32; 3]> = triangles.par_iter().map(|t| from_least(t.map(own))).collect();
        triangles.par_sort_unstable();
        let sheet = Sheet::of_triangles(used.iter().map(|(_, v)| place(surface, *v)).collect(), triangles);
        Self { sheet, places: used.into_iter().map(|(place, _)| place).collect() }
    }
}

impl PlacedSheet {
    fn placed(&self, triangle: u32) -> [u32; 3] {
        from_least(self.sheet.triangles[triangle as usize].map(|v| self.places[v as usize]))
    }

    fn triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        (0..self.sheet.triangles.len() as u32).map(|t| self.placed(t))
    }
}

fn far(shown: &[Shown]) -> Vec<u32> {
    (0..).zip(shown).filter(|(_, shown)| shown.bound.is_infinite()).map(|(t, _)| t).collect()
}

impl<'a> Reference<'a> {
    pub(super) fn new(surface: &'a Surface, places: &'a [u32], sheet: &'a PlacedSheet, tolerance_local: f64) -> Self {
        let corners: Vec<(u32, u32)> =
            sheet.sheet.triangles.iter().zip(0..).flat_map(|(t, number)| t.map(|v| (v, number))).collect();
        Self {
            surface,
            places,
            overlay: Overlay::new(&sheet.sheet),
            sheet,
            edges: special_edges(places, &surface.triangles),
            bad: bad(surface, &surface.triangles).len(),
            stars: Csr::from_pairs(sheet.places.len(), &corners),
            tolerance_local,
        }
    }

    pub(super) fn verdict(&self, proposal: &[[u32; 3]], known: &mut Known, cancel: &Cancel) -> Result<Verdict> {
        let mut faults = self.edge_faults(proposal);
        let bad = bad(self.surface, proposal);
        if bad.len() > self.bad {
            faults.extend(bad.iter().flat_map(|t| self.under(t.map(|v| place(self.surface, v)))));
        }
        let sheet = PlacedSheet::new(self.surface, self.places, proposal);
        let there = self.there(&sheet, known, cancel)?;
        faults.extend(self.farthest(&far(&there), &sheet.sheet));
        let back = self.back(&sheet, known, cancel)?;
        faults.extend(far(&back).iter().filter_map(|t| self.farthest_under(sheet.sheet.corners(*t))));
        if !faults.is_empty() {
            return Ok(Verdict::Refused(faults));
        }
        Ok(Verdict::Kept(there.iter().chain(&back).fold(0.0, |most: f64, shown| most.max(shown.bound))))
    }

    /// From the mesh to a proposal. What showed it of a triangle before, and still is there, shows it.
    fn there(&self, proposal: &PlacedSheet, known: &mut Known, cancel: &Cancel) -> Result<Vec<Shown>> {
        let numbers: HashMap<[u32; 3], u32> = proposal.triangles().zip(0..).collect();
        let still = |t: u32| {
            let (bound, by) = known.there.get(t as usize)?.as_ref()?;
            let [a, b, c, d] = by.map(|triangle| numbers.get(&triangle).copied());
            Some(Shown { bound: *bound, by: Some([a?, b?, c?, d?]) })
        };
        let overlay = Overlay::new(&proposal.sheet);
        let shown = hausdorff::within(&self.sheet.sheet, &overlay, self.tolerance_local, CUTS, still, cancel)?;
        let by = |shown: &Shown| Some((shown.bound, shown.by?.map(|t| proposal.placed(t))));
        known.there = shown.par_iter().map(by).collect();
        Ok(shown)
    }

    /// From a proposal to the mesh, which does not change: what was shown of a triangle stays shown.
    fn back(&self, proposal: &PlacedSheet, known: &mut Known, cancel: &Cancel) -> Result<Vec<Shown>> {
        let still = |t: u32| known.back.get(&proposal.placed(t)).map(|bound| Shown { bound: *bound, by: None });
        let shown = hausdorff::within(&proposal.sheet, &self.overlay, self.tolerance_local, CUTS, still, cancel)?;
        let kept = proposal.triangles().zip(&shown).filter(|(_, shown)| shown.bound.is_finite());
        known.back.extend(kept.map(|(triangle, shown)| (triangle, shown.bound)));
        Ok(shown)
    }

    /// All places around edges that have other triangles than they had.
    fn edge_faults(&self, proposal: &[[u32; 3]]) -> Vec<u32> {
        let edges = special_edges(self.places, proposal);
        let new = edges.iter().filter(|edge| self.edges.binary_search(edge).is_err());
        let lost = self.edges.iter().filter(|edge| edges.binary_search(edge).is_err());
        new.chain(lost).flat_map(|edge| edge.0).flat_map(|place| self.around(place)).collect()
    }

    /// The places that share a triangle with a place.
    pub(super) fn around(&self, place: u32) -> impl Iterator<Item = u32> {
        let own = self.sheet.places.binary_search(&place).ok();
        let triangles = own.map_or(&[][..], |own| self.stars.list(own));
        triangles.iter().flat_map(|t| self.sheet.sheet.triangles[*t as usize]).map(|v| self.sheet.places[v as usize])
    }

    /// Of each of these triangles the corner that is farthest from the proposal, where no corner around it is farther:
    /// to keep the worst place is often enough.
    fn farthest(&self, far: &[u32], proposal: &Sheet<'_>) -> Vec<u32> {
        let slack = 0.125 * self.tolerance_local;
        let distance =
            |v: u32| proposal.near_enough(self.sheet.sheet.positions[v as usize], None, slack).map(|n| n.upper);
        let mut corners: Vec<u32> = far.iter().flat_map(|t| self.sheet.sheet.triangles[*t as usize]).collect();
        corners.sort_unstable();
        corners.dedup();
        let distances: Vec<f64> = corners.par_iter().map(|v| distance(*v).unwrap_or(0.0)).collect();
        let of = |v: u32| corners.binary_search(&v).map_or(0.0, |at| distances[at]);
        let is_top = |v: &u32| {
            let around = self.stars.list(*v as usize).iter().flat_map(|t| self.sheet.sheet.triangles[*t as usize]);
            around.into_iter().all(|other| (of(other), other) <= (of(*v), *v))
        };
        corners.iter().copied().filter(is_top).map(|v| self.sheet.places[v as usize]).collect()
    }

    /// The corners of the mesh's triangle nearest to the middle of a triangle of a proposal: place and number.
    fn nearest(&self, corners: [DVec3; 3]) -> Option<[(DVec3, u32); 3]> {
        let near = self.sheet.sheet.nearest(corners.into_iter().sum::<DVec3>() / 3.0, None, 0.0)?;
        let ids = self.sheet.sheet.triangles[near.triangle as usize];
        Some(ids.map(|v| (self.sheet.sheet.positions[v as usize], self.sheet.places[v as usize])))
    }

    fn under(&self, corners: [DVec3; 3]) -> impl Iterator<Item = u32> {
        self.nearest(corners).into_iter().flatten().map(|(_, number)| number)
    }

    fn farthest_under(&self, corners: [DVec3; 3]) -> Option<u32> {
        let distance = |place: DVec3| distance_to_triangle(place, corners);
        let near = self.nearest(corners)?.into_iter();
        near.max_by(|a, b| distance(a.0).total_cmp(&distance(b.0))).map(|(_, number)| number)
    }
}

/// Sorted by places: borders, and edges where more than two triangles meet or two run the same way.
pub(super) fn special_edges(places: &[u32], triangles: &[[u32; 3]]) -> Vec<Edge> {
    let side = |(a, b): (u32, u32)| ([a.min(b), a.max(b)], if a < b { 1 } else { -1 });
    let sides = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| places[v as usize]);
        [(a, b), (b, c), (c, a)].map(side)
    };
    let mut all: Vec<([u32; 2], i32)> = triangles.par_iter().flat_map_iter(sides).collect();
    all.par_sort_unstable();
    let edge = |group: &[([u32; 2], i32)]| (group[0].0, group.iter().map(|side| side.1).sum(), group.len() as u32);
    all.chunk_by(|a, b| a.0 == b.0).map(edge).filter(|(_, ways, triangles)| *ways != 0 || *triangles > 2).collect()
}

/// Triangles that face against the normals of their corners, and those that are too thin to face anywhere.
fn bad(surface: &Surface, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let is_bad = |t: &&[u32; 3]| {
        let [a, b, c] = t.map(|v| place(surface, v));
        let normal: DVec3 = t.iter().map(|v| DVec3::from_array(surface.normals[*v as usize].map(f64::from))).sum();
        let double_area = (b - a).cross(c - a);
        let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
        double_area.dot(normal) <= 0.0 || double_area.length() <= THIN * longest
    };
    triangles.par_iter().filter(is_bad).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plane of 3 x 3 squares of side 1 with its middle vertices raised.
    fn hill(height: f32) -> Surface {
        let at = |i: u32| [i % 4, i / 4];
        let is_inner = |[x, z]: [u32; 2]| (1..3).contains(&x) && (1..3).contains(&z);
        let place = |i: u32| [at(i)[0] as f32, if is_inner(at(i)) { height } else { 0.0 }, at(i)[1] as f32];
        let corners = (0..16).filter(|&i| at(i)[0] < 3 && at(i)[1] < 3);
        Surface {
            positions: (0..16).map(place).collect(),
            normals: vec![[0.0, 1.0, 0.0]; 16],
            triangles: corners.flat_map(|i| [[i, i + 4, i + 1], [i + 1, i + 4, i + 5]]).collect(),
            ..Surface::default()
        }
    }

    fn verdict(surface: &Surface, proposal: &[[u32; 3]], tolerance: f64) -> Verdict {
        let places: Vec<u32> = (0..16).collect();
        let sheet = PlacedSheet::new(surface, &places, &surface.triangles);
        let reference = Reference::new(surface, &places, &sheet, tolerance);
        reference.verdict(proposal, &mut Known::default(), &Cancel::default()).expect("nobody cancels")
    }

    /// All of the border, and nothing inside.
    const FLAT: [[u32; 3]; 10] = [
        [0, 4, 1],
        [1, 4, 2],
        [2, 4, 8],
        [2, 8, 3],
        [3, 8, 7],
        [7, 8, 11],
        [11, 8, 12],
        [11, 12, 13],
        [11, 13, 14],
        [11, 14, 15],
    ];

    #[test]
    fn a_proposal_is_kept_with_its_distance_where_it_is_near_enough() {
        let Verdict::Kept(distance) = verdict(&hill(0.01), &FLAT, 0.02) else { panic!("it is near enough") };
        assert!((0.01..0.011).contains(&distance), "{distance}");
    }

    #[test]
    fn a_proposal_that_breaks_the_tolerance_is_refused_for_the_farthest_places() {
        let Verdict::Refused(faults) = verdict(&hill(0.01), &FLAT, 0.005) else { panic!("it is too far") };
        assert!(faults.iter().any(|place| [5, 6, 9, 10].contains(place)), "{faults:?}");
    }

    #[test]
    fn a_proposal_that_opens_or_turns_anything_is_refused() {
        let surface = hill(0.0);
        assert!(matches!(verdict(&surface, &FLAT, 1.0), Verdict::Kept(_)));
        assert!(matches!(verdict(&surface, &FLAT[1..], 9.0), Verdict::Refused(_)), "a triangle is missing");
        let mut turned = FLAT;
        turned[4].swap(0, 1);
        assert!(matches!(verdict(&surface, &turned, 9.0), Verdict::Refused(_)), "a triangle faces down");
    }
}
