//! One base triangle, cut into convex regions.

use std::{
    collections::{BTreeMap, HashMap},
    hash::{BuildHasherDefault, Hasher},
    sync::atomic::{AtomicUsize, Ordering},
};

use glam::DVec3;

use super::{
    Dicing, Limits, Region, SharedEdges, ears,
    kinks::{Cut, GRID_SLACK, Kinks, MOST_FAN_LINES, halving},
};
use crate::{
    domain::{Result, cancel::Cancel, mesh::Mesh},
    oracle::surface::Surface,
};

/// Regions between two looks at whether the caller still waits.
const CANCEL_EVERY: usize = 256;

/// Vertices, and polygons of them.
pub(super) struct Patch {
    vertices: Vec<Vertex>,
    /// What lies between two neighbouring vertices that were once joined directly.
    splits: Splits,
    polygons: Vec<Polygon>,
}

type Splits = HashMap<u64, u32, BuildHasherDefault<Mixer>>;

/// Mixes one number; the keys are our own, so nobody chooses them to collide.
#[derive(Default)]
struct Mixer(u64);

impl Hasher for Mixer {
    fn finish(&self) -> u64 {
        self.0 ^ (self.0 >> 32)
    }
    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|byte| self.write_u64(u64::from(*byte)));
    }
    fn write_u64(&mut self, number: u64) {
        self.0 = (self.0 ^ number).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    }
}

fn edge_key(a: u32, b: u32) -> u64 {
    u64::from(a.min(b)) << 32 | u64::from(a.max(b))
}

struct Vertex {
    b: DVec3,
    position: DVec3,
    /// From where this base triangle alone would have it to where all agree.
    moved: f64,
}

struct Polygon {
    corners: Vec<u32>,
    depth: u32,
    deviation: f64,
}

impl Patch {
    /// Fails when cancelled, and when all patches together have more than the allowed triangles.
    pub(super) fn cut(
        surface: &Surface<'_>,
        t: usize,
        limits: &Limits,
        spent: &AtomicUsize,
        cancel: &Cancel,
        wants_more: &(dyn Fn(&Region<'_>) -> bool + Sync),
    ) -> Result<Self> {
        let corners =
            [DVec3::X, DVec3::Y, DVec3::Z].map(|b| Vertex { b, position: surface.position(t, b), moved: 0.0 });
        let lengths = [1, 2].map(|k| corners[k].position.distance(corners[0].position));
        let mut patch = Self { vertices: corners.into(), splits: Splits::default(), polygons: Vec::new() };
        let kinks = Kinks { grids: surface.grids(t), lines: surface.seam_lines(t, MOST_FAN_LINES) };
        let mut open = vec![Polygon { corners: vec![0, 1, 2], depth: 0, deviation: 0.0 }];
        while let Some(mut polygon) = open.pop() {
            if patch.polygons.len().is_multiple_of(CANCEL_EVERY) {
                cancel.check()?;
            }
            polygon.corners = patch.expanded(&polygon.corners);
            let b: Vec<DVec3> = polygon.corners.iter().map(|&v| patch.vertices[v as usize].b).collect();
            let positions: Vec<DVec3> = polygon.corners.iter().map(|&v| patch.vertices[v as usize].position).collect();
            polygon.deviation = surface.deviation(t, &b);
            let region = Region { base: t, positions: &positions, deviation: polygon.deviation };
            // What is not finite is refused once all is cut; cutting it further finds no end.
            let finite = positions.iter().all(|p| p.is_finite());
            if finite && polygon.depth < limits.max_depth && wants_more(&region) {
                let cut = kinks.cut(&b).unwrap_or_else(|| halving(&b, lengths));
                let parts = patch.divide(surface, t, &polygon, cut);
                if parts.len() == 2 {
                    open.extend(parts);
                    continue;
                }
            }
            // What has no bound where it cannot be cut further has none.
            if finite && polygon.deviation.is_infinite() {
                return Err(super::unbounded());
            }
            let triangles = polygon.corners.len() - 2;
            if spent.fetch_add(triangles, Ordering::Relaxed) + triangles > limits.max_triangles {
                return Err(super::too_many(limits));
            }
            patch.polygons.push(polygon);
        }
        Ok(patch)
    }

    /// Corners with everything that has been put between them since.
    fn expanded(&self, corners: &[u32]) -> Vec<u32> {
        let mut all = Vec::with_capacity(corners.len() + 2);
        for (k, &from) in corners.iter().enumerate() {
            all.push(from);
            self.between(from, corners[(k + 1) % corners.len()], &mut all);
        }
        all
    }

    /// In order, the ends left out. With a stack of its own: a long edge is split thousands of times in a row.
    fn between(&self, from: u32, to: u32, all: &mut Vec<u32>) {
        let mut open = vec![(from, to)];
        while let Some((from, to)) = open.pop() {
            if from == to {
                all.push(from);
            } else if let Some(&middle) = self.splits.get(&edge_key(from, to)) {
                open.extend([(middle, to), (middle, middle), (from, middle)]);
            }
        }
    }

    /// The parts on either side of a cut; fewer than two where it only touches.
    fn divide(&mut self, surface: &Surface<'_>, t: usize, polygon: &Polygon, cut: Cut) -> Vec<Polygon> {
        let sign = |patch: &Self, v: u32| patch.side(v, cut);
        let mut parts = [Vec::new(), Vec::new()];
        let count = polygon.corners.len();
        for k in 0..count {
            let (from, to) = (polygon.corners[k], polygon.corners[(k + 1) % count]);
            let (a, b) = (sign(self, from), sign(self, to));
            if a <= 0 {
                parts[0].push(from);
            }
            if a >= 0 {
                parts[1].push(from);
            }
            if a * b < 0 {
                let middle = self.split(surface, t, from, to, cut);
                parts.iter_mut().for_each(|part| part.push(middle));
            }
        }
        let depth = polygon.depth + 1;
        let part = |corners: Vec<u32>| Polygon { corners, depth, deviation: 0.0 };
        // A part that lies on the cut alone has no area, however many corners.
        let has_area = |corners: &Vec<u32>| corners.iter().any(|&v| sign(self, v) != 0);
        parts.into_iter().filter(has_area).map(part).collect()
    }

    /// −1, 0 or 1.
    fn side(&self, v: u32, cut: Cut) -> i32 {
        let d = cut.line.dot(self.vertices[v as usize].b);
        if d.abs() <= GRID_SLACK { 0 } else { d.signum() as i32 }
    }

    fn split(&mut self, surface: &Surface<'_>, t: usize, from: u32, to: u32, cut: Cut) -> u32 {
        let (from, to) = (from.min(to), from.max(to));
        let [p, q] = [from, to].map(|v| self.vertices[v as usize].b);
        let (d, e) = (cut.line.dot(p), cut.line.dot(q));
        let b = p + (q - p) * (d / (d - e));
        // On a side of the base triangle a barycentric is exactly 0 and stays so.
        self.put_between(surface, t, from, to, b)
    }

    fn put_between(&mut self, surface: &Surface<'_>, t: usize, from: u32, to: u32, b: DVec3) -> u32 {
        let middle = self.vertices.len() as u32;
        self.vertices.push(Vertex { b, position: surface.position(t, b), moved: 0.0 });
        self.splits.insert(edge_key(from, to), middle);
        middle
    }

    pub(super) fn most_moved(&self) -> f64 {
        self.vertices.iter().map(|vertex| vertex.moved).fold(0.0, f64::max)
    }

    pub(super) fn is_finite(&self) -> bool {
        self.vertices.iter().all(|vertex| vertex.position.as_vec3().is_finite())
    }

    pub(super) fn corner(&self, k: usize) -> DVec3 {
        self.vertices[k].position
    }

    /// Vertices inside side k of the base triangle: how far along its edge, and where.
    pub(super) fn on_side(&self, mesh: &Mesh, t: usize, k: usize) -> Vec<(f64, DVec3)> {
        let mut between = Vec::new();
        self.between(k as u32, (k as u32 + 1) % 3, &mut between);
        let along = |v: u32| along_edge(mesh, t, k, self.vertices[v as usize].b);
        between.into_iter().map(|v| (along(v), self.vertices[v as usize].position)).collect()
    }

    /// Takes in what the other sides of its edges were cut at, and the places agreed on there.
    pub(super) fn insert_shared(&mut self, surface: &Surface<'_>, t: usize, edges: &SharedEdges) {
        let mesh = surface.mesh();
        for k in 0..3 {
            let ge = mesh.ae_ge[mesh.triangles[t].ae[k] as usize] as usize;
            self.insert_on_side(surface, t, k, &edges[ge]);
            let gv = mesh.av_gv[mesh.triangles[t].av[k] as usize];
            self.move_to(k, surface.corner_position(gv as usize, self.vertices[k].position));
        }
    }

    fn move_to(&mut self, vertex: usize, place: DVec3) {
        let vertex = &mut self.vertices[vertex];
        vertex.moved += vertex.position.distance(place);
        vertex.position = place;
    }

    /// Goes along side k once, past its own vertices and the shared points in one order.
    fn insert_on_side(&mut self, surface: &Surface<'_>, t: usize, k: usize, points: &BTreeMap<u64, DVec3>) {
        let mesh = surface.mesh();
        let (mut last, end) = (k as u32, (k as u32 + 1) % 3);
        let mut own = Vec::new();
        self.between(last, end, &mut own);
        let mut own = own.into_iter().peekable();
        let rising = ends(mesh, t, k).0 == k;
        let shared = points.iter().map(|(&bits, &place)| (f64::from_bits(bits), place));
        let shared: Vec<(f64, DVec3)> = if rising { shared.collect() } else { shared.rev().collect() };
        for (along, place) in shared {
            let past = |patch: &Self, v: u32| {
                let ahead = along_edge(mesh, t, k, patch.vertices[v as usize].b) - along;
                if rising { ahead } else { -ahead }
            };
            while let Some(passed) = own.next_if(|&v| past(self, v) < -super::SAME_POINT) {
                last = passed;
            }
            last = match own.next_if(|&v| past(self, v) <= super::SAME_POINT) {
                Some(known) => known,
                None => {
                    let next = own.peek().copied().unwrap_or(end);
                    self.put_between(surface, t, last, next, on_edge(mesh, t, k, along))
                }
            };
            self.move_to(last as usize, place);
            // What lies too near to be another point becomes the same.
            while let Some(same) = own.next_if(|&v| past(self, v).abs() <= super::SAME_POINT) {
                self.move_to(same as usize, place);
                last = same;
            }
        }
    }

    /// Adds the regions as triangles. `shared` numbers the points of base edges.
    pub(super) fn append(
        &self,
        mesh: &Mesh,
        t: usize,
        shared: &dyn Fn(usize, f64) -> Option<u32>,
        dicing: &mut Dicing,
    ) {
        let mut number: Vec<Option<u32>> = vec![None; self.vertices.len()];
        for k in 0..3 {
            number[k] = Some(mesh.av_gv[mesh.triangles[t].av[k] as usize]);
            let mut between = Vec::new();
            self.between(k as u32, (k as u32 + 1) % 3, &mut between);
            let ge = mesh.ae_ge[mesh.triangles[t].ae[k] as usize] as usize;
            for v in between {
                number[v as usize] = shared(ge, along_edge(mesh, t, k, self.vertices[v as usize].b));
            }
        }
        let numbers: Vec<u32> = number
            .into_iter()
            .zip(&self.vertices)
            .map(|(number, vertex)| {
                number.unwrap_or_else(|| {
                    dicing.positions.push(vertex.position);
                    dicing.positions.len() as u32 - 1
                })
            })
            .collect();
        for polygon in &self.polygons {
            let outline = self.expanded(&polygon.corners);
            let moved = outline.iter().map(|&v| self.vertices[v as usize].moved).fold(0.0, f64::max);
            let places: Vec<DVec3> = outline.iter().map(|&v| self.vertices[v as usize].b).collect();
            for corners in ears::triangles(&places) {
                let triangle = corners.map(|k| numbers[outline[k] as usize]);
                if has_one_point_twice(triangle) {
                    continue;
                }
                dicing.triangles.push(triangle);
                dicing.at.push(corners.map(|k| places[k]));
                dicing.base.push(t as u32);
                dicing.residual.push(((polygon.deviation + moved) as f32).next_up());
            }
        }
    }
}

/// Points of an edge that are nearly one are one; between them nothing is left.
fn has_one_point_twice([a, b, c]: [u32; 3]) -> bool {
    a == b || b == c || c == a
}

/// How far along its edge a point on side k lies, 0 to 1 from the edge's lower vertex.
fn along_edge(mesh: &Mesh, t: usize, k: usize, b: DVec3) -> f64 {
    let (from, to) = ends(mesh, t, k);
    b[to] / (b[to] + b[from])
}

fn on_edge(mesh: &Mesh, t: usize, k: usize, along: f64) -> DVec3 {
    let (from, to) = ends(mesh, t, k);
    let mut b = DVec3::ZERO;
    b[to] = along;
    b[from] = 1.0 - along;
    b
}

/// Corners where the edge of side k starts and ends.
fn ends(mesh: &Mesh, t: usize, k: usize) -> (usize, usize) {
    let triangle = &mesh.triangles[t];
    let forward = mesh.ae_av[triangle.ae[k] as usize][0] == triangle.av[k];
    if forward { (k, (k + 1) % 3) } else { ((k + 1) % 3, k) }
}
