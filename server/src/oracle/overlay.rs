//! How far a triangle is at most from a mesh that lies over it without folds.
//!
//! Lines across the triangle meet the mesh where its own triangles are over it. Where all those that are face the same
//! way, and no border of the mesh runs over the triangle, they cover it: what is covered is open and closed in it. No
//! place of the triangle is then farther from the mesh than the mesh is high over it, which is at the corners of the
//! parts that are over it. Much cheaper than cutting the triangle until its parts are each near one other, which is
//! what is left to do where something folds.

use std::collections::HashSet;

use glam::DVec3;

use super::sheet::Sheet;

/// A border this near to the triangle's own, as a share of it, is its own: rounding tells no more.
const MARGIN: f64 = 1e-9;
/// Triangles of the mesh over one triangle that are looked at: more are left to others.
const MOST: usize = 1 << 16;
const NONE: u32 = u32::MAX;

/// A mesh and which of its triangles share a side.
pub struct Overlay<'s> {
    sheet: &'s Sheet<'s>,
    /// Of each triangle, across the side that starts at each corner; `NONE` at borders and where sheets meet.
    neighbours: Vec<[u32; 3]>,
}

/// A place by its weights at the triangle's corners, and its height over it.
type Raised = [f64; 4];

impl<'s> Overlay<'s> {
    #[must_use]
    pub fn new(sheet: &'s Sheet<'s>) -> Self {
        let mut sides: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * sheet.triangles.len());
        for (t, ids) in (0..).zip(&sheet.triangles) {
            sides.extend((0..3).map(|k| {
                let (a, b) = (ids[k], ids[(k + 1) % 3]);
                ([a.min(b), a.max(b)], 3 * t + k as u32)
            }));
        }
        sides.sort_unstable();
        let mut neighbours = vec![[NONE; 3]; sheet.triangles.len()];
        for group in sides.chunk_by(|a, b| a.0 == b.0) {
            if let &[(_, a), (_, b)] = group {
                neighbours[a as usize / 3][a as usize % 3] = b / 3;
                neighbours[b as usize / 3][b as usize % 3] = a / 3;
            }
        }
        Self { sheet, neighbours }
    }

    #[must_use]
    pub fn sheet(&self) -> &Sheet<'s> {
        self.sheet
    }

    /// No place of the triangle is farther from the mesh; none where that is not shown. `start` is a triangle of the mesh
    /// near to it.
    #[must_use]
    pub fn height(&self, corners: [DVec3; 3], start: u32, seen: &mut Seen) -> Option<f64> {
        let frame = Frame::of(corners)?;
        seen.begin(start);
        let (mut highest, mut is_covered) = (0f64, false);
        while let Some(t) = seen.next() {
            let raised = self.sheet.corners(t).map(|p| frame.raised(p));
            let part = part_over(&raised);
            if part.is_empty() {
                continue;
            }
            if !faces_alike(&raised) || seen.all.len() > MOST {
                return None;
            }
            is_covered = true;
            seen.over.push(t);
            highest = part.iter().fold(highest, |most, p| most.max(p[3].abs()));
            for k in 0..3 {
                let side = [raised[k], raised[(k + 1) % 3]];
                match self.neighbours[t as usize][k] {
                    NONE if runs_over(side, MARGIN) => return None,
                    NONE => {}
                    other => {
                        if runs_over(side, -MARGIN) {
                            seen.add(other);
                        }
                    }
                }
            }
        }
        let extent = corners[0].distance(corners[1]).max(corners[1].distance(corners[2]));
        is_covered.then_some(highest + 4.0 * MARGIN * extent)
    }
}

/// The triangles that a search has come to; kept from one search to the next to save memory.
#[derive(Default)]
pub struct Seen {
    all: Vec<u32>,
    known: HashSet<u32>,
    done: usize,
    /// Those that are over the triangle.
    over: Vec<u32>,
}

/// Triangles of the mesh, the last repeated.
pub type Few = [u32; 4];

impl Seen {
    fn begin(&mut self, start: u32) {
        self.all.clear();
        self.known.clear();
        self.over.clear();
        self.done = 0;
        self.add(start);
    }

    fn next(&mut self) -> Option<u32> {
        self.done += 1;
        self.all.get(self.done - 1).copied()
    }

    /// The triangles of the mesh over the last triangle that was covered.
    #[must_use]
    pub fn few(&self) -> Option<Few> {
        let last = *self.over.last()?;
        (self.over.len() <= 4).then(|| std::array::from_fn(|k| self.over.get(k).copied().unwrap_or(last)))
    }

    fn add(&mut self, triangle: u32) {
        if self.known.insert(triangle) {
            self.all.push(triangle);
        }
    }
}

/// From places to weights at the corners of a triangle, and heights over it.
struct Frame {
    origin: DVec3,
    weights: [DVec3; 2],
    normal: DVec3,
}

impl Frame {
    /// None where rounding leaves the triangle no area.
    fn of([a, b, c]: [DVec3; 3]) -> Option<Self> {
        let (ab, ac) = (b - a, c - a);
        let cross = ab.cross(ac);
        let square = cross.length_squared();
        let is_flat = square <= 1e-16 * ab.length_squared() * ac.length_squared();
        let weights = [ac.cross(cross) / square, cross.cross(ab) / square];
        (!is_flat && square > 0.0).then(|| Self { origin: a, weights, normal: cross / square.sqrt() })
    }

    fn raised(&self, place: DVec3) -> Raised {
        let from = place - self.origin;
        let [b, c] = self.weights.map(|weight| weight.dot(from));
        [1.0 - b - c, b, c, self.normal.dot(from)]
    }
}

/// Whether a triangle of the mesh runs round as the one under it does.
fn faces_alike([a, b, c]: &[Raised; 3]) -> bool {
    (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1]) > 0.0
}

/// Whether a side comes farther over the triangle than by `margin` of it.
fn runs_over([from, to]: [Raised; 2], margin: f64) -> bool {
    let (mut first, mut last) = (0f64, 1f64);
    for k in 0..3 {
        let (start, end) = (from[k] - margin, to[k] - margin);
        if start < 0.0 && end < 0.0 {
            return false;
        }
        if start < 0.0 {
            first = first.max(start / (start - end));
        } else if end < 0.0 {
            last = last.min(start / (start - end));
        }
    }
    first <= last
}

/// The corners of what of a triangle of the mesh is over the one under it (Sutherland and Hodgman 1974).
fn part_over(corners: &[Raised; 3]) -> Vec<Raised> {
    let mut part = corners.to_vec();
    for k in 0..3 {
        if part.iter().all(|p| p[k] >= 0.0) {
            continue;
        }
        let mut rest = Vec::with_capacity(part.len() + 1);
        for (i, p) in part.iter().enumerate() {
            let q = &part[(i + 1) % part.len()];
            if p[k] >= 0.0 {
                rest.push(*p);
            }
            if (p[k] < 0.0) != (q[k] < 0.0) {
                let share = p[k] / (p[k] - q[k]);
                rest.push(std::array::from_fn(|n| p[n] + share * (q[n] - p[n])));
            }
        }
        part = rest;
    }
    part
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid of 4 x 4 squares of side 1 in xz, facing +y, as high as `height` says.
    fn grid(height: impl Fn(u32, u32) -> f64) -> Sheet<'static> {
        let at = |i: u32| [i % 5, i / 5];
        let place = |i: u32| DVec3::new(f64::from(at(i)[0]), height(at(i)[0], at(i)[1]), f64::from(at(i)[1]));
        let corners = (0..25).filter(|&i| at(i)[0] < 4 && at(i)[1] < 4);
        let triangles = corners.flat_map(|i| [[i, i + 5, i + 1], [i + 1, i + 5, i + 6]]).collect();
        Sheet::of_triangles((0..25).map(place).collect(), triangles)
    }

    const UNDER: [DVec3; 3] = [DVec3::new(0.5, 0.0, 0.5), DVec3::new(0.5, 0.0, 3.5), DVec3::new(3.0, 0.0, 0.5)];

    fn height(sheet: &Sheet<'_>, corners: [DVec3; 3]) -> Option<f64> {
        let near = sheet.nearest(corners.into_iter().sum::<DVec3>() / 3.0, None, 0.0)?;
        Overlay::new(sheet).height(corners, near.triangle, &mut Seen::default())
    }

    #[test]
    fn a_triangle_is_as_far_from_what_covers_it_as_that_is_high() {
        let tent = grid(|x, z| if (x, z) == (1, 2) { 0.25 } else { 0.125 });
        let found = height(&tent, UNDER).unwrap();
        assert!((found - 0.25).abs() < 1e-7, "{found}");
        // The highest place is not over this one.
        let beside = UNDER.map(|p| DVec3::new(3.9 - 0.4 * p.x, 0.0, 0.4 * p.z));
        let found = height(&tent, [beside[0], beside[2], beside[1]]).unwrap();
        assert!((found - 0.125).abs() < 1e-7, "{found}");
    }

    #[test]
    fn what_a_border_runs_over_or_a_fold_lies_over_is_not_shown() {
        assert_eq!(height(&grid(|_, _| 0.0), UNDER.map(|p| 1.5 * p)), None);
        let mut folded = grid(|_, _| 0.0);
        folded.positions[6].x = 2.5;
        assert_eq!(height(&folded, UNDER), None);
        assert_eq!(height(&grid(|_, _| 0.0), [UNDER[0], UNDER[2], UNDER[1]]), None, "upside down");
    }

    #[test]
    fn a_side_that_is_the_border_is_none() {
        let whole = [DVec3::ZERO, DVec3::new(0.0, 0.0, 4.0), DVec3::new(4.0, 0.0, 0.0)];
        assert!(height(&grid(|_, _| 0.0), whole).unwrap() < 1e-7);
    }

    #[test]
    fn few_triangles_that_cover_are_named() {
        let (sheet, mut seen) = (grid(|_, _| 0.0), Seen::default());
        let small = UNDER.map(|p| DVec3::new(0.1, 0.0, 0.1) + 0.1 * p);
        assert!(Overlay::new(&sheet).height(small, 0, &mut seen).is_some());
        assert_eq!(seen.few(), Some([0; 4]));
        assert!(Overlay::new(&sheet).height(UNDER, 0, &mut seen).is_some());
        assert_eq!(seen.few(), None);
    }
}
