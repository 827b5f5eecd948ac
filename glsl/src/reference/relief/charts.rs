//! Twin of `chart_walk`: a straight way over a height map, from triangle to triangle, as far as they are of one chart. A
//! chart goes on where the map repeats, and, bent, where it is mirrored.

use glam::{DVec2, DVec3};

use crate::layout::relief::{CHART_OPEN, CHART_SEAM, ChartSides, Crossing};

/// Of triangles; beyond as many, a way goes on as if there were no border.
pub const MOST_CROSSED: usize = 64;
pub const MOST_BENDS: usize = 3;

/// The triangles of a mesh as they lie on its map, which is 1 wide and high.
pub struct Charts<'a> {
    pub sides: &'a [ChartSides],
    pub triangles: &'a [[u32; 3]],
    /// Of a vertex, on the map.
    pub place: &'a dyn Fn(u32) -> DVec2,
    /// Of a vertex, mesh-local.
    pub position: &'a dyn Fn(u32) -> DVec3,
}

/// How a way ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum End {
    /// On the chart, or nobody knows.
    #[default]
    Inside,
    /// Nothing is beyond.
    Open,
    /// The surface goes on, and is elsewhere on the map.
    Seam,
}

/// A way, and what has become of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Way {
    /// That it has come to.
    pub triangle: usize,
    /// The side it came in by.
    entry: Option<usize>,
    /// What is to be added to places of the triangle.
    pub turns: DVec2,
    /// Its place where t is 0, as if it had been straight.
    from: DVec2,
    rate: DVec2,
    /// So far it is inside.
    pub t: f64,
    pub end: End,
    /// Places and t.
    pub bends: Vec<(DVec2, f64)>,
}

/// What a triangle is left by.
enum Step {
    Ends(End),
    Goes,
}

impl Way {
    #[must_use]
    pub fn new(triangle: usize, place: DVec2, rate: DVec2) -> Self {
        let turns = DVec2::ZERO;
        Self { triangle, entry: None, turns, from: place, rate, t: 0.0, end: End::Inside, bends: Vec::new() }
    }

    #[must_use]
    pub fn place(&self, t: f64) -> DVec2 {
        self.from + self.rate * t
    }

    /// On until t is `until`, or a border is met; one that mirrors is one after so many bends.
    #[must_use]
    pub fn followed(mut self, charts: &Charts<'_>, until: f64, most_bends: usize) -> Self {
        self.bends.clear();
        for _ in 0..MOST_CROSSED {
            if let Step::Ends(end) = self.cross(charts, until, most_bends) {
                return Self { end, ..self };
            }
        }
        Self { t: until, end: End::Inside, ..self }
    }

    fn cross(&mut self, charts: &Charts<'_>, until: f64, most_bends: usize) -> Step {
        let vertices = charts.triangles[self.triangle];
        let places = vertices.map(|v| (charts.place)(v) + self.turns);
        let Some((side, leaves)) = self.exit(places, until) else {
            self.t = until;
            return Step::Ends(End::Inside);
        };
        self.t = self.t.max(leaves);
        let across = charts.sides[self.triangle].across[side];
        match across {
            CHART_OPEN => return Step::Ends(End::Open),
            CHART_SEAM => return Step::Ends(End::Seam),
            _ => {}
        }
        let crossing = Crossing::of(charts.sides[self.triangle].how[side]);
        if crossing.mirrored {
            self.bend(vertices.map(charts.position), places, side);
        }
        self.turns += DVec2::from_array(crossing.turns.map(f64::from));
        self.entry = Some(crossing.side as usize);
        self.triangle = across as usize;
        if self.bends.len() > most_bends {
            self.bends.pop();
            return Step::Ends(End::Seam);
        }
        Step::Goes
    }

    /// The first side that leads out before `until`, and when.
    fn exit(&self, places: [DVec2; 3], until: f64) -> Option<(usize, f64)> {
        let turn = (places[1] - places[0]).perp_dot(places[2] - places[0]);
        let turn = if turn == 0.0 { 0.0 } else { turn.signum() };
        let leaves = |side: usize| {
            let along = places[(side + 1) % 3] - places[side];
            let rate = turn * self.rate.perp_dot(along);
            let gap = turn * (places[side] - self.from).perp_dot(along);
            (rate > 0.0).then(|| (side, gap / rate))
        };
        let sides = (0..3).filter(|side| Some(*side) != self.entry);
        sides.filter_map(leaves).filter(|(_, t)| *t < until).min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// What lies across a side on the surface lies on its near side on the map.
    fn bend(&mut self, corners: [DVec3; 3], places: [DVec2; 3], side: usize) {
        let [next, last] = [(side + 1) % 3, (side + 2) % 3];
        let edge = corners[next] - corners[side];
        let share = (corners[last] - corners[side]).dot(edge) / edge.length_squared();
        let along = places[next] - places[side];
        let across = places[last] - places[side] - along * share;
        let place = self.place(self.t);
        self.rate -= across * (2.0 * along.perp_dot(self.rate) / along.perp_dot(across));
        self.from = place - self.rate * self.t;
        self.bends.push((place, self.t));
    }
}

#[cfg(test)]
mod tests;
