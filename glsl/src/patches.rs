//! The smooth base as tables: Bézier triangles of degree 2 to 4, split around places where one would not do.

use glam::DVec3;

pub use crate::layout::smooth::PatchNode;
use crate::{
    bezier::{self, Net},
    layout::geometry::NONE,
};

/// Splits from a whole triangle to its smallest part, at most: places are multiples of 2^-24.
pub const MOST_SPLITS: u32 = 24;

/// Patches of one base mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Patches {
    /// Node t is base triangle t; the parts of those that are split follow.
    pub nodes: Vec<PatchNode>,
    pub points: Vec<[f32; 3]>,
    /// Where each ae lies; see [`on_edge`].
    pub edges: Vec<u32>,
    /// Of each node, or none: what bounds read instead of many small patches.
    pub summaries: Vec<Summary>,
}

/// A node as one flat triangle: its places and unit normals are nowhere farther than the radii from what is straight
/// between those at its corners.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Summary {
    pub places: [DVec3; 3],
    pub place_radius: f64,
    pub normals: [DVec3; 3],
    pub normal_radius: f64,
}

/// Where the base is evaluated: at an attribute vertex.
pub const AT_VERTEX: u32 = NONE;

/// Within base triangle t.
#[must_use]
pub const fn inside(t: u32) -> u32 {
    8 * t
}

/// On side k of base triangle t; `reversed` where the edge runs from corner k + 1 to corner k.
#[must_use]
pub const fn on_edge(t: u32, k: u32, reversed: bool) -> u32 {
    8 * t + 1 + 2 * k + reversed as u32
}

/// Corners of the base triangle where an edge starts and ends; none within a triangle.
#[must_use]
pub fn ends(patch: u32) -> Option<[usize; 2]> {
    let code = (patch % 8).checked_sub(1)? as usize;
    let (first, second) = (code / 2, (code / 2 + 1) % 3);
    Some(if code % 2 == 1 { [second, first] } else { [first, second] })
}

/// Barycentrics of the base triangle from those of a site.
#[must_use]
pub fn within_triangle(patch: u32, b: DVec3) -> DVec3 {
    let Some([from, to]) = ends(patch) else { return b };
    let mut place = DVec3::ZERO;
    place[from] = b.x;
    place[to] = b.y + b.z;
    place
}

/// A Bézier triangle and where in it a place lies.
#[derive(Clone, Copy, Debug)]
pub struct Leaf {
    pub node: PatchNode,
    pub b: DVec3,
    /// What derivatives along the leaf's barycentrics count along those of the whole triangle.
    pub scale: f64,
}

/// The part of four that has a place.
#[must_use]
pub fn part_of(b: DVec3) -> usize {
    (0..3).find(|k| b[*k] >= 0.5).unwrap_or(3)
}

/// Barycentrics in one of four parts.
#[must_use]
pub fn into_part(part: usize, b: DVec3) -> DVec3 {
    if part == 3 {
        return DVec3::ONE - 2.0 * b;
    }
    let mut inside = 2.0 * b;
    inside[part] -= 1.0;
    inside
}

impl Patches {
    /// The patch of triangle t that has the place b.
    #[must_use]
    pub fn leaf(&self, t: u32, mut b: DVec3) -> Leaf {
        let mut node = self.nodes[t as usize];
        let mut scale = 1.0;
        while node.parts != NONE {
            let part = part_of(b);
            b = into_part(part, b);
            scale *= if part == 3 { -2.0 } else { 2.0 };
            node = self.nodes[node.parts as usize + part];
        }
        Leaf { node, b, scale }
    }

    #[must_use]
    pub fn vector(&self, index: u32) -> DVec3 {
        DVec3::from_array(self.points[index as usize].map(f64::from))
    }

    /// Positions of a leaf, less [`Self::origin`].
    #[must_use]
    pub fn position(&self, leaf: &PatchNode) -> Net {
        self.net(leaf.points + 1, leaf.degree as usize)
    }

    #[must_use]
    pub fn origin(&self, leaf: &PatchNode) -> DVec3 {
        self.vector(leaf.points)
    }

    /// Normals and directions of a leaf that has nets of them.
    #[must_use]
    pub fn normals(&self, leaf: &PatchNode) -> Option<[Net; 2]> {
        let first = (leaf.normals != NONE).then_some(leaf.normals)?;
        Some([self.net(first, 2), self.net(first + bezier::points(2) as u32, 2)])
    }

    /// How far places get at most beyond the box of the `vertices`, along any axis.
    #[must_use]
    pub fn bulge(&self, vertices: &[[f32; 3]]) -> f64 {
        let ends = |k: usize| {
            let each = vertices.iter().map(|p| f64::from(p[k]));
            each.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
        };
        let ends = [0, 1, 2].map(ends);
        let beyond = |p: DVec3| (0..3).map(|k| (ends[k].0 - p[k]).max(p[k] - ends[k].1)).fold(0.0, f64::max);
        let of_leaf = |leaf: &PatchNode| {
            let (net, origin) = (self.position(leaf), self.origin(leaf));
            net.points().iter().map(|p| beyond(origin + *p)).fold(0.0, f64::max)
        };
        self.nodes.iter().filter(|node| node.parts == NONE).map(of_leaf).fold(0.0, f64::max)
    }

    /// Bytes on a device.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        (size_of_val(&*self.nodes) + size_of_val(&*self.points)) as u64
    }

    /// Corners of triangle t whose directions are given, as 1 and 0, and those directions.
    #[must_use]
    pub fn given(&self, t: u32) -> Option<(DVec3, [DVec3; 3])> {
        let first = Some(self.nodes[t as usize].given).filter(|first| *first != NONE)?;
        Some((self.vector(first), [1, 2, 3].map(|k| self.vector(first + k))))
    }

    fn net(&self, first: u32, degree: usize) -> Net {
        Net::new(degree, |j, k| self.vector(first + bezier::index(degree, j, k) as u32))
    }
}
