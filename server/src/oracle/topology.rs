//! Places, edges and pieces of a list of triangles, by the exact bits of their positions.

use rayon::prelude::*;

/// How triangles hang together. Corners are in one place when their positions have the same bits, −0 counting as
/// +0: a crack of one unit in the last place is a crack.
#[derive(Clone, Debug, Default)]
pub struct Topology {
    /// Corners as places; triangles with two corners in one place are left out.
    pub triangles: Vec<[u32; 3]>,
    /// A vertex of each place.
    pub vertex_of_place: Vec<u32>,
    /// Sorted by places.
    pub edges: Vec<Edge>,
    /// Triangles left out.
    pub collapsed: u64,
}

/// An edge between two places, and the triangles that have it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// The lower first.
    pub places: [u32; 2],
    /// Triangles that run along it from the lower place to the higher.
    pub along: u32,
    /// Triangles that run the other way.
    pub against: u32,
}

impl Edge {
    #[must_use]
    pub fn triangles(&self) -> u32 {
        self.along + self.against
    }
}

impl Topology {
    /// Indices are in range.
    #[must_use]
    pub fn new(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Self {
        let (place, vertex_of_place) = places(positions);
        let placed = triangles.par_iter().map(|t| t.map(|v| place[v as usize]));
        let kept: Vec<[u32; 3]> = placed.filter(|&[a, b, c]| a != b && b != c && c != a).collect();
        let collapsed = (triangles.len() - kept.len()) as u64;
        Self { edges: edges(&kept), triangles: kept, vertex_of_place, collapsed }
    }

    /// Edges with one triangle.
    pub fn boundary(&self) -> impl Iterator<Item = &Edge> {
        self.edges.iter().filter(|edge| edge.triangles() == 1)
    }

    /// Edges with more than two triangles.
    pub fn non_manifold(&self) -> impl Iterator<Item = &Edge> {
        self.edges.iter().filter(|edge| edge.triangles() > 2)
    }

    /// Edges whose two triangles run the same way.
    pub fn badly_wound(&self) -> impl Iterator<Item = &Edge> {
        self.edges.iter().filter(|edge| edge.triangles() == 2 && edge.along != edge.against)
    }

    /// Every edge is run along as often one way as the other: the triangles bound a volume.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.edges.iter().all(|edge| edge.along == edge.against)
    }

    /// Places − edges + triangles.
    #[must_use]
    pub fn euler_characteristic(&self) -> i64 {
        let mut used = vec![false; self.vertex_of_place.len()];
        self.triangles.as_flattened().iter().for_each(|&place| used[place as usize] = true);
        let places = used.into_iter().filter(|used| *used).count();
        places as i64 - self.edges.len() as i64 + self.triangles.len() as i64
    }

    /// Pieces that share no place.
    #[must_use]
    pub fn components(&self) -> u64 {
        let mut parent: Vec<u32> = (0..self.vertex_of_place.len() as u32).collect();
        for edge in &self.edges {
            let [a, b] = edge.places.map(|place| root(&mut parent, place));
            parent[a.max(b) as usize] = a.min(b);
        }
        let mut roots: Vec<u32> = self.triangles.iter().map(|t| root(&mut parent, t[0])).collect();
        roots.sort_unstable();
        roots.dedup();
        roots.len() as u64
    }
}

/// The place of each vertex, and a vertex of each place. Places are numbered in the order of their positions' bits.
#[must_use]
pub fn places(positions: &[[f32; 3]]) -> (Vec<u32>, Vec<u32>) {
    let bits = |p: [f32; 3]| p.map(|x| (x + 0.0).to_bits());
    let mut sorted: Vec<([u32; 3], u32)> =
        positions.par_iter().enumerate().map(|(v, &p)| (bits(p), v as u32)).collect();
    sorted.par_sort_unstable();
    let mut place = vec![0; positions.len()];
    let mut vertex_of_place: Vec<u32> = Vec::new();
    for group in sorted.chunk_by(|a, b| a.0 == b.0) {
        group.iter().for_each(|(_, vertex)| place[*vertex as usize] = vertex_of_place.len() as u32);
        vertex_of_place.push(group[0].1);
    }
    (place, vertex_of_place)
}

fn edges(triangles: &[[u32; 3]]) -> Vec<Edge> {
    let side = |(a, b): (u32, u32)| (a.min(b), a.max(b), a > b);
    let mut sides: Vec<(u32, u32, bool)> =
        triangles.par_iter().flat_map_iter(|&[a, b, c]| [(a, b), (b, c), (c, a)].map(side)).collect();
    sides.par_sort_unstable();
    let edge = |group: &[(u32, u32, bool)]| {
        let against = group.iter().filter(|side| side.2).count() as u32;
        Edge { places: [group[0].0, group[0].1], along: group.len() as u32 - against, against }
    };
    sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).map(edge).collect()
}

fn root(parent: &mut [u32], mut place: u32) -> u32 {
    while parent[place as usize] != place {
        // Halving the path keeps it short.
        parent[place as usize] = parent[parent[place as usize] as usize];
        place = parent[place as usize];
    }
    place
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    fn corners() -> Vec<[f32; 3]> {
        vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    }

    #[test]
    fn a_tetrahedron_is_closed_and_an_open_one_is_not() {
        let whole = Topology::new(&corners(), &TETRAHEDRON);
        assert!(whole.is_closed());
        assert_eq!((whole.euler_characteristic(), whole.components(), whole.edges.len()), (2, 1, 6));
        let open = Topology::new(&corners(), &TETRAHEDRON[1..]);
        assert!(!open.is_closed());
        assert_eq!((open.boundary().count(), open.euler_characteristic()), (3, 1));
    }

    #[test]
    fn vertices_of_one_position_are_one_place_and_one_bit_parts_them() {
        let soup: Vec<[f32; 3]> = TETRAHEDRON
            .as_flattened()
            .iter()
            .map(|&v| corners()[v as usize].map(|x| if x == 0.0 { -x } else { x }))
            .collect();
        let mut apart = soup.clone();
        let each: Vec<[u32; 3]> = (0..4).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        assert_eq!(Topology::new(&soup, &each).boundary().count(), 0);
        let vertex = apart.iter().position(|p| p[0] == 1.0).expect("a corner");
        apart[vertex][0] = 1.0f32.next_up();
        assert_eq!(Topology::new(&apart, &each).boundary().count(), 4);
    }

    #[test]
    fn three_sheets_on_an_edge_and_a_turned_triangle_are_seen() {
        let turned = [[0, 1, 2], [0, 1, 3]];
        let topology = Topology::new(&corners(), &turned);
        assert_eq!((topology.badly_wound().count(), topology.non_manifold().count()), (1, 0));
        let mut points = corners();
        points.push([0.0, -1.0, 0.0]);
        let book = Topology::new(&points, &[[0, 1, 2], [0, 1, 3], [1, 0, 4]]);
        assert_eq!((book.non_manifold().count(), book.boundary().count()), (1, 6));
    }

    #[test]
    fn collapsed_triangles_change_nothing() {
        let mut triangles = TETRAHEDRON.to_vec();
        triangles.push([1, 2, 1]);
        let topology = Topology::new(&corners(), &triangles);
        assert_eq!((topology.collapsed, topology.euler_characteristic(), topology.is_closed()), (1, 2, true));
    }

    #[test]
    fn pieces_are_counted() {
        let mut points = corners();
        points.extend(corners().iter().map(|p| p.map(|x| x + 5.0)));
        let two: Vec<[u32; 3]> = TETRAHEDRON.iter().flat_map(|t| [*t, t.map(|v| v + 4)]).collect();
        assert_eq!(Topology::new(&points, &two).components(), 2);
    }
}
