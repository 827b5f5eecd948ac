//! How the fine vertices and triangles of a surface are numbered, and where on the base mesh each vertex lies.

use std::{ops::Range, sync::Arc};

use displace_glsl::{lattice, layout::refine::UNIT};

use super::Pieces;
use crate::domain::mesh::{Mesh, Primitive};

/// Fine vertices come in three blocks: the base avs; then, for each ae, its inner vertices from the ae's first av to
/// its second; then, for each base triangle, its inner vertices, in rows of one b2, b1 rising. Fine triangles are
/// sorted by base triangle.
#[derive(Clone, Debug, PartialEq)]
pub enum Layout {
    /// 2^level segments on each edge, and all points of the lattice between (see `displace_glsl::lattice`).
    Uniform { level: u32 },
    /// As many as listed.
    Pieces(Arc<Pieces>),
}

impl Default for Layout {
    /// The base mesh itself.
    fn default() -> Self {
        Self::Uniform { level: 0 }
    }
}

impl Layout {
    #[must_use]
    pub fn vertices(&self, mesh: &Mesh) -> usize {
        self.blocks(mesh)[2].end
    }

    #[must_use]
    pub fn triangles(&self, mesh: &Mesh) -> usize {
        self.triangle_entries(&(0..mesh.triangles.len() as u32)).end
    }

    /// Corners, edges and interiors of the whole mesh.
    #[must_use]
    pub fn blocks(&self, mesh: &Mesh) -> [Range<usize>; 3] {
        let corners = mesh.av_gv.len();
        let edges = corners + self.edge_entries(&(0..mesh.ae_av.len() as u32)).end;
        let interiors = edges + self.interior_entries(&(0..mesh.triangles.len() as u32)).end;
        [0..corners, corners..edges, edges..interiors]
    }

    /// The three ranges of fine vertices of one primitive: corners, edges, interiors.
    #[must_use]
    pub fn vertices_of(&self, mesh: &Mesh, primitive: &Primitive) -> [Range<usize>; 3] {
        let [_, edges, interiors] = self.blocks(mesh);
        [
            scaled(&primitive.avs, 1),
            after(edges.start, &self.edge_entries(&primitive.aes)),
            after(interiors.start, &self.interior_entries(&primitive.triangles)),
        ]
    }

    /// Inner vertices of an ae, from its first av to its second.
    #[must_use]
    pub fn edge_vertices(&self, mesh: &Mesh, ae: u32) -> Range<usize> {
        after(mesh.av_gv.len(), &self.edge_entries(&(ae..ae + 1)))
    }

    /// Fine triangles of a base triangle.
    #[must_use]
    pub fn triangles_of(&self, base_triangle: usize) -> Range<usize> {
        let first = base_triangle as u32;
        self.triangle_entries(&(first..first + 1))
    }

    /// Fine triangles of a primitive.
    #[must_use]
    pub fn triangles_of_primitive(&self, primitive: &Primitive) -> Range<usize> {
        self.triangle_entries(&primitive.triangles)
    }

    /// The base triangle of a fine triangle.
    #[must_use]
    pub fn base_of(&self, triangle: usize) -> u32 {
        match self {
            Self::Uniform { level } => (triangle >> (2 * level)) as u32,
            Self::Pieces(pieces) => pieces.base_of(triangle) as u32,
        }
    }

    /// Whether fine triangles may span several base triangles; see [`Pieces::is_spanning`].
    #[must_use]
    pub fn is_spanning(&self) -> bool {
        matches!(self, Self::Pieces(pieces) if pieces.is_spanning)
    }

    /// What is wrong with the lists, if anything; all else about a layout may be asked only where nothing is.
    #[must_use]
    pub fn fault(&self, mesh: &Mesh) -> Option<String> {
        match self {
            Self::Uniform { .. } => None,
            Self::Pieces(pieces) => pieces.fault(mesh),
        }
    }

    /// Where a fine vertex lies.
    #[must_use]
    pub fn place(&self, mesh: &Mesh, vertex: usize) -> Place {
        let [corners, edges, interiors] = self.blocks(mesh);
        if vertex < corners.end {
            Place::Corner { av: vertex as u32 }
        } else if vertex < edges.end {
            self.on_edge(vertex - edges.start)
        } else {
            self.inside(vertex - interiors.start)
        }
    }

    fn on_edge(&self, entry: usize) -> Place {
        match self {
            Self::Uniform { level } => {
                let points = lattice::edge_points(*level) as usize;
                let along = (entry % points + 1) as u32 * (UNIT >> level);
                Place::Edge { ae: (entry / points) as u32, along }
            }
            Self::Pieces(pieces) => pieces.on_edge(entry),
        }
    }

    fn inside(&self, entry: usize) -> Place {
        match self {
            Self::Uniform { level } => {
                let points = lattice::interior_points(*level) as usize;
                let (i, j) = lattice::interior_point(*level, (entry % points) as u64);
                let b = [i, j].map(|steps| steps as u32 * (UNIT >> level));
                Place::Inside { triangle: (entry / points) as u32, b }
            }
            Self::Pieces(pieces) => pieces.inside(entry),
        }
    }

    fn edge_entries(&self, aes: &Range<u32>) -> Range<usize> {
        match self {
            Self::Uniform { level } => scaled(aes, lattice::edge_points(*level)),
            Self::Pieces(pieces) => listed(&pieces.edge_first, aes),
        }
    }

    fn interior_entries(&self, triangles: &Range<u32>) -> Range<usize> {
        match self {
            Self::Uniform { level } => scaled(triangles, lattice::interior_points(*level)),
            Self::Pieces(pieces) => listed(&pieces.interior_first, triangles),
        }
    }

    fn triangle_entries(&self, triangles: &Range<u32>) -> Range<usize> {
        match self {
            Self::Uniform { level } => scaled(triangles, 1 << (2 * level)),
            Self::Pieces(pieces) => listed(&pieces.triangle_first, triangles),
        }
    }
}

/// What a fine vertex lies on. Lengths count units of 2^-24 of a side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    Corner {
        av: u32,
    },
    /// `along` from the ae's first av.
    Edge {
        ae: u32,
        along: u32,
    },
    /// `b` are the weights of the base triangle's second and third corner.
    Inside {
        triangle: u32,
        b: [u32; 2],
    },
}

impl Place {
    /// Three base avs and their weights, of sum 1. An av that is repeated has weight 0.
    #[must_use]
    pub fn site(self, mesh: &Mesh) -> ([u32; 3], [f64; 3]) {
        let (avs, units) = match self {
            Self::Corner { av } => ([av; 3], [UNIT, 0, 0]),
            Self::Edge { ae, along } => {
                let [from, to] = mesh.ae_av[ae as usize];
                ([from, to, to], [UNIT - along, along, 0])
            }
            Self::Inside { triangle, b } => (mesh.triangles[triangle as usize].av, weights(b)),
        };
        (avs, units.map(|units| f64::from(units) / f64::from(UNIT)))
    }

    /// Weights of the corners of base triangle `t`, in units; none where the vertex is not of it.
    #[must_use]
    pub fn within(self, mesh: &Mesh, t: usize) -> Option<[u32; 3]> {
        let triangle = mesh.triangles.get(t)?;
        let mut units = [0; 3];
        match self {
            Self::Corner { av } => units[triangle.av.iter().position(|own| *own == av)?] = UNIT,
            Self::Edge { ae, along } => {
                let side = triangle.ae.iter().position(|own| *own == ae)?;
                let forward = mesh.ae_av[ae as usize][0] == triangle.av[side];
                let along = if forward { along } else { UNIT - along };
                (units[side], units[(side + 1) % 3]) = (UNIT - along, along);
            }
            Self::Inside { triangle, b } if triangle as usize == t => units = weights(b),
            Self::Inside { .. } => return None,
        }
        Some(units)
    }
}

/// From those of the second and the third corner.
fn weights([b1, b2]: [u32; 2]) -> [u32; 3] {
    [UNIT - b1 - b2, b1, b2]
}

/// `each` entries for every item.
fn scaled(items: &Range<u32>, each: u64) -> Range<usize> {
    items.start as usize * each as usize..items.end as usize * each as usize
}

/// The entries of items whose lists begin at `firsts`.
fn listed(firsts: &[u32], items: &Range<u32>) -> Range<usize> {
    firsts[items.start as usize] as usize..firsts[items.end as usize] as usize
}

fn after(first: usize, entries: &Range<usize>) -> Range<usize> {
    first + entries.start..first + entries.end
}
