//! The numbering of a surface that is finer where it needs to be.

use displace_glsl::layout::refine::UNIT;

use super::Place;
use crate::domain::mesh::{Csr, Mesh};

/// Inner vertices of edges and triangles in rising order, so that a primitive's are contiguous. Every list of firsts
/// has one entry more than there are owners: owner i has entries `first[i]..first[i + 1]`. Aes of one ge have equal
/// lists.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Pieces {
    /// Inner vertices of each ae, from its first av to its second.
    pub edge_first: Vec<u32>,
    /// How far along the ae each is, in units of 2^-24 (`displace_glsl::layout::refine::UNIT`).
    pub edge_place: Vec<u32>,
    /// Inner vertices of each base triangle.
    pub interior_first: Vec<u32>,
    /// Weights of the second and the third corner, in units of 2^-24, the third's rising, then the second's.
    pub interior_place: Vec<[u32; 2]>,
    /// Fine triangles of each base triangle.
    pub triangle_first: Vec<u32>,
    /// Whether fine triangles may span several base triangles of a primitive, each of them owned by one that has one of
    /// its corners, and whether vertices may be of no fine triangle. Else the fine triangles of a base triangle tile it.
    pub is_spanning: bool,
}

/// A surface without normals and attributes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shape {
    pub pieces: Pieces,
    /// Of every fine vertex, mesh-local units.
    pub positions: Vec<[f32; 3]>,
    /// Fine vertex ids, sorted by base triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl Pieces {
    pub(super) fn on_edge(&self, entry: usize) -> Place {
        Place::Edge { ae: owner(&self.edge_first, entry), along: self.edge_place[entry] }
    }

    pub(super) fn inside(&self, entry: usize) -> Place {
        Place::Inside { triangle: owner(&self.interior_first, entry), b: self.interior_place[entry] }
    }

    /// The base triangle of a fine triangle.
    #[must_use]
    pub fn base_of(&self, triangle: usize) -> usize {
        owner(&self.triangle_first, triangle) as usize
    }

    /// What of the invariants does not hold.
    pub(super) fn fault(&self, mesh: &Mesh) -> Option<String> {
        let triangles = mesh.triangles.len();
        // How many fine triangles there are is the surface's to know.
        let fine = self.triangle_first.last().map_or(0, |last| *last as usize);
        (list_fault("edge_first", &self.edge_first, mesh.ae_av.len(), self.edge_place.len()))
            .or_else(|| list_fault("interior_first", &self.interior_first, triangles, self.interior_place.len()))
            .or_else(|| list_fault("triangle_first", &self.triangle_first, triangles, fine))
            .or_else(|| self.edge_fault(&mesh.ge_ae))
            .or_else(|| self.interior_fault())
    }

    fn edge_fault(&self, ge_ae: &Csr) -> Option<String> {
        let of = |ae: u32| list(&self.edge_first, &self.edge_place, ae as usize);
        let inner = |place: &u32| (1..UNIT).contains(place);
        let disorder = |ae: u32| !of(ae).iter().all(inner) || !of(ae).is_sorted_by(|a, b| a < b);
        if let Some(ae) = (0..self.edge_first.len() as u32 - 1).find(|ae| disorder(*ae)) {
            return Some(format!("places of ae {ae} do not rise from 1 to {}", UNIT - 1));
        }
        let differs = |aes: &[u32]| aes.windows(2).any(|pair| of(pair[0]) != of(pair[1]));
        let ge = (0..ge_ae.offsets.len().saturating_sub(1)).find(|ge| differs(ge_ae.list(*ge)))?;
        Some(format!("the aes of ge {ge} differ"))
    }

    fn interior_fault(&self) -> Option<String> {
        let inner = |[b1, b2]: &[u32; 2]| *b1 > 0 && *b2 > 0 && b1.saturating_add(*b2) < UNIT;
        let of = |t: usize| list(&self.interior_first, &self.interior_place, t);
        let disorder =
            |t: &usize| !of(*t).iter().all(inner) || !of(*t).is_sorted_by(|a, b| (a[1], a[0]) < (b[1], b[0]));
        let t = (0..self.interior_first.len() - 1).find(disorder)?;
        Some(format!("places of base triangle {t} are not within it, or do not rise"))
    }
}

/// Whose list an entry is in; owners without entries are passed over.
fn owner(firsts: &[u32], entry: usize) -> u32 {
    firsts.partition_point(|first| *first as usize <= entry) as u32 - 1
}

fn list<'a, T>(firsts: &[u32], entries: &'a [T], owner: usize) -> &'a [T] {
    &entries[firsts[owner] as usize..firsts[owner + 1] as usize]
}

fn list_fault(name: &str, firsts: &[u32], owners: usize, entries: usize) -> Option<String> {
    let sound = firsts.len() == owners + 1
        && firsts.is_sorted()
        && firsts[0] == 0
        && firsts.last().is_some_and(|last| *last as usize == entries);
    (!sound).then(|| format!("{name} does not rise from 0 to {entries} in {} entries", owners + 1))
}
