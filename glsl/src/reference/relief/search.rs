//! What the methods share that step until a ray is below the surface and then narrow down where it went below; as in
//! `march_search.glsl`.
//!
//! Ways are told in parts of even steps, whole numbers: what is found depends on the signs of gaps alone. A [`Gauge`]
//! keeps how near to zero they came, and can take one the other way, so that tests know which other answer rounding
//! may give.

use super::{Course, March, ReliefMap};

/// Parts of an even step: what five bisections leave.
pub const PARTS: u32 = 32;
/// Of all parts of the most steps.
const MOST_BISECTIONS: u32 = 14;

/// Answers what a march asks of a map on the way of one course.
#[derive(Clone, Debug)]
pub struct Gauge<'a> {
    pub map: &'a ReliefMap,
    pub course: &'a Course,
    /// Even steps of the whole course.
    pub steps: u32,
    /// Of the values that were asked for, in turn; a march decides by their signs.
    pub gaps: Vec<f64>,
    /// Number of the gap whose sign is changed.
    pub turned: Option<usize>,
}

/// Where even steps first lead from above the surface to on or below it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The first below.
    pub step: u32,
    pub above_gap: f64,
    pub below_gap: f64,
}

impl<'a> Gauge<'a> {
    #[must_use]
    pub fn new(map: &'a ReliefMap, course: &'a Course) -> Self {
        Self { map, course, steps: map.steps(course), gaps: Vec::new(), turned: None }
    }

    /// The same, but gap number k has the other sign.
    #[must_use]
    pub fn turning(self, k: usize) -> Self {
        Self { turned: Some(k), gaps: Vec::new(), ..self }
    }

    /// s at the end of a part.
    #[must_use]
    pub fn s(&self, part: u32) -> f64 {
        f64::from(part) * (self.course.nodes.len() - 1) as f64 / f64::from(self.steps * PARTS)
    }

    /// How high the ray is above the surface at the end of a part.
    pub fn gap(&mut self, part: u32) -> f64 {
        let place = self.course.place(self.s(part));
        let gap = place.z - self.map.level.height(place.truncate().truncate());
        self.gaps.push(gap);
        match (self.turned == Some(self.gaps.len() - 1), gap > 0.0) {
            (false, _) => gap,
            (true, true) => -gap,
            (true, false) => (-gap).max(f64::MIN_POSITIVE),
        }
    }

    /// `None` where nothing is met.
    pub fn crossing(&mut self) -> Option<Crossing> {
        let mut above_gap = 0.0;
        for step in 0..=self.steps {
            let gap = self.gap(step * PARTS);
            if above_gap > 0.0 && gap <= 0.0 {
                return Some(Crossing { step, above_gap, below_gap: gap });
            }
            above_gap = gap;
        }
        None
    }

    /// The first part below, between one above the surface and one on or below it.
    pub fn bisected(&mut self, mut above: u32, mut below: u32) -> u32 {
        for _ in 0..MOST_BISECTIONS {
            if below - above <= 1 {
                break;
            }
            let middle = above.midpoint(below);
            if self.gap(middle) <= 0.0 { below = middle } else { above = middle }
        }
        below
    }

    /// The march of what is met at s.
    #[must_use]
    pub fn met(&self, s: f64, steps: u32) -> March {
        let place = self.course.place(s).truncate().truncate();
        March { s, place, fetches: self.gaps.len() as u32, steps, capped: false }
    }

    #[must_use]
    pub fn nothing_met(&self) -> March {
        March::missed(self.gaps.len() as u32, self.steps)
    }
}
