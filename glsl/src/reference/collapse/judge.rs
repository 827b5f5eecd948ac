//! Which vertices may go, and what it costs.

use std::cmp::Ordering;

use glam::DVec3;
use smallvec::SmallVec;

use super::{
    Candidate, Facet, MOST_AROUND, Simplified, Stars,
    star::{Corner, Star, Triangle, corners, twice_area},
};
use crate::{
    layout::refine::{RefinedVertex, kind},
    reference::{
        bound::{Asked, bound_in_map, is_direct},
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

/// A vertex drawn into a neighbour, by its number in the star.
#[derive(Clone, Copy)]
struct Move {
    to: usize,
    /// The error is no less.
    least: f64,
}

/// A triangle that faces away from its base may turn so far: half its old direction.
const LEAST_TURN: f64 = 0.5;

impl Judge<'_> {
    /// No way costs less, as far as is quickly known: what is lost at the vertex itself. None where it may not go.
    #[must_use]
    pub fn least(&self, vertex: u32) -> Option<f64> {
        let mut star = Star::default();
        if !self.gather(&mut star, vertex) {
            return None;
        }
        let mut least: Option<f64> = None;
        for planned in self.moves(&star, vertex) {
            least = Some(least.map_or(planned.least, |least| least.min(planned.least)));
            if planned.least == 0.0 {
                break;
            }
        }
        least
    }

    /// The neighbour that costs least, of equal ones the one with the lowest key.
    #[must_use]
    pub fn candidate(&self, vertex: u32) -> Candidate {
        let mut star = Star::default();
        if !self.gather(&mut star, vertex) {
            return Candidate::None;
        }
        let mut moves: SmallVec<[Move; 12]> = self.moves(&star, vertex).collect();
        let key = |to: u32| (self.mesh.keys[to as usize], to);
        let order = |planned: &Move| (planned.least, key(star.neighbour(planned.to)));
        moves.sort_unstable_by(|a, b| order(a).partial_cmp(&order(b)).unwrap_or(Ordering::Equal));
        star.find_in_map(self.places, self.mesh);
        let mut best: Option<(usize, f64)> = None;
        for planned in moves {
            let most = best.map_or(1.0, |(_, error)| error);
            if planned.least > most || best.is_some() && planned.least == most {
                break;
            }
            let found = self.error(&star, planned.to, most).filter(|error| best.is_none() || *error < most);
            best = found.map(|error| (planned.to, error)).or(best);
        }
        best.map_or(Candidate::None, |(to, error)| Candidate::To { vertex: star.neighbour(to), error })
    }

    /// Whether the vertex may go at all; into a star that is empty.
    fn gather(&self, star: &mut Star, vertex: u32) -> bool {
        let triangles = self.stars.of(vertex);
        let stays = self.mesh.vertices[vertex as usize].kind == kind::CORNER;
        if stays || triangles.is_empty() || triangles.len() > MOST_AROUND {
            return false;
        }
        star.gather(self.places, self.mesh, triangles, vertex);
        true
    }

    /// The ways it may go.
    fn moves<'s>(&'s self, star: &'s Star, vertex: u32) -> impl Iterator<Item = Move> + 's {
        let moving = self.mesh.vertices[vertex as usize];
        let sheets = if moving.kind == kind::EDGE { star.sheets() } else { 2 };
        let open = move |to: &usize| star.shared_with(*to) == sheets && self.is_along(&moving, star.neighbour(*to));
        star.neighbours().filter(open).filter_map(|to| self.planned(star, to))
    }

    /// Whether the vertex may go there: along its base edge, if it is on one. (And with as many triangles vanishing as
    /// there are sheets around.)
    fn is_along(&self, moving: &RefinedVertex, to: u32) -> bool {
        if moving.kind == kind::INTERIOR {
            return true;
        }
        let target = &self.mesh.vertices[to as usize];
        match target.kind {
            kind::CORNER => self.places.base.edges[moving.owner as usize].contains(&target.owner),
            kind::EDGE => target.owner == moving.owner,
            _ => false,
        }
    }

    /// None where a triangle would turn over, or where the place that the vertex leaves would be too far off.
    fn planned(&self, star: &Star, to: usize) -> Option<Move> {
        // The cheapest question first: it settles most.
        if star.after(to).any(|(_, after)| after.twice_area() <= 0) {
            return None;
        }
        let mut least: f64 = 0.0;
        for (before, after) in star.after(to) {
            least = least.max(self.lost(&before, &after));
            if least > 1.0 || !self.faces_as(&before, &after) {
                return None;
            }
        }
        Some(Move { to, least })
    }

    /// How far the place of the vertex is from a triangle that now lies over it, as a share of the tolerance.
    #[inline]
    fn lost(&self, before: &Triangle<'_>, after: &Triangle<'_>) -> f64 {
        let [a, b, c] = after.0.map(|corner| corner.units);
        let left = before.0[0].units;
        let (beyond_b, beyond_c) = (twice_area([a, left, c]), twice_area([a, b, left]));
        if beyond_b < 0 || beyond_c < 0 {
            return 0.0;
        }
        let whole = after.twice_area();
        let shares = [whole - beyond_b - beyond_c, beyond_b, beyond_c].map(|share| share as f64 / whole as f64);
        let positions = after.positions();
        let flat = positions[0] * shares[0] + positions[1] * shares[1] + positions[2] * shares[2];
        flat.distance(before.0[0].position) / (self.tolerance)(positions)
    }

    /// The largest error of the triangles that come of it; none above `most`.
    fn error(&self, star: &Star, to: usize, most: f64) -> Option<f64> {
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
        let corners = corners(self.places, self.mesh, facet).map(|corner| corner.in_map(self.places, self.mesh));
        self.error_at(&Triangle(corners.each_ref()), most)
    }

    fn error_at(&self, triangle: &Triangle<'_>, most: f64) -> f64 {
        if is_direct(self.places, triangle.base(), &triangle.in_map()) {
            return self.find(triangle, most);
        }
        // From one corner on, whoever asks: sums in another order differ in their last bits.
        let triangle = triangle.lowest_first();
        self.mesh.found.of(triangle.facet(), most, || self.find(&triangle, most))
    }

    fn find(&self, triangle: &Triangle<'_>, most: f64) -> f64 {
        let tolerance = (self.tolerance)(triangle.positions());
        bound_in_map(self.places, self.asked, triangle.base(), triangle.shares(), triangle.in_map(), tolerance, most)
    }

    /// The larger error of what turning the side ab between the triangles abc and bad makes, below `most`; none where
    /// it is not, or where a new triangle would run or face the other way.
    pub(in crate::reference) fn turned(&self, gv: [u32; 4], base: u32, most: f64) -> Option<f64> {
        let corners = gv.map(|gv| Corner::new(self.places, self.mesh, gv, base));
        let before = triangles(&corners, [[0, 1, 2], [1, 0, 3]]);
        let follows =
            |after: &Triangle<'_>| after.twice_area() > 0 && before.iter().all(|before| self.faces_as(before, after));
        let after = [[2, 0, 3], [3, 1, 2]];
        if !triangles(&corners, after).iter().all(follows) {
            return None;
        }
        let corners = corners.map(|corner| corner.in_map(self.places, self.mesh));
        let mut worst: f64 = 0.0;
        for triangle in triangles(&corners, after) {
            worst = worst.max(self.error_at(&triangle, most));
            if worst >= most {
                return None;
            }
        }
        Some(worst)
    }

    #[inline]
    fn faces_as(&self, before: &Triangle<'_>, after: &Triangle<'_>) -> bool {
        if self.places.is_height_field(after.base()) {
            return true;
        }
        let facing = self.places.tables.triangle_facing[after.base() as usize];
        let new = after.normal();
        if new.dot(DVec3::from_array(facing.map(f64::from))) > 0.0 {
            return true;
        }
        let old = before.normal();
        new.dot(old) > LEAST_TURN * new.length() * old.length()
    }
}

fn triangles(of: &[Corner; 4], corners: [[usize; 3]; 2]) -> [Triangle<'_>; 2] {
    corners.map(|corners| Triangle(corners.map(|k| &of[k])))
}
