//! What of a proposal is refused: what opens or joins anything, what turns triangles over or leaves them without area,
//! and what is not shown to be near enough.

use glam::DVec3;

use super::patch::place;
use crate::{
    domain::{Result, cancel::Cancel, surface::Surface},
    oracle::{hausdorff, sheet::Sheet},
};

/// Cuts for each triangle before the search for a bound is given up.
const CUTS: u64 = 64;
/// Height of a triangle over its longest side, as a share of it, below which f32 places tell nothing of its normal.
const THIN: f64 = 1e-5;

/// The part of a mesh that proposals are to stand for.
pub(super) struct Reference<'a> {
    surface: &'a Surface,
    /// Of every fine vertex.
    places: &'a [u32],
    sheet: Sheet<'static>,
    edges: Vec<Edge>,
    bad: usize,
    tolerance_local: f64,
}

/// An edge that is not one of two triangles that run along it both ways: its places, the difference of the two ways,
/// and all its triangles.
type Edge = ([u32; 2], i32, u32);

impl<'a> Reference<'a> {
    pub(super) fn new(surface: &'a Surface, places: &'a [u32], triangles: &[[u32; 3]], tolerance_local: f64) -> Self {
        Self {
            surface,
            places,
            sheet: sheet(surface, places, triangles),
            edges: special_edges(places, triangles),
            bad: bad(surface, triangles),
            tolerance_local,
        }
    }

    /// How far the proposal is at most from what it stands for, both ways; none where it is refused.
    pub(super) fn distance(&self, proposal: &[[u32; 3]], cancel: &Cancel) -> Result<Option<f64>> {
        if bad(self.surface, proposal) > self.bad || special_edges(self.places, proposal) != self.edges {
            return Ok(None);
        }
        let sheet = sheet(self.surface, self.places, proposal);
        let cuts = CUTS * (self.sheet.triangles.len() + sheet.triangles.len()) as u64;
        let within = |a, b| hausdorff::within(a, b, self.tolerance_local, cuts, cancel);
        let Some(there) = within(&self.sheet, &sheet)? else { return Ok(None) };
        Ok(within(&sheet, &self.sheet)?.map(|back| back.max(there)))
    }
}

fn sheet(surface: &Surface, places: &[u32], triangles: &[[u32; 3]]) -> Sheet<'static> {
    let mut used: Vec<(u32, u32)> = triangles.as_flattened().iter().map(|&v| (places[v as usize], v)).collect();
    used.sort_unstable();
    used.dedup_by_key(|(place, _)| *place);
    let own = |v: u32| used.partition_point(|(place, _)| *place < places[v as usize]) as u32;
    let triangles = triangles.iter().map(|t| t.map(own)).collect();
    Sheet::of_triangles(used.iter().map(|(_, v)| place(surface, *v)).collect(), triangles)
}

/// Sorted by places: borders, and edges where more than two triangles meet or two run the same way.
pub(super) fn special_edges(places: &[u32], triangles: &[[u32; 3]]) -> Vec<Edge> {
    let side = |(a, b): (u32, u32)| ([a.min(b), a.max(b)], if a < b { 1 } else { -1 });
    let sides = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| places[v as usize]);
        [(a, b), (b, c), (c, a)].map(side)
    };
    let mut all: Vec<([u32; 2], i32)> = triangles.iter().flat_map(sides).collect();
    all.sort_unstable();
    let edge = |group: &[([u32; 2], i32)]| {
        (group[0].0, group.iter().map(|side| side.1).sum(), group.len() as u32)
    };
    all.chunk_by(|a, b| a.0 == b.0).map(edge).filter(|(_, ways, triangles)| *ways != 0 || *triangles > 2).collect()
}

/// Triangles that face against the normals of their corners, and those that are too thin to face anywhere.
fn bad(surface: &Surface, triangles: &[[u32; 3]]) -> usize {
    let is_bad = |t: &&[u32; 3]| {
        let [a, b, c] = t.map(|v| place(surface, v));
        let normal: DVec3 = t.iter().map(|v| DVec3::from_array(surface.normals[*v as usize].map(f64::from))).sum();
        let double_area = (b - a).cross(c - a);
        let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
        double_area.dot(normal) <= 0.0 || double_area.length() <= THIN * longest
    };
    triangles.iter().filter(is_bad).count()
}
