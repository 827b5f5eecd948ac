//! Twin of the `refine_*` passes: one round of longest-edge bisection owned by edges (Rivara 1984; templates of
//! Plaza and Carey 2000). All but lengths is whole numbers, so device and twin agree to the bit.

use super::keys::{self, step};
use crate::layout::refine::{RefineBase, RefinedEdge, RefinedTriangle, RefinedVertex, UNIT, kind};

/// The base mesh as refinement sees it.
#[derive(Clone, Debug, Default)]
pub struct Base {
    pub triangles: Vec<RefineBase>,
    /// gvs of each ge, the first the lower.
    pub edges: Vec<[u32; 2]>,
    /// A triangle and its side for each ge.
    pub edge_side: Vec<[u32; 2]>,
    /// Positions of gvs, local units.
    pub positions: Vec<[f32; 3]>,
    /// Of gvs; see [`keys`].
    pub keys: Vec<u32>,
}

impl Base {
    #[must_use]
    pub fn new(triangles: Vec<RefineBase>, edges: Vec<[u32; 2]>, positions: Vec<[f32; 3]>) -> Self {
        let mut edge_side = vec![[0; 2]; edges.len()];
        for (t, triangle) in (0..triangles.len() as u32).zip(&triangles).rev() {
            triangle.ge.iter().zip(0u32..).for_each(|(ge, side)| edge_side[*ge as usize] = [t, side]);
        }
        let keys = positions.iter().map(|position| keys::corner(*position)).collect();
        Self { triangles, edges, edge_side, positions, keys }
    }
}

/// The refined mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Refined {
    pub vertices: Vec<RefinedVertex>,
    pub edges: Vec<RefinedEdge>,
    pub triangles: Vec<RefinedTriangle>,
    /// 0 of triangles that the last round made.
    pub states: Vec<u32>,
}

/// Where a vertex lies in a base triangle that has it, in units.
#[must_use]
pub fn barycentrics(vertex: &RefinedVertex, base: &RefineBase) -> [u32; 3] {
    match vertex.kind {
        kind::CORNER => base.gv.map(|gv| if gv == vertex.owner { UNIT } else { 0 }),
        kind::EDGE => {
            let side = base.ge.iter().position(|ge| *ge == vertex.owner).unwrap_or(2);
            let along = vertex.param[0];
            let along = if base.reversed >> side & 1 == 1 { UNIT - along } else { along };
            let mut b = [0; 3];
            (b[side], b[(side + 1) % 3]) = (UNIT - along, along);
            b
        }
        _ => [UNIT - vertex.param[0] - vertex.param[1], vertex.param[0], vertex.param[1]],
    }
}

/// The side to split first.
#[must_use]
pub fn longest_side(edges: &[RefinedEdge], triangle: &RefinedTriangle) -> usize {
    let rank = triangle.ge.map(|ge| (edges[ge as usize].length_square.to_bits(), edges[ge as usize].key));
    (1..3).fold(0, |best, k| if rank[k] > rank[best] { k } else { best })
}

/// Marks of edges: the longest sides of wanted triangles, and of all that get a hanging vertex by them.
#[must_use]
pub fn marks(refined: &Refined, wanted: &[u32]) -> Vec<u32> {
    let mut marks = vec![0; refined.edges.len()];
    let longest = |t: &RefinedTriangle| t.ge[longest_side(&refined.edges, t)] as usize;
    let first = refined.triangles.iter().zip(wanted).filter(|(_, wanted)| **wanted == 1);
    first.for_each(|(triangle, _)| marks[longest(triangle)] = 1);
    let mut changed = true;
    while changed {
        changed = false;
        for triangle in &refined.triangles {
            let hangs = triangle.ge.iter().any(|ge| marks[*ge as usize] == 1);
            if hangs && marks[longest(triangle)] == 0 {
                marks[longest(triangle)] = 1;
                changed = true;
            }
        }
    }
    marks
}

impl Refined {
    /// The base mesh itself.
    #[must_use]
    pub fn of(base: &Base) -> Self {
        let corner = |owner: u32| RefinedVertex { kind: kind::CORNER, owner, param: [0; 2] };
        let edge = |(owner, gv): (u32, &[u32; 2])| {
            let [a, b] = gv.map(|gv| base.positions[gv as usize]);
            let key = keys::edge(gv.map(|gv| base.keys[gv as usize]));
            RefinedEdge { gv: *gv, length_square: length_square(a, b), kind: kind::EDGE, owner, key }
        };
        let triangle = |(t, base): (u32, &RefineBase)| RefinedTriangle { gv: base.gv, ge: base.ge, base: t };
        Self {
            vertices: (0..base.positions.len() as u32).map(corner).collect(),
            edges: (0..).zip(&base.edges).map(edge).collect(),
            triangles: (0..).zip(&base.triangles).map(triangle).collect(),
            states: vec![0; base.triangles.len()],
        }
    }

    /// Whether all middles are whole numbers of units.
    #[must_use]
    pub fn halves_exactly(&self, base: &Base, marks: &[u32]) -> bool {
        let marked = self.edges.iter().zip(marks).filter(|(_, mark)| **mark == 1);
        marked.map(|(edge, _)| edge).all(|edge| self.sums(base, edge).iter().all(|sum| sum % 2 == 0))
    }

    /// The next round.
    #[must_use]
    pub fn split(&self, base: &Base, marks: &[u32]) -> Self {
        let mut next = Self { vertices: self.vertices.clone(), ..Self::default() };
        let (sums, marked) = super::scan::exclusive_sums(marks);
        let whole = |ge: u32| (u64::from(ge) - sums[ge as usize]) as u32;
        let first_half = |ge: u32| (self.edges.len() as u64 - marked + 2 * sums[ge as usize]) as u32;
        let vertex = |ge: u32| (self.vertices.len() as u64 + sums[ge as usize]) as u32;
        next.edges = self.edges.iter().zip(marks).filter(|(_, mark)| **mark == 0).map(|(edge, _)| *edge).collect();
        for (ge, edge) in (0..).zip(&self.edges).filter(|(ge, _)| marks[*ge as usize] == 1) {
            next.vertices.push(self.midpoint(base, edge));
            let key = keys::next(edge.key, step::HALF);
            let half = RefinedEdge { length_square: edge.length_square * 0.25, key, ..*edge };
            next.edges.push(RefinedEdge { gv: [edge.gv[0], vertex(ge)], ..half });
            next.edges.push(RefinedEdge { gv: [vertex(ge), edge.gv[1]], ..half });
        }
        for (triangle, state) in self.triangles.iter().zip(&self.states) {
            let side = |k: usize| {
                let ge = triangle.ge[k];
                let edge = &self.edges[ge as usize];
                if marks[ge as usize] == 0 {
                    return Side { vertex: None, halves: [whole(ge); 2], key: edge.key };
                }
                let first = first_half(ge);
                let halves = if edge.gv[0] == triangle.gv[k] { [first, first + 1] } else { [first + 1, first] };
                Side { vertex: Some(vertex(ge)), halves, key: edge.key }
            };
            next.put(base, triangle, *state, longest_side(&self.edges, triangle), [side(0), side(1), side(2)]);
        }
        next
    }

    fn midpoint(&self, base: &Base, edge: &RefinedEdge) -> RefinedVertex {
        RefinedVertex { kind: edge.kind, owner: edge.owner, param: self.sums(base, edge).map(|sum| sum / 2) }
    }

    /// The parameters of both ends, added.
    fn sums(&self, base: &Base, edge: &RefinedEdge) -> [u32; 2] {
        let ends = edge.gv.map(|gv| self.vertices[gv as usize]);
        if edge.kind == kind::EDGE {
            let first = base.edges[edge.owner as usize][0];
            let along = ends.map(|end| match end.kind {
                kind::CORNER if end.owner == first => 0,
                kind::CORNER => UNIT,
                _ => end.param[0],
            });
            return [along[0] + along[1], 0];
        }
        let [a, b] = ends.map(|end| barycentrics(&end, &base.triangles[edge.owner as usize]));
        [a[1] + b[1], a[2] + b[2]]
    }

    fn put(&mut self, base: &Base, triangle: &RefinedTriangle, state: u32, longest: usize, sides: [Side; 3]) {
        let Some(middle) = sides[longest].vertex else {
            self.triangles.push(RefinedTriangle { ge: sides.map(|side| side.halves[0]), ..*triangle });
            self.states.push(state);
            return;
        };
        let at = |k: usize| (longest + k) % 3;
        let [p, q, r] = [0, 1, 2].map(|k| triangle.gv[at(k)]);
        let [to_start, to_end] = sides[longest].halves;
        let across = self.inner_edge(base, triangle.base, [middle, r], keys::next(sides[longest].key, step::ACROSS));
        self.put_half(base, triangle.base, [r, p, middle], &sides[at(2)], to_start, across);
        self.put_half(base, triangle.base, [q, r, middle], &sides[at(1)], across, to_end);
    }

    /// Triangle (p, q, m), of which pq is a side of the whole.
    fn put_half(&mut self, base: &Base, owner: u32, [p, q, m]: [u32; 3], side: &Side, qm: u32, mp: u32) {
        let push = |refined: &mut Self, gv, ge| {
            refined.triangles.push(RefinedTriangle { gv, ge, base: owner });
            refined.states.push(0);
        };
        let Some(x) = side.vertex else { return push(self, [p, q, m], [side.halves[0], qm, mp]) };
        let xm = self.inner_edge(base, owner, [x, m], keys::next(side.key, step::BETWEEN));
        push(self, [p, x, m], [side.halves[0], xm, mp]);
        push(self, [x, q, m], [side.halves[1], qm, xm]);
    }

    fn inner_edge(&mut self, base: &Base, owner: u32, gv: [u32; 2], key: u32) -> u32 {
        let place = |vertex: u32| {
            let triangle = &base.triangles[owner as usize];
            let b = barycentrics(&self.vertices[vertex as usize], triangle).map(|units| units as f32 / UNIT as f32);
            let [p, q, r] = triangle.gv.map(|gv| base.positions[gv as usize]);
            std::array::from_fn(|k| b[0] * p[k] + b[1] * q[k] + b[2] * r[k])
        };
        let length_square = length_square(place(gv[0]), place(gv[1]));
        self.edges.push(RefinedEdge { gv, length_square, kind: kind::INTERIOR, owner, key });
        self.edges.len() as u32 - 1
    }
}

/// What a side becomes: itself under its new number, or two and the vertex between them.
struct Side {
    vertex: Option<u32>,
    /// From the side's start, to its end.
    halves: [u32; 2],
    /// Of the side before.
    key: u32,
}

/// In f32, since it decides which side is split.
fn length_square(a: [f32; 3], b: [f32; 3]) -> f32 {
    let d: [f32; 3] = std::array::from_fn(|k| a[k] - b[k]);
    d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
}
