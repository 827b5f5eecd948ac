//! A ray over the lattice: which cells it is over between which t, and where it meets the surface in one of them.

use std::iter;

use glam::{DVec2, DVec3};

use super::Hit;
use crate::oracle::{bvh::Segment, field::Field};

/// Numbers of blocks of cells, or of lattice lines, across and down.
pub(super) type Lattice = [i64; 2];
/// Start and end, of t.
pub(super) type Range = [f64; 2];

const NEVER: Range = [f64::INFINITY, f64::NEG_INFINITY];

pub(super) struct Course {
    ray: Segment,
    /// 1 when the ray starts on or above the surface, −1 below it.
    side: f64,
}

/// Every rounding on the way to a root, as a share of what goes in: about twenty, rounded up.
const ROUNDING: f64 = 256.0 * f64::EPSILON;

impl Course {
    pub(super) fn new(field: &Field, channel: u32, ray: &Segment) -> Self {
        let mut course = Self { ray: *ray, side: 1.0 };
        let [x, y] = [0, 1].map(|axis| course.first_cell(axis));
        let place = course.place(ray.from);
        let above = place.z - field.patch(channel, x, y).value(from_corner([x, y], place)) >= 0.0;
        course.side = if above { 1.0 } else { -1.0 };
        course
    }

    fn place(&self, t: f64) -> DVec3 {
        self.ray.origin + self.ray.direction * t
    }

    /// The t at which a lattice line is crossed: from its number alone, so that whoever asks gets the same bits.
    fn crossing(&self, axis: usize, line: i64) -> f64 {
        (line as f64 - self.ray.origin[axis]) / self.ray.direction[axis]
    }

    /// The t between two lines of one axis.
    fn between(&self, axis: usize, low: i64, high: i64) -> Range {
        let direction = self.ray.direction[axis];
        if direction > 0.0 {
            [self.crossing(axis, low), self.crossing(axis, high)]
        } else if direction < 0.0 {
            [self.crossing(axis, high), self.crossing(axis, low)]
        } else if (low..high).contains(&(self.ray.origin[axis].floor() as i64)) {
            [f64::NEG_INFINITY, f64::INFINITY]
        } else {
            NEVER
        }
    }

    /// The parts before and after lattice line `middle`, in the order of the ray, of an axis' span.
    pub(super) fn halves(&self, axis: usize, middle: i64, [start, end]: Range) -> [Range; 2] {
        if self.ray.direction[axis] != 0.0 {
            let middle = self.crossing(axis, middle);
            [[start, middle], [middle, end]]
        } else if (self.ray.origin[axis].floor() as i64) < middle {
            [[start, end], NEVER]
        } else {
            [NEVER, [start, end]]
        }
    }

    /// The t for which the ray is in the spans of both axes; none where it only touches what they are of.
    pub(super) fn within(&self, [x, y]: [Range; 2]) -> Option<Range> {
        let start = later(self.ray.from, later(x[0], y[0]));
        let end = earlier(self.ray.to, earlier(x[1], y[1]));
        (start < end).then_some([start, end])
    }

    /// 1, −1 or 0 lines at a time.
    pub(super) fn step(&self, axis: usize) -> i64 {
        let direction = self.ray.direction[axis];
        i64::from(direction > 0.0) - i64::from(direction < 0.0)
    }

    /// The column or row in which the ray starts, or one that it has just left.
    fn first_cell(&self, axis: usize) -> i64 {
        let mut cell = self.place(self.ray.from)[axis].floor() as i64;
        // Rounding may put the start beyond a line that is crossed later.
        while self.between(axis, cell, cell + 1)[0] > self.ray.from {
            cell -= self.step(axis);
        }
        cell
    }

    /// The blocks of `size` cells along the ray, in order, and the spans of each across and down.
    pub(super) fn blocks(&self, size: Lattice) -> impl Iterator<Item = (Lattice, [Range; 2])> {
        let mut next = Some([0, 1].map(|axis| self.first_cell(axis).div_euclid(size[axis])));
        iter::from_fn(move || {
            loop {
                let block = next?;
                let lines = |axis: usize| (block[axis] * size[axis], (block[axis] + 1) * size[axis]);
                let spans = [0, 1].map(|axis| self.between(axis, lines(axis).0, lines(axis).1));
                next = self.after(block, spans);
                if self.within(spans).is_some() {
                    return Some((block, spans));
                }
            }
        })
    }

    /// The block that the ray enters where it first leaves one of the spans of this one.
    fn after(&self, mut block: Lattice, [x, y]: [Range; 2]) -> Option<Lattice> {
        let axis = usize::from(y[1] < x[1]);
        block[axis] += self.step(axis);
        (earlier(x[1], y[1]) < self.ray.to).then_some(block)
    }

    /// Whether the ray stays so clear of heights from `low` to `high` that rounding cannot find a hit in it.
    pub(super) fn is_clear(&self, low: f64, high: f64, range: Range) -> bool {
        let z = range.map(|t| self.ray.origin.z + self.ray.direction.z * t);
        let gap = if self.side > 0.0 { earlier(z[0], z[1]) - high } else { low - later(z[0], z[1]) };
        let reach = later(range[0].abs(), range[1].abs());
        let size = self.ray.origin.abs() + self.ray.direction.abs() * reach;
        gap > ROUNDING * (size.z + later(low.abs(), high.abs()) * (2.0 + size.x + size.y))
    }

    /// Where the ray meets the surface in one cell, within the range: the gap to the surface, on the side it starts on,
    /// is c + b t + a t² from the range's start; its first root without cancellation (Press et al. 2007, 5.6).
    pub(super) fn hit(&self, field: &Field, channel: u32, cell: Lattice, [start, end]: Range) -> Option<Hit> {
        let patch = field.patch(channel, cell[0], cell[1]);
        let (place, direction) = (self.place(start), self.ray.direction);
        let p = from_corner(cell, place);
        let c = self.side * (place.z - patch.value(p));
        let b = self.side * (direction.z - patch.gradient(p).dot(direction.truncate()));
        let a = -self.side * patch.twist * direction.x * direction.y;
        let after = first_root(a, b, c)?;
        let hit = Hit { t: earlier(start + after, end), cell, from_above: self.side > 0.0 };
        (after <= end - start).then_some(hit)
    }
}

/// The first t from 0 on where c + b t + a t² is not above 0.
fn first_root(a: f64, b: f64, c: f64) -> Option<f64> {
    let discriminant = b * b - 4.0 * a * c;
    if c <= 0.0 {
        Some(0.0)
    } else if discriminant < 0.0 {
        None
    } else if b < 0.0 {
        Some(2.0 * c / (discriminant.sqrt() - b))
    } else {
        (a < 0.0).then(|| -0.5 * (b + discriminant.sqrt()) / a)
    }
}

fn from_corner(cell: Lattice, place: DVec3) -> DVec2 {
    place.truncate() - DVec2::new(cell[0] as f64, cell[1] as f64)
}

/// As `f64::max` and `f64::min`, which leave open which zero they return.
fn later(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

fn earlier(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}
