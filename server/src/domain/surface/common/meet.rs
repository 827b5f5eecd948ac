//! The parts of one base triangle.

use std::collections::BTreeMap;

use displace_glsl::layout::refine::UNIT;

use super::{
    At,
    cut::{self, Point, Triangle},
    only,
};
use crate::domain::{
    mesh::Mesh,
    surface::{Pieces, Surface},
};

const SIDE: i64 = UNIT as i64;
/// Cells along the side of a grid that finds what may meet, at most.
const MOST_CELLS: usize = 512;

/// Weights of the third and of the second corner of the base triangle, in units, so that keys sort as interiors do.
type Key = [u32; 2];

/// The parts of one base triangle.
#[derive(Clone, Debug, Default)]
pub(super) struct Met {
    /// Corners of parts that lie on no side of the base triangle, and where either has them.
    pub(super) inside: BTreeMap<Key, [At; 2]>,
    /// Turning as the base triangle does.
    pub(super) triangles: Vec<[Key; 3]>,
}

/// The triangles of a surface in one base triangle.
struct Tiles {
    ids: Vec<[u32; 3]>,
    corners: Vec<Triangle>,
}

impl Tiles {
    fn of(mesh: &Mesh, surface: &Surface, t: usize) -> Self {
        let corner = |id: u32| {
            let units = surface.layout.place(mesh, id as usize).within(mesh, t).unwrap_or_default();
            [i64::from(units[1]), i64::from(units[2])]
        };
        let ids = surface.triangles[surface.triangles_of(t)].to_vec();
        let corners = ids.iter().map(|ids| ids.map(corner)).collect();
        Self { ids, corners }
    }

    /// Where tile `k` has a place that lies in it.
    fn at(&self, k: usize, place: Point) -> At {
        let (ids, corners) = (self.ids[k], self.corners[k]);
        let whole =
            corners.iter().position(|c| place.x == i128::from(c[0]) * place.w && place.y == i128::from(c[1]) * place.w);
        whole.map_or_else(|| (ids, cut::weights(corners, place)), |corner| only(ids[corner]))
    }
}

impl Met {
    pub(super) fn new(mesh: &Mesh, surfaces: [&Surface; 2], t: usize) -> Self {
        let tiles = surfaces.map(|surface| Tiles::of(mesh, surface, t));
        let grid = Grid::of(&tiles[1].corners);
        let (mut met, mut near) = (Self::default(), Vec::new());
        for (k, corners) in tiles[0].corners.iter().enumerate() {
            grid.near(corners, &mut near);
            for &other in &near {
                let part = cut::shared(*corners, tiles[1].corners[other as usize]);
                if part.len() > 2 {
                    met.put(&part, |place| [tiles[0].at(k, place), tiles[1].at(other as usize, place)]);
                }
            }
        }
        met
    }

    /// A convex part, as a fan.
    fn put(&mut self, part: &[Point], at: impl Fn(Point) -> [At; 2]) {
        let mut keys: Vec<Key> = part.iter().map(|corner| key(*corner)).collect();
        for (key, corner) in keys.iter().zip(part) {
            if is_inside(*key) {
                self.inside.entry(*key).or_insert_with(|| at(*corner));
            }
        }
        keys.dedup();
        if keys.len() > 1 && keys.first() == keys.last() {
            keys.pop();
        }
        // The fan begins where it is widest seen from, so that it has no triangle without area if it need not.
        let Some(first) = (0..keys.len()).max_by_key(|k| least_area(&keys, *k)) else { return };
        keys.rotate_left(first);
        let fan = (1..keys.len().saturating_sub(1)).map(|k| [keys[0], keys[k], keys[k + 1]]);
        self.triangles.extend(fan);
    }

    /// By the numbers that `pieces` gives vertices.
    pub(super) fn numbered<'m>(
        &'m self,
        mesh: &'m Mesh,
        pieces: &'m Pieces,
        t: usize,
    ) -> impl Iterator<Item = [u32; 3]> + 'm {
        let inside: Vec<Key> = self.inside.keys().copied().collect();
        let first = mesh.av_gv.len() + pieces.edge_place.len() + pieces.interior_first[t] as usize;
        let number = move |key: Key| match inside.binary_search(&key) {
            Ok(rank) => (first + rank) as u32,
            Err(_) => on_side(mesh, pieces, t, key),
        };
        self.triangles.iter().map(move |keys| keys.map(&number))
    }
}

/// Twice the least area of a fan's triangles, which is 0 where some of them have none.
fn least_area(keys: &[Key], first: usize) -> i64 {
    let at = |k: usize| keys[(first + k) % keys.len()].map(i64::from);
    let area = |k: usize| {
        let [a, b, c] = [at(0), at(k), at(k + 1)];
        ((b[1] - a[1]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[1] - a[1])).abs()
    };
    (1..keys.len().saturating_sub(1)).map(area).min().unwrap_or(0)
}

/// Whole units. What is within the base triangle stays there, since nothing but vertices of either is on its sides.
fn key(place: Point) -> Key {
    let Point { x, y, w } = place;
    let [mut b1, mut b2] = cut::rounded(place);
    if x > 0 && y > 0 && x + y < i128::from(SIDE) * w {
        b1 = b1.clamp(1, SIDE - 2);
        b2 = b2.clamp(1, SIDE - 1 - b1);
    }
    [b2 as u32, b1 as u32]
}

fn is_inside([b2, b1]: Key) -> bool {
    b1 > 0 && b2 > 0 && b1 + b2 < UNIT
}

/// The number of a vertex on a side of base triangle `t`.
fn on_side(mesh: &Mesh, pieces: &Pieces, t: usize, [b2, b1]: Key) -> u32 {
    let (triangle, units) = (&mesh.triangles[t], [UNIT - b1 - b2, b1, b2]);
    if let Some(corner) = units.iter().position(|own| *own == UNIT) {
        return triangle.av[corner];
    }
    // Side k goes from corner k to the next.
    let side = (0..3).find(|k| units[(k + 2) % 3] == 0).unwrap_or(0);
    let ae = triangle.ae[side] as usize;
    let forward = mesh.ae_av[ae][0] == triangle.av[side];
    let along = if forward { units[(side + 1) % 3] } else { units[side] };
    let range = pieces.edge_first[ae] as usize..pieces.edge_first[ae + 1] as usize;
    let rank = pieces.edge_place[range.clone()].partition_point(|place| *place < along);
    (mesh.av_gv.len() + range.start + rank) as u32
}

/// Which triangles are near a place.
struct Grid {
    cells: usize,
    first: Vec<u32>,
    listed: Vec<u32>,
}

impl Grid {
    fn of(triangles: &[Triangle]) -> Self {
        let cells = (triangles.len() as f64).sqrt().ceil().clamp(1.0, MOST_CELLS as f64) as usize;
        let mut entries: Vec<(u32, u32)> = Vec::new();
        for (number, triangle) in (0..).zip(triangles) {
            entries.extend(cells_of(triangle, cells).map(|cell| (cell, number)));
        }
        entries.sort_unstable();
        let first = (0..=(cells * cells) as u32).map(|cell| entries.partition_point(|e| e.0 < cell) as u32).collect();
        Self { cells, first, listed: entries.into_iter().map(|(_, number)| number).collect() }
    }

    /// In rising order, each once.
    fn near(&self, triangle: &Triangle, found: &mut Vec<u32>) {
        found.clear();
        for cell in cells_of(triangle, self.cells) {
            let [from, to] = [0, 1].map(|k| self.first[cell as usize + k] as usize);
            found.extend_from_slice(&self.listed[from..to]);
        }
        found.sort_unstable();
        found.dedup();
    }
}

/// The cells that the box around a triangle touches.
fn cells_of(triangle: &Triangle, cells: usize) -> impl Iterator<Item = u32> + use<> {
    let cell = |x: i64| ((x * cells as i64) / (SIDE + 1)) as u32;
    let range = |axis: usize| {
        let of = triangle.iter().map(|corner| corner[axis]);
        let [low, high] = of.fold([i64::MAX, i64::MIN], |[low, high], x| [low.min(x), high.max(x)]);
        cell(low)..=cell(high)
    };
    let (columns, rows) = (range(0), range(1));
    rows.flat_map(move |row| columns.clone().map(move |column| row * cells as u32 + column))
}
