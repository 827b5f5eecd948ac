//! Smooth bases, evaluated from the definition: Bézier triangles as polynomials in two of the barycentrics, by their
//! Taylor series about the place or the middle of the region that is asked for.

mod polynomial;

use displace_glsl::{
    layout::geometry::NONE,
    patches::{PatchNode, Patches},
};
use glam::DVec3;

use super::parameter::Parameter;
use crate::domain::mesh::Mesh;

/// Shortest blended normal that a direction is divided by, and that has a direction itself.
const SHORTEST_NORMAL: f64 = 0.125;
const SHORTEST_UNIT: f64 = 1e-12;

/// The patches of a mesh.
pub(super) struct Bends<'m> {
    patches: &'m Patches,
    triangles: Vec<Node>,
}

enum Node {
    Whole(Box<Leaf>),
    /// At corners 0, 1, 2, and in the middle, turned half round.
    Parts(Box<[Node; 4]>),
}

struct Leaf {
    position: Polynomial,
    normals: Normals,
    side: f64,
}

enum Normals {
    /// Cross products of these two: derivatives, at a length near 1.
    Own([Polynomial; 2]),
    /// Blended normals and directions.
    Blended([Polynomial; 2]),
}

/// A vector Σ a[m, n] x^m y^n, m + n at most `degree`; x and y are the second and the third barycentric.
pub struct Polynomial {
    degree: usize,
    coefficients: Vec<DVec3>,
}

/// A box of places in a leaf, and what derivatives along its x and y count along those of the whole triangle.
pub struct Spot {
    pub low: [f64; 2],
    pub high: [f64; 2],
    pub scale: f64,
}

/// Unit normals, and directions per unit of height.
pub(super) struct Fields<N> {
    pub(super) position: [N; 3],
    pub(super) normal: [N; 3],
    pub(super) direction: [N; 3],
}

impl<'m> Bends<'m> {
    pub(super) fn of(mesh: &'m Mesh) -> Option<Self> {
        let patches = mesh.patches.as_deref()?;
        let triangles = (0..mesh.triangles.len()).map(|t| Node::of(patches, &patches.nodes[t])).collect();
        Some(Self { patches, triangles })
    }

    pub(super) fn fields<N: Parameter>(&self, t: usize, place: &N::Place) -> Fields<N> {
        let mut found: Option<Fields<N>> = None;
        self.triangles[t].visit(N::corners(place), 1.0, &mut |leaf, spot| {
            let own = leaf.fields::<N>(spot);
            found = Some(match found.take() {
                None => own,
                Some(before) => Fields {
                    position: either(before.position, own.position),
                    normal: either(before.normal, own.normal),
                    direction: either(before.direction, own.direction),
                },
            });
        });
        let nothing = || Fields { position: zero(), normal: zero(), direction: zero() };
        let fields = found.unwrap_or_else(nothing);
        match self.patches.nodes[t].given {
            NONE => fields,
            first => Fields { direction: self.with_given::<N>(fields.direction, place, first), ..fields },
        }
    }

    pub(super) fn position<N: Parameter>(&self, t: usize, place: &N::Place) -> [N; 3] {
        let mut found: Option<[N; 3]> = None;
        self.triangles[t].visit(N::corners(place), 1.0, &mut |leaf, spot| {
            let own = N::polynomial(spot, &leaf.position);
            found = Some(found.map_or(own, |before| either(before, own)));
        });
        found.unwrap_or_else(zero)
    }

    /// At a place along an attribute edge.
    pub(super) fn on_edge<N: Parameter>(&self, ae: u32, along: N) -> Fields<N> {
        let place = self.patches.edges[ae as usize];
        let code = place as usize % 8 - 1;
        let (first, second) = (code / 2, (code / 2 + 1) % 3);
        let [from, to] = if code % 2 == 1 { [second, first] } else { [first, second] };
        let corners: Vec<DVec3> = along.extremes().map(|t| edge_place(t.clamp(0.0, 1.0), from, to)).to_vec();
        let Fields { position, normal, direction } = self.fields::<N>(place as usize / 8, N::place(&corners));
        let chained = |v: [N; 3]| v.map(|x| x.chained(along, from, to));
        Fields { position: chained(position), normal: chained(normal), direction: chained(direction) }
    }

    /// Corners with directions of their own have them, by their weights.
    fn with_given<N: Parameter>(&self, direction: [N; 3], place: &N::Place, first: u32) -> [N; 3] {
        let [mask, a, b, c] = [0, 1, 2, 3].map(|k| vector(self.patches, first + k));
        let given = [a * mask.x, b * mask.y, c * mask.z];
        let left = N::affine(place, (DVec3::ONE - mask).to_array());
        std::array::from_fn(|k| direction[k].mul(left).add(N::affine(place, given.map(|d| d[k]))))
    }
}

fn edge_place(t: f64, from: usize, to: usize) -> DVec3 {
    let mut b = DVec3::ZERO;
    (b[from], b[to]) = (1.0 - t, t);
    b
}

fn zero<N: Parameter>() -> [N; 3] {
    [N::constant(0.0); 3]
}

fn either<N: Parameter>(a: [N; 3], b: [N; 3]) -> [N; 3] {
    std::array::from_fn(|k| a[k].either(b[k]))
}

fn vector(patches: &Patches, index: u32) -> DVec3 {
    DVec3::from_array(patches.points[index as usize].map(f64::from))
}

impl Node {
    fn of(patches: &Patches, node: &PatchNode) -> Self {
        if node.parts == NONE {
            return Self::Whole(Box::new(Leaf::of(patches, node)));
        }
        let part = |k: usize| Self::of(patches, &patches.nodes[node.parts as usize + k]);
        Self::Parts(Box::new([part(0), part(1), part(2), part(3)]))
    }

    /// All leaves that the region with these corners touches; of one point, the first that has it.
    fn visit(&self, corners: &[DVec3], scale: f64, found: &mut dyn FnMut(&Leaf, &Spot)) {
        let parts = match self {
            Self::Whole(leaf) => return found(leaf, &Spot::around(corners, scale)),
            Self::Parts(parts) => parts,
        };
        let most = |k: usize| corners.iter().fold(0.0, |most: f64, b| most.max(b[k]));
        let least = |k: usize| corners.iter().fold(1.0, |least: f64, b| least.min(b[k]));
        for (k, part) in parts.iter().enumerate() {
            let touches = if k < 3 { most(k) >= 0.5 } else { (0..3).all(|k| least(k) <= 0.5) };
            if !touches {
                continue;
            }
            let (turned, mut origin) = (if k == 3 { -2.0 } else { 2.0 }, DVec3::ONE);
            if k < 3 {
                origin = DVec3::ZERO;
                origin[k] = -1.0;
            }
            let inside: Vec<DVec3> = corners.iter().map(|b| origin + turned * *b).collect();
            part.visit(&inside, scale * turned, found);
            if corners.len() == 1 {
                return;
            }
        }
    }
}

impl Spot {
    fn around(corners: &[DVec3], scale: f64) -> Self {
        let over = |axis: usize, start: f64, best: fn(f64, f64) -> f64| {
            corners.iter().map(|b| b[axis].clamp(0.0, 1.0)).fold(start, best)
        };
        let ends = |start, best| [over(1, start, best), over(2, start, best)];
        Self { low: ends(1.0, f64::min), high: ends(0.0, f64::max), scale }
    }
}

impl Leaf {
    fn of(patches: &Patches, node: &PatchNode) -> Self {
        let net = |first: u32, degree: usize| Polynomial::of_net(degree, |k| vector(patches, first + k as u32));
        let mut position = net(node.points + 1, node.degree as usize);
        let own = || {
            let slopes = [position.derivative(0), position.derivative(1)];
            let size = slopes.iter().map(Polynomial::size).fold(f64::MIN_POSITIVE, f64::max);
            slopes.map(|slope| slope.times(1.0 / size))
        };
        let normals = match node.normals {
            NONE => Normals::Own(own()),
            first => Normals::Blended([net(first, 2), net(first + 6, 2)]),
        };
        position.coefficients[0] += vector(patches, node.points);
        Self { position, normals, side: f64::from(node.side) }
    }

    fn fields<N: Parameter>(&self, spot: &Spot) -> Fields<N> {
        let position = N::polynomial(spot, &self.position);
        let (normal, direction) = match &self.normals {
            Normals::Own(slopes) => {
                let [u, v] = slopes.each_ref().map(|slope| N::polynomial(spot, slope));
                let side = N::constant(self.side);
                let normal: [N; 3] = std::array::from_fn(|k| {
                    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                    u[i].mul(v[j]).sub(u[j].mul(v[i])).mul(side)
                });
                (normal, None)
            }
            Normals::Blended(nets) => {
                let [normal, direction] = nets.each_ref().map(|net| N::polynomial(spot, net));
                (normal, Some(direction))
            }
        };
        let square = normal.iter().fold(N::constant(0.0), |sum, x| sum.add(x.mul(*x)));
        let over = |v: [N; 3], least: f64| {
            let length = N::max(square.sqrt(), N::constant(least));
            v.map(|x| x.div(length))
        };
        let unit = over(normal, SHORTEST_UNIT);
        Fields { position, normal: unit, direction: direction.map_or(unit, |d| over(d, SHORTEST_NORMAL)) }
    }
}
