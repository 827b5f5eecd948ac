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
    /// What was asked for, in turn.
    pub asked: Vec<Asked>,
    /// Number of the question that is decided the other way.
    pub turned: Option<usize>,
}

/// What a march decides by, at the end of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Asked {
    /// By its sign.
    Gap { part: u32, gap: f64 },
    /// By how many there are whole.
    Parts { part: u32, parts: f64 },
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
        Self { map, course, steps: map.steps(course), asked: Vec::new(), turned: None }
    }

    /// The same, but question number k is decided the other way.
    #[must_use]
    pub fn turning(self, k: usize) -> Self {
        Self { turned: Some(k), asked: Vec::new(), ..self }
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
        match (self.ask(Asked::Gap { part, gap }), gap > 0.0) {
            (false, _) => gap,
            (true, true) => -gap,
            (true, false) => (-gap).max(f64::MIN_POSITIVE),
        }
    }

    /// Whole parts; the other way, the number that is next nearest.
    pub fn whole(&mut self, part: u32, parts: f64) -> u32 {
        let whole = parts as u32;
        match (self.ask(Asked::Parts { part, parts }), parts.fract() < 0.5) {
            (false, _) => whole,
            (true, true) => whole.saturating_sub(1),
            (true, false) => whole + 1,
        }
    }

    /// Whether it is decided the other way.
    fn ask(&mut self, asked: Asked) -> bool {
        self.asked.push(asked);
        self.turned == Some(self.asked.len() - 1)
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

    /// A cone is read for each question of how many parts.
    fn fetches(&self) -> u32 {
        self.asked.len() as u32
    }

    /// The march of what is met at s.
    #[must_use]
    pub fn met(&self, s: f64, steps: u32) -> March {
        let place = self.course.place(s).truncate().truncate();
        March { s, place, fetches: self.fetches(), steps, capped: false }
    }

    #[must_use]
    pub fn nothing_met(&self) -> March {
        March::missed(self.fetches(), self.steps)
    }
}
