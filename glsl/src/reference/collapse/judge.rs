//! Which vertices may go, and what it costs.

use std::cmp::Ordering;

use glam::DVec3;

use super::{
    Candidate, Facet, MOST_AROUND, Simplified, Stars,
    star::{Around, Star, twice_area},
};
use crate::{
    layout::refine::{RefinedVertex, kind},
    reference::{
        bound::{Asked, bound},
        place::Places,
    },
};

/// Everything a candidate is judged by.
pub struct Judge<'j> {
    pub places: &'j Places<'j>,
    pub asked: Asked,
    pub mesh: &'j Simplified,
    pub stars: &'j Stars,
    /// What a triangle with these displaced corners may be off by.
    pub tolerance: &'j (dyn Fn([DVec3; 3]) -> f64 + Sync),
}

/// A vertex drawn into another.
#[derive(Clone, Copy)]
struct Move {
    to: u32,
    /// The error is no less.
    least: f64,
}

/// A triangle that faces away from its base may turn so far: half its old direction.
const LEAST_TURN: f64 = 0.5;

impl Judge<'_> {
    /// What is quickly known: what is lost at the vertex itself.
    #[must_use]
    pub fn estimate(&self, vertex: u32) -> Candidate {
        let Some(star) = self.star(vertex) else { return Candidate::None };
        let least = self.moves(&star, vertex).map(|planned| planned.least).min_by(f64::total_cmp);
        least.map_or(Candidate::None, |error| Candidate::AtLeast { error })
    }

    /// The neighbour that costs least, of equal ones the one with the lowest key.
    #[must_use]
    pub fn candidate(&self, vertex: u32) -> Candidate {
        let Some(star) = self.star(vertex) else { return Candidate::None };
        let mut moves: Vec<Move> = self.moves(&star, vertex).collect();
        let order = |planned: &Move| (planned.least, self.mesh.keys[planned.to as usize], planned.to);
        moves.sort_by(|a, b| order(a).partial_cmp(&order(b)).unwrap_or(Ordering::Equal));
        let mut best: Option<(u32, f64)> = None;
        for planned in moves {
            let most = best.map_or(1.0, |(_, error)| error);
            if planned.least > most || best.is_some() && planned.least == most {
                break;
            }
            let found = self.error(&star, planned.to, most).filter(|error| best.is_none() || *error < most);
            best = found.map(|error| (planned.to, error)).or(best);
        }
        best.map_or(Candidate::None, |(vertex, error)| Candidate::To { vertex, error })
    }

    /// None around a vertex that stays in any case.
    fn star(&self, vertex: u32) -> Option<Star> {
        let triangles = self.stars.of(vertex);
        let stays = self.mesh.vertices[vertex as usize].kind == kind::CORNER;
        (!stays && !triangles.is_empty() && triangles.len() <= MOST_AROUND)
            .then(|| Star::new(self.places.base, self.mesh, triangles, vertex))
    }

    /// The ways it may go.
    fn moves<'s>(&'s self, star: &'s Star, vertex: u32) -> impl Iterator<Item = Move> + 's {
        let moving = self.mesh.vertices[vertex as usize];
        let sheets = if moving.kind == kind::EDGE { star.sheets() } else { 2 };
        let open = move |to: &&u32| self.is_open(star, &moving, **to, sheets);
        star.neighbours.iter().filter(open).filter_map(|to| self.planned(star, *to))
    }

    /// Whether the vertex may go there at all: along its base edge, and with as many triangles vanishing as there are
    /// sheets around.
    fn is_open(&self, star: &Star, moving: &RefinedVertex, to: u32, sheets: usize) -> bool {
        let target = &self.mesh.vertices[to as usize];
        let along = match (moving.kind, target.kind) {
            (kind::INTERIOR, _) => true,
            (_, kind::CORNER) => self.places.base.edges[moving.owner as usize].contains(&target.owner),
            (_, kind::EDGE) => target.owner == moving.owner,
            _ => false,
        };
        along && star.shared_with(to) == sheets
    }

    /// None where a triangle would turn over, or where the place that the vertex leaves would be too far off.
    fn planned(&self, star: &Star, to: u32) -> Option<Move> {
        let mut least: f64 = 0.0;
        for (before, after) in star.after(to) {
            if after.twice_area() <= 0 || !self.faces_as(before, &after) {
                return None;
            }
            least = least.max(self.lost(before, &after));
            if least > 1.0 {
                return None;
            }
        }
        Some(Move { to, least })
    }

    /// How far the place of the vertex is from a triangle that now lies over it, as a share of the tolerance.
    fn lost(&self, before: &Around, after: &Around) -> f64 {
        let [a, b, c] = after.corners.each_ref().map(|corner| corner.units);
        let left = before.corners[0].units;
        let (beyond_b, beyond_c) = (twice_area([a, left, c]), twice_area([a, b, left]));
        if beyond_b < 0 || beyond_c < 0 {
            return 0.0;
        }
        let at_a = twice_area([left, b, c]);
        let whole = (at_a + beyond_b + beyond_c) as f64;
        let shares = [at_a, beyond_b, beyond_c].map(|share| share as f64 / whole);
        let positions = after.positions();
        let flat = positions[0] * shares[0] + positions[1] * shares[1] + positions[2] * shares[2];
        flat.distance(before.corners[0].position) / (self.tolerance)(positions)
    }

    /// The largest error of the triangles that come of it; none above `most`.
    fn error(&self, star: &Star, to: u32, most: f64) -> Option<f64> {
        let mut worst = 0.0;
        for (_, after) in star.after(to) {
            let error = self.error_at(&after, most);
            if error > most {
                return None;
            }
            worst = error.max(worst);
        }
        Some(worst)
    }

    /// As a share of the tolerance; anything above `most` where it is above.
    #[must_use]
    pub fn error_of(&self, facet: &Facet, most: f64) -> f64 {
        self.error_at(&self.around(facet), most)
    }

    fn error_at(&self, around: &Around, most: f64) -> f64 {
        let tolerance = (self.tolerance)(around.positions());
        bound(self.places, self.asked, around.base, around.shares(), tolerance, most)
    }

    fn around(&self, facet: &Facet) -> Around {
        Around::new(self.places.base, self.mesh, facet, 0)
    }

    /// Whether a triangle may take the place of another: it runs the same way in its base triangle, and faces as that
    /// does or nearly as the old one did.
    pub(in crate::reference) fn may_follow(&self, before: &Facet, after: &Facet) -> bool {
        let [before, after] = [before, after].map(|facet| self.around(facet));
        after.twice_area() > 0 && self.faces_as(&before, &after)
    }

    fn faces_as(&self, before: &Around, after: &Around) -> bool {
        let facing = self.places.tables.triangle_facing[after.base as usize];
        let new = after.normal();
        if new.dot(DVec3::from_array(facing.map(f64::from))) > 0.0 {
            return true;
        }
        let old = before.normal();
        new.dot(old) > LEAST_TURN * new.length() * old.length()
    }
}
