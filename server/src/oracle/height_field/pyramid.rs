//! The least and greatest height of every cell and of every 2 x 2 of those below it, and rays down that hierarchy
//! (Tevs, Ihrke, Seidel 2008).

use super::{
    Hit, Walk,
    course::{Course, Lattice, Range},
};
use crate::oracle::{bvh::Segment, field::Field};

/// One period of a field's channel. 11 bytes a cell; a mirrored axis has twice as many cells as texels.
pub struct Pyramid {
    field: Field,
    channel: u32,
    /// Cells after which the field repeats; the size of the map along a clamped axis.
    tile: Lattice,
    clamped: [bool; 2],
    /// From cells to one node.
    levels: Vec<Level>,
}

struct Level {
    size: Lattice,
    bounds: Vec<Bounds>,
}

/// Least and greatest; texels are f32, so these are exact.
type Bounds = [f32; 2];

/// A ray over one tile.
struct Trip<'c> {
    course: &'c Course,
    tile: Lattice,
    fetches: u64,
}

/// 2^level cells a side; those at the end of a tile are as small as it leaves them.
#[derive(Clone, Copy)]
struct Node {
    level: usize,
    at: Lattice,
    /// The t between its lines across, and between those down.
    spans: [Range; 2],
}

impl Pyramid {
    #[must_use]
    pub fn new(field: &Field, channel: u32) -> Self {
        let period = field.period();
        let tile = [0, 1].map(|axis| i64::from(period[axis].unwrap_or(field.size()[axis])));
        let mut levels = vec![Level::new(tile, |x, y| cell_bounds(field, channel, tile, [x, y]))];
        while let Some(below) = levels.last().filter(|level| level.size != [1; 2]) {
            let parent = Level::new(below.size.map(|n| (n + 1) / 2), |x, y| below.bounds_of_four(x, y));
            levels.push(parent);
        }
        Self { field: field.clone(), channel, tile, clamped: period.map(|p| p.is_none()), levels }
    }

    /// What [`super::walk_cells`] finds, bit for bit, in fewer fetches where the ray is clear of the surface for long.
    #[must_use]
    pub fn walk(&self, ray: &Segment) -> Walk {
        let course = Course::new(&self.field, self.channel, ray);
        let mut fetches = 0;
        let hit = course.blocks(self.tile).find_map(|(tile, spans)| {
            let mut trip = Trip { course: &course, tile, fetches: 0 };
            let root = Node { level: self.levels.len() - 1, at: [0; 2], spans };
            let start = self.smallest_around(&trip, root);
            let hit = self.descend(&mut trip, start);
            fetches += trip.fetches;
            hit
        });
        Walk { hit, fetches }
    }

    /// The smallest node with the same way of the ray over it: larger ones tell less.
    fn smallest_around(&self, trip: &Trip<'_>, mut node: Node) -> Node {
        let range = trip.course.within(node.spans);
        while node.level > 0 {
            let whole = |child: &Node| trip.course.within(child.spans) == range;
            let Some(child) = self.children(trip, node).into_iter().find(whole) else { break };
            node = child;
        }
        node
    }

    fn descend(&self, trip: &mut Trip<'_>, node: Node) -> Option<Hit> {
        let range = trip.course.within(node.spans)?;
        trip.fetches += 1;
        let [low, high] = self.bounds(trip.tile, node).map(f64::from);
        if trip.course.is_clear(low, high, range) {
            return None;
        }
        if node.level == 0 {
            trip.fetches += 1;
            let cell = [0, 1].map(|axis| trip.tile[axis] * self.tile[axis] + node.at[axis]);
            return trip.course.hit(&self.field, self.channel, cell, range);
        }
        self.children(trip, node).into_iter().find_map(|child| self.descend(trip, child))
    }

    /// The four children as the ray may pass them: of the middle two it passes one at most.
    fn children(&self, trip: &Trip<'_>, node: Node) -> [Node; 4] {
        let (course, level) = (trip.course, node.level - 1);
        let halves = [0, 1].map(|axis| {
            let middle = ((2 * node.at[axis] + 1) << level).min(self.tile[axis]);
            course.halves(axis, trip.tile[axis] * self.tile[axis] + middle, node.spans[axis])
        });
        let near = [0, 1].map(|axis| i64::from(course.step(axis) < 0));
        [[0, 0], [1, 0], [0, 1], [1, 1]].map(|far| {
            let at = [0, 1].map(|axis| 2 * node.at[axis] + (near[axis] ^ far[axis] as i64));
            Node { level, at, spans: [0, 1].map(|axis| halves[axis][far[axis]]) }
        })
    }

    /// Bounds that hold for a node of any tile: beyond a clamped map the cells are those of its border.
    fn bounds(&self, tile: Lattice, node: Node) -> Bounds {
        let level = &self.levels[node.level];
        let [x, y] = [0, 1].map(|axis| match tile[axis] {
            ..=-1 if self.clamped[axis] => 0,
            1.. if self.clamped[axis] => level.size[axis] - 1,
            _ => node.at[axis],
        });
        level.bounds[(y * level.size[0] + x) as usize]
    }
}

impl Level {
    fn new(size: Lattice, bounds: impl Fn(i64, i64) -> Bounds) -> Self {
        let bounds = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))).map(|(x, y)| bounds(x, y));
        Self { size, bounds: bounds.collect() }
    }

    fn bounds_of_four(&self, x: i64, y: i64) -> Bounds {
        let at = |i: i64, j: i64| {
            let (x, y) = ((2 * x + i).min(self.size[0] - 1), (2 * y + j).min(self.size[1] - 1));
            self.bounds[(y * self.size[0] + x) as usize]
        };
        united([at(0, 0), at(1, 0), at(0, 1), at(1, 1)])
    }
}

/// Least and greatest corner of a cell in every tile: at the ends of a period two texels may lie on one place, of
/// which each tile shows one; two tiles show both.
fn cell_bounds(field: &Field, channel: u32, tile: Lattice, cell: Lattice) -> Bounds {
    let tiles = |axis: usize| if cell[axis] == 0 || cell[axis] + 1 == tile[axis] { 0..2 } else { 0..1 };
    united(tiles(1).flat_map(|v| tiles(0).map(move |u| [u, v])).flat_map(|[u, v]| {
        let texels = field.cell(channel, cell[0] + u * tile[0], cell[1] + v * tile[1]);
        texels.map(|texel| [texel as f32; 2])
    }))
}

fn united(bounds: impl IntoIterator<Item = Bounds>) -> Bounds {
    bounds.into_iter().fold([f32::INFINITY, f32::NEG_INFINITY], |a, b| [a[0].min(b[0]), a[1].max(b[1])])
}
