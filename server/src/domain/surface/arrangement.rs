//! From a refined mesh, whose vertices and triangles come in any order, to fine vertices in the order of a surface.

use displace_glsl::layout::refine::{RefinedTriangle, RefinedVertex, kind};
use rayon::prelude::*;

use super::{Pieces, Shape};
use crate::domain::{
    Error, Result,
    mesh::Mesh,
    plan::{MAX_PAGES, PAGE_ELEMENTS},
};

/// A refined mesh as fine vertices and triangles. The numbers are those of places alone: the same refinement gives the
/// same, however its vertices and triangles are numbered.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Arrangement {
    pub pieces: Pieces,
    /// The refined vertex of each fine vertex.
    pub refined_of_fine: Vec<u32>,
    /// Fine vertex ids, from the lowest on, sorted by base triangle and then by ids.
    pub triangles: Vec<[u32; 3]>,
}

impl Arrangement {
    /// Sorts a conforming refinement of `mesh`: no two vertices in one place, and every base gv among them. Inner
    /// vertices that no triangle uses are left out. Fails with `TooLarge` where there are more fine vertices or
    /// triangles than fit, and with `Internal` where a triangle is not of the base triangle it names.
    pub fn of(mesh: &Mesh, vertices: &[RefinedVertex], triangles: &[RefinedTriangle]) -> Result<Self> {
        let sorted = Sorted::of(mesh, vertices, &used(vertices.len(), triangles)?);
        let pieces = sorted.pieces(mesh, triangles)?;
        check_size(mesh, mesh.av_gv.len() + pieces.edge_place.len() + pieces.interior_place.len(), triangles.len())?;
        let numbers = Numbers { mesh, vertices, sorted: &sorted, pieces: &pieces };
        let mut fine: Vec<(u32, [u32; 3])> = triangles
            .par_iter()
            .map(|triangle| numbers.triangle(triangle).ok_or_else(|| misplaced(triangle)))
            .collect::<Result<_>>()?;
        fine.par_sort_unstable();
        Ok(Self {
            refined_of_fine: sorted.refined_of_fine(mesh)?,
            triangles: fine.into_iter().map(|(_, ids)| ids).collect(),
            pieces,
        })
    }

    /// With the position of every refined vertex.
    #[must_use]
    pub fn placed(self, positions: &[[f32; 3]]) -> Shape {
        let positions = self.refined_of_fine.par_iter().map(|vertex| positions[*vertex as usize]).collect();
        Shape { pieces: self.pieces, positions, triangles: self.triangles }
    }
}

fn misplaced(triangle: &RefinedTriangle) -> Error {
    Error::internal(format!("{triangle:?} has a corner that is not of its base triangle"))
}

fn check_size(mesh: &Mesh, vertices: usize, triangles: usize) -> Result<()> {
    let limit = PAGE_ELEMENTS * MAX_PAGES;
    if vertices as u64 <= limit && triangles as u64 <= limit {
        return Ok(());
    }
    let message = format!(
        "{triangles} triangles and {vertices} vertices of mesh '{}'; at most {limit} of each fit one mesh: allow fewer triangles",
        mesh.name
    );
    Err(Error::too_large("geometry.max_triangles", message))
}

/// Which refined vertices are corners of triangles.
fn used(vertices: usize, triangles: &[RefinedTriangle]) -> Result<Vec<bool>> {
    let mut used = vec![false; vertices];
    for triangle in triangles {
        for gv in triangle.gv {
            *used.get_mut(gv as usize).ok_or_else(|| misplaced(triangle))? = true;
        }
    }
    Ok(used)
}

/// A vertex that base ge or base triangle `owner` has, by what it is sorted by.
type Entry = (u32, [u32; 2], u32);

/// Inner vertices by owner and place.
struct Sorted {
    /// Refined vertex of each base gv.
    corners: Vec<Option<u32>>,
    /// (ge, [along, 0], refined vertex)
    edges: Vec<Entry>,
    /// First entry of each ge, and the end.
    edge_first: Vec<u32>,
    /// (base triangle, [b2, b1], refined vertex)
    interiors: Vec<Entry>,
    interior_first: Vec<u32>,
    /// Each refined vertex's number among those of its owner.
    rank: Vec<u32>,
}

impl Sorted {
    fn of(mesh: &Mesh, vertices: &[RefinedVertex], used: &[bool]) -> Self {
        let mut sorted = Self {
            corners: vec![None; mesh.gv_position.len()],
            edges: Vec::new(),
            edge_first: Vec::new(),
            interiors: Vec::new(),
            interior_first: Vec::new(),
            rank: vec![0; vertices.len()],
        };
        for (number, vertex) in (0..).zip(vertices) {
            sorted.put(number, vertex, used[number as usize]);
        }
        sorted.edges.par_sort_unstable();
        sorted.interiors.par_sort_unstable();
        sorted.edge_first = firsts(mesh.ge_gv.len(), &sorted.edges, &mut sorted.rank);
        sorted.interior_first = firsts(mesh.triangles.len(), &sorted.interiors, &mut sorted.rank);
        sorted
    }

    fn put(&mut self, number: u32, vertex: &RefinedVertex, used: bool) {
        let [first, second] = vertex.param;
        match vertex.kind {
            kind::CORNER => {
                if let Some(corner) = self.corners.get_mut(vertex.owner as usize) {
                    *corner = Some(number);
                }
            }
            kind::EDGE if used => self.edges.push((vertex.owner, [first, 0], number)),
            kind::INTERIOR if used => self.interiors.push((vertex.owner, [second, first], number)),
            _ => {}
        }
    }

    fn of_edge(&self, ge: u32) -> &[Entry] {
        &self.edges[self.edge_first[ge as usize] as usize..self.edge_first[ge as usize + 1] as usize]
    }

    fn pieces(&self, mesh: &Mesh, triangles: &[RefinedTriangle]) -> Result<Pieces> {
        let mut pieces =
            Pieces { edge_first: vec![0], interior_first: self.interior_first.clone(), ..Pieces::default() };
        for ge in &mesh.ae_ge {
            pieces.edge_place.extend(self.of_edge(*ge).iter().map(|(_, [along, _], _)| *along));
            pieces.edge_first.push(pieces.edge_place.len() as u32);
        }
        pieces.interior_place = self.interiors.iter().map(|(_, [b2, b1], _)| [*b1, *b2]).collect();
        pieces.triangle_first = vec![0; mesh.triangles.len() + 1];
        for triangle in triangles {
            let count = pieces.triangle_first.get_mut(triangle.base as usize + 1);
            *count.ok_or_else(|| misplaced(triangle))? += 1;
        }
        accumulate(&mut pieces.triangle_first);
        Ok(pieces)
    }

    fn refined_of_fine(&self, mesh: &Mesh) -> Result<Vec<u32>> {
        let corner = |gv: &u32| {
            self.corners[*gv as usize].ok_or_else(|| Error::internal(format!("base gv {gv} is not refined")))
        };
        let mut refined: Vec<u32> = mesh.av_gv.iter().map(corner).collect::<Result<_>>()?;
        refined.extend(mesh.ae_ge.iter().flat_map(|ge| self.of_edge(*ge)).map(|entry| entry.2));
        refined.extend(self.interiors.iter().map(|entry| entry.2));
        Ok(refined)
    }
}

/// The first entry of each owner, and the end. Notes the rank of every entry's vertex.
fn firsts(owners: usize, entries: &[Entry], rank: &mut [u32]) -> Vec<u32> {
    let mut firsts = vec![0; owners + 1];
    for list in entries.chunk_by(|a, b| a.0 == b.0) {
        for (number, (owner, _, vertex)) in (0..).zip(list) {
            rank[*vertex as usize] = number;
            if let Some(count) = firsts.get_mut(*owner as usize + 1) {
                *count = number + 1;
            }
        }
    }
    accumulate(&mut firsts);
    firsts
}

fn accumulate(counts: &mut [u32]) {
    let mut sum = 0;
    for count in counts {
        sum += *count;
        *count = sum;
    }
}

/// Numbers refined vertices as fine ones.
struct Numbers<'a> {
    mesh: &'a Mesh,
    vertices: &'a [RefinedVertex],
    sorted: &'a Sorted,
    pieces: &'a Pieces,
}

impl Numbers<'_> {
    /// The base triangle and the corners, the lowest first; none where a corner is not of the base triangle.
    fn triangle(&self, triangle: &RefinedTriangle) -> Option<(u32, [u32; 3])> {
        let [a, b, c] = triangle.gv.map(|vertex| self.corner(triangle.base, vertex));
        let mut ids = [a?, b?, c?];
        let lowest = (0..3).min_by_key(|k| ids[*k])?;
        ids.rotate_left(lowest);
        Some((triangle.base, ids))
    }

    /// The fine vertex of base triangle `t` that lies where a refined vertex does.
    fn corner(&self, t: u32, number: u32) -> Option<u32> {
        let (triangle, corners) = (&self.mesh.triangles[t as usize], self.mesh.av_gv.len() as u32);
        let vertex = &self.vertices[number as usize];
        let rank = self.sorted.rank[number as usize];
        match vertex.kind {
            kind::CORNER => triangle.av.into_iter().find(|av| self.mesh.av_gv[*av as usize] == vertex.owner),
            kind::EDGE => {
                let ae = triangle.ae.into_iter().find(|ae| self.mesh.ae_ge[*ae as usize] == vertex.owner)?;
                Some(corners + self.pieces.edge_first[ae as usize] + rank)
            }
            _ if vertex.owner == t => {
                let edges = self.pieces.edge_place.len() as u32;
                Some(corners + edges + self.pieces.interior_first[t as usize] + rank)
            }
            _ => None,
        }
    }
}
